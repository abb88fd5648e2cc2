// XML of cv::FileStorage as keys and numbers.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_xml.h"

#include <algorithm>

#include <tinyxml2.h>

namespace kaz::vision {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

// Texts become quoted words, so that a colon in a text does not make a key.
std::string value_of(std::string_view text) {
  constexpr std::string_view kNumeric = "0123456789+-.eEaAiIfFnN \t\r\n";
  std::string value(text);
  if (text.find_first_not_of(kNumeric) == std::string_view::npos) return value;
  std::ranges::replace(value, '"', ' ');
  return '"' + value + '"';
}

bool is_matrix_data(const tinyxml2::XMLElement& element, std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return element.Name() == std::string_view("data");
  text = text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
  return element.Name() == std::string_view("data") ||
         text.find_first_of(kBlanks) != std::string_view::npos;
}

// tinyxml2 limits the depth of a document.
void add_element(const tinyxml2::XMLElement& element, std::string& yaml) {
  yaml += element.Name();
  yaml += ": ";
  const tinyxml2::XMLElement* child = element.FirstChildElement();
  const std::string_view text = child || !element.GetText() ? "" : element.GetText();
  const std::string value = value_of(text);
  if (!child)
    yaml += is_matrix_data(element, text) && !value.starts_with('"') ? "[ " + value + " ]" : value;
  yaml += '\n';
  for (; child; child = child->NextSiblingElement()) add_element(*child, yaml);
}

}  // namespace

bool looks_like_xml(std::string_view content) {
  const auto first = content.find_first_not_of(kBlanks);
  return first != std::string_view::npos && content[first] == '<';
}

Result<std::string> calibration_xml_as_yaml(const std::string& content, const std::string& name) {
  tinyxml2::XMLDocument document;
  if (document.Parse(content.data(), content.size()) != tinyxml2::XML_SUCCESS)
    return fail(Fault::usage, name + ":" + std::to_string(document.ErrorLineNum()) +
                                  ": is not well-formed XML; write the file again");
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || root->Name() != std::string_view("opencv_storage"))
    return fail(Fault::usage, name + ":" + std::to_string(root ? root->GetLineNum() : 1) +
                                  ": the root element must be opencv_storage, as in XML files of "
                                  "cv::FileStorage");
  std::string yaml;
  for (const auto* child = root->FirstChildElement(); child; child = child->NextSiblingElement())
    add_element(*child, yaml);
  return yaml;
}

}  // namespace kaz::vision
