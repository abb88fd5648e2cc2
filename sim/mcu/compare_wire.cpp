// Runs conversations with both boards and compares them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/compare_wire.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <optional>
#include <utility>

#include "shared/base/counted.hpp"
#include "shared/base/hex_text.hpp"
#include "shared/protocol/frame.h"
#include "shared/protocol/message_info.h"
#include "sim/mcu/compare.h"
#include "sim/mcu/traffic.h"
#include "sim/mcu/txd_watch.h"
#include "sim/mcu/wire_differences.h"
#include "sim/mcu/wire_host.h"

namespace kaz::sim {
namespace {

constexpr States kTick = KZ_STATES_PER_TICK;
constexpr std::size_t kDifferencesKept = 5, kRequestsShown = 6;
constexpr int kFewestRequests = 20;
constexpr States kLength = 1000 * kTick;
constexpr States kDrain = 60 * kTick;  // replies to the last requests
// Time after a tick became due at which voltages change and pins are compared: neither converter samples
// then, and both boards have written their pins.
constexpr States kQuietAfter = 15000;
// Time at which an idle tick selects a supply's multiplexer input, which is visible at the pins.
constexpr States kSelectAfter = 735;
// A starting board enables its receiver this long before its first tick; from then on each byte extends
// the start, until the clock runs.
constexpr States kListensBefore = 46940 + 700, kClockRunsBefore = 18000;
// How far the native board's default start may be from that of the image. The chip spends about 23 states
// on the CRC of each byte of its application, and a message adds some 500 bytes: with a tick as tolerance the
// second new message would fail here. Conversations do not depend on it: they run with the measured start.
constexpr States kStartTolerance = 5 * kTick;
// Tolerance of an edge relative to its place in the frame: 2 % of a bit.
constexpr States kEdgeTolerance = KZ_STATES_PER_BIT / 50;

struct WireByte {
  std::uint8_t value = 0;
  States start = 0;
};

// The bytes between two zeros.
struct WireFrame {
  std::vector<std::uint8_t> bytes;
  States start = 0, end = 0;
  bool cut = false;  // by reset or power, perhaps a byte earlier on the one board than on the other
};

std::vector<WireFrame> frames_of(const std::vector<WireByte>& bytes,
                                 const std::vector<States>& cuts) {
  std::vector<WireFrame> frames;
  bool open = false;
  auto cut = cuts.begin();
  for (const WireByte& byte : bytes) {
    if (cut != cuts.end() && byte.start >= *cut) {
      open = false;
      ++cut;
    }
    if (byte.value == 0) {
      open = false;
      continue;
    }
    if (!open) frames.push_back({{}, byte.start, 0});
    open = true;
    frames.back().bytes.push_back(byte.value);
    frames.back().end = byte.start + KZ_STATES_PER_BYTE;
  }
  for (WireFrame& frame : frames) {
    frame.cut = std::any_of(cuts.begin(), cuts.end(), [&frame](States at) {
      return frame.start < at && at < frame.end + 2 * KZ_STATES_PER_BYTE;
    });
  }
  // A first byte that only one board got out.
  std::erase_if(frames, [](const WireFrame& f) { return f.cut && f.bytes.size() < 3; });
  return frames;
}

// The body of a frame without checksum and stuffing, as far as present in one that was cut. Empty if
// there is none.
std::vector<std::uint8_t> body_of(const WireFrame& frame) {
  constexpr std::size_t check = 3;
  std::vector<std::uint8_t> body;
  const auto& bytes = frame.bytes;
  if (!frame.cut && bytes.size() <= check) return body;
  const std::size_t end = frame.cut ? bytes.size() : bytes.size() - check;
  for (std::size_t at = 0; at < end;) {
    const std::size_t next = at + bytes[at];
    if (next > end && !frame.cut) return {};
    if (at != 0) body.push_back(0);
    body.insert(body.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                bytes.begin() + static_cast<std::ptrdiff_t>(std::min(next, end)));
    at = next;
  }
  return body;
}

std::string text_of(const WireFrame& frame) {
  const auto body = body_of(frame);
  std::string text;
  if (body.size() >= KZ_HEADER_SIZE) {
    const kz_message_info* info = kz_message_find(body[1]);
    text = std::string(info ? info->name : "?") + " number " + std::to_string(body[2]) + ":";
  } else {
    text = "no frame:";
  }
  return text + " " + hex_text(body.size() >= KZ_HEADER_SIZE ? body : frame.bytes, " ");
}

class Boards {
 public:
  Boards(const WireOptions& options, H8Mcu& h8, WireReport& report)
      : options_(options), h8_(h8), txd_(h8), report_(report) {
    blank_.fill(0xFF);
    h8_.on_pins([this](States at, const PinLevels& pins) { h8_pins(at, pins); });
    h8_.on_watchdog_reset([this](States at) { h8_reset_ = at; });
    h8_.set_analog(
        [this](int channel, const PinLevels& levels, States) { return voltage(channel, levels); });
  }

