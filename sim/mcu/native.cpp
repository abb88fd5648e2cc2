// The native engine: shared/servo compiled for this machine, behind the same pins.
// SPDX-License-Identifier: Apache-2.0
//
// Byte times and A/D readings are as the firmware gives them, but there is no CPU that takes time.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "shared/servo/servo.h"
#include "shared/servo/startup.h"
#include "sim/h8s/line_rate.h"
#include "sim/mcu/mcu.h"
#include "sim/mcu/native_memory.h"

namespace kaz::sim {
namespace {

// As firmware/ does it; the engines' timing need not agree to the state (design, section 3).
constexpr States start_states = 20 * KZ_STATES_PER_TICK;  // from reset to the first tick
constexpr std::size_t receive_ring = 63;                  // bytes that its receive buffer holds
constexpr std::size_t transmit_ring = 63;                 // bytes that its transmit buffer holds
constexpr States scan_start = 4400;                       // from a tick's start to the first sample
constexpr States scan_interval = 894;   // from one multiplexer setting to the next
constexpr States convert_states = 256;  // from one of AN0..AN2 to the next
constexpr States never = std::numeric_limits<States>::max() / 2;

class NativeMcu final : public Mcu {
 public:
  NativeMcu() { power_cycle(); }

  std::string engine() const override { return "native"; }
  States now() const override { return now_; }

  Result<void> run_until(States until) override {
    while (true) {
      const States sample_at = sample_time();
      if (std::min({tick_at_, sample_at, act_at_}) > until) break;
      if (act_at_ <= std::min(sample_at, tick_at_)) {
        now_ = std::max(now_, act_at_);
        act();
      } else if (sample_at < tick_at_) {
        now_ = std::max(now_, sample_at);
        sample();
      } else {
        now_ = std::max(now_, tick_at_);
        tick();
      }
    }
    now_ = std::max(now_, until);
    return {};
  }

  void reset() override { start(KZ_RESET_POWER, start_states); }

  // The native engine has no RAM that could outlive its servo's state.
  void power_cycle() override { reset(); }

  std::array<std::uint8_t, memory_size> memory() const override {
    std::array<std::uint8_t, memory_size> bytes{};
    std::copy(memory_.bytes().begin(), memory_.bytes().end(), bytes.begin());
    return bytes;
  }
  void set_memory(std::span<const std::uint8_t, memory_size> bytes) override {
    memory_.set_bytes(bytes);
  }

  const kz_servo* servo() const override { return &servo_; }
  const PinLevels& pins() const override { return pins_; }
  void on_pins(std::function<void(States, const PinLevels&)> listener) override {
    on_pins_ = std::move(listener);
  }
  void set_analog(AnalogSource source) override { analog_ = std::move(source); }
  void receive(const SerialByte& byte) override {
    const auto heard = h8s::heard_at(byte.value, byte.bit_states, KZ_STATES_PER_BIT);
    if (heard.heard)
      received_.push_back({heard.value, byte.at, byte.framing_error || heard.framing_error});
  }
  void on_tick(std::function<void(const TickRecord&)> listener) override {
    on_tick_ = std::move(listener);
  }

  void save(StateWriter& to) override { transfer(to); }
  void restore(StateReader& from) override { transfer(from); }

  std::vector<SerialByte> take_transmitted() override {
    std::vector<SerialByte> left;
    while (!wire_.empty() && wire_.front().at <= now_) {
      left.push_back(wire_.front());
      wire_.pop_front();
    }
    return left;
  }

 private:
  template <class A>
  void transfer(A& a) {
    a(memory_, started_, now_, tick_at_, act_at_, action_, released_, asked_at_, deaf_from_,
      deaf_until_, overrun_at_, setting_, pins_, received_, ring_, lost_, wire_, wire_free_);
    a.plain(startup_);
    a.plain(servo_);
    a.plain(input_);
    a.plain(output_);
  }

  // Reset or power-on; the first tick comes after `states`.
  void start(u8 cause, States states) {
    memory_.cut(now_);
    kz_startup_nominal(&startup_);
    startup_.reset_cause = cause;
    startup_.start_8states = static_cast<u16>(start_states / 8);
    startup_.tests_done = KZ_TEST_RAM | KZ_TEST_FLASH;
    memory_.load(startup_);
    started_ = false;
    servo_ = {};
    output_ = {};
    input_ = {};
    memory_.tell(input_);
    released_ = false;
    act_at_ = never;
    action_ = KZ_ACTION_NONE;
    tick_at_ = now_ + states;
    deaf_until_ = tick_at_ - start_states;
    setting_ = 0;  // like the firmware, it converts once before the first tick
    received_.clear();
    ring_.clear();
    lost_ = false;
    overrun_at_ = never;
    while (!wire_.empty() && wire_.back().at > now_) wire_.pop_back();
    wire_free_ = now_;
    show({});
  }

