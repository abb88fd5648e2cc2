// The terminal, by ncurses: lines out, keys in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/monitor/board_view.h"

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

// While it lives the terminal shows these lines and nothing else; afterwards it is as before.
class Terminal {
 public:
  // Errors: standard input or output is no terminal, or one of a kind that nobody knows (TERM).
  static Result<Terminal> open();
  // The first of them.
  static Result<void> check();
  Terminal(Terminal&& other) noexcept : open_(other.open_) { other.open_ = false; }
  Terminal& operator=(Terminal&&) = delete;
  ~Terminal();

  // Lines of at most columns() columns.
  void show(const std::vector<Line>& lines);
  int rows() const;  // of the window as it is now
  int columns() const;
  // The next key that was pressed; never waits.
  Key key();

 private:
  Terminal() = default;
  bool open_ = true;
};

}  // namespace kaz::tools
