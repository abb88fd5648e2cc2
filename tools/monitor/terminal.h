// Output and keyboard input of the terminal, using ncurses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "tools/monitor/board_view.h"

namespace kaz::tools {

enum class Key {
  none,
  up,
  down,
  left,
  right,
  page_left,
  page_right,
  toggle,
  all_on,
  stop,
  clear,
  quit
};

// Shows text lines on the whole terminal. The destructor restores the terminal.
class Terminal {
 public:
  // Fails if standard input or output is not a terminal, or if the terminal's type (TERM) is unknown.
  static Result<Terminal> open();
  // Fails if standard input or output is no terminal.
  static Result<void> check();
  Terminal(Terminal&& other) noexcept : open_(other.open_) { other.open_ = false; }
  Terminal& operator=(Terminal&&) = delete;
  ~Terminal();

  // Each line may have at most columns() columns.
  void show(const std::vector<Line>& lines);
  int rows() const;  // present size of the window
  int columns() const;
  // Returns the next pressed key. Returns Key::none immediately if no key was pressed.
  Key key();

 private:
  Terminal() = default;
  bool open_ = true;
};

}  // namespace kaz::tools