  void tick() {
    const States start = tick_at_;
    tick_at_ += KZ_STATES_PER_TICK;
    if (!started_) {
      kz_startup_test_analog(&startup_, input_.analog);
      kz_servo_init(&servo_, &startup_, &output_);
      started_ = true;
      // What came for the loader is lost.
      while (!received_.empty() && received_.front().at <= deaf_until_) received_.pop_front();
    }

    show(levels_of(output_));
    transmit(start);
    gather(start);

    kz_tick(&servo_, &input_, &output_);
    if (on_tick_) on_tick_({input_, output_});
    input_.tick += 1;
    input_.missed = 0;
    input_.result = KZ_RESULT_NONE;
    setting_ = 0;
    if (output_.action != KZ_ACTION_NONE) prepare_action(start);
  }

  // What a tick has asked for is done when its outputs are at the pins and its bytes have left.
  void prepare_action(States start) {
    action_ = std::exchange(output_.action, u8{KZ_ACTION_NONE});
    asked_at_ = start;
    show(levels_of(output_));
    transmit(now_);
    released_ = true;
    act_at_ = std::max(wire_free_, now_);
    tick_at_ = never;
    setting_ = KZ_MUX_INPUTS;
  }

  void act() {
    act_at_ = never;
    const bool motors_on = (output_.p4 & KZ_P4_ENABLE) != 0;
    switch (std::exchange(action_, u8{KZ_ACTION_NONE})) {
      case KZ_ACTION_RESET:
        if (motors_on) return go_on(false);
        return start(KZ_RESET_COMMAND, start_states);
      case KZ_ACTION_LOADER:
        if (motors_on) return go_on(false);
        return start(KZ_RESET_COMMAND, start_states + KZ_LOADER_S * KZ_CLOCK_HZ);
      case KZ_ACTION_STORE_CALIBRATION:
        if (motors_on) return go_on(false);
        memory_.store_calibration(servo_, now_);
        break;
      case KZ_ACTION_STORE_ADDRESS:
        if (motors_on) return go_on(false);
        memory_.store_address(servo_, now_);
        break;
      default:  // the end of a store
        listen_again();
        return go_on(memory_.finish());
    }
    deaf_from_ = now_;
    act_at_ = memory_.over_at();
  }

  // The chip's receiver holds one byte; those that come on top of it are lost, and it says so.
  void listen_again() {
    const auto in_deafness = [this](const SerialByte& byte) {
      return byte.at > deaf_from_ && byte.at <= now_;
    };
    const auto first = std::find_if(received_.begin(), received_.end(), in_deafness);
    const auto behind = std::find_if_not(first, received_.end(), in_deafness);
    if (behind - first < 2) return;
    overrun_at_ = first->at;
    received_.erase(first + 1, behind);
  }

  // Ticks begin again, in step with those before.
  void go_on(bool done) {
    memory_.tell(input_);
    input_.result = done ? KZ_RESULT_DONE : KZ_RESULT_FAILED;
    const States ticks = (now_ - asked_at_ + KZ_STATES_PER_TICK - 1) / KZ_STATES_PER_TICK + 1;
    tick_at_ = asked_at_ + ticks * KZ_STATES_PER_TICK;
    input_.missed = static_cast<u16>(ticks - 1);
    input_.tick += input_.missed;
    setting_ = 0;
  }

  // The bytes that the previous tick queued go to the wire back to back.
  void transmit(States start) {
    if (std::exchange(released_, false)) return;
    wire_free_ = std::max(wire_free_, start);
    for (int i = 0; i < output_.tx_count; ++i) {
      wire_free_ += KZ_STATES_PER_BYTE;
      wire_.push_back({output_.tx[i], wire_free_, false});
    }
  }

