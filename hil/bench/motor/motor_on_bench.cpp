// One motor on the bench.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/motor/motor_on_bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "hil/bench/line_trouble.h"
#include "shared/base/counted.hpp"

namespace kaz::hil {
namespace {

using std::chrono::milliseconds;

constexpr Time kSampling = milliseconds(5);
constexpr Time kCycle = milliseconds(10);
constexpr Time kLateFrames = milliseconds(100);  // a bench that was later than that measures again
constexpr double kTravelSpeed = 1.5;             // rad/s, of go_to
constexpr int kUnlockSeconds = 60;
constexpr double kRampStep = 0.05;  // rad/s; half of the unit in which the board has it
constexpr Time kUnlockSpare = std::chrono::seconds(5);

std::uint32_t bit(int joint) {
  return std::uint32_t{1} << joint;
}

}  // namespace

MotorOnBench::MotorOnBench(host::Robot& robot, Stand* stand, int joint, const host::Gains& gains)
    : robot_(robot), stand_(stand), joint_(joint), gains_(gains) {
  const host::JointSettings settings = sure(robot_.settings(joint));
  const host::JointInfo& info = host::joint_table()[static_cast<std::size_t>(joint)];
  lower_ = info.lower_rad;
  upper_ = info.upper_rad;
  own_gains_ = settings.gains;
  sure(robot_.set_gains(bit(joint), gains));
  const host::Limits &own = settings.limits, all{.lower_rad = lower_, .upper_rad = upper_};
  if (own.lower_rad == lower_ && own.upper_rad == upper_ &&
      std::abs(own.ramp_rad_per_s - all.ramp_rad_per_s) < kRampStep)
    return;
  sure(robot_.set_limits(bit(joint), all));
  own_limits_ = own;
}

MotorOnBench::~MotorOnBench() {
  if (listening_) (void)robot_.subscribe(Time::zero(), 0);
  (void)robot_.disable_all();  // at a port, what puts the board back makes it confirm this
  (void)robot_.set_gains(bit(joint_), own_gains_);
  if (own_limits_) (void)robot_.set_limits(bit(joint_), *own_limits_);
}

std::string MotorOnBench::name() const {
  return host::joint_table()[static_cast<std::size_t>(joint_)].name;
}

void MotorOnBench::come_to_rest() {
  // What an earlier run has latched is no failure of this one; enable(0) succeeds with it.
  const auto before = robot_.state();
  if (!before || (before->status & host::kMotorsOffFaults) != 0) or_throw(robot_.clear());
  or_throw(robot_.enable(0));
  wait(0.1);
}

void MotorOnBench::set_supply(double volts) {
  sure(stand_->set_supply(volts));
  wait(0.05);
  const double there = or_throw(robot_.health()).supply_volts;
  char text[100];
  std::snprintf(text, sizeof text, "the supply should be %.1f V, but the board reads %.1f V", volts,
                there);
  check(std::abs(there - volts) <= 0.2 + 0.03 * volts, text);
}

void MotorOnBench::wait(double length_s) {
  // A port that goes in a long rest is noticed then, and not after it.
  constexpr Time kLook = std::chrono::seconds(1);
  const Time end = robot_.clock().now() + from_seconds(length_s);
  for (Time next = robot_.clock().now() + kLook; next < end; next += kLook) {
    sure(robot_.clock().sleep_until(next));
    (void)or_throw(robot_.health());
  }
  sure(robot_.clock().sleep_until(end));
}

void MotorOnBench::check_potentiometer() {
  const auto details = or_throw(robot_.joints(bit(joint_)));
  check(!details.empty() && (details.front().flags & KZ_JOINT_POT) == 0,
        "the potentiometer's reading is at an end of its range: the wiper is open or touches a "
        "supply; check the potentiometer's three wires");
}

double MotorOnBench::potentiometer_code(double angle_rad) {
  const auto all = or_throw(robot_.calibration());
  const host::JointCalibration& joint = all.joints[static_cast<std::size_t>(joint_)];
  return 0.5 * KZ_POT_CODES * (1 + (angle_rad - joint.centre_rad) / joint.scale_rad);
}

std::string MotorOnBench::take_line_trouble() {
  const host::LinkStatistics now = robot_.statistics();
  std::string trouble = line_trouble(std::exchange(counted_, now), now);
  const auto resumed = robot_.take_resumption();
  if (std::exchange(link_lost_, false)) {
    add_trouble(trouble, "the connection to the board was lost");
  } else if (resumed && resumed->cause == host::Resumption::Cause::link) {
    add_trouble(trouble, "the connection to the board was lost for a while");
  }
  if (const auto frames = std::exchange(frames_lost_, 0); frames > 0)
    add_trouble(trouble, counted(frames, "telemetry frame") + " did not arrive");
  return trouble;
}

void MotorOnBench::unlock() {
  const Time now = robot_.clock().now();
  if (now < unlocked_until_) return;
  or_throw(robot_.unlock(kUnlockSeconds));
  unlocked_until_ = now + std::chrono::seconds(kUnlockSeconds) - kUnlockSpare;
}

void MotorOnBench::listen(bool on) {
  // Asked again each time: the link watchdog may have ended it.
  or_throw(robot_.subscribe(on ? kSampling : Time::zero(), on ? KZ_TELEMETRY_STATE : 0));
  listening_ = on;
}

void MotorOnBench::forget_telemetry() {
  while (or_throw(robot_.next_telemetry(robot_.clock().now()))) continue;
}

template <class Enough>
void MotorOnBench::collect(Trace& to, std::uint32_t begin_tick, Time until, double until_s,
                           Enough enough) {
  const auto incomplete = [&] {
    return to.empty() || to.back().t_s < until_s - 3 * seconds(kSampling);
  };
  for (;;) {
    const Time now = robot_.clock().now();
    const Time end = now < until ? until : until + kLateFrames;
    if (now >= end || (now >= until && !incomplete())) return;
    const auto frame = or_throw(robot_.next_telemetry(end));
    if (!frame || frame->selection != KZ_TELEMETRY_STATE) continue;
    const auto ms = static_cast<std::int32_t>(frame->tick - begin_tick);
    if (ms < 0) continue;
    if (const std::uint16_t why = frame->status & host::kMotorsOffFaults; why != 0) {
      throw Failed{robot_.describe_fault(frame->status)};
    }
    if (!to.empty()) {
      const auto periods = std::lround((1e-3 * ms - to.back().t_s) / seconds(kSampling));
      frames_lost_ += static_cast<std::uint64_t>(std::max(periods - 1, 0L));
    }
    to.push_back({1e-3 * ms, frame->values[static_cast<std::size_t>(joint_)], frame->supply_volts});
    if (enough(to.back())) return;
  }
}

void MotorOnBench::go_to(double angle_rad) {
  const double at = or_throw(robot_.state()).angle[static_cast<std::size_t>(joint_)];
  const double goal = std::clamp(angle_rad, lower_, upper_);
  const double takes = std::max(0.2, std::abs(goal - at) / kTravelSpeed);
  or_throw(robot_.enable(bit(joint_)));
  const host::JointTarget target{joint_, goal};
  or_throw(robot_.set_targets({&target, 1}, from_seconds(takes)));
  wait(takes + 0.3);
  const host::Posture there = or_throw(robot_.state());
  if ((there.status & host::kMotorsOffFaults) != 0)
    throw Failed{robot_.describe_fault(there.status)};
  or_throw(robot_.enable(0));
  wait(0.1);
}

Trace MotorOnBench::watch(double length_s) {
  listen(true);
  forget_telemetry();
  const std::uint32_t begin = or_throw(robot_.state()).tick;
  Trace trace;
  collect(trace, begin, robot_.clock().now() + from_seconds(length_s), length_s,
          [](const Sample&) { return false; });
  listen(false);
  return trace;
}

template <class Enough>
Trace MotorOnBench::drive_until(double duty, double length_s, double after_s, Enough enough) {
  unlock();
  listen(true);
  forget_telemetry();
  const std::uint32_t begin = or_throw(robot_.raw_drive(joint_, duty, from_seconds(length_s)));
  const Time end = robot_.clock().now() + from_seconds(length_s);
  Trace trace;
  bool stopped = false;
  collect(trace, begin, end, length_s,
          [&](const Sample& sample) { return stopped = enough(sample); });
  if (stopped) (void)or_throw(robot_.raw_drive(joint_, 0, milliseconds(1)));
  if (after_s > 0) {
    const double driven_s = stopped ? trace.back().t_s : length_s;
    collect(trace, begin, robot_.clock().now() + from_seconds(after_s), driven_s + after_s,
            [](const Sample&) { return false; });
  }
  listen(false);
  return trace;
}

Trace MotorOnBench::drive(double duty, double length_s, double within_rad, double after_s) {
  return drive_until(duty, length_s, after_s, [&](const Sample& sample) {
    const double left = duty > 0 ? upper_ - sample.angle_rad : sample.angle_rad - lower_;
    return within_rad > 0 && left < within_rad;
  });
}

Trace MotorOnBench::nudge(double duty, double length_s, double from_rad, double enough_rad) {
  return drive_until(duty, length_s, 0, [&](const Sample& sample) {
    return std::abs(sample.angle_rad - from_rad) > enough_rad;
  });
}

void MotorOnBench::keep_driving(double duty, double length_s) {
  unlock();
  (void)or_throw(robot_.raw_drive(joint_, duty, from_seconds(length_s)));
}

Trace MotorOnBench::step(double from_rad, double to_rad, double length_s) {
  or_throw(robot_.enable(bit(joint_)));
  const host::JointTarget from{joint_, from_rad}, to{joint_, to_rad};
  or_throw(robot_.set_targets({&from, 1}, from_seconds(0.3)));
  wait(0.7);
  listen(true);
  forget_telemetry();
  const std::uint32_t begin = or_throw(robot_.exchange({&to, 1}, Time::zero())).tick;
  Trace trace;
  collect(trace, begin, robot_.clock().now() + from_seconds(length_s), length_s,
          [](const Sample&) { return false; });
  listen(false);
  or_throw(robot_.enable(0));
  return trace;
}

MotorOnBench::Sine MotorOnBench::follow(double middle_rad, double amplitude_rad, double hertz,
                                        double length_s) {
  or_throw(robot_.enable(bit(joint_)));
  const host::JointTarget start{joint_, middle_rad};
  or_throw(robot_.set_targets({&start, 1}, from_seconds(0.3)));
  wait(0.5);
  Sine sine;
  const Time begin = robot_.clock().now();
  const std::uint32_t begin_tick = or_throw(robot_.state()).tick;
  const auto cycles = static_cast<int>(length_s / kaz::seconds(kCycle));
  for (int i = 0; i < cycles; ++i) {
    sure(robot_.clock().sleep_until(begin + (i + 1) * kCycle));
    const double t = kaz::seconds(robot_.clock().now() - begin);
    const double angle = middle_rad + amplitude_rad * std::sin(2 * std::numbers::pi * hertz * t);
    const host::JointTarget target{joint_, angle};
    const host::Posture posture = or_throw(robot_.exchange({&target, 1}, kCycle));
    if ((posture.status & host::kMotorsOffFaults) != 0)
      throw Failed{robot_.describe_fault(posture.status)};
    sine.target.push_back({t, angle, posture.supply_volts});
    sine.answer.push_back({1e-3 * static_cast<std::int32_t>(posture.tick - begin_tick),
                           posture.angle[static_cast<std::size_t>(joint_)], posture.supply_volts});
  }
  or_throw(robot_.enable(0));
  return sine;
}

double mean_angle(const Trace& trace) {
  check(!trace.empty(), "no readings arrived");
  double sum = 0;
  for (const Sample& sample : trace) sum += sample.angle_rad;
  return sum / static_cast<double>(trace.size());
}

double mean_volts(const Trace& trace, double from_s, double to_s) {
  double sum = 0;
  int count = 0;
  for (const Sample& sample : trace) {
    if (sample.t_s < from_s || sample.t_s > to_s) continue;
    sum += sample.volts;
    ++count;
  }
  check(count > 0, "no readings of the supply arrived");
  return sum / count;
}

}  // namespace kaz::hil