  // From power-on to the first tick.
  Result<States> start_time() {
    voltages_.emplace(1);
    const States from = h8_.now();
    h8_.power_cycle();
    selected_at_ = 0;
    grid_.reset();
    while (!grid_ && h8_.now() - from < 2000 * kTick) {
      KAZ_TRY(h8_.run_until(h8_.now() + kTick));
    }
    if (!grid_)
      return fail(
          Fault::failed,
          options_.image_path + " executes no tick: check that the image is the servo firmware");
    return *grid_ - from;
  }

  // The native board's default must be that of the built image.
  Result<void> run(std::int64_t number, const NativeOptions& native_options) {
    number_ = number;
    differed_ = false;
    begin(native_options);
    while (h8_.now() < ends_at_) {
      if (auto stepped = step(); !stepped) return stepped;
    }
    compare_frames();
    finish();
    return {};
  }

 private:
  void begin(const NativeOptions& native_options) {
    start_states_ = native_options.start_states;
    const std::uint64_t seed = mix64(options_.seed ^ mix64(static_cast<std::uint64_t>(number_)));
    host_.emplace(seed);
    voltages_.emplace(mix64(seed));
    native_ = options_.make_other(native_options);
    native_->set_analog(
        [this](int channel, const PinLevels& levels, States) { return voltage(channel, levels); });
    native_->on_watchdog_reset([this](States at) { native_reset_ = at; });
    native_->set_memory(blank_);
    native_->power_cycle();
    h8_.set_memory(blank_);
    h8_.power_cycle();
    begun_at_ = h8_.now();
    ends_at_ = begun_at_ + kLength + kDrain;
    lag_ = native_->now() - begun_at_;
    from_h8_.clear();
    from_native_.clear();
    h8_reset_.reset();
    native_reset_.reset();
    cuts_.clear();
    slice_ = 0;
    started(begun_at_);
  }

  // Both boards have just been reset, at `at`.
  void started(States at) {
    txd_.restart();
    (void)h8_.take_transmitted();
    decoded_.clear();
    reported_.clear();
    selected_at_ = 0;
    grid_.reset();
    closed_from_ = at + start_states_ - kListensBefore;
    closed_until_ = at + start_states_ - kClockRunsBefore;
    if (nothing_stored()) {
      grid_ = at + start_states_;
    } else {
      // The duration of the start depends on what is stored: nothing is sent until ticks are detected.
      closed_until_ = at + kLength;
    }
  }

  bool nothing_stored() const {
    const auto memory = h8_.memory();
    return std::all_of(memory.begin(), memory.end(), [](std::uint8_t b) { return b == 0xFF; });
  }

  double voltage(int channel, const PinLevels& levels) const {
    constexpr unsigned inertial[] = {KZ_ANALOG_YAW_RATE, KZ_ANALOG_FORWARD_FORCE,
                                     KZ_ANALOG_LEFT_FORCE};
    if (channel >= KZ_MUXES + 3) return 0.0;
    const unsigned input = channel < KZ_MUXES ? static_cast<unsigned>(channel) * KZ_MUX_INPUTS +
                                                    (levels.p4 & KZ_P4_MUX_MASK)
                                              : inertial[channel - KZ_MUXES];
    return voltages_->ratio(input, slice_ * kTick);
  }

