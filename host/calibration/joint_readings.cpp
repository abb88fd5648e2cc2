// Moves the robot to stops and postures, and averages codes.
// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/joint_readings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kaz::calibration {

namespace {

using host::JointAngles;
using host::JointCalibration;
using Lines = std::array<JointCalibration, KZ_JOINTS>;

constexpr double kShrunk = 0.85;                  // scale of the calibration for stops
constexpr double kPressBeyond = 6 * kDegree;      // of the target behind the stop
constexpr double kTravel = 1.5, kApproach = 0.8;  // rad/s
constexpr double kSettle_s = 0.3, kRead_s = 0.4;
constexpr double kStandSettle_s = 0.5, kStandTravel = 0.6;
// A code of the accelerometer is 0.9 degrees, and its noise far less: read at rest, a mean would be off by up
// to half a code. So the trunk turns slowly over two codes, while joints and accelerometer are averaged.
constexpr double kSweep = 0.9 * kDegree, kSweep_s = 1.6;
// At rest: noise and rounding are 0.6 codes. Against nothing: the command is no further ahead than this.
constexpr double kCalm = 1.5, kPressed = 1.2 * kDegree;
constexpr std::uint32_t kHands = 1u << host::l_hand | 1u << host::r_hand;
constexpr std::uint32_t kNeck = 1u << host::neck_pan | 1u << host::neck_tilt;

Lines shrunk() {
  Lines lines;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    lines[static_cast<std::size_t>(j)] = nominal_calibration(j);
    lines[static_cast<std::size_t>(j)].scale_rad *= kShrunk;
  }
  return lines;
}

// The board's angle for a joint at `angle` of the nominal robot.
JointAngles by(const Lines& lines, const JointAngles& nominal) {
  JointAngles out;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const auto i = static_cast<std::size_t>(j);
    out[i] = angle_at(lines[i], code_at(nominal_calibration(j), nominal[i]));
  }
  return out;
}

// A motion in progress, and means of what the board measures.
class Mover {
 public:
  explicit Mover(host::Robot& robot) : robot_(robot) {}

  // One posture; also keeps the link watchdog content.
  Result<host::Posture> look() {
    const auto posture = KAZ_TRY(robot_.state());
    KAZ_TRY(take_resumptions());
    if (posture.status & host::kMotorsOffFaults)
      return fail(host::shutdown_fault(posture.status), robot_.describe_fault(posture.status));
    return posture;
  }

  // Runs `step` until the link was not lost in it: a loss ends all ramps, and joints hold where they are. A
  // host that is late on a busy machine loses it. Error: the board was reset, and the calibration in its RAM
  // is gone.
  template <class Step>
  Result<void> repeat(Step step) {
    constexpr int kAttempts = 10;
    for (int attempt = 1;; ++attempt) {
      resumed_ = false;
      const Result<void> done = step();
      KAZ_TRY(take_resumptions());
      if (!resumed_ || attempt == kAttempts) return done;
    }
  }

  Result<void> wait(double time_s) {
    for (const Time end = robot_.clock().now() + from_seconds(time_s);
         robot_.clock().now() < end;) {
      KAZ_TRY(look());
      KAZ_TRY(robot_.clock().sleep_until(
          std::min(end, robot_.clock().now() + std::chrono::milliseconds(20))));
    }
    return {};
  }

