// Servos with effects that no fitted model has.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/truth_testing.h"

#include <cmath>
#include <deque>
#include <random>

namespace kaz::hil::truth {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Servo {
  double k, ohm, rotor;                // N m/A, ohm, kg m2
  double dry, wet, extra, slow;        // N m, N m s/rad, N m at rest, rad/s
  double forward_loss, backward_loss;  // shares of what the gear passes on
  double bristle;                      // rad until they slide
  double ripple, teeth;                // share of the torque, a turn
  double cable, cable_at;              // N m/rad, rad
  double warms;                        // share of the resistance a W s
  double supply, sag;                  // V, ohm
  double gain;                         // duty a rad at most
  double clock, late;                  // share, s
  double zero;                         // rad
};

Servo drawn(std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919 + 17);
  const auto about = [&random](double middle, double share) {
    std::uniform_real_distribution<double> spread(1 - share, 1 + share);
    return middle * spread(random);
  };
  const bool small = seed % 2 == 0;
  Servo s{};
  s.k = about(small ? 0.37 : 1.6, 0.1);
  s.ohm = about(small ? 2.8 : 2.6, 0.15);
  s.rotor = about(small ? 0.0019 : 0.012, 0.15);
  s.dry = about(small ? 0.008 : 0.05, 0.3);
  s.wet = about(small ? 0.005 : 0.02, 0.3);
  s.extra = about(small ? 0.006 : 0.06, 0.3);
  s.slow = about(0.5, 0.4);
  s.forward_loss = about(0.22, 0.2);
  s.backward_loss = about(0.34, 0.2);
  s.bristle = about(0.004, 0.5);
  s.ripple = about(0.02, 0.5);
  s.teeth = small ? 11 : 9;
  s.cable = about(small ? 0.003 : 0.02, 0.5);
  s.cable_at = about(0.3, 0.5);
  s.warms = about(small ? 0.0015 : 0.0004, 0.5);
  s.supply = small ? 5.0 : 12.0;
  s.sag = about(0.15, 0.5);
  s.gain = small ? 1.15 : 5.0;
  s.clock = about(0.002, 0.9);
  s.late = about(0.002, 0.5);
  s.zero = about(0.01, 0.9);
  return s;
}

double cubic(double t, double t0, double t1, double a, double b) {
  const double x = std::fmin(1, std::fmax(0, (t - t0) / (t1 - t0)));
  return a + (b - a) * x * x * (3 - 2 * x);
}

double goal(Motion motion, double t) {
  switch (motion) {
    case Motion::sine_of_square:
      return std::sin(t * t);
    case Motion::lift_and_drop:
      return cubic(t, 0, 2, 0, -kPi / 2);
    case Motion::up_and_down:
      return t < 3 ? cubic(t, 0, 3, 0, kPi / 2) : cubic(t, 3, 6, kPi / 2, 0.4 * kPi);
    case Motion::two_sines:
      return std::sin(t) * kPi / 2 + std::sin(5 * t) * 0.5 * std::sin(2 * t);
    case Motion::steps:
      return static_cast<int>(t) % 2 == 0 ? 0 : 1;
  }
  return 0;
}

}  // namespace

