// Reads an XML file; errors name file and line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/xml_file.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::sim {
namespace {

// Replaces a declaration <?xml ...?> that follows comments by blanks. XML permits it only at the very start,
// but the parsers of ROS accept it, and old files of xacro have it.
void blank_late_declaration(std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  at = text.find_first_not_of(kBlanks, at);
  const std::size_t first = at;
  while (at != text.npos && text.compare(at, 4, "<!--") == 0) {
    at = text.find("-->", at);
    at = at == text.npos ? at : text.find_first_not_of(kBlanks, at + 3);
  }
  if (at == first || at == text.npos || text.compare(at, 5, "<?xml") != 0) return;
  const std::size_t end = text.find("?>", at);
  if (end == text.npos) return;
  for (std::size_t i = at; i < end + 2; ++i)
    if (text[i] != '\n') text[i] = ' ';
}

}  // namespace

Result<XmlFile> XmlFile::load(const std::string& path, const std::string& root_name,
                              std::size_t max_bytes) {
  return parse(path, root_name, KAZ_TRY(read_whole_file(path, max_bytes)));
}

Result<XmlFile> XmlFile::parse(const std::string& path, const std::string& root_name,
                               std::string text) {
  XmlFile file;
  file.path_ = path;
  file.document_ = std::make_unique<tinyxml2::XMLDocument>();
  file.text_ = std::move(text);
  KAZ_TRY(file.check_text());
  blank_late_declaration(file.text_);
  const tinyxml2::XMLError status = file.document_->Parse(file.text_.data(), file.text_.size());
  if (status == tinyxml2::XML_ERROR_EMPTY_DOCUMENT)
    return file.error(1, root_name.empty() ? "is empty; it needs an element"
                                           : "is empty; it needs an element <" + root_name + ">");
  if (status != tinyxml2::XML_SUCCESS) {
    // "XML_ERROR_MISMATCHED_ELEMENT" in words.
    std::string what = file.document_->ErrorName();
    if (const std::string prefix = "XML_ERROR_"; what.rfind(prefix, 0) == 0)
      what.erase(0, prefix.size());
    for (char& c : what) c = c == '_' ? ' ' : static_cast<char>(std::tolower(c));
    return file.error(file.document_->ErrorLineNum(),
                      "is not well-formed XML (" + what + "); check tags and quotes there");
  }
  // urdfdom and sdformat ignore everything after it.
  for (const tinyxml2::XMLNode* node = file.document_->FirstChild(); node != nullptr;
       node = node->NextSibling()) {
    if (node->ToUnknown() != nullptr)
      return file.error(node->GetLineNum(), "has a document type (<!...>); remove that line");
  }
  const tinyxml2::XMLElement* root = file.document_->RootElement();
  if (root == nullptr) return file.error(1, "has no element <" + root_name + ">");
  if (!root_name.empty() && root->Name() != root_name) {
    return file.error(
        *root, std::string("root element is <") + root->Name() + ">, expected <" + root_name + ">");
  }
  return file;
}

// The parsers of URDF and SDF read the same bytes afterwards, and one of them does not end at a NUL or
// a broken sequence of UTF-8 (TinyXML 2.6.2, CVE-2021-42260).
Result<void> XmlFile::check_text() const {
  int line = 1;
  for (std::size_t i = 0; i < text_.size();) {
    const auto c = static_cast<unsigned char>(text_[i]);
    const std::size_t length = c < 0x80   ? 1
                               : c < 0xc2 ? 0
                               : c < 0xe0 ? 2
                               : c < 0xf0 ? 3
                               : c < 0xf5 ? 4
                                          : 0;
    bool valid = c != 0 && length > 0 && i + length <= text_.size();
    for (std::size_t k = 1; valid && k < length; ++k)
      valid = (static_cast<unsigned char>(text_[i + k]) & 0xc0) == 0x80;
    if (!valid) return error(line, "contains a NUL byte or invalid UTF-8; save it as UTF-8");
    line += c == '\n';
    i += length;
  }
  return {};
}

tl::unexpected<Error> XmlFile::error(int line, const std::string& message) const {
  // Messages quote the file, and stay one line.
  std::string text = message;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return fail(Fault::usage, path_ + ":" + std::to_string(line) + ": " + text);
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

Result<void> XmlFile::check_no_text(const tinyxml2::XMLElement& element) const {
  for (const tinyxml2::XMLNode* node = element.FirstChild(); node; node = node->NextSibling()) {
    if (node->ToText() != nullptr)
      return error(node->GetLineNum(), std::string("text in <") + element.Name() +
                                           ">, which accepts only elements; remove the text");
  }
  return {};
}

Result<void> XmlFile::check_name(const tinyxml2::XMLElement& element) const {
  const auto wrong = name_error(element);
  return wrong ? error(element, *wrong) : Result<void>();
}

std::optional<std::string> name_error(const tinyxml2::XMLElement& element) {
  constexpr std::size_t kNameMax = 200;
  const char* value = element.Attribute("name");
  if (value == nullptr) return std::nullopt;
  const std::string name = value;
  if (name.size() > kNameMax)
    return std::string("the name of <") + element.Name() + "> has " + std::to_string(name.size()) +
           " bytes; names have at most " + std::to_string(kNameMax);
  if (name.find_first_of("&<>\"'") == std::string::npos && one_line(name) == name)
    return std::nullopt;
  return "the name `" + one_line(name) + "` of <" + element.Name() +
         "> contains one of & < > \" ' or a control character; remove it";
}

double number_of(const tinyxml2::XMLElement& element, const char* attribute, double otherwise) {
  const auto numbers = numbers_of(element, attribute, 1);
  return numbers.empty() ? otherwise : numbers.front();
}

std::vector<double> numbers_of(const tinyxml2::XMLElement& element, const char* attribute,
                               std::size_t count) {
  const char* text = element.Attribute(attribute);
  return parse_numbers(text == nullptr ? "" : text, count).value_or(std::vector<double>());
}

std::optional<double> coefficient_in(const tinyxml2::XMLElement& element) {
  const char* value = element.Attribute("value");
  const char* text = value != nullptr ? value : element.GetText();
  const auto numbers = parse_numbers(text == nullptr ? "" : text, 1);
  if (!numbers || numbers->front() < 0) return std::nullopt;
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