  // All joints, while the caller reads.
  Result<void> begin(const JointAngles& goal, double time_s) {
    std::vector<host::JointTarget> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) targets.push_back({j, goal[static_cast<std::size_t>(j)]});
    return robot_.set_targets(targets, from_seconds(time_s));
  }

  // Straight ramps of all joints of `mask`, as long as the longest takes.
  Result<void> go(const JointAngles& goal, std::uint32_t mask, double rad_per_s) {
    const auto at = KAZ_TRY(look());
    std::vector<host::JointTarget> targets;
    double longest = 0;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      if (!(mask >> j & 1)) continue;
      const auto i = static_cast<std::size_t>(j);
      targets.push_back({j, goal[i]});
      longest = std::max(longest, std::abs(goal[i] - at.angle[i]));
    }
    const double time_s = longest / rad_per_s + 0.05;
    KAZ_TRY(robot_.set_targets(targets, from_seconds(time_s)));
    return wait(time_s);
  }

  struct Means {
    JointAngles angle{}, spread{};  // mean and standard deviation
    bool has_force = false;
    double forward = 0, left = 0;
  };
  Result<Means> read(double time_s) {
    Means means;
    JointAngles squares{}, first{};
    int count = 0, forces = 0;
    for (const Time end = robot_.clock().now() + from_seconds(time_s);
         robot_.clock().now() < end;) {
      const auto posture = KAZ_TRY(look());
      if (count++ == 0) first = posture.angle;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        means.angle[j] += posture.angle[j] - first[j];
        squares[j] += (posture.angle[j] - first[j]) * (posture.angle[j] - first[j]);
      }
      if (posture.inertial) {
        ++forces;
        means.forward += posture.inertial->forward_m_per_s2;
        means.left += posture.inertial->left_m_per_s2;
      }
    }
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      means.angle[j] /= count;
      means.spread[j] =
          std::sqrt(std::max(0.0, squares[j] / count - means.angle[j] * means.angle[j]));
      means.angle[j] += first[j];
    }
    means.has_force = forces > 0;
    if (forces > 0) {
      means.forward /= forces;
      means.left /= forces;
    }
    return means;
  }

 private:
  Result<void> take_resumptions() {
    while (const auto resumed = robot_.take_resumption()) {
      resumed_ = true;
      if (resumed->cause == host::Resumption::Cause::reset)
        return fail(Fault::environment,
                    "the board was reset and lost the calibration in its RAM: start again");
    }
    return {};
  }

  host::Robot& robot_;
  bool resumed_ = false;  // since repeat() began
};

std::string degrees_text(double rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", rad / kDegree);
  return text;
}

StopReading reading_of(const Press& press, const Lines& lines, const Mover::Means& means,
                       double command_rad) {
  const auto j = static_cast<std::size_t>(press.joint);
  StopReading out{press.joint,
                  press.stop,
                  code_at(lines[j], means.angle[j]),
                  std::abs(means.spread[j] / lines[j].scale_rad) * KZ_POT_CODES / 2,
                  {}};
  const double angle = angle_at(nominal_calibration(press.joint), out.code);
  const double off = angle - stop_angle(press.joint, press.stop);
  const double ahead = (command_rad - means.angle[j]) * (press.stop == Stop::upper ? 1 : -1);
  if (out.spread > kCalm)
    out.fault = "the joint did not come to rest";
  else if (std::abs(off) > kMaxPotError)
    out.fault = "the joint rests at " + degrees_text(angle) + " degrees, but the stop is at " +
                degrees_text(stop_angle(press.joint, press.stop)) +
                ": check for an obstacle and for a misaligned potentiometer";
  else if (ahead < kPressed)
    out.fault = "no stop was found at " + degrees_text(angle) + " degrees";
  return out;
}

Result<void> enable_softly(host::Robot& robot) {
  constexpr host::Gains kSoft{.kp_per_rad = 4, .kd_s_per_rad = 0.09};
  constexpr host::Gains kJaws{.kp_per_rad = 2, .kd_s_per_rad = 0.09};
  KAZ_TRY(robot.set_gains(host::kAllJoints & ~kHands, kSoft));
  KAZ_TRY(robot.set_gains(kHands, kJaws));
  return robot.enable(host::kAllJoints);
}

Result<void> press_all(Mover& mover, const Lines& lines, const StopStep& step,
                       std::vector<StopReading>& readings) {
  JointAngles goal = step.posture;
  std::uint32_t mask = 0;
  for (const Press& press : step.presses) {
    goal[static_cast<std::size_t>(press.joint)] =
        stop_angle(press.joint, press.stop) +
        (press.stop == Stop::upper ? kPressBeyond : -kPressBeyond);
    mask |= 1u << press.joint;
  }
  const JointAngles command = by(lines, goal);
  Mover::Means means;
  KAZ_TRY(mover.repeat([&]() -> Result<void> {
    KAZ_TRY(mover.go(command, mask, kApproach));
    KAZ_TRY(mover.wait(kSettle_s));
    means = KAZ_TRY(mover.read(kRead_s));
    return {};
  }));
  for (const Press& press : step.presses)
    readings.push_back(
        reading_of(press, lines, means, command[static_cast<std::size_t>(press.joint)]));
  return mover.repeat([&] { return mover.go(by(lines, step.posture), mask, kTravel); });
}