Swing swing(std::uint64_t seed, Motion motion, double mass_share, double gain_share, double seconds,
            const Planted& planted) {
  Servo s = drawn(seed);
  if (planted.plain) {
    s.ripple = s.cable = s.warms = s.sag = s.clock = s.late = s.zero = s.extra = 0;
    s.bristle = 2e-4;
  }
  const bool small = seed % 2 == 0;
  Swing made{(small ? 0.15 : 0.9) * mass_share,
             small ? 0.1 : 0.15,
             small ? 0.008 : 0.03,
             s.gain * gain_share,
             0.95,
             {}};
  std::mt19937_64 random(seed ^ (static_cast<std::uint64_t>(1e3 * mass_share) << 20) ^
                         (static_cast<std::uint64_t>(1e3 * gain_share) << 36) ^
                         static_cast<std::uint64_t>(motion));
  std::normal_distribution<double> noise(0, 1);
  const double l = made.length_m;
  const double inertia = made.mass_kg * l * l + made.arm_kg * l * l / 3 + s.rotor;
  const double weight = (made.mass_kg + made.arm_kg / 2) * 9.80665 * l;
  constexpr double h = 5e-5;
  const double step = 2 * kPi / 4096;
  double q = 0, v = 0, z = 0, heat = 0, amps = 0, volts = s.supply;
  double next = 0, setpoint = 0, driven = 0;
  // Goals and torque switches on their way to the servo.
  std::deque<std::pair<double, bool>> sent(static_cast<std::size_t>(planted.delay / h),
                                           {goal(motion, 0), true});
  for (long i = 0; i * h <= seconds; ++i) {
    const double t = static_cast<double>(i) * h;
    const bool sent_on = motion != Motion::lift_and_drop || t < 2;
    // The client sends a goal with each reading.
    const double wanted = goal(motion, 0.01 * std::floor(t / 0.01 + 1e-6));
    sent.emplace_back(wanted, sent_on);
    const auto [arrived, on] = sent.front();
    sent.pop_front();
    const double zero = s.zero + planted.zero;
    const double seen = planted.plain ? q + zero : step * std::round((q + zero) / step);
    if (!on) setpoint = seen;
    setpoint += std::fmin(planted.slew * h, std::fmax(-planted.slew * h, arrived - setpoint));
    double off = setpoint - seen;
    if (!planted.plain && std::fabs(off) < step) off = 0;
    const double pushes = std::fmin(0.95, std::fmax(-0.95, made.gain_per_rad * off));
    driven = planted.lag > 0 ? driven + (pushes - driven) * h / planted.lag : pushes;
    if (!on) driven = 0;
    const double duty = driven;
    volts = s.supply - s.sag * std::fabs(amps * duty);
    const double ohm = s.ohm * (1 + s.warms * heat);
    amps = on ? (duty * volts - s.k * v) / ohm : 0;
    heat += (amps * amps * s.ohm - 0.02 * heat) * h;
    const double pushed = s.k * amps * (1 + s.ripple * std::sin(s.teeth * q));
    const double pulled = -weight * std::sin(q) - s.cable * (q - s.cable_at);
    // The gear passes on what the motor pushes or what pulls at the shaft, whichever leads the motion.
    const bool leads = pushed * v >= 0 && std::fabs(pushed) > 1e-9;
    const double lost =
        planted.plain ? s.forward_loss * std::fabs(pushed - pulled)
        : leads       ? s.forward_loss * std::fabs(pushed)
                      : s.backward_loss * std::fmin(std::fabs(pulled), std::fabs(pushed) + s.dry);
    const double most =
        s.dry + (on ? 0 : planted.coasting) + lost + s.extra / (1 + (v / s.slow) * (v / s.slow));
    // Bristles (Dahl): a spring that slides at `most`.
    z += (v - std::fabs(v) * z / s.bristle) * h;
    z = std::fmin(s.bristle, std::fmax(-s.bristle, z));
    const double brake =
        most * z / s.bristle + s.wet * v +
        0.3 * std::sqrt(most * inertia / s.bristle) * (1 - std::fabs(z) / s.bristle) * v;
    v += (pushed + pulled - brake) / inertia * h;
    q += v * h;
    if (t + 1e-9 < next) continue;
    next += 0.01;
    // Read a little after the time that is written down, by a clock that runs apart.
    made.readings.push_back({t * (1 + s.clock) - s.late, wanted,
                             step * std::round((q + zero) / step),
                             0.1 * std::round(10 * (volts + 0.02 * noise(random))),
                             0.0065 * std::round((amps + 0.01 * noise(random)) / 0.0065), sent_on});
  }
  return made;
}

}  // namespace kaz::hil::truth
