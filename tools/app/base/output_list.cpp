// The list in a folder of results.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_list.h"

#include <sys/sysmacros.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>

namespace kaz::tools {
namespace {

constexpr std::string_view kFirstLine = "kaz-results 1";

bool parse_process(std::string_view text, long& process) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, process);
  return error == std::errc() && stop == end && process > 0;
}

// Takes one line into the list; false if its format is unknown.
bool take_line(std::string_view line, OutputList& list) {
  const auto space = line.find(' ');
  if (space == std::string_view::npos) return false;
  const std::string_view key = line.substr(0, space), value = line.substr(space + 1);
  if (key == "process") return parse_process(value, list.process);
  if (key == "kind" && list.kind.empty() && is_output_kind(value)) {
    list.kind = value;
    return true;
  }
  if (key != "file" || !is_output_name(value) || list.names.size() == kMaxOutputNames) return false;
  list.names.emplace(value);
  return true;
}

}  // namespace

bool is_output_name(std::string_view name) {
  return !name.empty() && name.size() <= 255 && name != "." && name != ".." &&
         name != kOutputListName && std::ranges::all_of(name, [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte >= 0x20 && byte != 0x7f && c != '/';
         });
}

bool is_output_kind(std::string_view kind) {
  return !kind.empty() && kind.size() <= 32 && kind.front() != ' ' && kind.back() != ' ' &&
         std::ranges::all_of(kind, [](char c) { return (c >= 'a' && c <= 'z') || c == ' '; });
}

Result<OutputList> parse_output_list(const std::string& text, const std::string& path) {
  const auto damaged = [&](std::size_t line, const char* what) {
    return fail(Fault::usage,
                path + ": line " + std::to_string(line) + " " + what +
                    "; choose another folder with --out, or remove this list and its results");
  };
  if (text.size() > kMaxOutputListBytes) return damaged(1, "begins a list that is too long");
  OutputList list;
  std::size_t number = 0;
  for (std::size_t from = 0, end; (end = text.find('\n', from)) != std::string::npos;
       from = end + 1) {
    const std::string_view line = std::string_view(text).substr(from, end - from);
    if (++number == 1) {
      if (line != kFirstLine) return damaged(number, "is not the first line of a list of results");
    } else if (!take_line(line, list)) {
      return damaged(number, "has an unknown format");
    }
  }
  if (list.kind.empty() && !list.names.empty())
    return damaged(number, "is the last line, but the list has no line `kind`");
  return list;
}

std::string output_list_text(const OutputList& list) {
  std::string text = std::string(kFirstLine) + "\n";
  if (!list.kind.empty()) text += "kind " + list.kind + "\n";
  if (list.process > 0) text += "process " + std::to_string(list.process) + "\n";
  for (const std::string& name : list.names) text += "file " + name + "\n";
  return text;
}

// A line: "1: FLOCK  ADVISORY  WRITE 4711 08:01:131082 0 EOF", numbers of the device in hexadecimal.
long lock_holder(const struct stat& file) {
  std::ifstream locks("/proc/locks");
  std::string line;
  for (int lines = 0; lines < 100'000 && std::getline(locks, line); ++lines) {
    long process = 0;
    unsigned major_number = 0, minor_number = 0;
    unsigned long long inode = 0;
    if (std::sscanf(line.c_str(), "%*s FLOCK %*15s %*15s %ld %x:%x:%llu", &process, &major_number,
                    &minor_number, &inode) != 4)
      continue;
    if (inode == file.st_ino && major_number == major(file.st_dev) &&
        minor_number == minor(file.st_dev) && process > 0)
      return process;
  }
  return 0;
}

}  // namespace kaz::tools
