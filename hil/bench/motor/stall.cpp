// Torque at standstill: against voltage, and as the motor warms.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include <Eigen/Dense>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"

namespace kaz::hil {
namespace {

// Without load: at full duty the lowest leaves more than the 4 V below which the board switches off,
// the highest more than 10 V.
constexpr double kSupplies[] = {4.5, 5.0, 5.8, 7.0, 8.2, 9.4, 10.6};
constexpr double kPause = 0.5;  // s between two presses
constexpr double kRead = 0.05;  // s at a press's end in which it is read
// A motor that worked before the bench is warm, and weaker: what it gains at rest shows that.
constexpr double kRest = 60;  // s
constexpr double kRestSupply = 8.2;
// Of the gain at rest, what is missing still after it, at most: 1 / (exp(kRest / tau) - 1) with the
// case's time constant tau of 420 s (motor.xml), where the winding has cooled to its case already; 1.5
// for the winding's.
constexpr double kStillMissing = 6.5;

struct Press {
  double volts = 0;   // at the drivers' terminals
  double torque = 0;  // Nm, in the sense of the drive
  double warmth = 0;  // V2 s since the first press: what has warmed the winding until it was read
};

// `warmth`: before it; then after it.
Press press_once(MotorOnBench& motor, double sign, double& warmth) {
  const double length = motor.stand().pressing_s();
  sure(motor.stand().prepare_press(motor.joint(), sign > 0));
  const Trace trace = motor.drive(sign, length);
  Press press;
  press.volts = mean_volts(trace, length - kRead, length);
  press.torque = sign * sure(motor.stand().scale_nm(motor.joint()));
  const double square = press.volts * press.volts;
  press.warmth = warmth + square * (length - 0.5 * kRead);
  warmth += square * length;
  motor.wait(kPause);
  return press;
}

void hold(MotorOnBench& motor, double at_rad) {
  motor.go_to(at_rad);
  sure(motor.stand().clamp(motor.joint(), true));
}

struct Readings {
  std::vector<Press> positive, negative;
  std::vector<Press> all() const {
    std::vector<Press> both = positive;
    both.insert(both.end(), negative.begin(), negative.end());
    return both;
  }
};

// Up and down again, to separate the effects of temperature and voltage.
Readings read_all(MotorOnBench& motor) {
  std::vector<double> supplies(std::begin(kSupplies), std::end(kSupplies));
  supplies.insert(supplies.end(), std::rbegin(kSupplies), std::rend(kSupplies));
  Readings readings;
  double warmth = 0;
  for (const double supply : supplies) {
    motor.set_supply(supply);
    for (const double sign : {1.0, -1.0}) {
      (sign > 0 ? readings.positive : readings.negative).push_back(press_once(motor, sign, warmth));
    }
  }
  return readings;
}

// torque = slope volts - fading volts warmth - friction, by least squares: `slope` is that of a cold
// motor, whose winding's resistance grows with what has been pressed into it.
struct ColdLine {
  Line line;
  double fading = 0;
  double cold_torque(const Press& press) const {
    return press.torque + fading * press.volts * press.warmth;
  }
};

ColdLine fit_cold(const std::vector<Press>& presses) {
  const auto n = static_cast<Eigen::Index>(presses.size());
  Eigen::MatrixX3d factors(n, 3);
  Eigen::VectorXd torques(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Press& press = presses[static_cast<std::size_t>(i)];
    factors.row(i) << press.volts, -press.volts * press.warmth, 1;
    torques(i) = press.torque;
  }
  const Eigen::Vector3d found = factors.colPivHouseholderQr().solve(torques);
  const Eigen::VectorXd off = torques - factors * found;
  const Eigen::Matrix3d spread =
      (factors.transpose() * factors).inverse() * off.squaredNorm() / static_cast<double>(n - 3);
  ColdLine cold;
  cold.line = {found(2), found(0), std::sqrt(spread(2, 2)), std::sqrt(spread(0, 0)),
               off.cwiseAbs().maxCoeff()};
  cold.fading = found(1);
  return cold;
}

Points points_of(const std::vector<Press>& presses, const ColdLine& cold) {
  Points points;
  for (const Press& press : presses) points.emplace_back(press.volts, cold.cold_torque(press));
  return points;
}

// The torque at these volts by the readings around them alone, and its standard error: a circuit may
// give less at others than the line of all readings has.
std::pair<double, double> near(const Points& points, double volts) {
  constexpr double kAround = 1;  // V
  Points around;
  for (const auto& [v, torque] : points) {
    if (std::abs(v - volts) <= kAround) around.emplace_back(v - volts, torque);
  }
  const Line line = fit_line(around);
  return {line.at_zero, line.at_zero_error};
}

Plot stall_plot(const std::string& joint, const Readings& readings, const ColdLine& cold) {
  const Line& line = cold.line;
  Series fitted{"line", Series::Style::line, {{-line.at_zero / line.slope, 0}, {10.5, line(10.5)}}};
  return {"stall",
          joint,
          "Torque at standstill",
          "motor voltage, V",
          "torque, Nm",
          false,
          {{"positive", Series::Style::points, points_of(readings.positive, cold)},
           {"negative", Series::Style::points, points_of(readings.negative, cold)},
           fitted,
           {"paper, section 2.1", Series::Style::points, {{4.8, 0.97}, {10, 2.16}}}},
          "The voltage is measured at the driver's terminals under load. Each torque is converted "
          "to the torque of a cold motor. The slope of the line is the torque per volt. At "
          "0 V, the extended line reaches a negative torque. Its absolute value is the sliding "
          "friction."};
}

// Presses to both sides, then a rest of kRest. None where somebody has to press.
std::vector<Press> press_and_rest(MotorOnBench& motor, double supply) {
  if (motor.stand().pressing_s() > 0.5) return {};
  motor.set_supply(supply);
  double warmth = 0;
  std::vector<Press> presses;
  for (const double sign : {1.0, -1.0}) presses.push_back(press_once(motor, sign, warmth));
  motor.wait(kRest);
  return presses;
}

// The share of its torque that a motor has gained since those presses, for what had warmed it before them.
// `torque` of volts: after the rest. `fading`: share lost for each V2 s; 0.6 of what the presses themselves
// took is missing still after the rest.
double gain_at_rest(const std::vector<Press>& before, double fading,
                    const std::function<double(double volts)>& torque) {
  constexpr double kScatter = 0.002;  // of two presses
  if (before.empty()) return 0;
  fading = std::max(0.0, fading);
  double gain = 0;
  for (const Press& press : before) {
    check(press.torque > 0, "the motor exerts no torque on the stand");
    gain += torque(press.volts) / (press.torque * (1 + fading * press.warmth)) - 1 +
            0.6 * fading * before.back().warmth;
  }
  gain /= static_cast<double>(before.size());
  return gain > kScatter ? gain : 0;
}

std::string was_warm(double gain) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the motor was warm: its torque grew by %.1f %% while the motor rested for %.0f s; let the "
      "motor cool, then measure again (after hard work, cooling takes 20 minutes)",
      100 * gain, kRest);
  return text;
}

}  // namespace

