// Reads an XML file so that whatever is wrong with it can be said with file and line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/xml_file.h"

#include <charconv>
#include <cmath>

namespace kaz::sim {

Result<XmlFile> XmlFile::load(const std::string& path, const std::string& root_name) {
  XmlFile file;
  file.path_ = path;
  file.document_ = std::make_unique<tinyxml2::XMLDocument>();
  const tinyxml2::XMLError status = file.document_->LoadFile(path.c_str());
  if (status == tinyxml2::XML_ERROR_FILE_NOT_FOUND ||
      status == tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
      status == tinyxml2::XML_ERROR_FILE_READ_ERROR) {
    return fail(Fault::usage, path + ": cannot be read; check the path");
  }
  if (status != tinyxml2::XML_SUCCESS) {
    const std::string what = file.document_->ErrorName();
    return file.error(file.document_->ErrorLineNum(),
                      "is not well-formed XML (" + what + "); check tags and quotes there");
  }
  const tinyxml2::XMLElement* root = file.document_->RootElement();
  if (root == nullptr) return file.error(1, "has no element <" + root_name + ">");
  if (root->Name() != root_name) {
    return file.error(
        *root, std::string("root element is <") + root->Name() + ">, expected <" + root_name + ">");
  }
  return file;
}

tl::unexpected<Error> XmlFile::error(int line, const std::string& message) const {
  return fail(Fault::usage, path_ + ":" + std::to_string(line) + ": " + message);
}

Result<std::string> XmlFile::attribute(const tinyxml2::XMLElement& element,
                                       const char* name) const {
  const char* value = element.Attribute(name);
  if (value == nullptr) {
    return error(element,
                 std::string("<") + element.Name() + "> lacks the attribute `" + name + "`");
  }
  return std::string(value);
}

Result<double> XmlFile::number(const tinyxml2::XMLElement& element, const char* name) const {
  const Result<std::string> text = attribute(element, name);
  if (!text) return tl::unexpected(text.error());
  const auto numbers = parse_numbers(*text, 1);
  if (!numbers) {
    return error(element, std::string("attribute `") + name + "` of <" + element.Name() +
                              "> is \"" + *text + "\", expected a number");
  }
  return numbers->front();
}

std::optional<std::vector<double>> parse_numbers(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (true) {
    while (at != end && blank(*at)) ++at;
    if (at == end) break;
    if (*at == '+') ++at;
    double value = 0;
    const auto [next, status] = std::from_chars(at, end, value);
    if (status != std::errc() || !std::isfinite(value)) return std::nullopt;
    if (next != end && !blank(*next)) return std::nullopt;
    numbers.push_back(value);
    at = next;
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

}  // namespace kaz::sim
