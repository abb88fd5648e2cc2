// Output files with the name PATH.part until they are complete, and folders of results.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/output_file.h"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/file.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

// Files that with_saved_files() lists.
std::vector<std::string> g_saved;
std::vector<std::pair<std::string, OutputKind>> g_folders;
std::vector<std::string> g_command_words;

constexpr std::string_view kMarkStart = "kaz-results 1\nkind ";

tl::unexpected<Error> refused(const std::string& option, const std::string& path,
                              const std::string& why) {
  return fail(Fault::usage,
              option + ": '" + path + "' cannot be written (" + why + "); give another path");
}

tl::unexpected<Error> cannot_write(const std::string& option, const std::string& path, int error) {
  if (lacks_space(error)) return write_failure(path, "", error);
  return refused(option, path, std::strerror(error));
}

// A successful write of this size rules out a full disk.
Result<void> test_write(int fd, const std::string& path, std::size_t bytes) {
  const off_t size = ::lseek(fd, 0, SEEK_END);
  Result<void> written;
  if (!write_all(fd, std::string(bytes, '\n'))) written = write_failure(path, "write", errno);
  if (size >= 0 && (::ftruncate(fd, size) != 0 || ::lseek(fd, size, SEEK_SET) < 0) && written)
    written = write_failure(path, "write", errno);
  return written;
}

// Returns whether two words of the command line name this file.
bool is_named_twice(const std::string& path) {
  return std::ranges::count_if(g_command_words, [&](const std::string& word) {
           std::error_code none;
           const auto value = word.starts_with("--") ? word.find('=') + 1 : 0;
           return fs::equivalent(word.substr(value), path, none);
         }) > 1;
}

// The process with a flock() on the file; 0: none is listed. A line: "1: FLOCK  ADVISORY  WRITE 4711
// 08:01:131082 0 EOF", numbers of the device in hexadecimal.
long lock_holder(const struct stat& file) {
  std::ifstream locks("/proc/locks");
  std::string line;
  for (int lines = 0; lines < 100'000 && std::getline(locks, line); ++lines) {
    long process = 0;
    unsigned major_number = 0, minor_number = 0;
    unsigned long long inode = 0;
    if (std::sscanf(line.c_str(), "%*s FLOCK %*15s %*15s %ld %x:%x:%llu", &process, &major_number,
                    &minor_number, &inode) == 4 &&
        inode == file.st_ino && major_number == major(file.st_dev) &&
        minor_number == minor(file.st_dev) && process > 0)
      return process;
  }
  return 0;
}

// Opens or creates the file `name` and locks it: one process at a time writes to `path`.
Result<Descriptor> lock_file(const std::string& name, const std::string& option,
                             const std::string& path) {
  for (;;) {
    Descriptor file(
        ::open(name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
    struct stat here = {}, there = {};
    if (!file || ::fstat(file.get(), &here) != 0) return cannot_write(option, path, errno);
    if (!S_ISREG(here.st_mode)) return refused(option, path, name + " is not a regular file");
    // Other errors of flock(): a file system without locks.
    if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const long process = lock_holder(here);
      if (process == ::getpid()) return refused(option, path, "another option names the same path");
      const std::string number = process > 0 ? " (process " + std::to_string(process) + ")" : "";
      return fail(Fault::environment, option + ": another run" + number + " is writing '" + path +
                                          "': wait until that run ends, or give another path");
    }
    // The previous owner may have removed or renamed the file before this lock.
    if (::lstat(name.c_str(), &there) == 0 && here.st_ino == there.st_ino) return file;
  }
}

// A temporary file's name without its ending: NAME.part, NAME.part4711-0.
std::string without_part(const std::string& name) {
  const auto at = name.rfind(".part");
  const bool part = at != std::string::npos && at > 0 &&
                    name.find_first_not_of("0123456789-", at + 5) == std::string::npos;
  return part ? name.substr(0, at) : name;
}

bool is_written_by(const OutputKind& kind, const std::string& name) {
  return std::ranges::any_of(kind.files, [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
  });
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    names.push_back(at->path().filename().string());
  std::ranges::sort(names);
  return names;
}

// Results of this kind, also incomplete ones.
std::vector<std::string> results_in(const std::string& folder, const OutputKind& kind) {
  auto names = names_in(folder);
  std::erase_if(names, [&](const auto& name) { return !is_written_by(kind, without_part(name)); });
  return names;
}

}  // namespace

