// The native engine: shared/servo compiled for this machine, behind the same pins.
// SPDX-License-Identifier: Apache-2.0
//
// Models the board as seen from its pins and its line: rings, receiver, converter, flash and start-up have
// the firmware's order and times, but no CPU time is modelled. Actions of the firmware after a tick became
// due happen after their usual delay (wire_differences.h lists the remaining differences).
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "shared/servo/servo.h"
#include "shared/servo/startup.h"
#include "shared/servo/tick.h"
#include "sim/h8s/chip/line_rate.h"
#include "sim/mcu/native_mcu.h"
#include "sim/mcu/native_memory.h"

namespace kaz::sim {
namespace {

// Delays of the firmware measured in the emulator, in states. A tick begins with the entry into the clock's
// interrupt.
constexpr States kSendAfter =
    445;  // from a tick to the start bit of its first byte on an idle line
constexpr States kTickAfter = 650;   // to the read of the receive ring, and with it the computation
constexpr States kRoomAfter = 665;   // to the read of the transmit ring
constexpr States kActAfter = 5900;   // to the action that a tick requested, on an idle board
constexpr States kScanAfter = 850;   // to the first sample of the converter
constexpr States kScanFirst = 1133;  // from the first multiplexer input of a scan to the second
constexpr States kScanNext = 887;    // from each other one to the next
constexpr States kScanStates = 6500;    // a whole scan
constexpr States kConvertStates = 266;  // from one of AN0..AN3 to the next
constexpr States kInertialAge = 400;    // AN4 and AN5 at a tick: they are converted all the time

// Before the first tick: SCI0 listens; two scans. A start by watchdog takes longer, and so does one
// that finds something stored.
constexpr States kListenBefore = 46940;
constexpr States kScanBefore = 46800;
constexpr States kApplicationBefore = 156060;  // the loader has handed over
constexpr States kServoBefore = 18500;         // not included in kz_startup.start_8states
constexpr States kWatchdogStates = 1000;       // from the request to the reset
constexpr States kStoredLineStates = 681;
constexpr States kCalibratedStates = 1600;

constexpr std::size_t kTransmitRing = 63;  // capacity, bytes
constexpr std::size_t kReceiveMax =
    48;  // bytes waiting beyond it: the oldest may be lost (firmware/serial.c)
constexpr int kScanSettings = 7;  // a supply's input, then 0..5
constexpr States kNotDue = std::numeric_limits<States>::max() / 2;
constexpr States kMaxTime = States{1} << 50;  // of a saved state: two years

class NativeMcu final : public Mcu {
 public:
  explicit NativeMcu(const NativeOptions& options) : options_(options) { power_cycle(); }

  std::string name() const override { return to_string(McuKind::native); }
  States now() const override { return now_; }

  Result<void> run_until(States until) override {
    while (true) {
      const States sample_at = sample_time(), compute_at = tick_at_ + kTickAfter;
      if (std::min({compute_at, sample_at, act_at_}) > until) break;
      if (act_at_ <= std::min(sample_at, compute_at)) {
        now_ = std::max(now_, act_at_);
        act();
      } else if (sample_at < compute_at) {
        now_ = std::max(now_, sample_at);
        sample();
      } else {
        now_ = std::max(now_, compute_at);
        tick();
      }
    }
    now_ = std::max(now_, until);
    return {};
  }

  void reset() override { start(KZ_RESET_POWER, 0); }

  // The native engine has no RAM that could outlive its servo's state.
  void power_cycle() override { reset(); }

