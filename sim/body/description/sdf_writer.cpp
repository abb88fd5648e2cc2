// XML text of the used elements of a world file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_writer.h"

namespace kaz::sim {

void SdfWriter::open(const char* name, int line) {
  if (muted_) return;
  end_tag();
  for (; line_ < line; ++line_) text_ += '\n';
  text_ += '<';
  text_ += name;
  in_tag_ = true;
}

void SdfWriter::attribute(const char* name, std::string_view value) {
  if (muted_) return;
  text_ += ' ';
  text_ += name;
  text_ += "=\"";
  escape(value);
  text_ += '"';
}

void SdfWriter::content(std::string_view text) {
  if (muted_) return;
  end_tag();
  escape(text);
}

void SdfWriter::close(const char* name) {
  if (muted_) return;
  end_tag();
  text_ += "</";
  text_ += name;
  text_ += '>';
}

void SdfWriter::end_tag() {
  if (in_tag_) text_ += '>';
  in_tag_ = false;
}

// Line breaks become spaces: the lines of the text are those of the file.
void SdfWriter::escape(std::string_view text) {
  for (const char c : text) {
    switch (c) {
      case '&':
        text_ += "&amp;";
        break;
      case '<':
        text_ += "&lt;";
        break;
      case '>':
        text_ += "&gt;";
        break;
      case '"':
        text_ += "&quot;";
        break;
      case '\n':
      case '\r':
      case '\t':
        text_ += ' ';
        break;
      default:
        text_ += c;
    }
  }
}

}  // namespace kaz::sim
