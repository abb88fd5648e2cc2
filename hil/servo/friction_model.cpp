// Friction of a geared servo, as six models of growing detail.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/friction_model.h"

#include <cmath>

namespace kaz::hil {
namespace {

using P = ServoParams;

constexpr ServoParamInfo kKt{"kt", "N m/A", &P::kt, 0.02, 20, 0.1};
constexpr ServoParamInfo kResistance{"resistance", "ohm", &P::resistance, 0.1, 100, 0.3};
constexpr ServoParamInfo kArmature{"armature", "kg m2", &P::armature, 1e-5, 1, 1e-3};
constexpr ServoParamInfo kBase{"base", "N m", &P::base, 0, 5, 0.01};
constexpr ServoParamInfo kViscous{"viscous", "N m s/rad", &P::viscous, 0, 10, 0.01};
constexpr ServoParamInfo kGain{"gain_ratio", "1", &P::gain_ratio, 0.5, 2, 0.1};
constexpr ServoParamInfo kOffset{"offset", "rad", &P::offset, -0.2, 0.2, 0.01};
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

// M1 is the beginning of M2, M5 that of M6.
constexpr std::array kM2{kKt,   kResistance, kArmature, kBase,          kViscous,
                         kGain, kOffset,     kStribeck, kStribeckSpeed, kStribeckPower};
constexpr std::array kM3{kKt, kResistance, kArmature, kBase, kViscous, kGain, kOffset, kLoad};
constexpr std::array kM4{kKt,   kResistance,  kArmature, kBase,          kViscous,
                         kGain, kOffset,      kStribeck, kStribeckSpeed, kStribeckPower,
                         kLoad, kLoadStribeck};
constexpr std::array kM6{kKt,
                         kResistance,
                         kArmature,
                         kBase,
                         kViscous,
                         kGain,
                         kOffset,
                         kStribeck,
                         kMotor,
                         kStribeckSpeed,
                         kStribeckPower,
                         kExternal,
                         kMotorStribeck,
                         kExternalStribeck,
                         kMotorQuad,
                         kExternalQuad};

}  // namespace

std::span<const ServoParamInfo> servo_params(int model) {
  switch (model) {
    case 1:
      return std::span(kM2).first(7);
    case 2:
      return kM2;
    case 3:
      return kM3;
    case 4:
      return kM4;
    case 5:
      return std::span(kM6).first(14);
    default:
      return kM6;
  }
}

double friction_limit(int model, const ServoParams& p, double speed, double motor_nm,
                      double external_nm) {
  const double between = std::abs(motor_nm - external_nm);
  double limit = p.base + p.viscous * std::abs(speed);
  if (model == 3 || model == 4) limit += p.load * between;
  if (model >= 5) limit += std::abs(p.motor * motor_nm - p.external * external_nm);
  if (model == 1 || model == 3) return limit;
  double slow = p.stribeck;
  if (model == 4) slow += p.load_stribeck * between;
  if (model >= 5) slow += std::abs(p.motor_stribeck * motor_nm - p.external_stribeck * external_nm);
  if (model == 6 && motor_nm * external_nm < 0)
    slow += std::abs(motor_nm) > std::abs(external_nm) ? p.external_quad * external_nm * external_nm
                                                       : p.motor_quad * motor_nm * motor_nm;
  return limit + slow * std::exp(-std::pow(std::abs(speed) / p.stribeck_speed, p.stribeck_power));
}

}  // namespace kaz::hil
