// Frames to ISO-TP messages and back, error frames, and an interface that goes and comes back.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/can_link.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/link/byte_stream.h"
#include "host/link/wall_clock.h"
#include "shared/base/counted.hpp"

namespace kaz::host {

namespace {

// ISO-TP carries 4095 bytes; the board takes KZ_FRAME_MAX and counts what is longer.
constexpr std::size_t kMaxMessage = 4095;
constexpr std::size_t kMaxWaiting =
    16;  // messages to one receiver; more replies than a host asks for
constexpr std::uint32_t kErrorsTag = 0xFF;
constexpr Time kRetry = std::chrono::milliseconds(1);

// Errors of one transfer, which leave the interface and the socket usable (net/can/isotp.c).
bool of_one_transfer(int error) {
  switch (error) {
    case ETIMEDOUT:  // a consecutive frame did not come
    case EILSEQ:     // one came out of order
    case EBADMSG:    // wrong length or padding
    case ECOMM:      // nobody answered, or a frame of ours was not sent
    case EMSGSIZE:   // too long for the receiver
    case EOVERFLOW:
      return true;
    default:
      return false;
  }
}

bool tries_later(int error) {
  return error == EAGAIN || error == EBUSY || error == ENOBUFS;
}

}  // namespace

std::string CanStatistics::text() const {
  std::string text;
  const auto add = [&text](std::uint64_t count, const std::string& words) {
    if (count > 0) text += (text.empty() ? "" : ", ") + words;
  };
  add(error_frames, counted(error_frames, "error frame"));
  add(bus_off, "bus-off " + counted(bus_off, "time"));
  add(restarts, counted(restarts, "restart"));
  add(overflows, counted(overflows, "controller overflow"));
  add(unfinished_out, counted(unfinished_out, "message") + " not delivered");
  add(unfinished_in, counted(unfinished_in, "message") + " received incompletely");
  add(discarded, counted(discarded, "frame") + " discarded");
  return text;
}

Result<std::unique_ptr<CanLink>> CanLink::open(std::unique_ptr<CanSockets> sockets,
                                               const Options& options) {
  std::unique_ptr<CanLink> link(new CanLink(std::move(sockets), options));
  KAZ_TRY(link->open_all());
  return link;
}

CanLink::CanLink(std::unique_ptr<CanSockets> sockets, const Options& options)
    : sockets_(std::move(sockets)), options_(options) {
  for (std::uint8_t a = 1; a <= kCanAll; ++a) {
    const std::uint32_t request = kCanRequests + a, reply = kCanReplies + a;
    if (options_.end == End::host) {
      channels_[a].ids = {request, reply,
                          a == kCanAll ? IsoTpChannel::Mode::broadcast : IsoTpChannel::Mode::pair};
    } else {
      channels_[a].ids = {reply, request,
                          a == kCanAll ? IsoTpChannel::Mode::listen : IsoTpChannel::Mode::pair};
      channels_[a].used = a == kCanAll || std::ranges::count(options_.addresses, a) > 0;
    }
  }
}

// The host's end opens a channel when it first writes to it, and listens there from then on.
Result<void> CanLink::open_all() {
  KAZ_TRY(sockets_->check());
  events_ = Descriptor(epoll_create1(EPOLL_CLOEXEC));
  if (!events_)
    return fail(Fault::environment, "cannot wait for " + name() + ": " + std::strerror(errno));
  errors_ = KAZ_TRY(sockets_->open_errors());
  KAZ_TRY(watch(errors_.get(), kErrorsTag));
  for (std::uint8_t a = 1; a <= kCanAll; ++a) {
    if (channels_[a].used) KAZ_TRY(open_channel(a));
  }
  return {};
}

Result<void> CanLink::open_channel(std::uint8_t number) {
  Channel& channel = channels_[number];
  channel.socket = Descriptor();
  channel.socket = KAZ_TRY(sockets_->open_isotp(channel.ids));
  channel.used = true;
  return watch(channel.socket.get(), number);
}

Result<void> CanLink::watch(int descriptor, std::uint32_t tag) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u32 = tag;
  if (epoll_ctl(events_.get(), EPOLL_CTL_ADD, descriptor, &event) == 0) return {};
  return fail(Fault::environment, "cannot wait for " + name() + ": " + std::strerror(errno));
}