  std::array<std::uint8_t, kMemorySize> memory() const override {
    std::array<std::uint8_t, kMemorySize> bytes{};
    std::copy(memory_.bytes().begin(), memory_.bytes().end(), bytes.begin());
    return bytes;
  }
  void set_memory(std::span<const std::uint8_t, kMemorySize> bytes) override {
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
  void on_watchdog_reset(std::function<void(States)> listener) override {
    on_reset_ = std::move(listener);
  }

  void save(StateWriter& to) override { transfer(to); }
  // As it was if `from` is refused.
  void restore(StateReader& from) override {
    const NativeMcu before = *this;
    transfer(from);
    if (!from.good()) *this = before;
  }

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
    a(memory_, started_, now_, tick_at_, act_at_, action_, phase_, released_, requested_at_,
      deaf_from_, listens_from_, scan_at_, scans_left_, setting_, supply_input_, pins_, received_,
      ring_, wire_, wire_free_);
    a.plain(startup_);
    a.plain(servo_);
    a.plain(input_);
    a.plain(output_);
    // The first tick makes a servo.
    a.require((!started_ || is_possible(servo_)) && is_possible(output_) &&
                  action_ <= KZ_ACTION_LOADER && (supply_input_ | 1) == KZ_ANALOG_REFERENCE &&
                  scans_left_ >= 0 && scans_left_ <= 2 && setting_ >= 0 &&
                  setting_ < kScanSettings + (scans_left_ == 0 ? 1 : 0),
              "servo");
    // What is due has been done, so that nothing has to be caught up with.
    const auto is_due_later = [this](States at) { return at > now_ - KZ_STATES_PER_TICK; };
    a.require(now_ >= 0 && now_ <= kMaxTime && is_due_later(tick_at_) && is_due_later(act_at_) &&
                  is_due_later(sample_time()) && requested_at_ >= 0 && requested_at_ <= now_,
              "time");
  }

  // State between two ticks.
  enum class Phase : std::uint8_t { requested, restarting, writing, reading_back };
  friend constexpr Phase last_value(Phase) { return Phase::reading_back; }

  // Reset or power-on; the start begins after `wait`.
  void start(u8 cause, States wait) {
    memory_.cut(now_);
    kz_startup_nominal(&startup_);
    startup_.reset_cause = cause;
    startup_.tests_done = KZ_TEST_RAM | KZ_TEST_FLASH;
    memory_.load(startup_);
    States stored = memory_.lines() * kStoredLineStates;
    if (startup_.calibration != KZ_CALIBRATION_NOMINAL) stored += kCalibratedStates;
    startup_.start_8states = static_cast<u16>((kApplicationBefore - kServoBefore + stored) / 8);
    started_ = false;
    servo_ = {};
    output_ = {};
    input_ = {};
    memory_.report(input_);
    released_ = false;
    act_at_ = kNotDue;
    action_ = KZ_ACTION_NONE;
    tick_at_ = now_ + wait + options_.start_states + stored;
    listens_from_ = tick_at_ - kListenBefore;
    supply_input_ = KZ_ANALOG_REFERENCE;
    begin_scans(tick_at_ - kScanBefore, 2);
    received_.clear();
    ring_.clear();
    while (!wire_.empty() && wire_.back().at > now_) wire_.pop_back();
    wire_free_ = now_;
    show({});
  }

  void restart(States wait) {
    start(KZ_RESET_COMMAND, wait);
    if (on_reset_) on_reset_(now_);
  }

  void tick() {
    const States start = tick_at_;
    tick_at_ += KZ_STATES_PER_TICK;
    if (!started_) {
      kz_startup_test_analog(&startup_, input_.analog);
      kz_servo_init(&servo_, &startup_, &output_);
      started_ = true;
    }

    show(levels_of(output_));
    if (!std::exchange(released_, false)) transmit(start + kSendAfter);
    gather(start);

    kz_tick(&servo_, &input_, &output_);
    if (on_tick_) on_tick_({input_, output_});
    input_.tick += 1;
    input_.missed = 0;
    input_.result = KZ_RESULT_NONE;
    begin_scans(start + kScanAfter, 1);
    if (output_.action != KZ_ACTION_NONE) prepare_action(start);
  }

  // A tick's requested action is done when its outputs are at the pins and its bytes have been sent.
  void prepare_action(States start) {
    action_ = std::exchange(output_.action, u8{KZ_ACTION_NONE});
    phase_ = Phase::requested;
    requested_at_ = start;
    show(levels_of(output_));
    transmit(start + kActAfter);
    released_ = true;
    act_at_ = std::max(wire_free_, start + kActAfter);
    tick_at_ = kNotDue;
  }

  void act() {
    act_at_ = kNotDue;
    switch (phase_) {
      case Phase::requested:
        return begin_action();
      case Phase::restarting:
        return restart(action_ == KZ_ACTION_LOADER ? KZ_LOADER_S * KZ_CLOCK_HZ : 0);
      case Phase::writing:
        listen_again();
        act_at_ = now_ + memory_.read_back_states();
        phase_ = Phase::reading_back;
        return;
      case Phase::reading_back:
        return go_on(memory_.finish());
    }
  }