  // Ticks are detected by the multiplexer inputs of the supplies, which each tick selects first.
  void h8_pins(States at, const PinLevels& pins) {
    const int select = pins.p4 & KZ_P4_MUX_MASK;
    if (select == select_) return;
    select_ = select;
    if (select < KZ_MUX_INPUTS - 2) return;
    constexpr States jitter = 64;
    if (!grid_ && selected_at_ != 0 && std::abs(at - selected_at_ - kTick) < jitter) {
      grid_ = selected_at_ - kSelectAfter;
      closed_until_ = at;
    }
    selected_at_ = at;
  }

  States next_quiet(States after) const {
    const States origin = grid_.value_or(begun_at_) + kQuietAfter;
    States since = (after - origin) % kTick;
    if (since < 0) since += kTick;
    return after - since + kTick;
  }

  Result<void> step() {
    const States from = h8_.now();
    switch (host_->take_event(from)) {
      case WireHost::Event::reset_pin:
        collect();
        h8_.reset();
        native_->reset();
        board_event();
        break;
      case WireHost::Event::power_cycle:
        collect();
        h8_.power_cycle();
        native_->power_cycle();
        board_event();
        break;
      case WireHost::Event::none:
        break;
    }
    const States to = next_quiet(from);
    const auto grid = grid_;
    if (from - begun_at_ >= kLength) {
      if (host_->requests() < kFewestRequests)
        ends_at_ = from + kDrain;
      else
        host_->finish();
    }
    const WireWindows windows{grid_.has_value(), grid_.value_or(0), closed_from_, closed_until_};
    for (const SerialByte& byte : host_->bytes(from, to, windows)) {
      SerialByte other = byte;
      other.at += lag_;
      h8_.receive(byte);
      native_->receive(other);
    }
    if (auto ran = h8_.run_until(to); !ran) return ran;
    if (auto ran = native_->run_until(to + lag_); !ran) return ran;
    collect();
    follow_resets();
    if (differed_) return {};
    if (!h8_reset_ && !native_reset_) compare_pins(to);
    // Where ticks have just been detected `to` may be inside a scan.
    if (grid_ && grid_ == grid && to > *grid_) {
      voltages_->millisecond();
      ++slice_;
    }
    return {};
  }

  void board_event() {
    ++report_.resets;
    cuts_.push_back(h8_.now());
    lag_ = native_->now() - h8_.now();
    h8_reset_.reset();
    native_reset_.reset();
    started(h8_.now());
  }

  // Both boards restart by themselves within a tick of each other; from then on times count from there.
  void follow_resets() {
    if (!h8_reset_ && !native_reset_) return;
    if (h8_reset_ && native_reset_) {
      const States lag = *native_reset_ - lag_ - *h8_reset_;
      if (std::abs(lag) > kTick)
        differ(*h8_reset_, "the boards restart " + std::to_string(lag) + " states apart", "", "");
      report_.largest_reset_lag = std::max(report_.largest_reset_lag, std::abs(lag));
      lag_ += lag;
      ++report_.resets;
      const States at = *h8_reset_;
      h8_reset_.reset();
      native_reset_.reset();
      started(at);
      return;
    }
    const States at = h8_reset_ ? *h8_reset_ : *native_reset_ - lag_;
    if (h8_.now() - at > 2 * kTick)
      differ(at, std::string("only ") + (h8_reset_ ? "h8" : "native") + " restarts", "", "");
  }

  void collect() {
    for (const DecodedByte& byte : txd_.take()) {
      decoded_.push_back(byte);
      from_h8_.push_back({byte.value, byte.start});
    }
    for (const SerialByte& byte : h8_.take_transmitted()) reported_.push_back(byte);
    for (; !decoded_.empty() && !reported_.empty(); decoded_.pop_front(), reported_.pop_front())
      check_waveform(decoded_.front(), reported_.front());
    // A stop bit is sampled before it ends; the decoder reports it one bit later.
    const States settled = h8_.now() - 2 * KZ_STATES_PER_BIT;
    if (!decoded_.empty() && decoded_.front().start + KZ_STATES_PER_BYTE < settled)
      differ(decoded_.front().start, "TxD0 shows a byte that the channel has not sent", "", "");
    if (!reported_.empty() && reported_.front().at < settled)
      differ(reported_.front().at, "TxD0 does not show a byte that the channel has sent", "", "");
    for (const SerialByte& byte : native_->take_transmitted())
      from_native_.push_back({byte.value, byte.at - KZ_STATES_PER_BYTE - lag_});
  }