FloorReading floor_reading(const Lines& lines, const Mover::Means& means) {
  FloorReading out;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) out.codes[j] = code_at(lines[j], means.angle[j]);
  out.has_force = means.has_force;
  out.forward_m_per_s2 = means.forward;
  out.left_m_per_s2 = means.left;
  return out;
}

}  // namespace

Result<void> use_lines(host::Robot& robot, const Lines& lines) {
  KAZ_TRY(robot.enable(0));
  return robot.set_calibration(host::kAllJoints, lines);
}

Result<void> prepare_for_stops(host::Robot& robot) {
  return use_lines(robot, shrunk());
}

Result<void> read_stops(host::Robot& robot, const MotionGroup& group, const OnReading& on,
                        std::vector<StopReading>& readings) {
  const Lines lines = shrunk();
  Mover mover(robot);
  KAZ_TRY(enable_softly(robot));
  double done = 0;
  for (const StopStep& step : group.steps) {
    std::string names;
    for (const Press& press : step.presses)
      names += (names.empty() ? "" : ", ") +
               std::string(host::joint_table()[static_cast<std::size_t>(press.joint)].name);
    on(done++ / static_cast<double>(group.steps.size()), names.empty() ? group.name : names);
    KAZ_TRY(
        mover.repeat([&] { return mover.go(by(lines, step.posture), host::kAllJoints, kTravel); }));
    if (!step.presses.empty()) KAZ_TRY(press_all(mover, lines, step, readings));
  }
  on(1, group.name);
  return robot.enable(0);
}

Result<void> read_floor(host::Robot& robot, const Lines& lines, const OnReading& on,
                        std::vector<FloorReading>& readings) {
  // As behaviors hold the robot (host/behavior/control_cycle.h).
  KAZ_TRY(robot.set_gains(host::kAllJoints & ~kHands & ~kNeck,
                          {.kp_per_rad = 20, .kd_s_per_rad = 0.15}));
  KAZ_TRY(robot.set_gains(kHands, {.kp_per_rad = 0.8, .kd_s_per_rad = 0.15}));
  KAZ_TRY(robot.set_gains(kNeck, {.kp_per_rad = 12, .kd_s_per_rad = 0.15}));
  KAZ_TRY(robot.enable(host::kAllJoints));
  KAZ_TRY(robot.sense_inertial());
  Mover mover(robot);
  const Time begin = robot.clock().now();
  const auto stances = floor_stances();
  for (std::size_t i = 0; i < stances.size(); ++i) {
    on(static_cast<double>(i) / static_cast<double>(stances.size()),
       "posture " + std::to_string(i + 1) + " of " + std::to_string(stances.size()));
    motion::Stance from = stances[i], to = stances[i];
    from.pitch -= kSweep, from.roll -= kSweep;
    to.pitch += kSweep, to.roll += kSweep;
    Mover::Means means;
    KAZ_TRY(mover.repeat([&]() -> Result<void> {
      KAZ_TRY(mover.go(posture_of(from), host::kAllJoints, kStandTravel));
      KAZ_TRY(mover.wait(kStandSettle_s));
      KAZ_TRY(mover.begin(posture_of(to), kSweep_s));
      means = KAZ_TRY(mover.read(kSweep_s));
      return {};
    }));
    FloorReading reading = floor_reading(lines, means);
    reading.time_s = seconds(robot.clock().now() - begin);
    readings.push_back(reading);
  }
  on(1, "back to straight");
  KAZ_TRY(mover.repeat([&] { return mover.go(JointAngles{}, host::kAllJoints, kStandTravel); }));
  KAZ_TRY(mover.wait(kStandSettle_s));
  return robot.enable(0);
}

Result<FloorReading> read_here(host::Robot& robot, const Lines& lines) {
  Mover mover(robot);
  const auto means = KAZ_TRY(mover.read(kRead_s));
  return floor_reading(lines, means);
}

}  // namespace kaz::calibration