double measure_stall(MotorOnBench& motor, BenchJudge& judge, double supply_volts) {
  hold(motor, motor.middle_rad());
  const std::vector<Press> before = press_and_rest(motor, kRestSupply);
  const Readings readings = read_all(motor);
  const std::vector<Press> all = readings.all();
  const ColdLine cold = fit_cold(all);
  const Line& line = cold.line;
  check(line.slope > 0, "the torque does not increase with the voltage");
  const std::size_t first = judge.report().measurements.size();
  const Points points = points_of(all, cold);
  const auto torque_at = [&](const char* name, double volts) {
    const auto [torque, error] = near(points, volts);
    judge.enter(motor.name(), name, torque, error);
  };
  torque_at("stall.torque_4v8", 4.8);
  torque_at("stall.torque_10v", 10);
  judge.enter(motor.name(), "stall.slope", line.slope, line.slope_error);
  const double gain = gain_at_rest(before, cold.fading / line.slope, line);
  judge.doubt(first, 1 + kStillMissing * gain, was_warm(gain));
  sure(motor.stand().clamp(motor.joint(), false));
  motor.set_supply(supply_volts);
  double max_torque = 0;
  for (const Press& press : all) max_torque = std::max(max_torque, press.torque);
  judge.enter(motor.name(), "stall.line_error", 100 * line.worst / max_torque);
  const Line plus = fit_line(points_of(readings.positive, cold));
  const Line minus = fit_line(points_of(readings.negative, cold));
  judge.enter(motor.name(), "stall.asymmetry", 100 * (plus(7) / minus(7) - 1));
  judge.enter(motor.name(), "friction.sliding", -line.at_zero, line.at_zero_error);
  judge.add(stall_plot(motor.name(), readings, cold));
  return line.slope;
}

