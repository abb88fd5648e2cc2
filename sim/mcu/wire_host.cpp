// A seeded host that talks to a board over its serial line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/wire_host.h"

#include <algorithm>
#include <cstdio>

#include "shared/protocol/frame.h"
#include "shared/protocol/message_info.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;
// A tick reads its ring 450 to 850 states after it has become due, depending on its other work.
constexpr States kRingReadFrom = 300, kRingReadUntil = 1000;

constexpr std::uint32_t kMaxNoise = 160;  // bytes; sometimes longer than any frame

std::string name_of(std::uint8_t type) {
  const kz_message_info* info = kz_message_find(type);
  if (info) return info->name;
  char text[16];
  std::snprintf(text, sizeof text, "type 0x%02x", type);
  return text;
}

}  // namespace

WireHost::WireHost(std::uint64_t seed)
    : random_(seed), requests_of_(random_), sequence_(static_cast<std::uint8_t>(random_.next())) {
  plan_specials();
}

void WireHost::plan_specials() {
  const std::vector<std::uint8_t> off{KZ_TYPE_enable, 0, 0, 0, 0}, clear{KZ_TYPE_clear},
      quiet{KZ_TYPE_telemetry, 0, 0, 0};
  const auto key = [](std::uint8_t type) {
    return std::vector<std::uint8_t>{type, KZ_KEY >> 8, KZ_KEY & 0xFF};
  };
  const auto some_time = [this] { return 60 * kMs + random_.below(800) * kMs; };
  const auto away = [&](std::vector<std::vector<std::uint8_t>> bodies) {
    bodies.insert(bodies.begin(), {off, clear, quiet});
    planned_.push_back({some_time(), std::move(bodies), 25 * kMs});
  };
  if (random_.chance(0.2)) away({{KZ_TYPE_store_calibration}});
  if (random_.chance(0.1)) away({{KZ_TYPE_store_calibration}});
  if (random_.chance(0.15)) {
    auto unlock = key(KZ_TYPE_unlock);
    unlock.push_back(60);
    const auto address =
        static_cast<std::uint8_t>(random_.chance(0.5) ? KZ_ADDRESS_DEFAULT : 1 + random_.below(14));
    const std::uint8_t shared = random_.chance(0.3) ? 1 : 0;
    std::vector<std::vector<std::uint8_t>> bodies{unlock, {KZ_TYPE_set_address, address, shared}};
    if (random_.chance(0.7)) bodies.push_back(key(KZ_TYPE_reset));
    away(bodies);
  }
  if (random_.chance(0.2)) away({key(KZ_TYPE_reset)});
  if (random_.chance(0.03)) away({key(KZ_TYPE_loader)});
  std::sort(planned_.begin(), planned_.end(),
            [](const Planned& a, const Planned& b) { return a.not_before < b.not_before; });
  if (random_.chance(0.08)) events_.emplace_back(random_.below(900) * kMs, Event::reset_pin);
  if (random_.chance(0.08)) events_.emplace_back(random_.below(900) * kMs, Event::power_cycle);
}

WireHost::Event WireHost::take_event(States at) {
  for (auto event = events_.begin(); event != events_.end(); ++event) {
    if (begun_at_ + event->first > at || !begun_) continue;
    const Event kind = event->second;
    events_.erase(event);
    pending_.clear();
    return kind;
  }
  return Event::none;
}

void WireHost::begin(States at) {
  begun_ = true;
  begun_at_ = line_free_ = at;
  next_at_ = at + random_.below(50) * kMs;  // some while the board is starting
  manner_until_ = at + 120 * kMs;
  // All on, so that the loops run; telemetry in some.
  if (random_.chance(0.7)) {
    planned_.push_front({50 * kMs, {{KZ_TYPE_enable, 0, 3, 255, 255}}, 3 * kMs});
  }
  if (random_.chance(0.3)) {
    const auto period = static_cast<std::uint8_t>(5 + random_.below(60));
    const auto selection = static_cast<std::uint8_t>(1 + random_.below(15));
    planned_.push_front({50 * kMs, {{KZ_TYPE_telemetry, 0, period, selection}}, 3 * kMs});
  }
}

void WireHost::next_manner() {
  static constexpr Manner manners[] = {Manner::polite, Manner::polite,  Manner::polite,
                                       Manner::burst,  Manner::burst,   Manner::damaged,
                                       Manner::pieces, Manner::damaged, Manner::silent};
  manner_ = manners[random_.below(std::size(manners))];
  const States length =
      manner_ == Manner::silent ? 70 + random_.below(60) : 30 + random_.below(170);
  manner_until_ = next_at_ + length * kMs;
  if (manner_ == Manner::silent) {
    next_at_ = manner_until_;
    ++kinds_["silences"];
  }
}

std::vector<std::uint8_t> WireHost::harmless() {
  for (;;) {
    auto request = requests_of_.next();
    if (!kz_interrupts_service(request.front())) return request;
  }
}

