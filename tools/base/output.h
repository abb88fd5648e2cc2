// Output of a command: JSON on standard output, progress on standard error, temporary files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/base/output_file.h"

namespace kaz::tools {

// Prints progress to standard error, so that standard output contains only results. If standard error is a
// terminal, draws a progress bar. Otherwise prints a line every 10 %. Also prints a line if no line was
// printed for `longest_silence`. Prints nothing if `quiet`.
class Progress {
 public:
  Progress(std::string label, bool quiet,
           std::chrono::milliseconds longest_silence = std::chrono::seconds(10));
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `share`: completed fraction of the work, 0 to 1. `note`: a few words on the current work.
  void update(double share, const std::string& note);
  // Like update(), but for work of unknown length: shows the time `at_s` in seconds and the phase. If
  // standard error is not a terminal, prints a line whenever `at_s` has increased by 10 s.
  void show(double at_s, const std::string& phase);
  // Prints the start of a new phase on a separate line.
  void announce(double at_s, const std::string& phase);
  // Erases the progress bar. The destructor calls done().
  void done();

 private:
  bool draws_now();

  std::string label_;
  bool quiet_;
  bool terminal_;
  std::chrono::milliseconds longest_silence_;
  int last_decile_ = -1;
  double shown_s_ = 0;  // `at_s` of the last line that show() or announce() printed
  bool line_open_ = false;
  std::chrono::steady_clock::time_point last_draw_{};
};

// Returns a row of a list: `columns`, then `text`, then a line break. Text beyond column `width` is wrapped
// at spaces. The further lines of `text` are aligned with the first line. If fewer than 30 characters remain
// beside `columns`, the text starts on a new line. A `width` of 0 means no limit.
std::string list_row(const std::string& columns, const std::string& text, std::size_t width);
// Returns the width of the terminal at standard output, in columns. Returns 0 if standard output is not a
// terminal. A list then has one line per row.
std::size_t list_width();

// Wraps lines wider than `width` at spaces. Continuation lines are indented by 2 more columns. A `width` of 0
// means no limit.
std::string broken_lines(const std::string& text, std::size_t width);
// Like printf(), but only for complete lines, which are wrapped at the terminal's width.
[[gnu::format(printf, 1, 2)]] void print_lines(const char* format, ...);

// Prints a result to standard output. Replaces bytes that are not valid UTF-8: recordings may contain any
// bytes, but JSON must be UTF-8.
void print_json(const nlohmann::ordered_json& value);
// Returns whether print_json() was called in this process.
bool json_printed();

// Returns a path in a folder that only this process uses. The folder is removed at exit if the folder is
// empty then. Throws std::runtime_error if the folder cannot be created.
std::string temporary_file(const std::string& name);

// Flushes the complete file `part` to disk and renames it to `path`.
Result<void> put_in_place(const std::string& part, const std::string& path);

// Removes a file in its destructor, unless keep() was called.
class FileRemover {
 public:
  explicit FileRemover(std::string path) : path_(std::move(path)) {}
  ~FileRemover();
  FileRemover(const FileRemover&) = delete;
  FileRemover& operator=(const FileRemover&) = delete;
  void keep() { path_.clear(); }

 private:
  std::string path_;
};

}  // namespace kaz::tools