  void begin_action() {
    // No tick requests it, and motors must not be unsupervised for seconds.
    if ((output_.p4 & KZ_P4_ENABLE) != 0) return go_on(false);
    if (action_ == KZ_ACTION_RESET || action_ == KZ_ACTION_LOADER) {
      phase_ = Phase::restarting;
      act_at_ = now_ + kWatchdogStates;
      return;
    }
    if (action_ == KZ_ACTION_STORE_CALIBRATION) {
      memory_.store_calibration(servo_, now_);
    } else {
      memory_.store_address(servo_, now_);
    }
    phase_ = Phase::writing;
    deaf_from_ = memory_.deaf_from();
    act_at_ = memory_.over_at();
  }

  // Flash has been written with interrupts off. The chip's receiver holds one byte; those that
  // follow are lost and flagged as an overrun; none is accepted after a damaged one.
  void listen_again() {
    arrive(deaf_from_);
    bool full = false;
    std::uint8_t value = 0;
    unsigned flags = 0;
    bool any = false;
    for (; !received_.empty() && received_.front().at <= now_; received_.pop_front()) {
      const SerialByte& byte = received_.front();
      if (flags != 0) continue;
      any = true;
      if (byte.framing_error) flags |= KZ_RX_FRAMING;
      if (full) {
        flags |= KZ_RX_OVERRUN;
        continue;
      }
      value = byte.value;
      full = !byte.framing_error;
    }
    if (any) ring_.emplace_back(value, static_cast<u8>(flags));
  }

  // Ticks begin again, in step with those before, when every input has been converted.
  void go_on(bool done) {
    memory_.report(input_);
    input_.result = done ? KZ_RESULT_DONE : KZ_RESULT_FAILED;
    begin_scans(now_, 2);
    const States ticks = (now_ + 2 * kScanStates - requested_at_) / KZ_STATES_PER_TICK + 1;
    tick_at_ = requested_at_ + ticks * KZ_STATES_PER_TICK;
    input_.missed = static_cast<u16>(ticks - 1);
    input_.tick += input_.missed;
  }

  // The bytes that a tick queued go to the wire back to back, the first at `at` if it is idle. On a
  // shared line the transmitter is switched on for them, which takes a byte's time of mark.
  void transmit(States at) {
    if (output_.tx_count == 0) return;
    if (startup_.shared_line && wire_free_ <= at) at += KZ_STATES_PER_BYTE;
    wire_free_ = std::max(wire_free_, at);
    for (int i = 0; i < output_.tx_count; ++i) {
      wire_free_ += KZ_STATES_PER_BYTE;
      wire_.push_back({output_.tx[i], wire_free_, false});
    }
  }

  // Bytes on the line up to `until` come to the ring.
  void arrive(States until) {
    for (; !received_.empty() && received_.front().at <= until; received_.pop_front()) {
      const SerialByte& byte = received_.front();
      if (byte.at <= listens_from_) continue;
      ring_.emplace_back(byte.value, byte.framing_error ? u8{KZ_RX_FRAMING} : u8{0});
    }
  }

  // The snapshot that the tick computes from. A/D codes are in it already, but for those of the
  // inputs that are converted all the time.
  void gather(States start) {
    arrive(start + kTickAfter);
    if (ring_.size() > kReceiveMax) {
      ring_.erase(ring_.begin(), ring_.end() - KZ_RX_PER_TICK);
      ring_.front().second |= KZ_RX_LOST;
    }
    std::fill(std::begin(input_.rx), std::end(input_.rx), u8{0});
    std::fill(std::begin(input_.rx_flags), std::end(input_.rx_flags), u8{0});
    input_.rx_count = static_cast<u8>(std::min<std::size_t>(ring_.size(), KZ_RX_PER_TICK));
    for (std::size_t i = 0; i < input_.rx_count; ++i) {
      input_.rx[i] = ring_.front().first;
      input_.rx_flags[i] = ring_.front().second;
      ring_.pop_front();
    }
    input_.tx_room = transmit_room(start + kRoomAfter);
    input_.analog[KZ_ANALOG_FORWARD_FORCE] = code_of(4, now_ - kInertialAge);
    input_.analog[KZ_ANALOG_LEFT_FORCE] = code_of(5, now_ - kInertialAge);
  }

