// One cycle: estimate the state, decide at each half gait cycle, advance the phase.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/motion.h"

#include <algorithm>
#include <cmath>

namespace kaz::motion {

namespace {

constexpr double kMaxControlCycle_s = 0.040;  // a later one is not made up for: joints would leap
// Ramps of the amplitude in cycles: as the known gait.
constexpr double kWalkUp = 1.5, kWalkDown = 1.0, kTurnUp = 0.7, kTurnDown = 0.5;
constexpr double kSettle_s = 0.6;  // after the feet stand, until the gyro's zero is taken again

// What one stride (of both feet) still walks in the ramp down, and in half a cycle before it, in
// strides: tests/walking measures it.
constexpr double kDownStrides = 0.75, kHalfStrides = 0.60;

// Heading while walking: unequal strides, once a cycle.
constexpr double kStridePerRad = 0.06, kMaxDifference = 0.015;
constexpr double kTurnedByDifference = 4.0;  // rad a cycle and metre, without a gyro: reckoned

// One double support at full reach: first guess; learnt while turning where there is a gyro.
constexpr double kTurnedASupport = 12.5 * kDegree;
constexpr double kTurnedEnough = 2 * kDegree;
constexpr double kLearnt = 0.5;  // of what the last support turned
constexpr int kMaxHalves = 24;   // of turning per 45 degrees

constexpr double kTipped = 0.75;  // g across the trunk's axis: it lies, or nearly (49 degrees)
constexpr double kTippedFor_s = 0.3, kForceSmoothing_s = 0.15;
constexpr double kGravity = 9.81;

// Delay of the weight transfer against the plan, s: servos lag, and without the delay a foot that still
// swings would count as half a support. Fitted to walks in simulation (docs/explanation/motion.md), where
// odometry was 1.4 % short without it.
// The balance policy rolls the trunk further, which takes the weight over sooner: without a delay walks
// with it are 2 mm a metre off, with this one 94.
constexpr double kFootLags_s = 0.055;
// What the gyro's own sigma leaves out: a trunk that shakes and leans while it walks, per root metre.
constexpr double kShaking = 1.5 * kDegree;

}  // namespace

Motion::Motion(const Settings& settings)
    : settings_(settings),
      walk_roll_(roll_for(settings.walk)),
      turn_roll_(roll_for(settings.turn)),
      turned_a_support_(kTurnedASupport) {
  if (settings_.balance) balance_.emplace(*settings_.balance);
}

double Motion::heading() const {
  return gyro_ ? heading_.rad() : reckoned_;
}

void Motion::walk(double distance, double turned) {
  wish_ = Wish::walk;
  endless_ = false;
  goal_walked_ = walked() + distance;
  goal_heading_ = heading() + turned;
  stride_ = distance < 0 ? -settings_.stride : settings_.stride;
  if (state_ == State::walking) ending_ = false;
}

void Motion::walk_on(double stride, double heading) {
  wish_ = Wish::walk;
  endless_ = true;
  stride_ = std::clamp(stride, -settings_.stride, settings_.stride);
  goal_heading_ = heading;
  if (state_ == State::walking) ending_ = false;
}

void Motion::turn(double angle) {
  wish_ = Wish::turn;
  goal_heading_ = heading() + angle;
  turned_enough_ = false;
  halves_ = 0;
}

void Motion::stop() {
  wish_ = Wish::stand;
}

Motion::LegTargets Motion::step(Time now, const host::Posture& posture) {
  const double dt = last_ ? std::clamp(seconds(now - *last_), 0.0, kMaxControlCycle_s) : 0.0;
  last_ = now;
  sense(posture);
  if (balance_ && gyro_ && posture.inertial) keep_balance(posture, dt);
  if (state_ != State::fallen) advance(dt);
  return targets(posture);
}

void Motion::keep_balance(const host::Posture& posture, double dt) {
  correction_ = balance_->step({.dt = dt,
                                .still = state_ == State::standing && still_s_ > kSettle_s,
                                .walks = state_ == State::walking,
                                .phase = phase_,
                                .amplitude = steps_.amplitude,
                                .yaw_rate = heading_.rate(),
                                .posture = &posture});
}

void Motion::sense(const host::Posture& posture) {
  const bool still = state_ == State::standing && still_s_ > kSettle_s;
  if (posture.inertial && settings_.use_gyro) {
    gyro_ = true;
    const double dt = seconds(posture.inertial->time - last_sample_);
    const double upright = std::cos(3 * kDegree) * std::cos(roll_);
    heading_.add(*posture.inertial, still, upright);
    if (last_sample_ != Time{}) watch_for_a_fall(*posture.inertial, std::clamp(dt, 0.0, 0.1));
    last_sample_ = posture.inertial->time;
  }
  odometry_.add(posture.angle,
                left_share(shape(), phase_ - (balance_ ? 0 : kFootLags_s) / shape().period,
                           steps_.amplitude),
                heading(),
                gyro_ ? std::hypot(heading_.sigma_rad(), kShaking * std::sqrt(odometry_.way()))
                      : 0.3 * std::abs(reckoned_) + 2 * kDegree);
}

void Motion::watch_for_a_fall(const host::Inertial& sample, double dt) {
  const double share = dt / (kForceSmoothing_s + dt);
  forward_g_ += share * (sample.forward_m_per_s2 / kGravity - forward_g_);
  left_g_ += share * (sample.left_m_per_s2 / kGravity - left_g_);
  tipped_s_ = std::hypot(forward_g_, left_g_) > kTipped ? tipped_s_ + dt : 0;
  if (tipped_s_ > kTippedFor_s) {
    state_ = State::fallen;
    wish_ = Wish::stand;
  }
}

void Motion::begin(State state) {
  state_ = state;
  phase_ = 0;
  ending_ = false;
  steps_ = {};
  still_s_ = 0;
  amplitude_before_ = 0;
  heading_before_ = heading();
  state == State::walking ? choose_strides() : choose_reach();
}

void Motion::advance(double dt) {
  if (state_ == State::standing) {
    still_s_ += dt;
    if (wish_ == Wish::walk) begin(State::walking);
    if (wish_ == Wish::turn) begin(State::turning);
    if (state_ == State::standing) return;
  }
  const bool walks = state_ == State::walking;
  if (wish_ != (walks ? Wish::walk : Wish::turn)) ending_ = true;
  const Shape& now = shape();
  dt *= correction_.phase_rate;
  const double before = phase_;
  phase_ += dt / now.period;
  // In the middle of each swing both feet pass below the hips: there strides may change, and nothing
  // leaps.
  const double first = now.lag + 0.25;
  if (std::floor(2 * (phase_ - first)) != std::floor(2 * (before - first))) half_cycle();
  const double ramp =
      ending_ ? -1 / (walks ? kWalkDown : kTurnDown) : 1 / (walks ? kWalkUp : kTurnUp);
  steps_.amplitude = std::clamp(steps_.amplitude + ramp * dt / now.period, 0.0, 1.0);
  roll_ = roll_at(walks ? walk_roll_ : turn_roll_, phase_, steps_.amplitude) + correction_.roll;
  if (!ending_ || steps_.amplitude > 0) return;
  // Finished, or continues with a command received meanwhile.
  const bool more = wish_ == (walks ? Wish::turn : Wish::walk);
  state_ = State::standing;
  if (!more) wish_ = Wish::stand;
  steps_ = {};
  roll_ = 0;
  still_s_ = 0;
}

void Motion::half_cycle() {
  if (state_ == State::walking) {
    reckon_strides();
    if (!ending_) choose_strides();
  } else {
    count_turn();
    if (!ending_) choose_reach();
  }
}

// Chooses strides at full amplitude such that the ramp down ends at the goal.
void Motion::choose_strides() {
  double stride = stride_;
  if (!endless_) {
    const double left = goal_walked_ - walked();
    const double remaining = std::copysign(1.0, stride_) * left;
    const double full = std::abs(stride_);
    if (remaining <= kDownStrides * full) {
      ending_ = true;
      stride = std::copysign(std::clamp(remaining / kDownStrides, 0.0, full), stride_);
    } else if (remaining < (kDownStrides + kHalfStrides) * full) {
      stride = std::copysign(remaining / (kDownStrides + kHalfStrides), stride_);
    }
  }
  double difference = 0;
  if (settings_.hold_heading) {
    difference =
        std::clamp(kStridePerRad * (goal_heading_ - heading()), -kMaxDifference, kMaxDifference);
  }
  steps_.left = stride - difference;
  steps_.right = stride + difference;
}

void Motion::choose_reach() {
  const double left = goal_heading_ - heading();
  if (turned_enough_ || std::abs(left) < kTurnedEnough || ++halves_ > kMaxHalves) {
    turned_enough_ = true;
    ending_ = true;
    steps_.reach = 0;
    if (wish_ == Wish::turn) wish_ = Wish::stand;
    return;
  }
  steps_.reach = settings_.reach * std::clamp(left / turned_a_support_, -1.0, 1.0);
}

// How far the support that is over has turned the robot: measured where there is a gyro, and learnt
// for the next one, because it is friction that decides; else reckoned.
void Motion::count_turn() {
  const double amplitude = (amplitude_before_ + steps_.amplitude) / 2;
  const double share = steps_.reach / settings_.reach * amplitude;
  if (!gyro_) {
    reckoned_ += share * turned_a_support_;
  } else if (std::abs(share) > 0.5) {
    const double turned = (heading() - heading_before_) / share;
    turned_a_support_ +=
        kLearnt *
        (std::clamp(turned, 0.5 * kTurnedASupport, 1.6 * kTurnedASupport) - turned_a_support_);
  }
  heading_before_ = heading();
  amplitude_before_ = steps_.amplitude;
}

void Motion::reckon_strides() {
  if (!gyro_)
    reckoned_ += kTurnedByDifference / 2 * (steps_.right - steps_.left) / 2 * steps_.amplitude;
}

Motion::LegTargets Motion::targets(const host::Posture& posture) {
  LegTargets out;
  JointAngles angles = posture.angle;
  if (state_ != State::fallen) {
    const double roll = state_ == State::turning ? turn_roll_ : walk_roll_;
    Steps steps = steps_;
    steps.left *= correction_.stride;
    steps.right *= correction_.stride;
    steps.roll = correction_.roll;
    steps.lift = correction_.lift;
    steps.height = correction_.height;
    steps.lean += correction_.lean;
    angles = within_limits(legs_at(shape(), roll, phase_, steps));
  }
  if (balance_) balance_->sent(angles);
  for (int i = 0; i < 4; ++i) {
    const auto n = static_cast<std::size_t>(i);
    out[n] = {host::l_hip_roll + i, angles[static_cast<std::size_t>(host::l_hip_roll + i)]};
    out[n + 4] = {host::r_hip_roll + i, angles[static_cast<std::size_t>(host::r_hip_roll + i)]};
  }
  return out;
}

}  // namespace kaz::motion
