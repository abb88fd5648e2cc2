// A file that grows beside its place.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "shared/base/files.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/output_list.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> g_saved;  // files of this process that are in their place

// Errors of a full disk, with what is saved; others as they are.
Error explained(Error error) {
  if (!is_disk_full(error)) return error;
  error.message += "; saved so far: ";
  if (g_saved.empty()) error.message += "nothing";
  for (const std::string& path : g_saved)
    error.message += (&path == g_saved.data() ? "" : ", ") + path;
  return error;
}

tl::unexpected<Error> refused(const std::string& option, const std::string& path,
                              const std::string& why) {
  return fail(Fault::usage,
              option + ": '" + path + "' cannot be written (" + why + "); give another path");
}

Result<void> write_all(int fd, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return write_failure(path, "write", errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return {};
}

// Whether an earlier run may have written the file, or it holds nothing.
bool may_replace(const std::string& path, const FileKind& kind) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (error) return false;
  if (size == 0 || kind.size != 0) return size == 0 || size == kind.size;
  std::string head(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return !kind.marks[0].empty() && std::ranges::all_of(kind.marks, [&](std::string_view mark) {
    return head.find(mark) != std::string::npos;
  });
}

tl::unexpected<Error> refuse_to_replace(const std::string& option, const std::string& path,
                                        const std::string& there, const FileKind& kind) {
  const bool recognised = !kind.marks[0].empty() || kind.size != 0;
  return refused(option, path,
                 recognised ? there + " exists and is not a " + kind.name + " of kaz"
                            : there + " exists already");
}

bool is_standard_output(const std::string& path) {
  struct stat there = {}, ours = {};
  if (::stat(path.c_str(), &there) != 0) return false;
  for (const int fd : {STDOUT_FILENO, STDERR_FILENO}) {
    if (::fstat(fd, &ours) == 0 && ours.st_dev == there.st_dev && ours.st_ino == there.st_ino)
      return true;
  }
  return false;
}

}  // namespace

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(target_, other.target_);
  std::swap(part_, other.part_);
  std::swap(fd_, other.fd_);
  std::swap(at_last_, other.at_last_);
  return *this;
}

OutputFile::~OutputFile() {
  if (fd_ < 0) return;
  if (!target_.empty()) ::unlink(part_.c_str());
  release();
}

const std::string& OutputFile::part() const {
  keep_what_grows(at_last_);
  return part_;
}

// Held open from now on: the reader of a pipe would see its end otherwise.
Result<void> OutputFile::open_stream(const std::string& option) {
  part_ = path_;
  struct stat about = {};
  if (::stat(path_.c_str(), &about) == 0 && S_ISBLK(about.st_mode))
    return refused(option, path_, "the path is a block device");
  fd_ = ::open(path_.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0)
    return refused(option, path_,
                   errno == ENXIO && S_ISFIFO(about.st_mode) ? "no program reads this pipe"
                                                             : std::strerror(errno));
  ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) & ~O_NONBLOCK);
  return {};
}

// The part is created anew: one that a killed run has left may be a link. False: try again.
Result<bool> OutputFile::lock_part(const std::string& option, const FileKind& kind) {
  fd_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const bool fresh = fd_ >= 0, stale = !fresh && errno == EEXIST;
  if (stale) fd_ = ::open(part_.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) {
    if (errno == ENOENT && stale) return false;  // it has gone in between
    if (lacks_space(errno)) return write_failure(path_, "write", errno);
    const int error = errno;
    const fs::path folder = fs::absolute(part_).parent_path();
    if (error == ENOENT && !fs::exists(folder))
      return refused(option, path_, "there is no folder " + folder.string());
    return refused(option, path_, std::strerror(error));
  }
  struct stat here = {}, there = {};
  ::fstat(fd_, &here);
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const long process = lock_holder(here);
    ::close(std::exchange(fd_, -1));
    if (process == ::getpid()) return refused(option, path_, "another option names the same file");
    return fail(Fault::environment,
                option + ": another run" +
                    (process > 0 ? " (process " + std::to_string(process) + ")" : std::string()) +
                    " is writing '" + path_ + "': wait until that run ends, or give another path");
  }
  const bool in_place = ::lstat(part_.c_str(), &there) == 0 && here.st_ino == there.st_ino;
  if (fresh && in_place) return true;
  if (in_place && !may_replace(part_, kind)) {
    ::close(std::exchange(fd_, -1));
    return refuse_to_replace(option, path_, part_, kind);
  }
  if (in_place && ::unlink(part_.c_str()) != 0) {
    const int error = errno;
    ::close(std::exchange(fd_, -1));
    return refused(option, path_, std::strerror(error));
  }
  ::close(std::exchange(fd_, -1));
  return false;
}