  void check_waveform(const DecodedByte& decoded, const SerialByte& reported) {
    if (decoded.framing_error || decoded.edge_deviation > kEdgeTolerance)
      return differ(decoded.start,
                    "TxD0 violates 115,200 baud, 8N1: an edge is " +
                        std::to_string(decoded.edge_deviation) + " states off" +
                        (decoded.framing_error ? ", the stop bit is low" : ""),
                    "", "");
    if (decoded.value != reported.value || decoded.start + KZ_STATES_PER_BYTE != reported.at)
      differ(decoded.start, "a byte at TxD0 differs from the channel's byte in value or time",
             std::to_string(decoded.value), std::to_string(reported.value));
  }

  void compare_pins(States at) {
    PinLevels ours = native_->pins(), theirs = h8_.pins();
    ours.p4 &= static_cast<std::uint8_t>(~KZ_P4_MUX_MASK);
    theirs.p4 &= static_cast<std::uint8_t>(~KZ_P4_MUX_MASK);
    ++report_.pins_compared;
    if (ours == theirs) return;
    const auto text = [](const PinLevels& pins) {
      std::string line;
      for (const auto value : pins.pw) line += std::to_string(value) + " ";
      for (const auto value : pins.tmo) line += std::to_string(value) + " ";
      for (const int value : {pins.p3, pins.p4, pins.p5, pins.p6})
        line += std::to_string(value) + " ";
      return line;
    };
    differ(at, "the pins (pw, tmo, p3 to p6) differ", text(theirs), text(ours));
  }

  void compare_frames() {
    if (differed_) return;
    const auto theirs = frames_of(from_h8_, cuts_), ours = frames_of(from_native_, cuts_);
    // A reply that begins at the very end may be on one board only.
    const States last = h8_.now() - 2 * kTick - KZ_FRAME_MAX * KZ_STATES_PER_BYTE;
    for (std::size_t i = 0; i < std::max(theirs.size(), ours.size()); ++i) {
      const bool h8_has = i < theirs.size(), native_has = i < ours.size();
      const States at = h8_has ? theirs[i].start : ours[i].start;
      if (at > last) return;
      if (!h8_has || !native_has)
        return differ(at, std::string("only ") + (h8_has ? "h8" : "native") + " sends a frame",
                      h8_has ? text_of(theirs[i]) : "", native_has ? text_of(ours[i]) : "");
      if (!equal(theirs[i], ours[i])) {
        if (waited_for_room(theirs, i) && one_tick_apart(theirs[i], ours[i])) {
          ++report_.ended_early;
          return;
        }
        return differ(at, "the replies differ", text_of(theirs[i]), text_of(ours[i]));
      }
      const States lag = std::abs(theirs[i].start - ours[i].start);
      report_.largest_lag = std::max(report_.largest_lag, lag);
      if (lag > kTick)
        return differ(at, "a reply begins " + std::to_string(lag) + " states apart",
                      text_of(theirs[i]), text_of(ours[i]));
      ++report_.replies;
      report_.bytes += static_cast<std::int64_t>(theirs[i].bytes.size());
      if (const auto body = body_of(theirs[i]); body.size() > 1) ++report_.by_type[body[1]];
    }
  }

  bool equal(const WireFrame& theirs, const WireFrame& ours) {
    if (theirs.bytes == ours.bytes) return true;
    auto a = body_of(theirs), b = body_of(ours);
    if (theirs.cut && ours.cut) {
      std::size_t common = std::min(a.size(), b.size());
      if (std::max(a.size(), b.size()) - common > 1) return false;
      // A frame that ends just before the cut is whole: its check is among the bytes, and depends on the
      // masked fields. Messages with masked fields have one size.
      const kz_message_info* info = a.size() > 1 && a[1] == b[1] ? kz_message_find(a[1]) : nullptr;
      if (info) common = std::min(common, std::size_t{KZ_HEADER_SIZE} + info->size_max);
      a.resize(common);
      b.resize(common);
      if (a == b) return true;
    }
    if (a.empty() || !mask_wire_differences(a) || !mask_wire_differences(b)) return false;
    if (a != b) return false;
    ++report_.masked;
    return true;
  }

