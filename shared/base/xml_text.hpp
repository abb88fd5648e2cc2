// Text as it stands in XML and HTML, between tags and in quoted attributes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_XML_TEXT_HPP
#define KAZ_SHARED_BASE_XML_TEXT_HPP

#include <string>

namespace kaz {

inline std::string xml_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace kaz

#endif
