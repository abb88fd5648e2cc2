// Negotiation, settings, and the bytes between them.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/rfc2217_link.h"

#include <algorithm>
#include <array>
#include <utility>

#include "host/link/tcp_socket.h"
#include "host/link/wall_clock.h"
#include "shared/base/counted.hpp"

namespace kaz::host {

namespace {

using namespace telnet;

constexpr Time kFirst = std::chrono::seconds(3), kAgain = std::chrono::milliseconds(500);
constexpr Time kReplyWithin = std::chrono::seconds(1);
constexpr std::size_t kMaxReplies = 64;
// Data that come while a command is answered: more than a port at 4 Mbaud receives within kReplyWithin.
constexpr std::size_t kMaxKept = 1 << 20;

}  // namespace

Result<std::unique_ptr<Rfc2217Link>> Rfc2217Link::open(const PortAddress& address,
                                                       const Interrupt* interrupt) {
  std::unique_ptr<Rfc2217Link> link(new Rfc2217Link(address, interrupt));
  KAZ_TRY(link->begin(kFirst));
  return link;
}

Rfc2217Link::Rfc2217Link(PortAddress address, const Interrupt* interrupt)
    : address_(std::move(address)),
      interrupt_(interrupt),
      stream_(address_.name(),
              address_.name() +
                  " was closed by the other end: the board was unplugged, the server ended, or "
                  "another program uses the connection",
              interrupt) {}

Result<void> Rfc2217Link::begin(Time patience) {
  stream_.detach();
  dropped_ += reader_.dropped();
  reader_ = {};
  options_ = {};
  data_.clear();
  replies_.clear();
  const Time deadline = WallClock().now() + patience;
  stream_.attach(KAZ_TRY(
      connect_tcp(address_.name(), address_.place, address_.tcp_port, patience, interrupt_)));
  std::vector<std::uint8_t> wire;
  options_.begin(End::client, wire);
  KAZ_TRY(stream_.write(wire));
  while (!options_.com_port()) {
    if (options_.refused() || WallClock().now() >= deadline)
      return fail(Fault::environment,
                  name() + ": the server at this address does not support RFC 2217: give " +
                      "tcp:" + name().substr(std::string_view("rfc2217:").size()) +
                      " to transfer only bytes, or serve the port with `kaz serve-port` or "
                      "ser2net (with its option telnet(rfc2217))");
    KAZ_TRY(pump(deadline));
    data_.clear();  // of a port whose settings are another client's
  }
  return set_up();
}

Result<void> Rfc2217Link::set_up() {
  std::vector<std::uint8_t> wire;
  for (const auto& [command, value] : {std::pair(kDataSize, std::uint8_t{8}),
                                       {kParity, 1},
                                       {kStopSize, 1},
                                       {kControl, kNoFlowControl}})
    put_com_port(command, {{value}}, wire);
  KAZ_TRY(stream_.write(wire));
  KAZ_TRY(set_baud(address_.baud));
  // What the port received before is of another client.
  KAZ_TRY(value_of(kPurge, {{3}}));
  data_.clear();
  return {};
}

Result<void> Rfc2217Link::set_baud(int baud) {
  const auto set = KAZ_TRY(value_of(kBaudRate, big_endian(static_cast<std::uint32_t>(baud))));
  if (!set)
    return fail(Fault::environment, name() + " does not confirm the bit rate of " +
                                        std::to_string(baud) + " baud: its server is too slow");
  if (*set != static_cast<std::uint32_t>(baud))
    return fail(Fault::usage, name() + " cannot set its port to " + std::to_string(baud) +
                                  " baud; it stays at " + std::to_string(*set));
  address_.baud = baud;
  return {};
}

Result<void> Rfc2217Link::set_dtr_rts(bool dtr, bool rts) {
  std::vector<std::uint8_t> wire;
  put_com_port(kControl, {{dtr ? kDtrOn : kDtrOff}}, wire);
  replies_.clear();
  KAZ_TRY(stream_.write(wire));
  const auto set = KAZ_TRY(value_of(kControl, {{rts ? kRtsOn : kRtsOff}}));
  // Both replies, or one, have come: the last says what became of RTS.
  if (set && *set == (rts ? kRtsOn : kRtsOff)) return {};
  if (set && *set == (dtr ? kDtrOn : kDtrOff)) {
    const Time deadline = WallClock().now() + kReplyWithin;
    while (replies_.empty() && WallClock().now() < deadline) KAZ_TRY(pump(deadline));
    if (!replies_.empty() && replies_.front().data == std::vector{rts ? kRtsOn : kRtsOff})
      return {};
  }
  return fail(Fault::environment,
              name() +
                  ": the serial port behind the server has no lines DTR and RTS, or the server "
                  "does not set them");
}

Result<std::optional<std::uint32_t>> Rfc2217Link::value_of(ComPort command,
                                                           std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> wire;
  put_com_port(command, data, wire);
  KAZ_TRY(stream_.write(wire));
  const Time deadline = WallClock().now() + kReplyWithin;
  while (true) {
    while (!replies_.empty()) {
      const Command reply = std::move(replies_.front());
      replies_.pop_front();
      if (reply.what != command + kReply || reply.data.empty()) continue;
      return std::optional<std::uint32_t>(command == kBaudRate ? read_big_endian(reply.data)
                                                               : reply.data.front());
    }
    if (WallClock().now() >= deadline) return std::nullopt;
    KAZ_TRY(pump(deadline));
  }
}

Result<bool> Rfc2217Link::pump(Time deadline) {
  std::array<std::uint8_t, 1024> wire;
  const std::size_t count = KAZ_TRY(stream_.read(wire, deadline));
  std::span<const std::uint8_t> left = std::span(wire).first(count);
  std::vector<std::uint8_t> answer;
  while (auto command = reader_.take(left)) {
    options_.take(*command, answer);
    if (command->verb == kSb && replies_.size() < kMaxReplies)
      replies_.push_back(std::move(*command));
  }
  const auto data = reader_.take_data();
  data_.insert(data_.end(), data.begin(), data.end());
  if (data_.size() > kMaxKept)
    return fail(Fault::environment, name() + " sent more than " + std::to_string(kMaxKept) +
                                        " bytes before the reply to a command, which is "
                                        "not possible for a serial port: check the server at "
                                        "this address");
  if (!answer.empty()) KAZ_TRY(stream_.write(answer));
  return count > 0;
}

Result<void> Rfc2217Link::write(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> wire;
  put_data(bytes, wire);
  return stream_.write(wire);
}

Result<std::size_t> Rfc2217Link::read(std::span<std::uint8_t> bytes, Time deadline) {
  replies_.clear();  // notices of line and modem states
  while (data_.empty()) {
    // A server that sends commands without end must not keep the caller.
    const bool more = KAZ_TRY(pump(deadline));
    if (data_.empty() && (!more || WallClock().now() >= deadline)) return 0;
  }
  const std::size_t count = std::min(bytes.size(), data_.size());
  const auto end = data_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(data_.begin(), end, bytes.begin());
  data_.erase(data_.begin(), end);
  return count;
}

Result<void> Rfc2217Link::reopen() {
  if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
  return begin(kAgain);
}

std::string Rfc2217Link::counts() const {
  const std::uint64_t dropped = dropped_ + reader_.dropped();
  return dropped == 0 ? "" : counted(dropped, "telnet command") + " dropped";
}

}  // namespace kaz::host