  // Whether the frame follows on a line without a pause for at least a tick: its request may have waited for
  // room in the transmit ring, and how much there is depends on when in its tick the CPU looks.
  bool waited_for_room(const std::vector<WireFrame>& frames, std::size_t i) const {
    constexpr States no_pause = KZ_STATES_PER_BYTE + 2 * KZ_STATES_PER_BIT;
    const States start = frames[i].start;
    const auto first = std::find_if(from_h8_.begin(), from_h8_.end(),
                                    [start](const WireByte& byte) { return byte.start >= start; });
    States since = start;
    for (auto byte = first; byte != from_h8_.begin(); since = byte->start) {
      --byte;
      if (since - byte->start > no_pause) break;
    }
    return start - since >= kTick;
  }

  // Whether only the replies' ticks differ, by one.
  static bool one_tick_apart(const WireFrame& theirs, const WireFrame& ours) {
    auto a = body_of(theirs), b = body_of(ours);
    constexpr std::size_t behind = KZ_HEADER_SIZE + 4;
    if (a.size() < behind || a.size() != b.size()) return false;
    mask_wire_differences(a);
    mask_wire_differences(b);
    std::uint32_t ticks_a = 0, ticks_b = 0;
    for (std::size_t k = KZ_HEADER_SIZE; k < behind; ++k) {
      ticks_a = ticks_a << 8 | a[k];
      ticks_b = ticks_b << 8 | b[k];
    }
    return (ticks_a - ticks_b + 1u) <= 2u &&
           std::equal(a.begin(), a.begin() + KZ_HEADER_SIZE, b.begin()) &&
           std::equal(a.begin() + behind, a.end(), b.begin() + behind);
  }

  void differ(States at, std::string what, std::string h8, std::string native) {
    if (differed_) return;
    differed_ = true;
    ++report_.different;
    ends_at_ = h8_.now();  // later differences are consequences
    if (report_.differences.size() >= kDifferencesKept) return;
    WireDifference difference;
    difference.conversation = number_;
    difference.ms = static_cast<double>(at - begun_at_) / static_cast<double>(kTick);
    difference.what = std::move(what);
    difference.h8 = std::move(h8);
    difference.native = std::move(native);
    std::vector<std::string> lines;
    for (const auto& sent : host_->sent()) {
      if (sent.at > at) break;
      char line[96];
      std::snprintf(line, sizeof line, "%s at %.2f ms", sent.text.c_str(),
                    static_cast<double>(sent.at - begun_at_) / static_cast<double>(kTick));
      lines.emplace_back(line);
    }
    const std::size_t from = lines.size() - std::min(lines.size(), kRequestsShown);
    for (std::size_t i = from; i < lines.size(); ++i) {
      if (i != from) difference.requests += ", ";
      difference.requests += lines[i];
    }
    report_.differences.push_back(std::move(difference));
  }

  void finish() {
    ++report_.conversations;
    report_.requests += host_->requests();
    if (report_.conversations == 1 || host_->requests() < report_.fewest_requests)
      report_.fewest_requests = host_->requests();
    for (const auto& [kind, count] : host_->kinds()) report_.kinds[kind] += count;
    report_.chip_s += static_cast<double>(h8_.now() - begun_at_) / KZ_CLOCK_HZ;
  }

