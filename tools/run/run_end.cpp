// Writes what remains of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_end.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/base/interrupt_signals.h"
#include "tools/run/run_report.h"

namespace kaz::tools {
namespace {

// Writes the result of a run that broke off. If the disk is full, result.json may be missing.
void write_end(RunStack& stack, const RunEnd& end, const char* outcome, const char* cause,
               const std::string& sentence) {
  const OutputFolder* folder = stack.files.folder();
  if (folder == nullptr) return;
  nlohmann::ordered_json result =
      broken_off_json(outcome, sentence, stack.plan.options().behavior, stack.plan.backend());
  if (*cause != '\0') result["cause"] = cause;
  if (end.wall_s > 0) add_times(result, end.run_s, end.run_s / end.wall_s);
  if (auto vision = module_statistics_json(stack.eyes->pipeline()); !vision.empty())
    result["vision"] = std::move(vision);
  (void)folder->write_json("result.json", result);
  (void)folder->write("vision.csv", stack.eyes->deliveries().text());
}

// Completes the recording of a run that broke off, and adds the recording's path to the error.
Error with_recording(Error error, const RunStack& stack, const RunEnd& end) {
  if (!stack.plan.records_in_folder()) return error;
  const auto ended = stack.robot.backend->finish_recording(end.threw ? "an exception" : "");
  if (!ended || ended->empty()) return error;
  if (const auto placed = place_recording(*stack.files.folder()))
    error.message += "; the recording until then is " + *placed;
  return error;
}

void print_error(const RunStack& stack, const Error& error) {
  std::fprintf(stderr, "%s: %s\n", stack.plan.options().label.c_str(), error.message.c_str());
}

BehaviorReport report_of(RunStack& stack, RunEnd& end) {
  const RunRecorder& recorder = *stack.recorder;
  const behavior::Outcome cut_short{
      false, "ended by " + std::string(received_signal_name()), {}, {}};
  return BehaviorReport{stack.plan.options().behavior,
                        stack.plan.backend(),
                        end.interrupted() ? cut_short : *end.outcome,
                        end.run_s,
                        end.run_s / end.wall_s,
                        score(recorder.recording(), recorder.probe(), recorder.start()),
                        stack.robot.robot.identity(),
                        end.health.value_or(kz_statistics_reply{}),
                        stack.robot.robot.statistics(),
                        recorder.start(),
                        recorder.recording(),
                        recorder.probe(),
                        module_statistics_json(stack.eyes->pipeline()),
                        module_statistics_text(stack.eyes->pipeline()),
                        stack.eyes->deliveries().text(),
                        end.interrupted(),
                        std::move(end.profile),
                        *end.sha256,
                        stack.robot.backend->camera_warning(),
                        end.lateness,
                        end.machine_failed,
                        &recorder.map(),
                        end.not_begun,
                        std::move(stack.start_pose),
                        stack.plan.behavior().needs_camera};
}

// Returns the result of a run whose report is complete. `undrawn`: a signal ended the drawing of pictures.
Result<bool> result_of(const RunStack& stack, const RunEnd& end, bool undrawn) {
  const std::string& out = stack.plan.options().out;
  if (end.machine_failed) {
    Error error{Fault::environment, end.outcome->sentence};
    stack.observer.lost(error);
    return tl::unexpected(std::move(error));
  }
  if (undrawn)
    return fail(Fault::interrupted, "interrupted while pictures were drawn; the run had ended (" +
                                        end.outcome->sentence +
                                        "), and the results so far are kept in " + out);
  if (!end.interrupted()) return end.outcome->success;
  char until[48];
  std::snprintf(until, sizeof until, "interrupted at %.2f s", end.run_s);
  return fail(Fault::interrupted,
              until + (out.empty() ? std::string("; without --out, nothing is kept")
                                   : "; the results so far are kept in " + out));
}

}  // namespace

Error lost(RunStack& stack, const RunEnd& end, Error error) {
  write_end(stack, end, "environment", "", error.message);
  stack.observer.lost(error);
  return error;
}

Result<void> check_end(RunStack& stack, RunEnd& end) {
  if (!end.sha256) return tl::unexpected(lost(stack, end, end.sha256.error()));
  if (end.interrupted()) {
    if (!end.left) print_error(stack, end.left.error());
    if (!stack.plan.options().keep_interrupted) return tl::unexpected(end.outcome.error());
    return {};
  }
  if (!end.outcome) {
    const bool unrecorded = stack.robot.backend->recording_failed();
    Error error = with_recording(together(end.outcome, end.left).error(), stack, end);
    // In lockstep, the board always answers, unless the recording cannot be written. At a port, the line may
    // have failed.
    if ((stack.robot.at_port() || end.threw || unrecorded) && error.fault == Fault::environment)
      error = lost(stack, end, std::move(error));
    else if (end.threw)
      write_end(stack, end, "failed", "crashed", error.message);
    else if (error.fault == Fault::environment)
      write_end(stack, end, "environment", "", error.message);
    return tl::unexpected(std::move(error));
  }
  if (!end.health) return tl::unexpected(end.health.error());
  if (end.outcome->success || end.left) return end.left;
  print_error(stack, end.left.error());
  return {};
}

Result<bool> report(RunStack& stack, RunEnd& end) {
  const RunOptions& options = stack.plan.options();
  if (!end.interrupted() && !stack.observer.is_worth_keeping()) {
    stack.files.discard_recording();
    return end.outcome->success;
  }
  if (!end.interrupted()) end.sha256 = stack.robot.backend->finish_recording();
  if (!end.sha256) return tl::unexpected(lost(stack, end, end.sha256.error()));
  const BehaviorReport report = report_of(stack, end);
  sim::Simulation* const simulation = stack.robot.backend->simulation();
  const auto written = write_report(report, simulation, stack.eyes->snapshots(),
                                    stack.files.folder(), stack.plan.records_in_folder());
  if (!written) {
    // The outcome of the run is known, although its folder is incomplete.
    const auto without = write_report(report, simulation, stack.eyes->snapshots(), nullptr, false);
    if (without && options.json && !options.quiet)
      print_report(*without, report, options.out, true);
    return tl::unexpected(lost(stack, end, written.error()));
  }
  const bool undrawn = !end.interrupted() && written->contains("interrupted");
  if (!options.quiet) print_report(*written, report, options.out, options.json);
  if (!end.not_begun.empty())
    std::fprintf(stderr, "%s: %s\n", options.label.c_str(),
                 faults::not_begun_text(end.not_begun).c_str());
  return result_of(stack, end, undrawn);
}

}  // namespace kaz::tools
