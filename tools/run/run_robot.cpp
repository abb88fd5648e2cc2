// Connects the robot of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_robot.h"

#include <algorithm>
#include <cstdio>

#include "host/robot/measure_link.h"
#include "tools/base/output.h"
#include "tools/run/robot_joints.h"

namespace kaz::tools {
namespace {

Result<std::unique_ptr<SessionBackend>> open_backend(const RunPlan& plan, RunObserver& observer,
                                                     host::Interrupt& interrupt) {
  auto backend = plan.options().open_backend ? plan.options().open_backend(interrupt)
                                             : SessionBackend::open(plan.backend(), interrupt);
  if (!backend && backend.error().fault == Fault::environment) observer.lost(backend.error());
  return backend;
}

Result<std::vector<std::unique_ptr<KeptRun>>> keep_boards(const RunPlan& plan,
                                                          SessionBackend& backend,
                                                          host::Interrupt& interrupt) {
  std::vector<std::unique_ptr<KeptRun>> kept;
  if (backend.port() == nullptr) return kept;
  std::function<std::string()> still_on;
  if (plan.on_servo_bus()) still_on = [&backend] { return backend.still_on(); };
  for (const host::RobotBoard& board : backend.boards())
    kept.push_back(KAZ_TRY(KeptRun::begin(*board.link, backend.clock(), interrupt,
                                          {.verb = plan.options().label,
                                           .port = board.link->name(),
                                           .address = board.address,
                                           .motors_off = false,
                                           .still_on = still_on,
                                           .notes = false})));
  return kept;
}

void print_loss(const std::string& label, const host::Loss& loss, Time since) {
  std::fprintf(stderr, "\n%s: after %.1f s %s; retrying for up to %.3g s: %s\n", label.c_str(),
               seconds(loss.at - since), text(loss.cause), seconds(loss.at_most), loss.why.c_str());
}

void print_resumption(const std::string& label, const host::Resumption& resumption, Time since) {
  if (resumption.reported) {
    std::fprintf(stderr, "\n%s: the link is back after %.2f s%s\n", label.c_str(),
                 seconds(resumption.resumed - resumption.lost),
                 resumption.cause == host::Resumption::Cause::reset ? "; the board was reset" : "");
    return;
  }
  std::fprintf(stderr, "\n%s: after %.1f s %s; the board answered again %.2f s later\n",
               label.c_str(), seconds(resumption.lost - since), text(resumption.cause),
               seconds(resumption.resumed - resumption.lost));
}

Result<host::Robot> connect(const RunPlan& plan, SessionBackend& backend, RunClock& clock,
                            const std::string& frames_path) {
  const Time connecting = backend.clock().now();
  const std::string& label = plan.options().label;
  const auto on_lost = [&backend, &label, connecting](const host::Loss& loss) {
    // If the recording failed, the virtual robot has stopped, and the link is not the cause.
    if (!backend.recording_failed()) print_loss(label, loss, connecting);
  };
  const auto on_resumed = [&label, connecting](const host::Resumption& resumption) {
    print_resumption(label, resumption, connecting);
  };
  const auto speeds = KAZ_TRY(parse_speeds(plan.backend().joint_speeds));
  host::ConnectOptions options{.reaction = plan.backend().reaction,
                               .reconnect = from_seconds(plan.backend().reconnect_s),
                               .on_lost = on_lost,
                               .on_resumed = on_resumed,
                               .frames_path = frames_path,
                               .joint_names = plan.backend().joints,
                               .max_rad_per_s = speeds};
  // The file, not an option, has the address of each board.
  if (const auto* boards = std::get_if<BoardsTarget>(&plan.target()))
    options.address_advice = "change the board's address in " + boards->file + " to ";
  return host::Robot::connect(backend.boards(), clock, options);
}

Result<void> print_round_trip(const RunPlan& plan, host::Robot& robot, const host::PortLink& port) {
  const auto trip = KAZ_TRY(host::measure_round_trip(robot, port));
  if (!plan.options().json || trip.slow)
    std::fprintf(stderr, "%s: %s\n", plan.options().label.c_str(), trip.sentence.c_str());
  return {};
}

}  // namespace

RunClock::RunClock(SessionBackend& backend, RunObserver& observer, std::optional<Time> until,
                   host::Interrupt& interrupt)
    : clock_(backend.clock()),
      simulation_(backend.simulation()),
      observer_(observer),
      until_(simulation_ == nullptr ? std::nullopt : until),
      interrupt_(interrupt) {}

Time RunClock::now() const {
  const Time now = clock_.now();
  if (simulation_ != nullptr && now > looked_) {
    observer_.look(*simulation_);
    looked_ = now;
  }
  // The interrupt also ends waits that do not use this clock, such as the wait for a reply or a picture.
  if (until_ && now >= *until_) interrupt_.request();
  return now;
}

Result<void> RunClock::sleep_until(Time time) {
  auto slept = clock_.sleep_until(until_ ? std::min(time, *until_) : time);
  if (slept) now();
  if (!slept || !ended()) return slept;
  return tl::unexpected(host::Interrupt::error());
}

Result<RunRobot> RunRobot::open(const RunPlan& plan, RunObserver& observer,
                                const OutputFolder* folder, host::Interrupt& interrupt) {
  auto backend = KAZ_TRY(open_backend(plan, observer, interrupt));
  auto kept = KAZ_TRY(keep_boards(plan, *backend, interrupt));
  auto clock = std::make_unique<RunClock>(*backend, observer, plan.options().until, interrupt);
  const host::PortLink* port = backend->port();
  const std::string frames_path = port == nullptr     ? std::string()
                                  : folder != nullptr ? folder->path("frames.txt")
                                                      : temporary_file("frames.txt");
  auto robot = KAZ_TRY(connect(plan, *backend, *clock, frames_path));
  // Servos on a bus have no board whose replies would show the delay of the line.
  if (port != nullptr && !plan.on_servo_bus()) KAZ_TRY(print_round_trip(plan, robot, *port));
  return RunRobot{std::move(backend), std::move(kept), std::move(clock), std::move(robot)};
}

Result<void> RunRobot::end_kept() {
  Result<void> all;
  for (const auto& board : kept) {
    auto ended = board->end();
    if (!ended && all) all = std::move(ended);
  }
  return all;
}

}  // namespace kaz::tools
