// A serial port as a link: rate, modem lines, and the same adapter again after it was unplugged.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tty_link.h"

#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "host/link/serial_identity.h"
#include "host/link/serial_port.h"

namespace kaz::host {

Result<std::unique_ptr<TtyLink>> TtyLink::open(const std::string& path, int baud,
                                               const Interrupt* interrupt) {
  const auto port = KAZ_TRY(open_serial_port(path, baud));
  return std::unique_ptr<TtyLink>(new TtyLink(path, baud, port, interrupt));
}

TtyLink::TtyLink(std::string path, int baud, const OpenPort& port, const Interrupt* interrupt)
    : path_(std::move(path)),
      identity_(serial_identity(path_)),
      baud_(baud),
      low_latency_(port.low_latency),
      interrupt_(interrupt),
      stream_(path_,
              "port " + path_ + " was closed: the board was unplugged or the simulator ended",
              interrupt) {
  stream_.attach(Descriptor(port.descriptor));
}

Result<std::string> TtyLink::path_now() const {
  if (identity_.empty() || serial_identity(path_) == identity_) return path_;
  if (const auto found = find_serial_port(identity_)) return *found;
  return fail(Fault::environment, "the adapter of " + path_ + " (USB " + identity_ +
                                      ") is not plugged in: plug it in again");
}

Result<void> TtyLink::reopen() {
  if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
  stream_.detach();
  const auto path = KAZ_TRY(path_now());
  const auto port = KAZ_TRY(open_serial_port(path, baud_));
  stream_.attach(Descriptor(port.descriptor));
  low_latency_ = port.low_latency;
  return {};
}

Time TtyLink::byte_time() const {
  return Time(10'000'000'000 / baud_);  // start bit, 8 data bits, stop bit
}

Result<void> TtyLink::set_baud(int baud) {
  if (!stream_.is_open()) return tl::unexpected(stream_.closed());
  if (auto set = set_serial_rate(stream_.descriptor(), path_, baud); !set) return set;
  baud_ = baud;
  return {};
}

Result<void> TtyLink::set_dtr_rts(bool dtr, bool rts) {
  if (!stream_.is_open()) return tl::unexpected(stream_.closed());
  if (low_latency_ == LowLatency::pseudo_terminal)
    return fail(Fault::environment,
                path_ + " is a pseudo-terminal, which has no lines DTR and RTS");
  int lines = 0;
  bool done = ioctl(stream_.descriptor(), TIOCMGET, &lines) == 0;
  lines = with_dtr_rts(lines, dtr, rts);
  done = done && ioctl(stream_.descriptor(), TIOCMSET, &lines) == 0;
  if (done) return {};
  return fail(Fault::environment, path_ + " has no lines DTR and RTS: " + std::strerror(errno));
}

bool TtyLink::drained() const {
  if (stream_.has_unsent()) return false;
  int queued = 0;
  if (ioctl(stream_.descriptor(), TIOCOUTQ, &queued) == 0 && queued > 0) return false;
  // Bytes in the FIFO of the UART or adapter are not in that number. They leave within milliseconds.
  return tcdrain(stream_.descriptor()) == 0 || errno != EINTR;
}

void TtyLink::purge(bool received, bool unsent) {
  if (unsent) stream_.drop_unsent();
  if (received || unsent)
    tcflush(stream_.descriptor(), !unsent ? TCIFLUSH : !received ? TCOFLUSH : TCIOFLUSH);
}

Result<void> TtyLink::write(std::span<const std::uint8_t> bytes) {
  return stream_.write(bytes);
}

Result<std::size_t> TtyLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  return stream_.read(bytes, deadline);
}

}  // namespace kaz::host