Result<OutputFile> OutputFile::open(const std::string& path, const std::string& option,
                                    const FileKind& kind) {
  OutputFile file;
  file.path_ = path;
  std::error_code error;
  const auto status = fs::status(path, error);
  const bool link = fs::is_symlink(fs::symlink_status(path, error));
  if (path.empty()) return refused(option, path, "the path is empty");
  if (fs::is_directory(status)) return refused(option, path, "the path is a folder");
  if (link && !fs::exists(status))
    return refused(option, path, "the path is a link to a missing file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    KAZ_TRY(file.open_stream(option));
    return file;
  }
  file.target_ = link ? fs::canonical(path, error).string() : path;
  file.part_ = file.target_ + ".part";
  if (fs::exists(status)) {
    if (is_standard_output(path))
      return refused(option, path, "the path is the standard output of this program");
    if (!may_replace(path, kind)) return refuse_to_replace(option, path, "the file", kind);
  }
  const fs::path folder = fs::absolute(file.target_, error).parent_path();
  if (fs::exists(fs::symlink_status(folder / kOutputListName, error)))
    return refused(option, path, "the folder of this path contains the results of a run");
  for (int attempt = 0;; ++attempt) {
    const auto locked = KAZ_TRY(file.lock_part(option, kind));
    if (locked) break;
    if (attempt == 100)
      return refused(option, path, "other programs remove " + file.part_ + " repeatedly");
  }
  file.at_last_ = remove_file_at_last(file.part_);
  // That so many bytes fit shows that the disk is not full.
  KAZ_TRY(write_all(file.fd_, path, std::string(4096, '\n')));
  if (::ftruncate(file.fd_, 0) != 0) return write_failure(path, "write", errno);
  ::lseek(file.fd_, 0, SEEK_SET);
  return file;
}

Result<void> OutputFile::check_room(std::uint64_t bytes) {
  if (target_.empty() || ::fallocate(fd_, 0, 0, static_cast<off_t>(bytes)) == 0 ||
      !lacks_space(errno)) {
    if (!target_.empty() && ::ftruncate(fd_, 0) != 0) return write_failure(path_, "write", errno);
    return {};
  }
  return tl::unexpected(explained(write_failure(path_, "write", errno).value()));
}

Result<void> OutputFile::write(std::string_view bytes) {
  if (auto written = write_all(fd_, path_, bytes); !written)
    return tl::unexpected(explained(written.error()));
  return commit();
}

Result<void> OutputFile::commit() {
  if (target_.empty()) return {};
  if (!sync_file(fd_))
    return tl::unexpected(explained(write_failure(path_, "write", errno).value()));
  if (!move_into_place(part_, target_))
    return write_failure(path_, "move the file into place", errno);
  g_saved.push_back(path_);
  release();
  return {};
}

Error OutputFile::failure() {
  const int fd = ::open(part_.c_str(), O_WRONLY | O_APPEND | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const off_t length = fd < 0 ? -1 : ::lseek(fd, 0, SEEK_END);
  const auto again = fd < 0 ? Result<void>(write_failure(path_, "write", errno))
                            : write_all(fd, path_, std::string(1 << 16, '\n'));
  if (length >= 0 && !target_.empty()) (void)!::ftruncate(fd, length);
  if (fd >= 0) ::close(fd);
  Error error =
      again ? Error{Fault::environment, path_ + ": writing has failed; try again"} : again.error();
  if (!target_.empty()) {
    g_saved.push_back(part_);
    release();
  }
  return explained(std::move(error));
}

void OutputFile::release() {
  forget_file(std::exchange(at_last_, -1));
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

}  // namespace kaz::tools