void measure_heat(MotorOnBench& motor, BenchJudge& judge, double supply_volts) {
  constexpr double kSupply = 6.5, kSeconds = 10, kBetween = 2, kRenewed = 0.4;
  hold(motor, motor.middle_rad());
  const std::vector<Press> before = press_and_rest(motor, kSupply);
  motor.set_supply(kSupply);
  Series shown{"torque", Series::Style::points, {}};
  double pressed_s = 0;
  const auto read = [&] {
    // Anew: a motor that weakens while it presses is held up by its friction.
    motor.wait(0.05);
    double warmth = 0;
    const double torque = press_once(motor, 1, warmth).torque;
    shown.points.emplace_back(pressed_s, torque);
    return torque;
  };
  const double cold = read();
  check(cold > 0.1, "the motor exerts no torque on the stand");
  double warm = cold;
  while (pressed_s < kSeconds - 0.5 * kBetween) {
    for (double left = kBetween; left > 0.5 * kRenewed; left -= kRenewed) {
      motor.keep_driving(1, kRenewed + 0.1);
      motor.wait(kRenewed);
    }
    pressed_s += kBetween;
    motor.keep_driving(0, 0.001);
    // Whoever reads the scale by eye would let it cool meanwhile.
    const bool last = pressed_s > kSeconds - 0.5 * kBetween;
    if (last || motor.stand().pressing_s() < 0.5) warm = read();
  }
  sure(motor.stand().clamp(motor.joint(), false));
  motor.set_supply(supply_volts);
  // Of all readings where there are several: the motor's friction leaves each some milli-Nm aside.
  const Line line = fit_line(shown.points);
  const bool fitted = std::isfinite(line.slope);
  const double kept = fitted ? line(kSeconds) / line(0) : warm / cold;
  const std::size_t first = judge.report().measurements.size();
  judge.enter(motor.name(), "thermal.torque_loss", 100 * (1 - kept),
              fitted ? 100 * kSeconds * line.slope_error / line(0) : 0);
  // Resistance is higher by what is missing: current and power are lower, and a share of it is less.
  const double rested = fitted ? line(0) : cold;
  const double gain = gain_at_rest(before, (1 - kept) / (kSupply * kSupply * kSeconds),
                                   [rested](double) { return rested; });
  const double missing = kStillMissing * gain;
  judge.doubt(first, (1 + missing) * (1 + missing), was_warm(gain));
  judge.add({"thermal",
             motor.name(),
             "Torque at the clamped shaft",
             "duration of pressing at 6.5 V, s",
             "torque, Nm",
             false,
             {shown},
             "The torque drops because the copper's resistance grows as the motor warms. Each "
             "point is a separate press. Before the press, the motor was off for 50 ms."});
}

}  // namespace kaz::hil
