// Non-blocking reads and writes on a serial port, waiting in poll().
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tty_link.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/link/serial_port.h"
#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

constexpr std::size_t kMaxPending = 65536;

}  // namespace

Result<std::unique_ptr<TtyLink>> TtyLink::open(const std::string& path, int baud,
                                               const Interrupt* interrupt) {
  const auto port = KAZ_TRY(open_serial_port(path, baud));
  return std::unique_ptr<TtyLink>(new TtyLink(path, baud, port, interrupt));
}

TtyLink::TtyLink(std::string path, int baud, const OpenPort& port, const Interrupt* interrupt)
    : path_(std::move(path)),
      baud_(baud),
      fd_(port.descriptor),
      low_latency_(port.low_latency),
      interrupt_(interrupt) {}

TtyLink::~TtyLink() {
  if (fd_ >= 0) close(fd_);
}

Result<void> TtyLink::reopen() {
  if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
  if (fd_ >= 0) close(std::exchange(fd_, -1));
  pending_.clear();
  const auto port = KAZ_TRY(open_serial_port(path_, baud_));
  fd_ = port.descriptor;
  low_latency_ = port.low_latency;
  return {};
}

Time TtyLink::byte_time() const {
  return Time(10'000'000'000 / baud_);  // start bit, 8 data bits, stop bit
}

Result<void> TtyLink::set_baud(int baud) {
  if (fd_ < 0) return tl::unexpected(closed());
  if (auto set = set_serial_rate(fd_, path_, baud); !set) return set;
  baud_ = baud;
  return {};
}

Result<void> TtyLink::set_dtr_rts(bool dtr, bool rts) {
  if (fd_ < 0) return tl::unexpected(closed());
  if (low_latency_ == LowLatency::pseudo_terminal)
    return fail(Fault::environment,
                path_ + " is a pseudo-terminal, which has no lines DTR and RTS");
  int lines = 0;
  bool done = ioctl(fd_, TIOCMGET, &lines) == 0;
  lines = with_dtr_rts(lines, dtr, rts);
  done = done && ioctl(fd_, TIOCMSET, &lines) == 0;
  if (done) return {};
  return fail(Fault::environment, path_ + " has no lines DTR and RTS: " + std::strerror(errno));
}

Error TtyLink::closed() const {
  return Error{Fault::environment,
               "port " + path_ + " was closed: the board was unplugged or the simulator ended"};
}

Result<void> TtyLink::write(std::span<const std::uint8_t> bytes) {
  if (pending_.size() + bytes.size() > kMaxPending) {
    return fail(Fault::environment, "port " + path_ + " takes no bytes: check the adapter");
  }
  if (fd_ < 0) return tl::unexpected(closed());
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  return flush();
}

Result<void> TtyLink::flush() {
  std::size_t done = 0;
  while (done < pending_.size()) {
    const ssize_t n = ::write(fd_, pending_.data() + done, pending_.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n < 0 && errno == EAGAIN) {
      break;
    } else if (n < 0 && errno != EINTR) {
      return tl::unexpected(closed());
    }
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
  return {};
}

Result<std::size_t> TtyLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  const WallClock clock;
  if (fd_ < 0) return tl::unexpected(closed());
  while (true) {
    if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
    const Time left = std::max(deadline - clock.now(), Time::zero());
    const Time now_left = interrupt_ ? interrupt_->max_wait(left) : left;
    const timespec wait{static_cast<time_t>(now_left.count() / 1'000'000'000),
                        static_cast<long>(now_left.count() % 1'000'000'000)};
    pollfd watched[2] = {{fd_, static_cast<short>(pending_.empty() ? POLLIN : POLLIN | POLLOUT), 0},
                         {interrupt_ ? interrupt_->descriptor() : -1, POLLIN, 0}};
    const int ready = ppoll(watched, 2, &wait, nullptr);
    if (ready < 0 && errno != EINTR) {
      return fail(Fault::environment, "cannot wait for " + path_ + ": " + std::strerror(errno));
    }
    if (ready == 0 && now_left == left) return 0;
    if (ready <= 0) continue;

    if (watched[0].revents & POLLOUT) {
      KAZ_TRY(flush());
    }
    if (watched[0].revents & (POLLIN | POLLHUP | POLLERR | POLLNVAL)) {
      const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
      if (n > 0) return static_cast<std::size_t>(n);
      if (n == 0 || (errno != EAGAIN && errno != EINTR)) return tl::unexpected(closed());
    }
  }
}

}  // namespace kaz::host
