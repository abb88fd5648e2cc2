// Reads an XML file; errors name file and line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tinyxml2.h>
#include <Eigen/Core>

#include "shared/base/result.hpp"

namespace kaz::sim {

class XmlFile {
 public:
  // Fails where the file cannot be read, is too large, is no UTF-8 or well-formed XML, or has another root
  // element.
  static Result<XmlFile> load(const std::string& path, const std::string& root_name);

  const std::string& path() const { return path_; }
  const tinyxml2::XMLElement& root() const { return *document_->RootElement(); }

  // Error "path:line: message" of an invalid input file.
  tl::unexpected<Error> error(int line, const std::string& message) const;
  tl::unexpected<Error> error(const tinyxml2::XMLElement& at, const std::string& message) const {
    return error(at.GetLineNum(), message);
  }

  // Value of a required attribute.
  Result<std::string> attribute(const tinyxml2::XMLElement& element, const char* name) const;
  // Value of a required attribute, one finite number.
  Result<double> number(const tinyxml2::XMLElement& element, const char* name) const;

  // Names go into messages of one line, JSON and XML: the attribute `name`, where there is one, is at most
  // 200 bytes without & < > " ' and control characters.
  Result<void> check_name(const tinyxml2::XMLElement& element) const;

  // For elements that hold other elements alone: no text between them.
  Result<void> check_no_text(const tinyxml2::XMLElement& element) const;

  // The bytes that were parsed.
  const std::string& text() const { return text_; }

 private:
  static constexpr std::size_t kBytesMax = std::size_t{16} << 20;
  static constexpr std::size_t kNameMax = 200;
  Result<void> check_text() const;

  std::string path_, text_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

// Parses exactly `count` finite numbers separated by blanks; nullopt otherwise. Independent of the locale.
std::optional<std::vector<double>> parse_numbers(const std::string& text, std::size_t count);

}  // namespace kaz::sim
