// Output of a verb: a folder of results, JSON on standard output, progress on standard error.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/output.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "shared/base/files.hpp"

namespace kaz::tools {

namespace fs = std::filesystem;

namespace {

int terminal_columns(int fd, int if_unknown) {
  winsize size{};
  const bool known = ::isatty(fd) == 1 && ::ioctl(fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : if_unknown;
}

// One line, broken at spaces beyond column `indent`. Further lines begin with `indent` spaces.
std::string wrapped(std::string line, std::size_t width, std::size_t indent) {
  std::string text;
  while (width > 0 && line.size() > width) {
    std::size_t space = line.rfind(' ', width);
    if (space == std::string::npos || space <= indent) space = line.find(' ', indent + 1);
    if (space == std::string::npos) break;
    text += line.substr(0, line.find_last_not_of(' ', space) + 1) + "\n";
    line = std::string(indent, ' ') + line.substr(space + 1);
  }
  return text + line + "\n";
}

}  // namespace

std::string list_row(const std::string& columns, const std::string& text, std::size_t width) {
  constexpr std::size_t kLeast = 30, kIndent = 6;
  if (width == 0 || columns.size() + std::min(text.size(), kLeast) <= width)
    return wrapped(columns + text, width, columns.size());
  return columns.substr(0, columns.find_last_not_of(' ') + 1) + "\n" +
         wrapped(std::string(kIndent, ' ') + text, width, kIndent);
}

std::size_t list_width() {
  return static_cast<std::size_t>(terminal_columns(STDOUT_FILENO, 0));
}

std::string broken_lines(const std::string& text, std::size_t width) {
  constexpr std::size_t kDeeper = 2;
  std::string broken;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    broken += wrapped(line, width, first + kDeeper);
  }
  return broken;
}

void print_lines(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<std::size_t>(std::max(std::vsnprintf(nullptr, 0, format, again), 0)),
                   '\0');
  va_end(again);
  std::vsnprintf(text.data(), text.size() + 1, format, arguments);
  va_end(arguments);
  std::fputs(broken_lines(text, list_width()).c_str(), stdout);
}

Progress::Progress(std::string label, bool quiet, std::chrono::milliseconds longest_silence)
    : label_(std::move(label)),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      longest_silence_(longest_silence) {}

Progress::~Progress() {
  done();
}

// Counts the call as a drawing if it is none too soon.
bool Progress::draws_now() {
  const auto now = std::chrono::steady_clock::now();
  if (line_open_ && now - last_draw_ < std::chrono::milliseconds(100)) return false;
  last_draw_ = now;
  line_open_ = true;
  return true;
}

void Progress::update(double share, const std::string& note) {
  if (quiet_) return;
  share = std::clamp(share, 0.0, 1.0);
  if (terminal_) {
    if (!draws_now()) return;
    // Label, bar, share, note: a line that wrapped could not be drawn over.
    const int room = terminal_columns(STDERR_FILENO, 80) - 1 - static_cast<int>(label_.size()) - 11;
    const int bar = std::clamp(room / 2, 4, 30), left = std::clamp(room - bar, 0, 36);
    const int filled = static_cast<int>(share * bar);
    std::fprintf(stderr, "\r%s [%s%s] %3d %%  %.*s\033[K", label_.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(bar - filled), '.').c_str(),
                 static_cast<int>(share * 100), left, note.c_str());
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  const int decile = static_cast<int>(share * 10);
  const bool next = decile != last_decile_;
  if (!next && now - last_draw_ < longest_silence_) return;
  last_decile_ = decile;
  last_draw_ = now;
  std::fprintf(stderr, "%s %3d %%%s%s\n", label_.c_str(),
               next ? decile * 10 : static_cast<int>(share * 100), note.empty() ? "" : "  ",
               note.c_str());
}

void Progress::show(double at_s, const std::string& phase) {
  if (quiet_) return;
  if (!terminal_) {
    if (at_s >= shown_s_ + 10) announce(at_s, phase);
  } else if (draws_now()) {
    const int room = terminal_columns(STDERR_FILENO, 80) - 1 - static_cast<int>(label_.size()) - 14;
    std::fprintf(stderr, "\r%s: %.1f s: %.*s\033[K", label_.c_str(), at_s, std::clamp(room, 0, 36),
                 phase.c_str());
  }
}

void Progress::announce(double at_s, const std::string& phase) {
  if (quiet_) return;
  done();
  shown_s_ = at_s;
  std::fprintf(stderr, "%s: %.2f s: %s\n", label_.c_str(), at_s, phase.c_str());
}

void Progress::done() {
  if (line_open_) std::fprintf(stderr, "\r\033[K");
  line_open_ = false;
}

namespace {

std::atomic<bool> g_json_printed{false};

}  // namespace

bool json_printed() {
  return g_json_printed;
}

void print_json(const nlohmann::ordered_json& value) {
  g_json_printed = true;
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  std::printf("%s\n", value.dump(2, ' ', false, replace).c_str());
}

namespace {

// Made when the first name is requested. Kept if a run leaves files in it (the last frames of a lost link),
// else removed at exit.
struct PrivateFolder {
  std::string path;
  PrivateFolder() {
    auto made = make_temporary_folder("kaz-");
    if (!made) throw std::runtime_error(made.error().message);
    path = std::move(*made);
  }
  ~PrivateFolder() { ::rmdir(path.c_str()); }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
};

}  // namespace

std::string temporary_file(const std::string& name) {
  static const PrivateFolder folder;
  return folder.path + "/" + name;
}

Result<void> put_in_place(const std::string& part, const std::string& path) {
  const Descriptor file(::open(part.c_str(), O_RDONLY | O_CLOEXEC));
  if (file && sync_file(file.get()) && move_into_place(part, path)) return {};
  return write_failure(path, "move the file into place", errno);
}

FileRemover::~FileRemover() {
  std::error_code error;
  if (!path_.empty()) fs::remove(path_, error);
}

}  // namespace kaz::tools
