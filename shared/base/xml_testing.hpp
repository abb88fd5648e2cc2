// Test helper: parses XML and finds its elements.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_XML_TESTING_HPP
#define KAZ_SHARED_BASE_XML_TESTING_HPP

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <string>
#include <vector>

namespace kaz {

// Parses `xml` into `to`. Fails the test if `xml` is not XML.
inline void parse_xml(const std::string& xml, tinyxml2::XMLDocument& to) {
  EXPECT_EQ(to.Parse(xml.data(), xml.size()), tinyxml2::XML_SUCCESS) << to.ErrorStr();
}

// Returns the elements with this name at any depth below a node.
inline std::vector<const tinyxml2::XMLElement*> elements(const tinyxml2::XMLNode& below,
                                                         const std::string& name) {
  std::vector<const tinyxml2::XMLElement*> all;
  for (auto* child = below.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (child->Name() == name) all.push_back(child);
    for (const auto* deeper : elements(*child, name)) all.push_back(deeper);
  }
  return all;
}

}  // namespace kaz

#endif