Error with_saved_files(Error error) {
  if (!error.disk_full) return error;
  constexpr std::size_t kMaxNamed = 8;  // of one folder
  std::vector<std::string> saved = g_saved;
  for (const auto& [folder, kind] : g_folders) {
    const auto names = results_in(folder, kind);
    for (std::size_t i = 0; i < std::min(names.size(), kMaxNamed); ++i)
      saved.push_back(folder + "/" + names[i]);
    if (names.size() > kMaxNamed)
      saved.push_back(std::to_string(names.size() - kMaxNamed) + " more in " + folder);
  }
  error.message += "; saved so far: " + (saved.empty() ? "nothing" : saved.front());
  for (std::size_t i = 1; i < saved.size(); ++i) error.message += ", " + saved[i];
  return error;
}

void set_command_words(std::vector<std::string> words) {
  g_command_words = std::move(words);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(target_, other.target_);
  std::swap(part_, other.part_);
  std::swap(file_, other.file_);
  std::swap(at_last_, other.at_last_);
  return *this;
}

OutputFile::~OutputFile() {
  if (file_ && !target_.empty()) ::unlink(part_.c_str());
  release();
}

Result<OutputFile> OutputFile::open(const std::string& path, const std::string& option,
                                    Existing existing) {
  OutputFile file;
  file.path_ = file.part_ = path;
  std::error_code error;
  const auto status = fs::status(path, error);
  const bool link = fs::is_symlink(fs::symlink_status(path, error));
  if (path.empty()) return refused(option, path, "the path is empty");
  if (fs::is_directory(status)) return refused(option, path, "the path is a folder");
  if (link && !fs::exists(status))
    return refused(option, path, "the path is a link to a missing file");
  if (fs::is_block_file(status)) return refused(option, path, "the path is a block device");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    // Held open from now on: the reader of a pipe would see its end otherwise.
    file.file_ = Descriptor(::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    const int fd = file.file_.get();
    if (fd < 0)
      return refused(option, path,
                     errno == ENXIO && fs::is_fifo(status) ? "no program reads this pipe"
                                                           : std::strerror(errno));
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
    return file;
  }
  if (fs::equivalent(path, "/dev/fd/1", error) || fs::equivalent(path, "/dev/fd/2", error))
    return refused(option, path, "the path is the standard output of this program");
  // A rename would replace a read-only file, too.
  if (fs::exists(status) && ::access(path.c_str(), W_OK) != 0)
    return refused(option, path, std::strerror(errno));
  if (existing == Existing::keep && fs::exists(status) && fs::file_size(path, error) != 0)
    return refused(option, path, "the file exists already");
  if (fs::exists(status) && is_named_twice(path))
    return refused(option, path, "another argument of the command names the same file");
  const std::string target = link ? fs::canonical(path, error).string() : path;
  const fs::path folder = fs::absolute(target, error).parent_path();
  if (!fs::is_directory(folder, error))
    return refused(option, path, "there is no folder " + folder.string());
  if (fs::exists(fs::symlink_status(folder / kResultsMark, error)))
    return refused(option, path, "the folder of this path contains the results of a run");
  file.part_ = target + ".part";
  for (;;) {
    file.file_ = KAZ_TRY(lock_file(file.part_, option, path));
    struct stat about = {};
    if (::fstat(file.file_.get(), &about) == 0 && about.st_size == 0 && about.st_nlink == 1) break;
    // A killed run has left this file. It is created anew, because it may be a hard link.
    if (::unlink(file.part_.c_str()) != 0) return cannot_write(option, path, errno);
    file.file_ = Descriptor();
  }
  file.target_ = target;
  file.at_last_ = remove_empty_file_at_last(file.part_);
  KAZ_TRY(test_write(file.file_.get(), path, 4096));
  return file;
}

Result<void> OutputFile::check_room(std::size_t bytes) {
  if (target_.empty()) return {};
  return test_write(file_.get(), path_, bytes);
}

Result<void> OutputFile::write(std::string_view bytes) {
  if (!write_all(file_.get(), bytes)) return write_failure(path_, "write", errno);
  return commit();
}

Result<void> OutputFile::commit() {
  if (target_.empty()) return {};
  KAZ_TRY(put_in_place(part_, target_));
  g_saved.push_back(path_);
  release();
  return {};
}

Error OutputFile::failure() {
  const auto again = test_write(file_.get(), path_, 1 << 16);
  if (!target_.empty()) {
    g_saved.push_back(part_);
    release();
  }
  if (!again) return again.error();
  return {Fault::environment, path_ + ": writing has failed; try again"};
}

