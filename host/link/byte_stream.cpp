// Reads, writes and waiting on a non-blocking descriptor.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/byte_stream.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

constexpr std::size_t kMaxPending = 65536;

}  // namespace

Result<short> wait_for(int descriptor, short events, Time deadline, const Interrupt* interrupt,
                       const std::string& name) {
  const WallClock clock;
  while (true) {
    if (interrupt && interrupt->ends_waiting()) return tl::unexpected(Interrupt::error());
    const Time left = std::max(deadline - clock.now(), Time::zero());
    const Time now_left = interrupt ? interrupt->max_wait(left) : left;
    const timespec wait{static_cast<time_t>(now_left.count() / 1'000'000'000),
                        static_cast<long>(now_left.count() % 1'000'000'000)};
    pollfd watched[2] = {{descriptor, events, 0},
                         {interrupt ? interrupt->descriptor() : -1, POLLIN, 0}};
    const int ready = ppoll(watched, 2, &wait, nullptr);
    if (ready < 0 && errno != EINTR)
      return fail(Fault::environment, "cannot wait for " + name + ": " + std::strerror(errno));
    if (ready == 0 && now_left == left) return short{0};
    if (ready > 0 && watched[0].revents != 0) return watched[0].revents;
  }
}

void ByteStream::attach(Descriptor fd) {
  // First the old one: a port may be open only once.
  descriptor_ = Descriptor();
  descriptor_ = std::move(fd);
  pending_.clear();
  struct stat info {};
  socket_ = is_open() && fstat(descriptor(), &info) == 0 && S_ISSOCK(info.st_mode);
}

Result<void> ByteStream::write(std::span<const std::uint8_t> bytes) {
  if (pending_.size() + bytes.size() > kMaxPending)
    return fail(Fault::environment, "port " + name_ + " does not accept bytes: check the adapter");
  if (!is_open()) return tl::unexpected(closed());
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  return flush();
}

Result<void> ByteStream::flush() {
  std::size_t done = 0;
  while (done < pending_.size()) {
    const std::uint8_t* from = pending_.data() + done;
    const std::size_t left = pending_.size() - done;
    // A socket whose other end is gone is an error here, and no signal.
    const ssize_t n = socket_ ? ::send(descriptor(), from, left, MSG_NOSIGNAL)
                              : ::write(descriptor(), from, left);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n < 0 && errno == EAGAIN) {
      break;
    } else if (n < 0 && errno != EINTR) {
      pending_.clear();
      if (!socket_) detach();  // a socket may still hold the other end's last bytes
      return tl::unexpected(closed());
    }
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
  return {};
}

Result<std::size_t> ByteStream::read(std::span<std::uint8_t> bytes, Time deadline) {
  if (!is_open()) return tl::unexpected(closed());
  while (true) {
    const short events = static_cast<short>(pending_.empty() ? POLLIN : POLLIN | POLLOUT);
    const short ready = KAZ_TRY(wait_for(descriptor(), events, deadline, interrupt_, name_));
    if (ready == 0) return 0;
    if ((ready & POLLOUT) && !flush() && !is_open()) return tl::unexpected(closed());
    if (ready & (POLLIN | POLLHUP | POLLERR | POLLNVAL)) {
      const ssize_t n = ::read(descriptor(), bytes.data(), bytes.size());
      if (n > 0) return static_cast<std::size_t>(n);
      if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
        detach();
        return tl::unexpected(closed());
      }
    }
  }
}

}  // namespace kaz::host
