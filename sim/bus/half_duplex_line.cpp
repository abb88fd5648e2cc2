// One wire shared by a host and servos, bit by bit.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/half_duplex_line.h"

#include <algorithm>

namespace kaz::sim {
namespace {

constexpr int kBits = 10;  // start, 8 data bits, stop

Time after(Time start, double bits, double bit_ns) {
  return start + Time(static_cast<std::int64_t>(bits * bit_ns + 0.5));
}

}  // namespace

HalfDuplexLine::HalfDuplexLine(std::size_t nodes, double baud) : uarts_(nodes) {
  for (Uart& uart : uarts_) uart.bit_ns = 1e9 / baud;
}

void HalfDuplexLine::set_baud(std::size_t node, double baud) {
  uarts_[node].bit_ns = 1e9 / baud;
  uarts_[node].known = false;
}

void HalfDuplexLine::set_damage(double share, std::uint64_t seed) {
  damage_ = share;
  random_ = Random(seed);
}

void HalfDuplexLine::set_echo(std::size_t node, bool on) {
  uarts_[node].echo = on;
  uarts_[node].known = false;
}

Time HalfDuplexLine::send(std::size_t node, std::span<const std::uint8_t> bytes, Time from) {
  Uart& sender = uarts_[node];
  const Time begin = std::max(from, sender.sent_until);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    WireByte byte{node, bytes[i], sender.bit_ns, after(begin, 10.0 * i, sender.bit_ns),
                  after(begin, 10.0 * (i + 1), sender.bit_ns)};
    if (damage_ > 0 && random_.chance(damage_)) {
      byte.value ^= static_cast<std::uint8_t>(1u << random_.below(8));
      ++damaged_;
    }
    sender.sent_until = byte.end;
    const auto later = std::ranges::upper_bound(wire_, byte.start, {}, &WireByte::start);
    wire_.insert(later, byte);
  }
  for (Uart& uart : uarts_) uart.known = false;
  return sender.sent_until;
}

Time HalfDuplexLine::busy_until() const {
  return std::ranges::max_element(uarts_, {}, &Uart::sent_until)->sent_until;
}

// The level that `node` receives.
bool HalfDuplexLine::level(std::size_t node, Time at) const {
  for (const WireByte& byte : wire_) {
    if (byte.start > at) break;
    if (ignores(node, byte) || at >= byte.end) continue;
    const auto bit = static_cast<int>(static_cast<double>((at - byte.start).count()) / byte.bit_ns);
    if (!byte.high(std::min(bit, kBits - 1))) return false;
  }
  return true;
}

std::optional<Time> HalfDuplexLine::falling_edge(std::size_t node, Time from) const {
  std::optional<Time> first;
  for (const WireByte& byte : wire_) {
    if (first && byte.start >= *first) break;
    if (ignores(node, byte) || byte.end <= from) continue;
    for (int bit = 0; bit < kBits; ++bit) {
      if (byte.high(bit) || (bit > 0 && !byte.high(bit - 1))) continue;
      const Time edge = byte.edge(bit);
      if (edge < from || (first && edge >= *first)) continue;
      if (level(node, edge - Time(1))) first = edge;
    }
  }
  return first;
}

// In its stop bit a node listens: an answer to a sender whose clock is slow begins there.
bool HalfDuplexLine::sends(std::size_t node, Time at) const {
  return std::ranges::any_of(wire_, [&](const WireByte& byte) {
    return ignores(node, byte) && byte.start <= at && at < byte.edge(kBits - 1);
  });
}

// The node's next byte: samples in the middle of each bit, counted from the falling edge of the start bit.
void HalfDuplexLine::look_ahead(std::size_t node) {
  Uart& uart = uarts_[node];
  uart.known = true;
  uart.next.reset();
  for (Time from = uart.from;;) {
    const auto start = falling_edge(node, from);
    if (!start) return;
    from = *start + Time(1);
    if (sends(node, *start) || level(node, after(*start, 0.5, uart.bit_ns))) continue;
    Received byte{node, 0, level(node, after(*start, 9.5, uart.bit_ns)),
                  after(*start, kBits, uart.bit_ns)};
    for (int bit = 0; bit < 8; ++bit) {
      if (level(node, after(*start, 1.5 + bit, uart.bit_ns)))
        byte.byte |= static_cast<std::uint8_t>(1u << bit);
    }
    uart.next = byte;
    uart.after = after(*start, 9.5, uart.bit_ns);
    return;
  }
}

std::optional<HalfDuplexLine::Received> HalfDuplexLine::next(Time until) {
  Uart* first = nullptr;
  for (std::size_t node = 0; node < uarts_.size(); ++node) {
    Uart& uart = uarts_[node];
    if (!uart.known) look_ahead(node);
    if (uart.next && (first == nullptr || uart.next->at < first->next->at)) first = &uart;
  }
  const bool none = first == nullptr || first->next->at > until;
  forget(none ? until : first->next->at);
  if (none) return std::nullopt;
  const Received received = *first->next;
  first->from = first->after;
  first->known = false;
  return received;
}

// Nothing that is not on the wire yet begins before `now`. Drops bytes that no node looks at any more.
void HalfDuplexLine::forget(Time now) {
  Time oldest = now;
  for (Uart& uart : uarts_) {
    if (!uart.next) uart.from = std::max(uart.from, now);
    oldest = std::min(oldest, uart.from);
  }
  while (!wire_.empty() && wire_.front().end + Time(1) < oldest) wire_.pop_front();
}

}  // namespace kaz::sim