Result<void> CanLink::set_dtr_rts(bool, bool) {
  return fail(Fault::environment, name() + " is a CAN bus, which has no lines DTR and RTS");
}

Result<void> CanLink::reopen() {
  if (options_.interrupt && options_.interrupt->ends_waiting())
    return tl::unexpected(Interrupt::error());
  // First all old sockets: their identifiers may be bound only once.
  for (Channel& channel : channels_) {
    channel.socket = Descriptor();
    channel.waiting.clear();
  }
  errors_ = Descriptor();
  events_ = Descriptor();
  message_.clear();
  too_long_ = false;
  received_.clear();
  bus_off_ = false;
  return open_all();
}

// Why: what is wrong with the interface now, or that it was lost although it is there again.
Error CanLink::lost() {
  events_ = Descriptor();
  if (const auto state = sockets_->check(); !state) return state.error();
  return {Fault::environment, "the CAN interface " + sockets_->interface() +
                                  (bus_off_ ? " was bus-off: check wiring, termination and bit rate"
                                            : " was lost for a while")};
}

Result<void> CanLink::write(std::span<const std::uint8_t> bytes) {
  if (!events_) return tl::unexpected(lost());
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      too_long_ = too_long_ || message_.size() == kMaxMessage;
      if (!too_long_) message_.push_back(byte);
      continue;
    }
    if (too_long_) {
      ++statistics_.discarded;
    } else if (!message_.empty()) {
      KAZ_TRY(send_message());
    }
    message_.clear();
    too_long_ = false;
  }
  return {};
}

// The first stuffed byte says how far it is to the first zero of the body, so behind a 1 the address is 0.
std::uint8_t CanLink::channel_for(std::span<const std::uint8_t> message) const {
  const std::uint8_t address = message.size() > 1 && message[0] > 1 ? message[1] : 0;
  if (options_.end == End::host)
    return address >= 1 && address <= KZ_ADDRESS_LAST ? address : kCanAll;
  // What says no address of its own, such as noise, is heard at the first: hosts say what came.
  return std::ranges::count(options_.addresses, address) > 0 ? address : options_.addresses.front();
}

Result<void> CanLink::send_message() {
  const std::uint8_t number = channel_for(message_);
  Channel& channel = channels_[number];
  if (!channel.socket) KAZ_TRY(open_channel(number));
  if (channel.waiting.size() >= kMaxWaiting) {
    ++statistics_.discarded;
    channel.waiting.pop_front();
  }
  if (channel.waiting.empty()) channel.since = WallClock().now();
  channel.waiting.push_back(message_);
  return flush(channel);
}

Result<void> CanLink::flush(Channel& channel) {
  for (int failures = 0; !channel.waiting.empty();) {
    const std::vector<std::uint8_t>& next = channel.waiting.front();
    const ssize_t n = send(channel.socket.get(), next.data(), next.size(), MSG_NOSIGNAL);
    if (n >= 0) {
      ++statistics_.frames_out;
      channel.waiting.pop_front();
      channel.since = WallClock().now();
    } else if (tries_later(errno)) {
      if (WallClock().now() - channel.since < kGiveUp) return {};
      // A new socket has no transfer under way.
      ++statistics_.unfinished_out;
      channel.waiting.clear();
      return open_channel(static_cast<std::uint8_t>(&channel - channels_.data()));
    } else if (of_one_transfer(errno)) {
      // The error of an earlier message.
      ++statistics_.unfinished_out;
      if (++failures > 2) channel.waiting.pop_front();
    } else if (errno != EINTR) {
      return tl::unexpected(lost());
    }
  }
  return {};
}

