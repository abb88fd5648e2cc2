// Escapes text for XML and HTML, between tags and in quoted attributes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_XML_TEXT_HPP
#define KAZ_SHARED_BASE_XML_TEXT_HPP

#include <string>

#include "shared/base/one_line.hpp"

namespace kaz {

// Returns the escaped text. Control characters except \n, \r and \t, and bytes that are not UTF-8, become
// \xNN.
inline std::string xml_text(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::size_t length = utf8_length(text, at);
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
      case '\'':
        out += "&apos;";
        break;
      case '\n':
      case '\r':
      case '\t':
        out += c;
        break;
      default: {
        const std::string_view one = std::string_view(text).substr(at, length == 0 ? 1 : length);
        out += one_line(one);
      }
    }
    at += length == 0 ? 1 : length;
  }
  return out;
}

}  // namespace kaz

#endif