  // SCI0 holds the byte that it sends and the next one; the rest waits in the ring.
  u8 transmit_room(States at) const {
    const auto first = std::find_if(wire_.begin(), wire_.end(),
                                    [at](const SerialByte& byte) { return byte.at > at; });
    const auto waiting = static_cast<std::size_t>(wire_.end() - first);
    if (waiting == 0) return kTransmitRing;
    const bool sends = first->at - KZ_STATES_PER_BYTE <= at;
    const std::size_t in_channel = std::min<std::size_t>(waiting, sends ? 2 : 1);
    return static_cast<u8>(kTransmitRing - std::min(waiting - in_channel, kTransmitRing));
  }

  // Each scan has one of the two supply inputs, in turn, and then the potentiometers'.
  void begin_scans(States at, int count) {
    supply_input_ ^= 1;
    scan_at_ = at;
    scans_left_ = count;
    setting_ = 0;
  }

  States sample_time() const {
    if (scans_left_ == 0) return kNotDue;
    return scan_at_ + (setting_ == 0 ? 0 : kScanFirst + (setting_ - 1) * kScanNext);
  }

  u16 code_of(int channel, States at) {
    const double ratio = analog_ ? analog_(channel, pins_, at) : 0.0;
    const int code = static_cast<int>(std::floor(KZ_POT_CODES * ratio));
    return static_cast<u16>(std::clamp(code, 0, KZ_POT_CODES - 1));
  }

  // One multiplexer setting: AN0, AN1, AN2 in turn, and AN3 with the first.
  void sample() {
    const int input = setting_ == 0 ? supply_input_ : setting_ - 1;
    PinLevels selected = pins_;
    selected.p4 = static_cast<std::uint8_t>((pins_.p4 & ~KZ_P4_MUX_MASK) | input);
    show(selected);
    for (int mux = 0; mux < KZ_MUXES; ++mux) {
      const int place = mux * KZ_MUX_INPUTS + input;
      // Nothing is connected there: they are the inertial option's places.
      if (place == KZ_ANALOG_YAW_RATE || place == KZ_ANALOG_FORWARD_FORCE ||
          place == KZ_ANALOG_LEFT_FORCE)
        continue;
      input_.analog[place] = code_of(mux, now_ + mux * kConvertStates);
    }
    if (setting_ == 0) {
      input_.analog[KZ_ANALOG_YAW_RATE] = code_of(KZ_MUXES, now_ + KZ_MUXES * kConvertStates);
    }
    if (++setting_ < kScanSettings) return;
    if (scans_left_ > 1) return begin_scans(scan_at_ + kScanStates, scans_left_ - 1);
    scans_left_ = 0;
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

  NativeOptions options_;
  NativeMemory memory_;
  kz_startup startup_{};
  bool started_ = false;  // the first tick has run
  kz_servo servo_{};
  kz_tick_input input_{};
  kz_tick_output output_{};  // of the last tick: for the pins and the wire at the next
  States now_ = 0;
  States tick_at_ = 0;       // when the next one becomes due
  States act_at_ = kNotDue;  // when the next step of `action_` is due
  u8 action_ = KZ_ACTION_NONE;
  Phase phase_ = Phase::requested;
  bool released_ = false;    // the bytes of `output_` are on the wire already
  States requested_at_ = 0;  // when the requesting tick became due
  States deaf_from_ = 0;     // writing flash: received bytes are lost from here
  States listens_from_ = 0;  // earlier bytes were lost
  States scan_at_ = 0;       // first sample of the current scan
  int scans_left_ = 0;
  int setting_ = 0;  // of the scan, to be sampled next
  int supply_input_ = KZ_ANALOG_REFERENCE;
  PinLevels pins_;

  std::deque<SerialByte> received_;     // on the wire to the board
  std::deque<std::pair<u8, u8>> ring_;  // received and not yet read: value, KZ_RX_*
  std::deque<SerialByte> wire_;         // on the wire from the board
  States wire_free_ = 0;

  std::function<void(States, const PinLevels&)> on_pins_;
  AnalogSource analog_;
  std::function<void(const TickRecord&)> on_tick_;
  std::function<void(States)> on_reset_;
};

}  // namespace

std::unique_ptr<Mcu> make_native() {
  return make_native(NativeOptions{});
}

std::unique_ptr<Mcu> make_native(const NativeOptions& options) {
  return std::make_unique<NativeMcu>(options);
}

}  // namespace kaz::sim
