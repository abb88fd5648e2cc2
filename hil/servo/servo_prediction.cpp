// Predicts the motion of a log's pendulum by the servo model.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_prediction.h"

#include <algorithm>
#include <cmath>

namespace kaz::hil {
namespace {

constexpr double kAway = 100;       // rad: the model has diverged
constexpr double kSameTime = 1e-6;  // s: shorter steps would only add rounding errors

// Sample whose goal the servo uses: each goal holds until the next sample, and all goals act late.
class DelayedGoal {
 public:
  DelayedGoal(const ServoLog& log, double delay) : samples_(log.samples), delay_(delay) {}

  const ServoSample& at(double time_s) {
    while (at_ + 1 < samples_.size() && samples_[at_ + 1].time_s + delay_ <= time_s + kSameTime)
      ++at_;
    return samples_[at_];
  }
  // Time of the next change, but at most `end_s`.
  double next_change(double end_s) const {
    if (at_ + 1 == samples_.size()) return end_s;
    const double next = samples_[at_ + 1].time_s + delay_;
    return next + kSameTime < end_s ? next : end_s;
  }

 private:
  const std::vector<ServoSample>& samples_;
  double delay_;
  std::size_t at_ = 0;
};

// Servo and pendulum, advanced in steps of the leapfrog method: torques act in the middle of a step, where
// the speed is extrapolated.
class Pendulum {
 public:
  Pendulum(int model, const ServoParams& params, const ServoLog& log, double zero_rad)
      : model_(model),
        params_(params),
        inertia_(log.load_kgm2() + params.armature),
        weight_(log.gravity_nm()),
        zero_(zero_rad),
        drive_(params, log.samples[0].goal_rad),
        angle_(log.samples[0].position_rad - zero_rad) {}

  void step(const servo_model::ServoCommand& command, double dt) {
    angle_ += 0.5 * dt * speed_;
    const double speed = speed_ + 0.5 * dt * acceleration_;
    current_ = drive_.advance(command, reading(), speed, dt);
    const double motor = params_.kt * current_, external = -weight_ * std::sin(angle_);
    const double friction =
        servo_model::friction_limit(model_, params_, speed, motor, external, command.torque_on);
    const double before = speed_;
    speed_ = servo_model::speed_after(speed_, motor + external, friction, inertia_, dt);
    acceleration_ = (speed_ - before) / dt;
    angle_ += 0.5 * dt * speed_;
    if (std::abs(angle_) < kAway) return;
    angle_ = std::copysign(kAway, angle_);
    speed_ = acceleration_ = 0;
  }
  double reading() const { return angle_ + zero_; }
  double current() const { return current_; }

 private:
  int model_;
  const ServoParams& params_;
  double inertia_, weight_, zero_;
  servo_model::ServoDrive drive_;
  double angle_, speed_ = 0, acceleration_ = 0, current_ = 0;
};

}  // namespace

Prediction predict(int model, const ServoParams& p, const ServoLog& log, double zero_rad,
                   double step_s) {
  Prediction all;
  const std::size_t n = log.samples.size();
  all.position_rad.reserve(n);
  all.current_a.reserve(n);
  Pendulum pendulum(model, p, log, zero_rad);
  DelayedGoal goal(log, p.delay);
  servo_model::ServoCommand command{0, 0, log.gain_per_rad, log.most_duty, true};
  for (std::size_t i = 0; i < n; ++i) {
    all.position_rad.push_back(pendulum.reading());
    all.current_a.push_back(pendulum.current());
    if (i + 1 == n) break;
    command.volts = log.samples[i].volts;
    const double end = log.samples[i + 1].time_s;
    for (double time = log.samples[i].time_s; time < end;) {
      const ServoSample& used = goal.at(time);
      command.goal_rad = used.goal_rad;
      command.torque_on = used.torque_on;
      const double until = goal.next_change(end), span = until - time;
      const int steps = std::max(1, static_cast<int>(std::ceil(span / step_s - 0.1)));
      for (int k = 0; k < steps; ++k) pendulum.step(command, span / steps);
      time = until;
    }
  }
  return all;
}

}  // namespace kaz::hil
