// Files appear whole or not at all.
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "tools/figure/figure.h"

namespace kaz::figure {

namespace {

tl::unexpected<Error> cannot(const std::string& what, const std::string& path, int error) {
  return fail(Fault::environment,
              path + ": cannot " + what + " (" + std::strerror(error) +
                  "): check the folder's existence, permissions and free space");
}

}  // namespace

Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::string temporary = path + ".XXXXXX";
  const int fd = mkstemp(temporary.data());
  if (fd < 0) return cannot("write here", path, errno);
  const auto give_up = [&](const std::string& what) {
    const int error = errno;
    unlink(temporary.c_str());
    return cannot(what, path, error);
  };
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t n = write(fd, bytes.data() + written, bytes.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const auto failure = give_up("write");
      close(fd);
      return failure;
    }
    written += static_cast<std::size_t>(n);
  }
  // mkstemp makes it private; results are for everyone the umask allows.
  const mode_t mask = umask(0);
  umask(mask);
  if (fchmod(fd, 0666 & ~mask) != 0) {
    const auto failure = give_up("set the permissions");
    close(fd);
    return failure;
  }
  if (close(fd) != 0) return give_up("write");
  if (std::rename(temporary.c_str(), path.c_str()) != 0)
    return give_up("put the file in its place");
  return {};
}

}  // namespace kaz::figure
