// ncurses in one place: its macros have common names.
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <string>

#define NCURSES_NOMACROS
#include <curses.h>

namespace kaz::tools {
namespace {

chtype attribute(Ink ink) {
  switch (ink) {
    case Ink::bold:
      return A_BOLD;
    case Ink::good:
      return static_cast<chtype>(COLOR_PAIR(1));
    case Ink::warning:
      return static_cast<chtype>(COLOR_PAIR(2)) | A_BOLD;
    case Ink::bad:
      return static_cast<chtype>(COLOR_PAIR(3)) | A_BOLD;
    case Ink::selected:
      return A_REVERSE;
    default:
      return A_NORMAL;
  }
}

}  // namespace

Result<void> Terminal::check() {
  if (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0) return {};
  return fail(Fault::usage, "the monitor needs a terminal; in scripts, use kaz status --json");
}

Result<Terminal> Terminal::open() {
  KAZ_TRY(check());
  std::setlocale(LC_ALL, "");
  if (newterm(nullptr, stdout, stdin) == nullptr) {
    const char* term = std::getenv("TERM");
    return fail(Fault::usage, std::string("unknown type of terminal (TERM=") +
                                  (term == nullptr ? "" : term) + "): try TERM=xterm");
  }
  cbreak();
  noecho();
  keypad(stdscr, TRUE);
  nodelay(stdscr, TRUE);
  set_escdelay(25);
  curs_set(0);
  if (has_colors()) {
    start_color();
    use_default_colors();
    init_pair(1, COLOR_GREEN, -1);
    init_pair(2, COLOR_YELLOW, -1);
    init_pair(3, COLOR_RED, -1);
  }
  return Terminal();
}

Terminal::~Terminal() {
  if (open_) endwin();
}

void Terminal::show(const std::vector<Line>& lines) {
  erase();
  int row = 0;
  for (const Line& line : lines) {
    if (row >= LINES) break;
    move(row, 0);
    for (const Span& span : line) {
      attrset(static_cast<int>(attribute(span.ink)));
      addstr(span.text.c_str());
    }
    ++row;
  }
  attrset(A_NORMAL);
  refresh();
}

int Terminal::rows() const {
  return LINES;
}
int Terminal::columns() const {
  return COLS;
}

Key Terminal::key() {
  switch (getch()) {
    case KEY_UP:
    case 'k':
      return Key::up;
    case KEY_DOWN:
    case 'j':
      return Key::down;
    case KEY_LEFT:
      return Key::left;
    case KEY_RIGHT:
      return Key::right;
    case '[':
      return Key::page_left;
    case ']':
      return Key::page_right;
    case 'e':
      return Key::toggle;
    case 'E':
      return Key::all_on;
    case ' ':
      return Key::stop;
    case 'c':
      return Key::clear;
    case 'q':
      return Key::quit;
    default:
      return Key::none;
  }
}

}  // namespace kaz::tools
