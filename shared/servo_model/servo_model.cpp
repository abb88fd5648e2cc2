// Model of a geared bus servo: control law, motor and friction.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_model/servo_model.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kaz::servo_model {
namespace {

using P = ServoParams;

constexpr ServoParamInfo kKt{"kt", "N m/A", &P::kt, 0.02, 20, 0.1};
constexpr ServoParamInfo kResistance{"resistance", "ohm", &P::resistance, 0.1, 100, 0.3};
constexpr ServoParamInfo kArmature{"armature", "kg m2", &P::armature, 1e-5, 1, 1e-3};
constexpr ServoParamInfo kBase{"base", "N m", &P::base, 0, 5, 0.01};
constexpr ServoParamInfo kViscous{"viscous", "N m s/rad", &P::viscous, 0, 10, 0.01};
constexpr ServoParamInfo kGain{"gain_ratio", "1", &P::gain_ratio, 0.5, 2, 0.1};
constexpr ServoParamInfo kBias{"error_bias", "rad", &P::error_bias, 0, 0.02, 5e-4};
constexpr ServoParamInfo kDelay{"delay", "s", &P::delay, 0, 0.1, 5e-3};
constexpr ServoParamInfo kSlew{"slew", "rad/s", &P::slew, 0.2, 100, 0.5};
constexpr ServoParamInfo kLag{"lag", "s", &P::lag, 0, 0.05, 5e-3};
constexpr ServoParamInfo kMostCurrent{"most_current", "A", &P::most_current, 0.02, 1000, 0.1};
constexpr ServoParamInfo kCoasting{"coasting", "N m", &P::coasting, 0, 1, 0.02};
constexpr ServoParamInfo kStribeck{"stribeck", "N m", &P::stribeck, 0, 5, 0.01};
constexpr ServoParamInfo kStribeckSpeed{
    "stribeck_speed", "rad/s", &P::stribeck_speed, 0.02, 10, 0.5};
constexpr ServoParamInfo kStribeckPower{"stribeck_power", "1", &P::stribeck_power, 0.5, 4, 0.5};
constexpr ServoParamInfo kLoad{"load", "1", &P::load, 0, 0.9, 0.05};
constexpr ServoParamInfo kLoadStribeck{"load_stribeck", "1", &P::load_stribeck, 0, 0.9, 0.05};
constexpr ServoParamInfo kMotor{"motor", "1", &P::motor, 0, 0.9, 0.05};
constexpr ServoParamInfo kExternal{"external", "1", &P::external, 0, 0.9, 0.05};
constexpr ServoParamInfo kMotorStribeck{"motor_stribeck", "1", &P::motor_stribeck, 0, 0.9, 0.05};
constexpr ServoParamInfo kExternalStribeck{
    "external_stribeck", "1", &P::external_stribeck, 0, 0.9, 0.05};
constexpr ServoParamInfo kMotorQuad{"motor_quad", "1/(N m)", &P::motor_quad, 0, 1, 0.02};
constexpr ServoParamInfo kExternalQuad{"external_quad", "1/(N m)", &P::external_quad, 0, 1, 0.02};

constexpr double kBiasRamp = 3e-3;  // rad: below this error, the bias is proportional to the error

template <std::size_t N>
constexpr auto with_law(const std::array<ServoParamInfo, N>& friction) {
  constexpr std::array law{kKt,   kResistance, kArmature, kBase, kViscous, kCoasting,
                           kGain, kBias,       kDelay,    kSlew, kLag,     kMostCurrent};
  std::array<ServoParamInfo, law.size() + N> all{};
  std::ranges::copy(friction, std::ranges::copy(law, all.begin()).out);
  return all;
}

constexpr auto kM1 = with_law(std::array<ServoParamInfo, 0>{});
constexpr auto kM2 = with_law(std::array{kStribeck, kStribeckSpeed, kStribeckPower});
constexpr auto kM3 = with_law(std::array{kLoad});
constexpr auto kM4 =
    with_law(std::array{kStribeck, kStribeckSpeed, kStribeckPower, kLoad, kLoadStribeck});
constexpr auto kM6 =
    with_law(std::array{kStribeck, kMotor, kStribeckSpeed, kStribeckPower, kExternal,
                        kMotorStribeck, kExternalStribeck, kMotorQuad, kExternalQuad});

}  // namespace

std::span<const ServoParamInfo> servo_params(int model) {
  switch (model) {
    case 1:
      return kM1;
    case 2:
      return kM2;
    case 3:
      return kM3;
    case 4:
      return kM4;
    case 5:
      return std::span(kM6).first(kM6.size() - 2);
    default:
      return kM6;
  }
}

double friction_limit(int model, const ServoParams& p, double speed, double motor_nm,
                      double external_nm, bool driven) {
  const double between = std::abs(motor_nm - external_nm);
  double limit = p.base + p.viscous * std::abs(speed) + (driven ? 0 : p.coasting);
  if (model == 3 || model == 4) limit += p.load * between;
  if (model >= 5) limit += std::abs(p.motor * motor_nm - p.external * external_nm);
  if (model == 1 || model == 3) return limit;
  double slow = p.stribeck;
  if (model == 4) slow += p.load_stribeck * between;
  if (model >= 5) slow += std::abs(p.motor_stribeck * motor_nm - p.external_stribeck * external_nm);
  if (model == 6 && motor_nm * external_nm < 0)
    slow += std::abs(motor_nm) > std::abs(external_nm) ? p.external_quad * external_nm * external_nm
                                                       : p.motor_quad * motor_nm * motor_nm;
  double share = std::abs(speed) / p.stribeck_speed;
  if (p.stribeck_power != 1) share = std::pow(share, p.stribeck_power);
  return limit + slow * std::exp(-share);
}

double ServoLaw::advance(const ServoCommand& command, double angle_rad, double dt) {
  const ServoParams& p = *params_;
  if (!command.torque_on) {
    setpoint_ = angle_rad;
    duty_ = 0;
    return 0;
  }
  const double most = p.slew * dt;
  const double change = std::clamp(command.goal_rad - setpoint_, -most, most);
  setpoint_ += change;
  // The setpoint moves at the speed `slew` and then rests: this is its mean.
  const double error = setpoint_ - change * std::abs(change) / (2 * most) - angle_rad;
  const double bias = p.error_bias * std::clamp(error / kBiasRamp, -1.0, 1.0);
  const double wanted = command.gain_per_rad * (p.gain_ratio * error + bias) + command.more_duty;
  const double target = std::clamp(wanted, -command.most_duty, command.most_duty);
  if (dt != dt_) {
    dt_ = dt;
    left_ = p.lag > 0 ? std::exp(-dt / p.lag) : 0;
    mean_left_ = (1 - left_) * p.lag / dt;
  }
  const double off = duty_ - target;
  duty_ = target + off * left_;
  return target + off * mean_left_;
}

double ServoDrive::advance(const ServoCommand& command, double angle_rad, double speed, double dt) {
  const double duty = law_.advance(command, angle_rad, dt);
  if (!command.torque_on) return 0;
  const double current = (command.volts * duty - params_->kt * speed) / params_->resistance;
  return std::clamp(current, -params_->most_current, params_->most_current);
}

double speed_after(double speed, double torque_nm, double friction_nm, double inertia, double dt) {
  const double stop = inertia / dt * speed + torque_nm;
  const double friction = -std::copysign(std::min(std::abs(stop), friction_nm), stop);
  return speed + (torque_nm + friction) / inertia * dt;
}

}  // namespace kaz::servo_model