Result<void> CanLink::flush_all() {
  for (Channel& channel : channels_) {
    if (!channel.waiting.empty()) KAZ_TRY(flush(channel));
  }
  return {};
}

bool CanLink::any_waiting() const {
  return std::ranges::any_of(channels_, [](const Channel& c) { return !c.waiting.empty(); });
}

Result<std::size_t> CanLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  const WallClock clock;
  while (true) {
    if (!received_.empty()) {
      const std::size_t count = std::min(bytes.size(), received_.size());
      const auto end = received_.begin() + static_cast<std::ptrdiff_t>(count);
      std::copy(received_.begin(), end, bytes.begin());
      received_.erase(received_.begin(), end);
      return count;
    }
    if (!events_) return tl::unexpected(lost());
    KAZ_TRY(flush_all());
    // Not for POLLOUT, which kernels before 6.3 report while a transfer is under way.
    const Time until = any_waiting() ? std::min(deadline, clock.now() + kRetry) : deadline;
    const short ready = KAZ_TRY(wait_for(events_.get(), POLLIN, until, options_.interrupt, name()));
    if (ready == 0 && clock.now() >= deadline) return 0;
    if (ready != 0) KAZ_TRY(take_ready());
  }
}

Result<void> CanLink::take_ready() {
  std::array<epoll_event, kCanAll + 1> events{};
  const int count = epoll_wait(events_.get(), events.data(), static_cast<int>(events.size()), 0);
  for (int i = 0; i < count; ++i) {
    const std::uint32_t tag = events[static_cast<std::size_t>(i)].data.u32;
    if (tag == kErrorsTag) {
      KAZ_TRY(take_errors());
    } else if (tag < channels_.size()) {
      KAZ_TRY(take_messages(channels_[tag]));
    }
  }
  return {};
}

Result<void> CanLink::take_messages(Channel& channel) {
  std::array<std::uint8_t, kMaxMessage + 1> message;
  for (int k = 0; k < static_cast<int>(kMaxWaiting) && channel.socket; ++k) {
    const ssize_t n = recv(channel.socket.get(), message.data(), message.size(), MSG_DONTWAIT);
    if (n > 0) {
      ++statistics_.frames_in;
      received_.push_back(0);
      // A zero inside would be two frames; none that came from a line has one.
      for (ssize_t i = 0; i < n; ++i) received_.push_back(message[static_cast<std::size_t>(i)]);
      received_.push_back(0);
    } else if (n == 0) {
      // The kernel's sockets have no end; a test's has.
      channel.socket = Descriptor();
      return tl::unexpected(lost());
    } else if (errno == EAGAIN || errno == EINTR) {
      return {};
    } else if (errno == ECOMM) {
      ++statistics_.unfinished_out;
    } else if (of_one_transfer(errno)) {
      ++statistics_.unfinished_in;
    } else {
      return tl::unexpected(lost());
    }
  }
  return {};
}

Result<void> CanLink::take_errors() {
  while (true) {
    can_frame frame{};
    const ssize_t n = recv(errors_.get(), &frame, sizeof frame, MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (n <= 0) return tl::unexpected(lost());
    if (n == sizeof frame && (frame.can_id & CAN_ERR_FLAG)) {
      count_error_frame(frame.can_id & CAN_ERR_MASK);
      if ((frame.can_id & CAN_ERR_CRTL) &&
          (frame.data[1] & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)))
        ++statistics_.overflows;
    }
  }
  return bus_off_ ? Result<void>(tl::unexpected(lost())) : Result<void>();
}

void CanLink::count_error_frame(std::uint32_t classes) {
  ++statistics_.error_frames;
  if (classes & CAN_ERR_BUSOFF) {
    ++statistics_.bus_off;
    bus_off_ = true;
  }
  if (classes & CAN_ERR_RESTARTED) {
    ++statistics_.restarts;
    bus_off_ = false;
  }
}

}  // namespace kaz::host
