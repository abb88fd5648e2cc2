// Computes each tick of the emulated firmware again with the native build, and compares.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/compare.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <deque>

#include "shared/base/hex_text.hpp"
#include "shared/flash/image.h"
#include "shared/protocol/message_info.h"
#include "shared/servo/fields.h"
#include "shared/servo/servo.h"
#include "shared/servo/tick.h"
#include "sim/mcu/frame_fields.h"
#include "sim/mcu/h8_layout.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/traffic.h"
#include "sim/mcu/txd_watch.h"

namespace kaz::sim {
namespace {

constexpr States kLineEdgeTolerance = KZ_STATES_PER_BIT / 50;  // 2 % of a bit
constexpr int kLongestStart_ms = 2000;                         // from reset to the first tick
constexpr int kMaxWithoutTick_ms = 1000 * KZ_LOADER_S + 1000;  // the loader waits

// "joint.angle" is an element of the array joint, "receiver.body" an array inside receiver.
std::string element(const std::string& prefix, const std::string& name, std::size_t index) {
  const std::string subscript = std::string("[").append(std::to_string(index)).append("]");
  if (name.starts_with("joint.")) return prefix + "joint" + subscript + name.substr(5);
  return prefix + name + subscript;
}

std::int64_t sign_extended(std::uint32_t value, const kz_state_field& field) {
  if (!field.is_signed) return value;
  const int shift = 32 - 8 * field.size;
  return static_cast<std::int32_t>(value << shift) >> shift;
}

std::uint32_t native_number(const std::uint8_t* at, std::size_t size) {
  if (size == 1) return *at;
  if (size == 2) {
    std::uint16_t value = 0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  std::uint32_t value = 0;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// What sent_body() takes of the chip's sender; the structure is at the same place as on the PC.
kz_sender h8_sender(std::span<const std::uint8_t> state) {
  kz_sender sender{};
  sender.length = state[offsetof(kz_servo, sender.length)];
  sender.first = state[offsetof(kz_servo, sender.first)];
  std::copy_n(&state[offsetof(kz_servo, sender.body)], std::size(sender.body), sender.body);
  return sender;
}

class Comparison {
 public:
  Comparison(const CompareOptions& options, H8Mcu& h8)
      : options_(options), h8_(h8), txd_(h8), host_(options.seed), analog_(mix64(options.seed)) {
    start_native();
    h8_.on_tick([this](const TickRecord& record) { tick(record); });
    h8_.on_watchdog_reset([this](States) {
      ++report_.resets;
      compare_line();
      // A requested reset waits until the line is idle.
      if (!in_flight_.empty()) differ_on_line("line.cut_off", in_flight_.front(), -1);
      in_flight_.clear();
      txd_.restart();
      start_native();
    });
    h8_.set_analog([this](int channel, const PinLevels& levels, States at) {
      if (channel >= KZ_MUXES) return 0.0;
      const auto input =
          static_cast<unsigned>(channel) * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
      return analog_.ratio(input, at);
    });
  }

  Result<CompareReport> run() {
    int without_tick_ms = -kLongestStart_ms;
    while (report_.ticks < options_.ticks && report_.equal()) {
      if (options_.stop && options_.stop()) {
        report_.stopped = true;
        break;
      }
      const States start = h8_.now();
      const auto before = report_.ticks;
      if (before > 0) {
        for (const SerialByte& byte : host_.millisecond(start)) h8_.receive(byte);
      }
      analog_.millisecond();
      KAZ_TRY(h8_.run_until(start + KZ_STATES_PER_TICK));
      report_.bytes_sent += static_cast<std::int64_t>(h8_.take_transmitted().size());
      compare_line();
      if (report_.ticks != before) {
        without_tick_ms = 0;
      } else if (++without_tick_ms > kMaxWithoutTick_ms) {
        return fail(Fault::failed, options_.image_path + " executes no tick (" +
                                       std::to_string(report_.ticks) +
                                       " so far): check that the image is the servo firmware\n" +
                                       h8_.chip().report());
      }
      if (options_.progress && report_.ticks / 1000 != before / 1000)
        options_.progress(report_.ticks, options_.ticks);
    }
    report_.frames_sent_to_board = host_.frames();
    report_.engine = h8s::name_of(h8_.chip().engine());
    report_.instructions = h8_.chip().instructions();
    report_.translated_instructions = h8_.chip().translated_instructions();
    report_.chip_s = static_cast<double>(h8_.now()) / KZ_CLOCK_HZ;
    return report_;
  }

 private:
  void start_native() { started_ = false; }

  void tick(const TickRecord& record) {
    if (!report_.equal() || report_.ticks >= options_.ticks) return;
    kz_tick_output output{};
    if (!started_) {
      const auto found = h8_.global("kz_startup_found", h8_layout::kStartupSize);
      const auto startup =
          h8_layout::decode_startup(std::span<const std::uint8_t, h8_layout::kStartupSize>(found));
      kz_servo_init(&native_, &startup, &output);
      started_ = true;
    }
    kz_tick(&native_, &record.input, &output);
    ++report_.ticks;
    last_tick_ = record.input.tick;
    report_.bytes_received += record.input.rx_count;
    report_.missed_ticks += record.input.missed;
    report_.worst_busy_8states =
        std::max<std::uint16_t>(report_.worst_busy_8states, record.input.worst_8states);

    compare_pins();
    compare_output(output, record.output);
    shown_ = output;
    if (output.tx_count != 0) line_since_ = h8_.now();
    in_flight_.insert(in_flight_.end(), output.tx, output.tx + output.tx_count);
    look_at(record.output);
    if (report_.ticks % options_.state_every == 0 || !report_.equal()) compare_state();
    if (!report_.equal()) {
      report_.tick = record.input.tick;
      report_.input_hex = hex_text(h8_.global("kz_input", h8_layout::kInputSize));
    }
  }

  void differ(std::string field, std::int64_t native, std::int64_t h8) {
    report_.differences.push_back({std::move(field), native, h8});
  }

  void check(const char* name, std::int64_t native, std::int64_t h8) {
    if (native != h8) differ(std::string("output.") + name, native, h8);
  }

  template <std::size_t N>
  void check_array(const char* name, const u8 (&native)[N], const u8 (&h8)[N], std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      if (native[i] != h8[i]) differ(element("output.", name, i), native[i], h8[i]);
  }

  void compare_output(const kz_tick_output& native, const kz_tick_output& h8) {
    check_array("pw", native.pw, h8.pw, std::size(native.pw));
    check_array("tmo", native.tmo, h8.tmo, std::size(native.tmo));
    check("p3", native.p3, h8.p3);
    check("p4", native.p4, h8.p4);
    check("p5", native.p5, h8.p5);
    check("p6", native.p6, h8.p6);
    check("action", native.action, h8.action);
    check("tx_count", native.tx_count, h8.tx_count);
    check_array("tx", native.tx, h8.tx,
                std::min<std::size_t>(std::min(native.tx_count, h8.tx_count), KZ_TX_PER_TICK));
  }

  // At the end of a tick the pins show the output of the previous tick.
  void compare_pins() {
    if (!shown_) return;
    const PinLevels& pins = h8_.pins();
    const auto check_pin = [this](const std::string& name, int native, int h8) {
      if (native != h8) differ("pins." + name, native, h8);
    };
    for (std::size_t i = 0; i < pins.pw.size(); ++i)
      check_pin(element("", "pw", i), shown_->pw[i], pins.pw[i]);
    for (std::size_t i = 0; i < pins.tmo.size(); ++i)
      check_pin(element("", "tmo", i), shown_->tmo[i], pins.tmo[i]);
    check_pin("p3", shown_->p3, pins.p3);
    check_pin("p4", shown_->p4, pins.p4 & ~KZ_P4_MUX_MASK);
    check_pin("p5", shown_->p5, pins.p5);
    check_pin("p6", shown_->p6, pins.p6);
    ++report_.pins_compared;
  }

  // Bytes at TxD0 must be those output by the native build, in this order.
  void compare_line() {
    for (const DecodedByte& byte : txd_.take()) {
      if (in_flight_.empty()) return differ_on_line("line.byte", -1, byte.value);
      const std::uint8_t wanted = in_flight_.front();
      in_flight_.pop_front();
      if (byte.value != wanted) return differ_on_line("line.byte", wanted, byte.value);
      if (byte.framing_error) return differ_on_line("line.stop_bit", 1, 0);
      if (byte.edge_deviation > kLineEdgeTolerance)
        return differ_on_line("line.edge_states", 0, byte.edge_deviation);
      line_since_ = byte.start + KZ_STATES_PER_BYTE;
      ++report_.line_bytes;
    }
    // Bytes are sent in the following tick; a write to flash comes after them.
    if (!in_flight_.empty() && h8_.now() - line_since_ > 3 * KZ_STATES_PER_TICK)
      differ_on_line("line.missing", in_flight_.front(), -1);
  }

  // -1: nothing.
  void differ_on_line(const char* field, std::int64_t native, std::int64_t h8) {
    if (!report_.equal()) return;
    differ(field, native, h8);
    report_.tick = last_tick_;
    report_.input_hex = hex_text(h8_.global("kz_input", h8_layout::kInputSize));
  }

  void look_at(const kz_tick_output& output) {
    CompareCoverage& coverage = report_.coverage;
    if (output.action != KZ_ACTION_NONE) ++coverage.actions[output.action];
    for (int i = 0; i < output.tx_count; ++i) {
      if (kz_receive(&heard_, output.tx[i], 0) != KZ_RECEIVE_FRAME) continue;
      const std::uint8_t type = heard_.body[1];
      const std::uint8_t* fields = heard_.body + KZ_HEADER_SIZE;
      ++coverage.replies[type];
      if (type == KZ_TYPE_refused) ++coverage.refusals[fields[7]];
      // The upper byte of the status, after the tick; in identify_reply two bytes later.
      const std::uint8_t reason = fields[type == KZ_TYPE_identify_reply ? 6 : 4];
      if (reason != KZ_SHUTDOWN_NONE) ++coverage.shutdowns[reason];
    }
  }

  void compare_state() {
    const auto h8 = h8_.global("kz_servo_state", kz_state_size_h8);
    if (h8.empty()) return;  // load() has checked the symbol
    const auto* native = reinterpret_cast<const std::uint8_t*>(&native_);
    for (std::size_t f = 0; f < kz_state_field_count; ++f) {
      const kz_state_field& field = kz_state_fields[f];
      for (std::size_t i = 0; i < field.count; ++i) {
        const std::size_t at = field.offset + i * field.stride;
        const std::uint32_t ours = native_number(native + at, field.size);
        const std::uint32_t theirs = h8_layout::number(h8, at, field.size);
        if (ours != theirs)
          differ(field.count > 1 ? element("state.", field.name, i)
                                 : std::string("state.") + field.name,
                 sign_extended(ours, field), sign_extended(theirs, field));
      }
    }
    name_frame_fields(h8);
  }

  // In place of bytes of the sender's body: the fields of the frame that they belong to, first of all.
  void name_frame_fields(std::span<const std::uint8_t> h8_state) {
    const auto is_byte = [](const CompareDifference& difference) {
      return difference.field.starts_with("state.sender.body[");
    };
    auto& all = report_.differences;
    if (std::ranges::none_of(all, is_byte)) return;
    const auto frame = frame_differences(sent_body(native_.sender), sent_body(h8_sender(h8_state)));
    if (frame.empty()) return;
    std::erase_if(all, is_byte);
    all.insert(all.begin(), frame.begin(), frame.end());
  }

  const CompareOptions& options_;
  H8Mcu& h8_;
  TxdWatch txd_;
  RandomHost host_;
  RandomAnalog analog_;
  kz_servo native_{};
  bool started_ = false;                 // initialised from the chip's startup data
  std::optional<kz_tick_output> shown_;  // output of the previous tick
  std::deque<std::uint8_t> in_flight_;   // output, not yet decoded at TxD0
  States line_since_ = 0;                // last time at which a byte was decoded or queued
  std::uint32_t last_tick_ = 0;
  kz_receiver heard_{};
  CompareReport report_;
};

// "identify_reply 12, state_reply 7"
template <class Name>
std::string listed(const std::map<std::uint8_t, std::int64_t>& counts, Name name) {
  std::string text;
  for (const auto& [code, count] : counts)
    text += (text.empty() ? "" : ", ") + std::string(name(code)) + " " + std::to_string(count);
  return text.empty() ? "none" : text;
}

std::string message_name(std::uint8_t type) {
  const kz_message_info* info = kz_message_find(type);
  return info ? info->name : "0x" + std::to_string(type);
}

}  // namespace

std::string CompareReport::text() const {
  char line[160];
  if (equal()) {
    std::snprintf(line, sizeof line,
                  "no difference in %lld ticks (%lld frames, %lld bytes in, %lld bytes out)",
                  static_cast<long long>(ticks), static_cast<long long>(frames_sent_to_board),
                  static_cast<long long>(bytes_received), static_cast<long long>(bytes_sent));
    const auto action_name = [](std::uint8_t action) {
      static constexpr const char* names[] = {"none", "store calibration", "store address", "reset",
                                              "loader"};
      return action < std::size(names) ? names[action] : "unknown";
    };
    char executed[120];
    std::snprintf(executed, sizeof executed,
                  "\n  emulator's engine: %s, %.1f %% of %lld instructions as translated code",
                  engine.c_str(),
                  100.0 * static_cast<double>(translated_instructions) /
                      static_cast<double>(std::max<std::int64_t>(instructions, 1)),
                  static_cast<long long>(instructions));
    return std::string(line) + executed +
           "\n  pins matched the native build's previous output in " +
           std::to_string(pins_compared) + " ticks; " + std::to_string(line_bytes) +
           " bytes decoded at TxD0; " + std::to_string(resets) + " resets" +
           "\n  replies: " + listed(coverage.replies, message_name) +
           "\n  refusals: " + listed(coverage.refusals, kz_refusal_text) +
           "\n  replies during a shutdown: " + listed(coverage.shutdowns, kz_shutdown_text) +
           "\n  actions: " + listed(coverage.actions, action_name);
  }
  std::snprintf(line, sizeof line, "first difference at tick %u:\n  %-32s %12s %12s",
                static_cast<unsigned>(*tick), "field", "native", "h8");
  std::string text = line;
  for (const CompareDifference& difference : differences) {
    std::snprintf(line, sizeof line, "\n  %-32s %12lld %12lld", difference.field.c_str(),
                  static_cast<long long>(difference.native), static_cast<long long>(difference.h8));
    text += line;
  }
  return text + "\n  input of this tick, in the H8's memory layout: " + input_hex;
}

Result<void> check_same_sources(const H8Mcu& h8, const std::string& image_path) {
  const h8s::Chip& chip = h8.chip();
  const auto build_id = chip.peek32(KZ_APPLICATION_HEADER + offsetof(kz_image_header, build_id));
  if (chip.peek32(KZ_APPLICATION_HEADER) != KZ_IMAGE_ID || build_id == kz_build_id) return {};
  char ids[60];
  std::snprintf(ids, sizeof ids, "(build %08x, this program %08x)",
                static_cast<unsigned>(build_id.value_or(0)), static_cast<unsigned>(kz_build_id));
  return fail(Fault::usage, image_path + ": the image was built from other sources " + ids +
                                ": build image and program from the same tree (./tools/dev prove)");
}

Result<CompareReport> compare_engines(const CompareOptions& options) {
  if (options.ticks < 1 || options.state_every < 1)
    return fail(Fault::usage, "the comparison needs at least one tick");
  h8s::Options chip;
  chip.engine = options.engine;
  auto h8 = KAZ_TRY(H8Mcu::load(options.image_path, chip));
  if (!h8->has_tick_symbols() || h8->global("kz_servo_state", 1).empty() ||
      h8->global("kz_startup_found", 1).empty())
    return fail(Fault::usage,
                options.image_path +
                    " has no symbols of the servo's tick; put the .coff file of the same "
                    "build into the image's folder");
  if (options.prepare_h8) options.prepare_h8(*h8);
  KAZ_TRY(check_same_sources(*h8, options.image_path));
  return Comparison(options, *h8).run();
}

}  // namespace kaz::sim