  const WireOptions& options_;
  H8Mcu& h8_;
  TxdWatch txd_;
  WireReport& report_;
  std::array<std::uint8_t, Mcu::kMemorySize> blank_{};
  std::unique_ptr<Mcu> native_;
  std::optional<WireHost> host_;
  std::optional<RandomAnalog> voltages_;
  std::int64_t slice_ = 0;  // of the voltages
  std::int64_t number_ = 0;
  States start_states_ = 0;
  States begun_at_ = 0, ends_at_ = 0;  // times are those of h8
  States lag_ = 0;                     // native's time minus h8's
  std::optional<States> grid_;         // when a tick of h8 is due
  int select_ = -1;
  States selected_at_ = 0;
  States closed_from_ = 0, closed_until_ = 0;
  std::optional<States> h8_reset_, native_reset_;
  std::vector<WireByte> from_h8_, from_native_;
  std::deque<DecodedByte> decoded_;  // not yet compared
  std::deque<SerialByte> reported_;
  std::vector<States> cuts_;  // by reset pin or power
  bool differed_ = false;
};

std::string name_of(std::uint8_t type) {
  const kz_message_info* info = kz_message_find(type);
  return info ? info->name : std::to_string(type);
}

}  // namespace

std::string WireReport::text() const {
  char line[240];
  std::string text;
  if (equal()) {
    std::snprintf(
        line, sizeof line,
        "no difference in %s: the host sent %lld requests, at least %lld in each conversation; "
        "each board sent %lld frames (%lld bytes)",
        counted(conversations, "conversation").c_str(), static_cast<long long>(requests),
        static_cast<long long>(kFewestRequests), static_cast<long long>(replies),
        static_cast<long long>(bytes));
  } else {
    std::snprintf(line, sizeof line, "%lld of %s differ (seed %llu)",
                  static_cast<long long>(different), counted(conversations, "conversation").c_str(),
                  static_cast<unsigned long long>(seed));
  }
  text = line;
  text += "; emulator's engine: ";
  text += emulator_engine;
  if (ended_early > 0) {
    text += "\n  ";
    text += std::to_string(ended_early);
    text +=
        " ended early: a request waited for room in the transmit ring one tick longer on one of "
        "the boards";
    if (ended_early > max_ended_early())
      text += ", more than the " + std::to_string(max_ended_early()) + " allowed";
  }
  for (const WireDifference& difference : differences) {
    std::snprintf(line, sizeof line,
                  "\n  conversation %lld (--first %lld --conversations 1), %.2f ms: ",
                  static_cast<long long>(difference.conversation),
                  static_cast<long long>(difference.conversation), difference.ms);
    text += line + difference.what;
    if (!difference.h8.empty() || !difference.native.empty())
      text += "\n    h8      " + difference.h8 + "\n    native  " + difference.native;
    text += "\n    sent before: " + difference.requests;
  }
  std::snprintf(line, sizeof line,
                "\n"
                "  replies begin at most %lld states apart (a tick has %ld states); %s, at most "
                "%lld states apart; pins equal in %lld ms",
                static_cast<long long>(largest_lag), KZ_STATES_PER_TICK,
                counted(resets, "reset").c_str(), static_cast<long long>(largest_reset_lag),
                static_cast<long long>(pins_compared));
  text += line;
  std::snprintf(line, sizeof line,
                "\n  from power-on to the first tick: h8 %lld states, native %lld; %s equal except "
                "for fields that differ by design",
                static_cast<long long>(h8_start),
                static_cast<long long>(NativeOptions::kDefaultStartStates),
                counted(masked, "frame").c_str());
  text += line;
  text += "\n  sent:";
  for (const auto& [kind, count] : kinds) {
    text += ' ';
    text += kind + " " + std::to_string(count) + ",";
  }
  text.back() = '\n';
  text += "  frames received:";
  for (const auto& [type, count] : by_type) {
    text += ' ';
    text += name_of(type) + " " + std::to_string(count) + ",";
  }
  text.pop_back();
  return text;
}

Result<WireReport> compare_wire(const WireOptions& options) {
  if (options.conversations < 1)
    return fail(Fault::usage, "the comparison needs at least one conversation");
  auto h8 = KAZ_TRY(H8Mcu::load(options.image_path));
  if (options.prepare_h8) options.prepare_h8(*h8);
  KAZ_TRY(check_same_sources(*h8, options.image_path));
  WireReport report;
  report.seed = options.seed;
  report.emulator_engine = h8->emulator_engine();
  Boards boards(options, *h8, report);
  const auto start = KAZ_TRY(boards.start_time());
  report.h8_start = start;
  if (std::abs(start - NativeOptions::kDefaultStartStates) > kStartTolerance) {
    ++report.different;
    report.differences.push_back(
        {0, 0,
         "h8 and the native board need different times to start. If the firmware has changed, set "
         "NativeOptions::kDefaultStartStates (sim/mcu/native_mcu.h) to the start-up time of h8",
         std::to_string(start), std::to_string(NativeOptions::kDefaultStartStates), ""});
    return report;
  }
  for (std::int64_t i = 0; i < options.conversations; ++i) {
    if (options.stop && options.stop()) {
      report.stopped = true;
      break;
    }
    if (auto ran = boards.run(options.first + i, {start}); !ran) return tl::unexpected(ran.error());
    if (options.progress) options.progress(i + 1, options.conversations);
  }
  return report;
}

}  // namespace kaz::sim