  // The snapshot that the tick computes from. A/D codes are in it already.
  void gather(States start) {
    while (!received_.empty() && received_.front().at <= start) {
      if (ring_.size() < receive_ring) {
        const auto flags = (received_.front().framing_error ? KZ_RX_FRAMING : 0) |
                           (lost_ ? KZ_RX_LOST : 0) |
                           (received_.front().at == overrun_at_ ? KZ_RX_OVERRUN : 0);
        ring_.emplace_back(received_.front().value, static_cast<u8>(flags));
        lost_ = false;
      } else {
        lost_ = true;
      }
      received_.pop_front();
    }
    std::fill(std::begin(input_.rx), std::end(input_.rx), u8{0});
    std::fill(std::begin(input_.rx_flags), std::end(input_.rx_flags), u8{0});
    input_.rx_count = static_cast<u8>(std::min<std::size_t>(ring_.size(), KZ_RX_PER_TICK));
    for (std::size_t i = 0; i < input_.rx_count; ++i) {
      input_.rx[i] = ring_.front().first;
      input_.rx_flags[i] = ring_.front().second;
      ring_.pop_front();
    }
    const States queued = (wire_free_ - start + KZ_STATES_PER_BYTE - 1) / KZ_STATES_PER_BYTE;
    const States room = static_cast<States>(transmit_ring) - std::max<States>(queued, 0);
    input_.tx_room = static_cast<u8>(std::clamp<States>(room, 0, 255));
  }

  States sample_time() const {
    if (setting_ >= KZ_MUX_INPUTS) return tick_at_ + 1;  // the tick comes first
    return tick_at_ - KZ_STATES_PER_TICK + scan_start + setting_ * scan_interval;
  }

  u16 code_of(int channel) {
    const double ratio = analog_ ? analog_(channel, pins_, now_ + channel * convert_states) : 0.0;
    const int code = static_cast<int>(std::floor(KZ_POT_CODES * ratio));
    return static_cast<u16>(std::clamp(code, 0, KZ_POT_CODES - 1));
  }

  // One multiplexer setting: AN0, AN1, AN2 in turn.
  void sample() {
    PinLevels selected = pins_;
    selected.p4 = static_cast<std::uint8_t>((pins_.p4 & ~KZ_P4_MUX_MASK) | setting_);
    show(selected);
    for (int mux = 0; mux < KZ_MUXES; ++mux) {
      input_.analog[mux * KZ_MUX_INPUTS + setting_] = code_of(mux);
    }
    // Then the inertial option's, over the inputs to which nothing is connected.
    if (setting_ == KZ_MUX_INPUTS - 1) {
      constexpr std::pair<int, int> kInertial[] = {
          {3, KZ_ANALOG_YAW_RATE}, {4, KZ_ANALOG_FORWARD_FORCE}, {5, KZ_ANALOG_LEFT_FORCE}};
      for (const auto& [channel, at] : kInertial) input_.analog[at] = code_of(channel);
    }
    ++setting_;
  }

  PinLevels levels_of(const kz_tick_output& output) const {
    PinLevels levels;
    for (std::size_t i = 0; i < 16; ++i) levels.pw[i] = output.pw[i];
    for (std::size_t i = 0; i < 2; ++i) levels.tmo[i] = output.tmo[i];
    levels.p3 = output.p3;
    levels.p4 =
        static_cast<std::uint8_t>((output.p4 & ~KZ_P4_MUX_MASK) | (pins_.p4 & KZ_P4_MUX_MASK));
    levels.p5 = output.p5;
    levels.p6 = output.p6;
    return levels;
  }

  void show(const PinLevels& levels) {
    if (levels == pins_) return;
    pins_ = levels;
    if (on_pins_) on_pins_(now_, pins_);
  }

  NativeMemory memory_;
  kz_startup startup_{};
  bool started_ = false;  // the first tick has come
  kz_servo servo_{};
  kz_tick_input input_{};
  kz_tick_output output_{};  // of the last tick: for the pins and the wire at the next
  States now_ = 0;
  States tick_at_ = 0;
  States act_at_ = never;  // when `action_` is due, or the store under way is over
  u8 action_ = KZ_ACTION_NONE;
  bool released_ = false;  // the bytes of `output_` are on the wire already
  States asked_at_ = 0;    // start of the tick that asked
  States deaf_from_ = 0;
  States deaf_until_ = 0;        // the loader runs, which listens to nothing
  States overrun_at_ = never;    // the byte that others have overrun
  int setting_ = KZ_MUX_INPUTS;  // of the multiplexers, to be sampled next
  PinLevels pins_;

  std::deque<SerialByte> received_;     // on the wire to us
  std::deque<std::pair<u8, u8>> ring_;  // received and not yet taken: value, KZ_RX_*
  bool lost_ = false;
  std::deque<SerialByte> wire_;  // on the wire from us
  States wire_free_ = 0;

  std::function<void(States, const PinLevels&)> on_pins_;
  AnalogSource analog_;
  std::function<void(const TickRecord&)> on_tick_;
};

}  // namespace

std::unique_ptr<Mcu> make_native() {
  return std::make_unique<NativeMcu>();
}

}  // namespace kaz::sim
