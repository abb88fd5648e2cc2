// Output of a command: JSON on standard output, progress on standard error, temporary files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/app/base/output_folder.h"

namespace kaz::tools {

// Prints progress to standard error, so that standard output contains only results. On a terminal it draws a
// bar. In a pipe it prints a line every 10 %, and after `longest_silence` without one. Prints nothing if
// `quiet`.
class Progress {
 public:
  Progress(std::string label, bool quiet,
           std::chrono::milliseconds longest_silence = std::chrono::seconds(10));
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `share`: completed part, 0 to 1. `note`: a few words on the current work.
  void update(double share, const std::string& note);
  // For work of unknown length: prints the time in seconds and the phase. In a pipe it prints a line every
  // 10 s of `at_s`.
  void show(double at_s, const std::string& phase);
  // Prints a new phase on a line of its own.
  void announce(double at_s, const std::string& phase);
  // Erases the bar. The destructor does the same.
  void done();

 private:
  std::string label_;
  bool quiet_;
  bool terminal_;
  std::chrono::milliseconds longest_silence_;
  int last_decile_ = -1;
  double shown_s_ = 0;  // time of the last line of show() or announce()
  bool line_open_ = false;
  std::chrono::steady_clock::time_point last_draw_{};
};

// Returns a row of a list, with its line break: `columns`, then `text`. Text beyond `width` is wrapped at
// spaces below its first line. If fewer than 30 characters remain beside `columns`, the text starts on a new
// line. 0: no limit.
std::string list_row(const std::string& columns, const std::string& text, std::size_t width);
// Returns the width of the terminal at standard output. 0: no terminal, so that a list has one line per row.
std::size_t list_width();

// Wraps lines wider than `width` at spaces, with 2 more columns of indentation. 0: no limit.
std::string broken_lines(const std::string& text, std::size_t width);
// printf() of complete lines, wrapped at the terminal's width.
[[gnu::format(printf, 1, 2)]] void print_lines(const char* format, ...);

// Prints a result to standard output. Replaces bytes that are not UTF-8: a recording may contain any bytes,
// but JSON may not.
void print_json(const nlohmann::ordered_json& value);
// Returns whether print_json() was called in this process.
bool json_printed();

// Returns a path in a folder that only this process uses. The folder is removed at exit if it is empty.
// Throws std::runtime_error if it cannot be created.
std::string temporary_file(const std::string& name);
// Removes that folder if it is empty, for a process that ends without its destructors.
void remove_temporary_folder();

// Flushes the complete file `part` to disk and renames it to `path`.
Result<void> put_in_place(const std::string& part, const std::string& path);

// The destructor removes the file, unless keep() was called.
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
