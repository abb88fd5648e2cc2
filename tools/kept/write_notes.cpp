// Notes of a `kaz flash write` while it is under way.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kept/write_notes.h"

#include <filesystem>
#include <utility>

#include "shared/base/one_line.hpp"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWrite = "write";  // begins the names of such notes

struct Left {
  std::string path;
  WriteFile write;
};

std::vector<Left> left_on(const std::string& port, const std::string& folder) {
  std::vector<Left> all;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), last; !none && at != last; at.increment(none)) {
    const std::string name = at->path().filename();
    if (!name.starts_with(kWrite) || !name.ends_with(".json")) continue;
    const auto write = read_write(at->path());
    if (write && same_port(write->run, port) && !notes_in_use(write->run))
      all.push_back({at->path(), *write});
  }
  return all;
}

}  // namespace

WriteNotes::WriteNotes(std::string port, std::string folder, std::string path)
    : port_(std::move(port)), folder_(std::move(folder)), path_(std::move(path)) {}

Result<WriteNotes> WriteNotes::begin(const std::string& port, const std::string& folder) {
  std::error_code none;
  const WriteFile write{this_run("kaz flash write", port), provenance().command,
                        fs::current_path(none).string()};
  auto path = KAZ_TRY(write_new_notes(folder, kWrite, port, write_text(write)));
  return WriteNotes(port, folder, std::move(path));
}

void WriteNotes::drop() const {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void WriteNotes::done() const {
  drop();
  std::error_code ignored;
  for (const Left& left : left_on(port_, folder_)) fs::remove(left.path, ignored);
}

std::vector<std::string> interrupted_writes(const std::string& port, const std::string& folder) {
  std::vector<std::string> sentences;
  for (const auto& [path, write] : left_on(port, folder))
    sentences.push_back(
        "`" + one_line(write.command) + "` on " + port +
        " was ended before the flash was complete: give the same command again in the folder " +
        one_line(write.folder) + ", or remove the notes in " + path);
  return sentences;
}

}  // namespace kaz::tools
