// Reads whole files, writes files atomically, and creates temporary folders.
// SPDX-License-Identifier: Apache-2.0
//
// New files and folders get unused names (O_EXCL, mkdtemp). In a shared folder such as /tmp, another user can
// place a link under a guessed name. These functions do not follow such a link.
#ifndef KAZ_SHARED_BASE_FILES_HPP
#define KAZ_SHARED_BASE_FILES_HPP

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz {

// Returns whether the errno value `error` means lack of space: full disk, quota, or file size limit.
inline bool lacks_space(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

// Returns the error for a failed write to `path`. `what` is the operation, `error` the errno value.
inline tl::unexpected<Error> write_failure(const std::string& path, const std::string& what,
                                           int error) {
  if (lacks_space(error))
    return tl::unexpected(
        Error{Fault::environment,
              "disk full while writing " + path + " (" + std::strerror(error) + ")", true});
  return fail(Fault::environment,
              path + ": cannot " + what + " (" + std::strerror(error) +
                  "): check the folder's existence, permissions and free space");
}

// Writes all bytes. Returns false and sets errno on failure.
inline bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

// Flushes a file to disk. Some file systems report a full disk only when a file is flushed. Returns false and
// sets errno on failure.
inline bool sync_file(int fd) {
  // EINVAL and ENOSYS are not errors: some files, such as devices, cannot be flushed.
  return fsync(fd) == 0 || errno == EINVAL || errno == ENOSYS;
}

// Creates an empty folder in TMPDIR or /tmp that only this user can access, and returns the path. The
// folder's name begins with `prefix`.
inline Result<std::string> make_temporary_folder(const std::string& prefix) {
  std::error_code error;
  const auto parent = std::filesystem::temp_directory_path(error);
  // mkdtemp requires and replaces the six X.
  std::string name = (parent / (prefix + "XXXXXX")).string();
  if (error || mkdtemp(name.data()) == nullptr)
    return fail(Fault::environment, "cannot make a folder for temporary files in " +
                                        (error ? std::string("TMPDIR") : parent.string()) + ": " +
                                        (error ? error.message() : std::strerror(errno)) +
                                        "; set TMPDIR to a writable folder");
  return name;
}

// Opens a regular file for reading. Rejects all other kinds of files: a pipe may block forever, a device may
// have no end, and opening some devices has side effects. `hint` is the end of the error message and states
// what the user can do. Returns Fault::usage if the file is missing, unreadable or not regular.
inline Result<Descriptor> open_input(const std::string& path,
                                     const std::string& hint = "check the path") {
  const auto cannot = [&](const std::string& what) {
    return fail(Fault::usage, path + ": " + what + "; " + hint);
  };
  struct stat about = {};
  const auto unreadable = [&] {
    return cannot(std::string("cannot be read (") + std::strerror(errno) + ")");
  };
  if (::stat(path.c_str(), &about) != 0) return unreadable();
  Descriptor file;
  if (S_ISREG(about.st_mode)) {
    // O_NONBLOCK: open() must not block if a pipe has replaced the file since stat().
    file = Descriptor(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!file || ::fstat(file.get(), &about) != 0) return unreadable();
  }
  if (S_ISREG(about.st_mode)) return file;
  return cannot(S_ISDIR(about.st_mode)    ? "is a folder, not a file"
                : S_ISFIFO(about.st_mode) ? "is a pipe, not a file: save its bytes in a file"
                : S_ISSOCK(about.st_mode) ? "is a socket, not a file"
                                          : "is a device, not a file");
}

// Returns all bytes of the file at `path`. Returns Fault::usage if open_input() fails, a read fails, or the
// file is larger than `max_bytes`.
inline Result<std::string> read_whole_file(const std::string& path, std::size_t max_bytes,
                                           const std::string& hint = "check the path") {
  const auto file = KAZ_TRY(open_input(path, hint));
  const auto cannot = [&](const std::string& what) {
    return fail(Fault::usage, path + ": " + what + "; " + hint);
  };
  const std::string too_large = max_bytes >= (1u << 20) ? std::to_string(max_bytes >> 20) + " MB"
                                                        : std::to_string(max_bytes >> 10) + " KB";
  std::string bytes;
  std::vector<char> block(1 << 16);
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return cannot(std::string("cannot be read (") + std::strerror(errno) + ")");
    if (n == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(n));
    if (bytes.size() > max_bytes)
      return cannot("has more than " + too_large + ", the limit for this kind of file");
  }
}

// Renames the file `from` to `to`, and flushes the folder's entry to disk. `from` must already be flushed to
// disk. Without the flush of the folder's entry, a power failure may restore the previous file. Returns false
// and sets errno on failure.
inline bool move_into_place(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) return false;
  const auto parent = std::filesystem::path(to).parent_path();
  const Descriptor folder(
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // A folder without read permission cannot be opened, so its entry is not flushed.
  return !folder || sync_file(folder.get());
}

// Replaces the file at `path` atomically: an existing file keeps its content until all new bytes are on disk.
// If `path` is a symbolic link, the target of the link is replaced. Devices and pipes are written directly.
// Returns Fault::environment on failure.
inline Result<void> write_whole_file(const std::string& path, std::string_view bytes) {
  const auto cannot = [&](const char* what, int error) { return write_failure(path, what, error); };
  std::error_code no_link;
  std::string target = path;
  for (int depth = 0; depth < 40 && std::filesystem::is_symlink(target, no_link); ++depth) {
    const auto to = std::filesystem::read_symlink(target, no_link);
    if (no_link) break;
    target = (std::filesystem::path(target).parent_path() / to).string();
  }
  // Devices and pipes are written directly, because a rename would remove the device or pipe for all
  // programs.
  const auto status = std::filesystem::status(target, no_link);
  const bool stream = std::filesystem::exists(status) &&
                      !std::filesystem::is_regular_file(status) &&
                      !std::filesystem::is_directory(status);
  std::string beside = target;
  int fd = stream ? open(target.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC) : -1;
  for (int n = 0; !stream && fd < 0 && n < 100; ++n) {
    beside = target + ".part" + std::to_string(getpid()) + "-" + std::to_string(n);
    fd = open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno != EEXIST) break;
  }
  if (fd < 0) return cannot("write here", errno);
  const auto give_up = [&](const char* what) {
    const int error = errno;
    if (!stream) unlink(beside.c_str());
    return cannot(what, error);
  };
  if (!write_all(fd, bytes) || (!stream && !sync_file(fd))) {
    auto failure = give_up("write");
    close(fd);
    return failure;
  }
  if (close(fd) != 0) return give_up("write");
  if (!stream && !move_into_place(beside, target)) return give_up("move the file into place");
  return {};
}

}  // namespace kaz

#endif
