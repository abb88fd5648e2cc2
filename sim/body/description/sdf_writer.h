// Writes the elements of a checked world file for libsdformat.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <tinyxml2.h>

namespace kaz::sim {

// Text of the elements that are used. Each element is on the line that it has in its file, so that errors of
// libsdformat have the right line.
class SdfWriter {
 public:
  // Begins an element. Attributes follow, and then content or close(). `line`: line in the file.
  void open(const char* name, int line);
  void attribute(const char* name, std::string_view value);
  void content(std::string_view text);
  void close(const char* name);
  // While `on`, nothing is written.
  void mute(bool on) { muted_ = on; }
  bool is_muted() const { return muted_; }
  const std::string& text() const { return text_; }

 private:
  void escape(std::string_view text);
  void end_tag();
  std::string text_;
  int line_ = 1;
  bool in_tag_ = false, muted_ = false;
};

}  // namespace kaz::sim
