// joint_table: calibrates robots "as built" by seed, and prints the errors that are left, by ground truth.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "host/calibration/joint_readings.h"
#include "shared/base/angle.hpp"
#include "shared/base/enum_names.hpp"
#include "tests/studies/common/calibrated.h"
#include "tests/studies/common/disturbed_robot.h"

namespace {

using namespace kaz;
using studies::JointLines;

constexpr int kAngles = 41;  // of each joint, from limit to limit

struct Arguments {
  std::uint64_t first = 1, seeds = 20;
  std::string mcu = "native";
};

// Absolute errors, degrees: at every angle of every robot, and the largest of each robot.
struct Errors {
  std::vector<double> all, worst;
  void add(const std::vector<double>& errors) {
    double largest = 0;
    for (const double error : errors) {
      all.push_back(std::abs(error) / kDegree);
      largest = std::max(largest, all.back());
    }
    worst.push_back(largest);
  }
  void add(const Errors& other) {
    all.insert(all.end(), other.all.begin(), other.all.end());
    worst.insert(worst.end(), other.worst.begin(), other.worst.end());
  }
};

// The smallest value that 95 % do not exceed.
double share95(std::vector<double> values) {
  std::ranges::sort(values);
  return values[(values.size() * 95 + 99) / 100 - 1];
}

void print_row(const char* name, const Errors& before, const Errors& stops, const Errors& all) {
  std::printf("| %s | %.2f | %.2f | %.2f | %.2f | %.2f |\n", name, share95(before.all),
              share95(stops.all), share95(all.all), share95(stops.worst), share95(all.worst));
}

Result<void> run(const Arguments& arguments) {
  const auto params = KAZ_TRY(sim::load_sensor_file(std::string(KAZ_ROBOT) + "/sensors.xml"));
  std::array<Errors, KZ_JOINTS> before, stops, all;
  double squares = 0, expected = 0, longest = 0, residual = 0;
  for (std::uint64_t seed = arguments.first; seed < arguments.first + arguments.seeds; ++seed) {
    const auto files = KAZ_TRY(studies::disturbed_files(KAZ_ROBOT, {}, seed));
    sim::SimulationOptions options;
    options.mcu = parse_enum(sim::kMcuKinds, arguments.mcu).value();
    options.image_path = KAZ_FIRMWARE_IMAGE;
    options.seed = seed;
    options.world_path = files.world();
    options.robot_path = files.robot();
    options.camera_path = files.camera();
    options.imu = true;
    options.sensors = sim::SensorSet::as_built;
    const auto done = KAZ_TRY(studies::calibrate_joints(options));
    longest = std::max(longest, done.seconds);
    residual = std::max(residual, done.worst_residual);
    double worst = 0;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto i = static_cast<std::size_t>(j);
      const auto errors = [&](const host::JointCalibration& line) {
        return studies::true_errors(params, sim::SensorSet::as_built, seed, j, line, kAngles);
      };
      before[i].add(errors(calibration::nominal_calibration(j)));
      stops[i].add(errors(done.stops[i]));
      const auto left = errors(done.all[i]);
      all[i].add(left);
      for (const double error : left) squares += error * error / kAngles;
      expected += done.expected_rad[i] * done.expected_rad[i];
      worst = std::max(worst, all[i].worst.back());
    }
    std::fprintf(stderr, "seed %llu: %.0f s, worst angle %.2f deg, residual %.1f\n",
                 static_cast<unsigned long long>(seed), done.seconds, worst, done.worst_residual);
  }
  std::printf(
      "| joint | as built | stops | stops, floor | stops, worst angle | stops, floor, worst angle "
      "|\n"
      "|---|---|---|---|---|---|\n");
  Errors before_all, stops_all, all_all;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    print_row(host::joint_table()[j].name, before[j], stops[j], all[j]);
    before_all.add(before[j]);
    stops_all.add(stops[j]);
    all_all.add(all[j]);
  }
  print_row("all", before_all, stops_all, all_all);
  std::printf("\nexpected over true error, rms: %.2f; at most %.0f s of the robot, residual %.1f\n",
              std::sqrt(expected / squares), longest, residual);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Errors of calibrated joints over robots as built, 95 % of angles and robots, degrees.");
  app.add_option("--first", arguments.first, "first seed");
  app.add_option("--seeds", arguments.seeds, "how many robots")->check(CLI::Range(1, 10000));
  app.add_option("--mcu", arguments.mcu, "h8: emulated firmware; native: the same C, compiled")
      ->check(CLI::IsMember(enum_names(sim::kMcuKinds)))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto done = run(arguments);
  if (!done) std::fprintf(stderr, "joint_table: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