void OutputFile::release() {
  forget_file(std::exchange(at_last_, -1));
  file_ = Descriptor();
}

struct OutputFolder::State {
  std::string path;
  OutputKind kind;
  std::vector<fs::path> missing;  // the folder and those above it that were not there
  Descriptor mark;                // locked
  bool marked = false;            // as a folder of this kind

  ~State();
  std::string mark_path() const { return path + "/" + kResultsMark; }
  Result<void> claim();
  Result<int> remove(bool incomplete) const;
};

OutputFolder::State::~State() {
  if (marked && !results_in(path, kind).empty()) return;
  struct stat about = {};
  if (marked || (mark && ::fstat(mark.get(), &about) == 0 && about.st_size == 0))
    ::unlink(mark_path().c_str());
  mark = Descriptor();
  for (const fs::path& folder : missing) ::rmdir(folder.c_str());
}

// Marks the folder as one of this kind, or refuses it. Earlier versions listed the files after the kind.
Result<void> OutputFolder::State::claim() {
  std::string text(256, '\0');
  const ssize_t size = ::pread(mark.get(), text.data(), text.size(), 0);
  if (size < 0) return cannot_write("--out", path, errno);
  text.resize(static_cast<std::size_t>(size));
  const std::string ours = std::string(kMarkStart) + kind.name + "\n";
  marked = text.starts_with(ours);
  if (marked) return {};
  if (!text.empty() && !text.starts_with(kMarkStart))
    return refused("--out", path, "its " + std::string(kResultsMark) + " has an unknown format");
  for (const std::string& name : names_in(path)) {
    if (name == kResultsMark) continue;
    if (!text.empty()) {
      const std::string other =
          text.substr(kMarkStart.size(), text.find('\n', kMarkStart.size()) - kMarkStart.size());
      return refused("--out", path,
                     "the folder contains results of " +
                         (other == "run" ? std::string("kaz run or kaz demo") : "kaz " + other));
    }
    if (is_written_by(kind, without_part(name)))
      return refused("--out", path,
                     "the file '" + name + "' would be replaced, but without " + kResultsMark +
                         ", kaz may not have written this file");
  }
  marked = true;
  if (::ftruncate(mark.get(), 0) == 0 && write_all(mark.get(), ours)) return {};
  return cannot_write("--out", path, errno);
}

// Removes the complete results, or the temporary files that a killed run has left.
Result<int> OutputFolder::State::remove(bool incomplete) const {
  int removed = 0;
  for (const std::string& name : results_in(path, kind)) {
    if ((without_part(name) != name) != incomplete) continue;
    if (::unlink((path + "/" + name).c_str()) == 0)
      ++removed;
    else if (errno != ENOENT)
      return refused("--out", path,
                     "the earlier '" + name + "' cannot be removed: " + std::strerror(errno));
  }
  return removed;
}

Result<OutputFolder> OutputFolder::open(const std::string& path, const OutputKind& kind) {
  auto state = std::make_shared<State>();
  state->path = path;
  state->kind = kind;
  std::error_code error;
  for (fs::path at = fs::absolute(path, error); at.has_relative_path() && !fs::exists(at, error);
       at = at.parent_path())
    state->missing.push_back(at);
  fs::create_directories(path, error);
  if (error) return cannot_write("--out", path, error.value());
  state->mark = KAZ_TRY(lock_file(state->mark_path(), "--out", path));
  KAZ_TRY(state->claim());
  KAZ_TRY(test_write(state->mark.get(), path, 4096));
  KAZ_TRY(state->remove(true));
  g_folders.emplace_back(path, kind);
  return OutputFolder(std::move(state));
}

Result<void> OutputFolder::clear() const {
  const int removed = KAZ_TRY(state_->remove(false));
  if (removed > 0) std::fprintf(stderr, "earlier results in %s are replaced\n", folder().c_str());
  return {};
}

Result<OutputFolder> OutputFolder::begin(const std::string& path, const OutputKind& kind) {
  auto folder = KAZ_TRY(open(path, kind));
  KAZ_TRY(folder.clear());
  return folder;
}

const std::string& OutputFolder::folder() const {
  return state_->path;
}

Result<void> OutputFolder::write(const std::string& name, std::string_view bytes) const {
  return write_whole_file(path(name), bytes);
}

Result<void> OutputFolder::write_json(const std::string& name,
                                      const nlohmann::ordered_json& value) const {
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return write(name, value.dump(2, ' ', false, replace) + "\n");
}

}  // namespace kaz::tools
