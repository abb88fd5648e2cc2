// One joint's potentiometer: from the angle of the output shaft to a fraction of AVCC.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/potentiometer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/board/noise_key.h"

namespace kaz::sim {
namespace {

struct Mounting {
  int sign, centre_decideg;
};

constexpr Mounting kMountings[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) {sign, pot_centre},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

constexpr double kRadPerDecideg = std::numbers::pi / 1800.0;
constexpr double kPotRange_rad = KZ_POT_RANGE_DECIDEG * kRadPerDecideg;

// Position of the wiper in tracks from the lower end; outside 0..1 it has left the track.
double place(int joint, double angle_rad) {
  const Mounting& at = kMountings[static_cast<std::size_t>(joint)];
  return 0.5 + at.sign * (angle_rad - at.centre_decideg * kRadPerDecideg) / kPotRange_rad;
}

}  // namespace

double pot_ratio(int joint, double angle_rad) {
  return std::clamp(place(joint, angle_rad), 0.0, 1.0);
}

Potentiometer::Potentiometer(int joint, const PotentiometerParams& params,
                             const SensorSwitches& switches, std::uint64_t seed)
    : joint_(joint),
      opens_(switches.potentiometer),
      terminal_rad_(params.terminal_rad),
      open_level_(params.open_level) {
  if (!switches.pot_as_built) return;
  const auto number = static_cast<std::uint64_t>(joint);
  offset_rad_ = spread(params.mounting_rad, seed, kPotMounting + number);
  // Longer waves are stronger: 1 : 1/2 : 1/4; the limit is reached if all are at their maximum.
  double share = params.linearity / 1.75;
  for (std::size_t k = 0; k < waves_.size(); ++k, share /= 2)
    waves_[k] = spread(share, seed, kPotLinearity + 8 * number + k);
}

double Potentiometer::ratio(double angle_rad) const {
  const double x = place(joint_, angle_rad + offset_rad_);
  const double beyond_rad = kPotRange_rad * std::max(-x, x - 1);
  if (opens_ && beyond_rad > terminal_rad_) return open_level_;
  if (beyond_rad >= 0) return std::clamp(x, 0.0, 1.0);
  double error = 0;
  for (std::size_t k = 0; k < waves_.size(); ++k)
    error += waves_[k] * std::sin(static_cast<double>(k + 1) * std::numbers::pi * x);
  return std::clamp(x + error, 0.0, 1.0);
}

}  // namespace kaz::sim
