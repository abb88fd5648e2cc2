// Noise, line and zero of a joint's potentiometer.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/samples.h"
#include "shared/base/angle.hpp"
#include "shared/board/table.h"

namespace kaz::hil {
namespace {

constexpr double kRange = 2e-4 * KZ_POT_HALF_SPAN;  // rad
constexpr double kCode = kRange / 1024;
constexpr int kPlaces = 13;
constexpr double kMargin = 0.05;  // rad, from the soft limits
constexpr double kFollows = 0.2;  // share of the shaft's turns; less is no error of the scale
// So near an end of the converter's range, a reading that does not move is none: that of a wiper which
// touches a supply through some ohms.
constexpr double kRailCodes = 12, kRailNoise = 0.05;

Plot line_plot(const std::string& joint, const Points& read, const Line& line) {
  Series off{"deviation from the line", Series::Style::line, {}};
  for (const auto& [turned, measured] : read)
    off.points.emplace_back(turned / kDegree, (measured - line(turned)) / kDegree);
  return {"potentiometer",
          joint,
          "Potentiometer against protractor",
          "shaft, degrees",
          "deviation, degrees",
          false,
          {off},
          "Measured angle minus the straight line through all positions."};
}

}  // namespace

void measure_potentiometer_noise(MotorOnBench& motor, BenchJudge& judge) {
  std::vector<double> codes;
  motor.check_potentiometer();
  for (const Sample& sample : motor.watch(2)) {
    // The ends of the potentiometer's range are beyond the joint's.
    check(sample.angle_rad > motor.lower_rad() - kMargin &&
              sample.angle_rad < motor.upper_rad() + kMargin,
          "the potentiometer reads an angle beyond the joint's limits: check the potentiometer's "
          "three wires");
    codes.push_back(sample.angle_rad / kCode);
  }
  motor.check_potentiometer();  // it may have gone meanwhile
  // Less than that is the rounding of sums.
  const double noise = std::round(1e6 * standard_deviation(codes)) / 1e6;
  const double code = motor.potentiometer_code(kCode * mean_of(codes).value);
  char text[160];
  std::snprintf(text, sizeof text,
                "the potentiometer constantly reads A/D code %.0f, at an end of its range: its "
                "wiper is open or touches a supply",
                code);
  check(noise > kRailNoise || (code > kRailCodes && code < KZ_POT_CODES - 1 - kRailCodes), text);
  judge.enter(motor.name(), "pot.noise", noise,
              noise / std::sqrt(2.0 * static_cast<double>(codes.size())));
}

void measure_potentiometer_line(MotorOnBench& motor, BenchJudge& judge) {
  Stand& stand = motor.stand();
  const double low = motor.lower_rad() + kMargin, high = motor.upper_rad() - kMargin;
  Points read;
  motor.check_potentiometer();
  for (int place = 0; place < kPlaces; ++place) {
    const double goal = low + (high - low) * place / (kPlaces - 1);
    const double turned = sure(stand.turn(motor.joint(), goal));
    read.emplace_back(turned, mean_angle(motor.watch(0.5)));
  }
  sure(stand.let_go(motor.joint()));
  const Line line = fit_line(read);
  char text[160];
  std::snprintf(text, sizeof text,
                "the reading changes by only %.1f %% of the shaft's motion: the wiper or its gear "
                "is loose, or the potentiometer belongs to another joint",
                100 * line.slope);
  check(std::abs(line.slope) > kFollows, text);
  judge.enter(motor.name(), "pot.linearity", 100 * line.worst / kRange);
  judge.enter(motor.name(), "pot.scale", 100 * (line.slope - 1), 100 * line.slope_error);
  judge.enter(motor.name(), "pot.offset", line.at_zero / kDegree, line.at_zero_error / kDegree);
  judge.add(line_plot(motor.name(), read, line));
}

}  // namespace kaz::hil
