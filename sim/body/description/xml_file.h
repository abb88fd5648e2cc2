// Parses an XML file. An error message names file and line.
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
  // Reads and parses a file. Fails if the file cannot be read, exceeds `max_bytes`, or is not well-formed XML
  // in UTF-8. Also fails if the file has a document type declaration, or if the name of the root element is
  // not `root_name`. An empty `root_name` permits any root element.
  static Result<XmlFile> load(const std::string& path, const std::string& root_name,
                              std::size_t max_bytes = std::size_t{16} << 20);
  // As load(), of text that was read before. `path` is for error messages.
  static Result<XmlFile> parse(const std::string& path, const std::string& root_name,
                               std::string text);

  const std::string& path() const { return path_; }
  const tinyxml2::XMLElement& root() const { return *document_->RootElement(); }

  // Returns the error "path:line: message". Control characters in `message` are replaced by spaces.
  tl::unexpected<Error> error(int line, const std::string& message) const;
  tl::unexpected<Error> error(const tinyxml2::XMLElement& at, const std::string& message) const {
    return error(at.GetLineNum(), message);
  }

  // Returns the value of a required attribute.
  Result<std::string> attribute(const tinyxml2::XMLElement& element, const char* name) const;
  // Returns the value of a required attribute that must be one finite number.
  Result<double> number(const tinyxml2::XMLElement& element, const char* name) const;

  // Returns name_error() as an error with file and line.
  Result<void> check_name(const tinyxml2::XMLElement& element) const;

  // Returns an error if `element` contains text. Call this function for elements that may contain only child
  // elements.
  Result<void> check_no_text(const tinyxml2::XMLElement& element) const;

  // The bytes of the file.
  const std::string& text() const { return text_; }

 private:
  Result<void> check_text() const;

  std::string path_, text_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

// Checks the attribute `name`, if present. The value must have at most 200 bytes, no control characters, and
// none of the characters & < > " '. Reason: names are used in one-line messages, JSON and XML. Returns what
// is wrong, or nullopt.
std::optional<std::string> name_error(const tinyxml2::XMLElement& element);

// Returns the number in an attribute, or `otherwise` if the attribute is missing or not one finite number.
double number_of(const tinyxml2::XMLElement& element, const char* attribute, double otherwise);
// Returns the `count` numbers in an attribute. Empty if the attribute is missing or contains something else.
std::vector<double> numbers_of(const tinyxml2::XMLElement& element, const char* attribute,
                               std::size_t count);

// Returns the number in the attribute `value` or, as Gazebo permits, in the text. nullopt if the number is
// missing, invalid or negative.
std::optional<double> coefficient_in(const tinyxml2::XMLElement& element);

// Parses exactly `count` finite numbers separated by whitespace. If the number of values in `text` is not
// `count`, returns nullopt. If a value is not a finite number, also returns nullopt. The locale of the
// process has no effect.
std::optional<std::vector<double>> parse_numbers(const std::string& text, std::size_t count);

}  // namespace kaz::sim
