// Output of a verb: a folder of results, JSON on standard output, progress on standard error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/app/base/output_folder.h"

namespace kaz::tools {

// A bar on a terminal; in a pipe a plain line every ten per cent, and after ten seconds without one
// (`longest_silence`). Goes to standard error, so that
// results on standard output stay clean. Prints nothing if `quiet`.
class Progress {
 public:
  Progress(std::string label, bool quiet,
           std::chrono::milliseconds longest_silence = std::chrono::seconds(10));
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // share: 0..1 done; note: a few words on what is going on.
  void update(double share, const std::string& note);
  // For work whose end is not known: how long it runs and its phase. In a pipe a line every ten seconds.
  void show(double at_s, const std::string& phase);
  // A new phase of the work: a line of its own.
  void announce(double at_s, const std::string& phase);
  void done();

 private:
  std::string label_;
  bool quiet_;
  bool terminal_;
  std::chrono::milliseconds longest_silence_;
  int last_decile_ = -1;
  double shown_s_ = 0;  // last line of show() or announce()
  bool line_open_ = false;
  std::chrono::steady_clock::time_point last_draw_{};
};

// A row of a list, with its line break: `columns`, then a text that is broken at spaces where it is wider
// than `width`, and goes on below itself; or in lines of its own, if `columns` leave too little room. 0: no
// width.
std::string list_row(const std::string& columns, const std::string& text, std::size_t width);
// Of the terminal at standard output; 0: there is none, so that what reads the list has a line a row.
std::size_t list_width();

// Lines wider than `width` go on, indented by two columns more than they begin; 0: no width.
std::string broken_lines(const std::string& text, std::size_t width);
// printf() of whole lines, broken at the terminal's width.
[[gnu::format(printf, 1, 2)]] void print_lines(const char* format, ...);

// A result on standard output. Text that is not UTF-8 (a recording may hold any bytes) is
// replaced: JSON has none.
void print_json(const nlohmann::ordered_json& value);
// Whether this process has printed a result by print_json().
bool json_printed();

// The path of a file of that name in a folder that only this process uses.
std::string temporary_file(const std::string& name);
// Removes that folder if it is empty: for a process that ends without its destructors.
void remove_temporary_folder();

// Gives a file its name when it is whole, and on the disk.
Result<void> put_in_place(const std::string& part, const std::string& path);

// Removes a file, if it is there, when the object goes; unless keep() was called.
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
