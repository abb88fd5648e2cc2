// A file that grows beside its place.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>

#include "shared/base/files.hpp"
#include "tools/app/base/output_list.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

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

// Where a symbolic link leads, also if nothing is there yet.
std::string target_of(const std::string& path) {
  std::string target = path;
  std::error_code error;
  for (int depth = 0; depth < 40 && fs::is_symlink(target, error); ++depth) {
    const auto to = fs::read_symlink(target, error);
    if (error) break;
    target = (fs::path(target).parent_path() / to).string();
  }
  return target;
}

}  // namespace

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(target_, other.target_);
  std::swap(part_, other.part_);
  std::swap(fd_, other.fd_);
  return *this;
}

OutputFile::~OutputFile() {
  if (fd_ < 0) return;
  ::unlink(part_.c_str());
  ::close(fd_);
}

// The part is created anew: one that a killed run has left may be a link, or somebody else's. False: try
// again.
Result<bool> OutputFile::lock_part(const std::string& option) {
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
                    " writes '" + path_ + "': wait for its end, or give another path");
  }
  const bool in_place = ::lstat(part_.c_str(), &there) == 0 && here.st_ino == there.st_ino;
  if (fresh && in_place) return true;
  if (in_place && ::unlink(part_.c_str()) != 0) {
    const int error = errno;
    ::close(std::exchange(fd_, -1));
    return refused(option, path_, std::strerror(error));
  }
  ::close(std::exchange(fd_, -1));
  return false;
}

Result<OutputFile> OutputFile::open(const std::string& path, const std::string& option) {
  OutputFile file;
  file.path_ = path;
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::is_directory(status)) return refused(option, path, "a folder of that name is there");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    file.part_ = path;
    if (::access(path.c_str(), W_OK) != 0) return refused(option, path, std::strerror(errno));
    return file;
  }
  file.target_ = target_of(path);
  file.part_ = file.target_ + ".part";
  for (int attempt = 0;; ++attempt) {
    const auto locked = KAZ_TRY(file.lock_part(option));
    if (locked) break;
    if (attempt == 100)
      return refused(option, path, "others remove " + file.part_ + " all the time");
  }
  // That so many bytes fit shows that the disk is not full.
  KAZ_TRY(write_all(file.fd_, path, std::string(4096, '\n')));
  if (::ftruncate(file.fd_, 0) != 0) return write_failure(path, "write", errno);
  ::lseek(file.fd_, 0, SEEK_SET);
  return file;
}

Result<void> OutputFile::write(std::string_view bytes) {
  if (target_.empty()) return write_whole_file(part_, bytes);
  KAZ_TRY(write_all(fd_, path_, bytes));
  return commit();
}

Result<void> OutputFile::commit() {
  if (target_.empty()) return {};
  if (::rename(part_.c_str(), target_.c_str()) != 0)
    return write_failure(path_, "put the file in its place", errno);
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
  if (target_.empty()) return error;
  error.message += "; saved so far: " + part_;
  release();
  return error;
}

void OutputFile::release() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

}  // namespace kaz::tools
