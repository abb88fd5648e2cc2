// Two virtual robots of one seed: one hangs, one stands.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/calibrated_joints.h"

#include "host/calibration/joint_readings.h"
#include "shared/base/hex_text.hpp"
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {
namespace {

struct Session {
  std::unique_ptr<sim::Simulation> simulation;
  std::unique_ptr<LockstepClock> clock;
  std::unique_ptr<LockstepLink> link;
  std::optional<host::Robot> robot;
};

Result<Session> open(sim::SimulationOptions options, bool suspended) {
  options.suspended = suspended;
  Session session;
  session.simulation = KAZ_TRY(sim::Simulation::create(options));
  session.clock = std::make_unique<LockstepClock>(*session.simulation);
  session.link = std::make_unique<LockstepLink>(*session.simulation);
  session.robot = KAZ_TRY(host::Robot::connect(*session.link, *session.clock));
  return session;
}

JointLines lines_of(const calibration::JointEstimator::Solution& solution) {
  JointLines lines;
  for (std::size_t j = 0; j < lines.size(); ++j) lines[j] = solution.joints[j].line;
  return lines;
}

void silent(double, const std::string&) {}

Result<double> read_stops(const sim::SimulationOptions& options,
                          std::vector<calibration::StopReading>& readings) {
  auto hung = KAZ_TRY(open(options, true));
  KAZ_TRY(calibration::prepare_for_stops(*hung.robot));
  for (const auto& group : calibration::stop_groups())
    KAZ_TRY(calibration::read_stops(*hung.robot, group, silent, readings));
  for (const auto& reading : readings)
    if (!reading.fault.empty())
      return fail(Fault::failed, host::joint_table()[static_cast<std::size_t>(reading.joint)].name +
                                     std::string(": ") + reading.fault);
  return seconds(hung.clock->now());
}

}  // namespace

Result<CalibratedJoints> calibrate_joints(const sim::SimulationOptions& options) {
  CalibratedJoints out;
  std::vector<calibration::StopReading> stops;
  out.seconds = KAZ_TRY(read_stops(options, stops));
  calibration::JointEstimator about;
  calibration::add_stops(about, stops);
  const auto by_stops = about.solve();
  out.stops = lines_of(by_stops);

  auto standing = KAZ_TRY(open(options, false));
  KAZ_TRY(calibration::use_lines(*standing.robot, out.stops));
  std::vector<calibration::FloorReading> floor;
  KAZ_TRY(calibration::read_floor(*standing.robot, out.stops, silent, floor));
  out.seconds += seconds(standing.clock->now());
  calibration::JointEstimator estimator(calibration::floor_unknowns(floor));
  calibration::add_stops(estimator, stops);
  calibration::add_floor(estimator, floor, by_stops);
  const auto solution = estimator.solve();
  out.all = lines_of(solution);
  out.worst_residual = solution.worst_residual;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    out.expected_rad[j] = solution.joints[j].expected_error_rad;
    out.worst_rad[j] = solution.joints[j].worst_error_rad;
  }
  return out;
}

Result<std::string> calibrated_memory(const sim::SimulationOptions& options) {
  const auto calibrated = KAZ_TRY(calibrate_joints(options));
  auto standing = KAZ_TRY(open(options, false));
  KAZ_TRY(standing.robot->set_calibration(host::kAllJoints, calibrated.all));
  KAZ_TRY(standing.robot->store_calibration());
  return hex_text(standing.simulation->board().mcu().memory());
}

}  // namespace kaz::lockstep
