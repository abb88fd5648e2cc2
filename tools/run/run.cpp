// Runs one behavior on a robot from start to end.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run.h"

#include <chrono>
#include <cstdio>

#include "host/behavior/plugin.h"
#include "tools/base/interrupt_signals.h"
#include "tools/run/live_camera.h"
#include "tools/run/run_end.h"
#include "tools/run/run_stack.h"

namespace kaz::tools {
namespace {

// Requests of the user, which are also recorded.
class RecordedRequests final : public behavior::Requests {
 public:
  RecordedRequests(const RunPlan& plan, RunRecorder& recorder) : plan_(plan), recorder_(recorder) {}
  std::vector<std::string> take(Time now) override {
    std::vector<std::string> lines = plan_.options().requests(now);
    for (const std::string& line : lines) recorder_.request(line);
    return lines;
  }

 private:
  const RunPlan& plan_;
  RunRecorder& recorder_;
};

// Runs the behavior. An exception becomes an error, so that the run still ends with motors off and complete
// files.
Result<behavior::Outcome> outcome_of(const RunPlan& plan, behavior::Context& context, bool& threw) {
  try {
    return plan.behavior().run(context);
  } catch (...) {
    threw = true;
    return tl::unexpected(behavior::thrown_error(plan.options().behavior));
  }
}

void run_behavior(RunStack& stack, RunEnd& end) {
  const RunPlan& plan = stack.plan;
  behavior::Context context{
      stack.robot.robot, stack.robot.robot.clock(), stack.eyes->behavior_vision(), *stack.recorder,
      plan.values(),     plan.backend().seed};
  context.ball_radius_m = plan.options().vision.ball.radius_m;
  RecordedRequests requests(plan, *stack.recorder);
  if (plan.options().requests && plan.behavior().takes_requests) context.requests = &requests;
  if (stack.robot.at_port()) context.camera = "camera " + plan.backend().camera;
  context.other_joints = plan.backend().joints;
  if (is_real_camera(plan.backend().camera)) context.camera_patience = kCameraPatience;
  const ProfileScope host("behavior and link");
  end.outcome = outcome_of(plan, context, end.threw);
}

// Completes the outcome of the behavior, and makes the outcome agree with a received interrupt.
void check_outcome(const RunStack& stack, RunEnd& end) {
  const std::string& name = stack.plan.options().behavior;
  const bool in_time = stack.robot.clock->ended();
  if (received_signal() != 0 && stack.interrupt.requested()) {
    end.outcome = tl::unexpected(host::Interrupt::error());
  } else if (!end.outcome) {
    Error& error = end.outcome.error();
    if (error.fault == Fault::interrupted && !in_time) error.fault = Fault::failed;
    if (error.message.empty()) error.message = name + " returned an error without a message";
    // The robot has failed, as in a run that has found no ball, so there is a complete report.
    if (error.fault == Fault::failed && !end.threw && !in_time)
      end.outcome = behavior::Outcome{false, std::string(error.message), {}, "error"};
  } else if (end.outcome->sentence.empty()) {
    end.outcome->sentence = name + " returned an outcome without a sentence";
  }
}

// If this program or the simulator at the port was late, a failure may be the machine's. An outcome with the
// cause "error" is not excused: that the board switched its motors off is true on any machine.
void excuse_failure(RunEnd& end) {
  if (!end.outcome || end.outcome->success || end.outcome->cause == "error") return;
  if (!end.lateness || end.lateness->excuse.empty()) return;
  end.machine_failed = true;
  end.outcome->sentence = "the result is undecided; the run failed (" + end.outcome->sentence +
                          "), but possibly not because of the robot: " + end.lateness->excuse +
                          "; end other programs and try again";
}

// Switches the motors off, restores the boards, and ends vision.
void settle(RunStack& stack, std::optional<RunLatenessMeter>& lateness, RunEnd& end) {
  std::optional<host::CleanUp> clean_up;
  const bool interrupted = end.interrupted();
  if (interrupted) {
    // The following messages are no part of the run, and not recorded.
    end.sha256 = stack.robot.backend->finish_recording(received_signal_name());
    clean_up.emplace(stack.interrupt);
  }
  if (end.outcome || interrupted) end.health = stack.robot.robot.board_statistics();
  const auto off = stack.robot.robot.disable_all();
  clean_up.reset();
  // After the motors are off: end() takes up to 0.1 s without a request, and the board's link watchdog would
  // expire. A simulator that does not answer any more is not asked.
  if (lateness && (end.outcome || interrupted)) end.lateness = lateness->end();
  excuse_failure(end);
  stack.recorder->progress().done();
  // Printed at once, because restoring the boards tries again and may take seconds.
  if (!off && stack.robot.at_port()) {
    const std::string on = stack.robot.backend->still_on();
    std::fprintf(stderr, "%s: %s\n", stack.plan.options().label.c_str(),
                 (on.empty() ? off.error().message : on).c_str());
  }
  end.left = stack.robot.end_kept();
  stack.eyes->end();
}

Result<bool> perform(RunStack& stack, RunEnd& end) {
  using Steady = std::chrono::steady_clock;
  const auto wall_start = Steady::now();
  std::optional<RunProfiler> profiler;
  if (stack.plan.options().profile) profiler.emplace();
  // From here on, the motors are switched off at the end, even if the link returns after the run gave up.
  for (const auto& kept : stack.robot.kept) kept->switch_motors_off();
  std::optional<RunLatenessMeter> lateness;
  if (stack.robot.at_port()) lateness.emplace(stack.robot.backend->link(), stack.interrupt);
  run_behavior(stack, end);
  end.wall_s = std::chrono::duration<double>(Steady::now() - wall_start).count();
  end.run_s = seconds(stack.robot.backend->clock().now() - stack.recorder->start());
  end.not_begun = stack.robot.backend->faults_not_begun();
  if (profiler) end.profile = profiler->end(end.run_s);
  if (end.threw) stack.observer.threw();
  check_outcome(stack, end);
  stack.observer.ended(end.outcome, end.run_s, end.run_s / end.wall_s);
  if (!end.outcome && stack.robot.clock->ended()) {
    stack.recorder->progress().done();
    stack.eyes->end();
    KAZ_TRY(stack.robot.backend->finish_recording());
    return false;
  }
  settle(stack, lateness, end);
  KAZ_TRY(check_end(stack, end));
  return report(stack, end);
}

}  // namespace

Result<bool> run(const RunPlan& plan, RunObserver& observer) {
  host::Interrupt interrupt;
  auto files = RunFiles::open(plan, observer);
  if (!files) return tl::unexpected(files.error());
  const InterruptSignals signals(interrupt);
  auto stack = KAZ_TRY(RunStack::open(plan, observer, *files, interrupt));
  RunEnd end;
  return perform(*stack, end);
}

Result<bool> run(RunOptions options, RunObserver& observer) {
  return run(KAZ_TRY(RunPlan::make(std::move(options))), observer);
}

}  // namespace kaz::tools