std::vector<std::uint8_t> WireHost::frame(const std::vector<std::uint8_t>& request) {
  if (!last_.empty() && random_.chance(0.04)) {  // its reply was lost
    ++kinds_["repeated"];
    return last_;
  }
  std::uint8_t address = has_moved_ && random_.chance(0.5) ? other_address_ : address_;
  if (random_.chance(0.04)) {
    address = KZ_ADDRESS_ALL;
    ++kinds_["to all boards"];
  } else if (random_.chance(0.04)) {
    address = static_cast<std::uint8_t>(random_.below(256));
    ++kinds_["to other addresses"];
  }
  std::vector<std::uint8_t> body{address, request.front(), ++sequence_};
  body.insert(body.end(), request.begin() + 1, request.end());
  if (body.size() > KZ_BODY_MAX) body.resize(KZ_BODY_MAX);
  std::vector<std::uint8_t> wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  last_ = wire;
  return wire;
}

void WireHost::damage(std::vector<std::uint8_t>& frame) {
  if (!damage_frame(random_, frame, 1, kMaxNoise)) frame.insert(frame.end(), random_.below(5), 0);
}

void WireHost::send(const std::vector<std::uint8_t>& frame, const char* kind,
                    const std::string& text) {
  States gap = std::max(next_at_ - line_free_, min_gap_);
  min_gap_ = 0;
  for (const std::uint8_t value : frame) {
    pending_.push_back({value, false, gap});
    gap = 0;
  }
  ++kinds_[kind];
  sent_.push_back({next_at_ + static_cast<States>(frame.size()) * KZ_STATES_PER_BYTE, text});
}

// Queues the next bytes on the idle line from `at` on.
void WireHost::refill(States at) {
  if (next_at_ < at) next_at_ = at;
  if (!planned_.empty() && next_at_ - begun_at_ >= planned_.front().not_before) {
    Planned& now = planned_.front();
    const auto request = now.bodies.front();
    now.bodies.erase(now.bodies.begin());
    const std::uint8_t type = request.front();
    if (kz_interrupts_service(type)) ++kinds_[name_of(type)];
    if (type == KZ_TYPE_set_address) {
      other_address_ = request[1];
      has_moved_ = true;
    }
    last_.clear();
    // The pause begins when the frame has ended, and what comes after the last one may come at once.
    const bool was_last = now.bodies.empty();
    const States pause = now.pause;
    if (was_last) planned_.pop_front();
    ++requests_;
    send(frame(request), "planned", name_of(type));
    min_gap_ = pause;  // also where the line was closed and the frame ends later than planned
    if (kz_interrupts_service(type)) last_.clear();  // repeated, it would not stand alone
    next_at_ += static_cast<States>(pending_.size()) * KZ_STATES_PER_BYTE + pause +
                random_.below(KZ_STATES_PER_TICK);
    return;
  }
  if (next_at_ >= manner_until_) next_manner();
  if (manner_ == Manner::silent) return;
  const auto request = harmless();
  const std::string text = name_of(request.front());
  auto bytes = frame(request);
  ++requests_;
  States pause = (2 + random_.below(20)) * kMs;
  switch (manner_) {
    case Manner::burst:
      send(bytes, "back to back", text);
      pause = random_.chance(0.75) ? 0 : (3 + random_.below(20)) * kMs;
      break;
    case Manner::damaged: {
      damage(bytes);
      send(bytes, "damaged", "damaged " + text);
      if (random_.chance(0.2)) {
        pending_[random_.below(static_cast<std::uint32_t>(pending_.size()))].framing_error = true;
        ++kinds_["framing errors"];
      }
      pause = random_.below(12) * kMs;
      break;
    }
    case Manner::pieces: {
      send(bytes, "in pieces", text + " in pieces");
      // Up to beyond the 20 ms for which a frame may pause.
      for (auto cuts = 1 + random_.below(3); cuts > 0; --cuts)
        pending_[random_.below(static_cast<std::uint32_t>(pending_.size()))].gap +=
            random_.below(25 * 18) * kMs / 18;
      break;
    }
    default:
      send(bytes, "polite", text);
      break;
  }
  for (const Pending& byte : pending_) next_at_ += byte.gap + KZ_STATES_PER_BYTE;
  // The first gap is the time up to where it began.
  next_at_ -= pending_.front().gap;
  next_at_ += pause + (pause != 0 ? random_.below(KZ_STATES_PER_TICK) : 0);
}

std::vector<SerialByte> WireHost::bytes(States from, States until, const WireWindows& windows) {
  if (!begun_) begin(from);
  std::vector<SerialByte> out;
  for (;;) {
    if (pending_.empty()) {
      if (finished_ || next_at_ >= until) return out;
      refill(std::max(line_free_, from));
      if (pending_.empty()) continue;
    }
    const Pending& next = pending_.front();
    States end = std::max(line_free_ + next.gap + KZ_STATES_PER_BYTE, from);
    if (end > windows.closed_from && end < windows.closed_until) end = windows.closed_until;
    if (windows.ticks) {
      States since = (end - windows.tick_at) % KZ_STATES_PER_TICK;
      if (since < 0) since += KZ_STATES_PER_TICK;
      if (since > kRingReadFrom && since < kRingReadUntil) end += kRingReadUntil - since;
    }
    if (end >= until) {
      return out;
    }
    out.push_back({next.value, end, next.framing_error});
    line_free_ = end;
    pending_.pop_front();
  }
}

}  // namespace kaz::sim
