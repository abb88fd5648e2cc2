// Runs the host alone against a recording, and compares what it sends.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_host.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "host/behavior/plugin.h"
#include "shared/base/counted.hpp"
#include "sim/runtime/time.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/lockstep/replayed_board.h"
#include "tools/run/live_camera.h"
#include "tools/run/run.h"

namespace kaz::tools {
namespace {

using lockstep::HostDifference;
using lockstep::RecordedRun;
using lockstep::ReplayedBoard;

// The first `max_pairs` pairs of the recording, or all. When the observer has these pairs, the recording
// counts as cut off, so that the host ends, too.
class FirstPairs final : public vision::Camera {
 public:
  FirstPairs(ReplayedBoard& board, RecordedRun& run, const ReplayOptions& options)
      : camera_(board), run_(run), max_(options.max_pairs), observer_(observer_of(options)) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override {
    if (max_ == 0 || given_ < max_) {
      auto pair = camera_.poll();
      if (pair && *pair) ++given_;
      return pair;
    }
    if (observer_.has_all_pictures()) {
      run_.cut_off = true;
      run_.end = 0;
    }
    return std::nullopt;
  }

 private:
  lockstep::ReplayCamera camera_;
  RecordedRun& run_;
  std::uint64_t max_, given_ = 0;
  const RunObserver& observer_;
};

// Passes all calls on. Also notes whether the behavior ended with an error of its own: one that it returned
// or threw before the board stopped.
class HostObserver final : public RunObserver {
 public:
  HostObserver(RunObserver& next, const ReplayedBoard& board) : next_(next), board_(board) {}
  bool failed_by_itself() const { return failed_by_itself_; }

  void phase(Time time, std::string_view behavior, std::string_view phase) override {
    next_.phase(time, behavior, phase);
  }
  void cycle(const behavior::CycleRow& row) override { next_.cycle(row); }
  void picture(const behavior::PictureRow& row) override { next_.picture(row); }
  void map(const behavior::MapReport& report) override { next_.map(report); }
  void begin_vision(vision::Pipeline& pipeline) override { next_.begin_vision(pipeline); }
  void end_vision(const vision::Pipeline& pipeline) override { next_.end_vision(pipeline); }
  bool has_all_pictures() const override { return next_.has_all_pictures(); }
  void pair(const vision::StereoPair& pair) override { next_.pair(pair); }
  void look(sim::Simulation& simulation) override { next_.look(simulation); }
  void threw() override { next_.threw(); }
  void ended(const Result<behavior::Outcome>& outcome, double run_s, double rtf) override {
    failed_by_itself_ = !outcome && !board_.error();
    next_.ended(outcome, run_s, rtf);
  }
  void lost(const Error& error) override { next_.lost(error); }
  bool is_worth_keeping() override { return next_.is_worth_keeping(); }

 private:
  RunObserver& next_;
  const ReplayedBoard& board_;
  bool failed_by_itself_ = false;
};

// The recording in the robot's place.
class ReplayBackend final : public SessionBackend {
 public:
  ReplayBackend(ReplayedBoard& board, RecordedRun& run, const ReplayOptions& options,
                const host::Interrupt& interrupt)
      : board_(board),
        clock_(raw_clock_, interrupt),
        link_(raw_link_, raw_clock_, interrupt),
        camera_(board, run, options) {}
  std::vector<host::RobotBoard> boards() override {
    return {{&link_, KZ_ADDRESS_DEFAULT, host::kAllJoints}};
  }
  host::Clock& clock() override { return clock_; }
  Result<void> open_camera() override { return {}; }
  bool sees() const override { return board_.run().has_pictures; }
  vision::Camera& camera() override {
    return board_.run().has_pictures ? static_cast<vision::Camera&>(camera_) : no_camera_;
  }
  vision::Pace pace() const override { return vision::Pace::lockstep; }
  Time camera_latency() const override { return board_.run().camera_latency; }
  sim::Simulation* simulation() override { return nullptr; }
  void record_behavior(const std::string& json) override { board_.think(json); }
  Result<std::string> finish_recording(const std::string&) override { return std::string(); }
  bool recording_failed() const override { return false; }

 private:
  ReplayedBoard& board_;
  lockstep::ReplayClock raw_clock_{board_};
  InterruptibleClock clock_;
  lockstep::ReplayLink raw_link_{board_};
  InterruptibleLink link_;
  FirstPairs camera_;
  NoCamera no_camera_;
};

std::string early_end(const RecordedRun& run) {
  return run.interrupted_by.empty()
             ? "the recording was cut off"
             : "the recording ends early, because its run was interrupted by " + run.interrupted_by;
}

nlohmann::ordered_json json_of(const HostDifference& difference) {
  return {{"time_s", seconds(difference.time)},
          {"where", difference.where},
          {"recorded", difference.recorded},
          {"now", difference.now}};
}

void print(const char* what, const HostDifference& difference) {
  std::printf("%s at %.6f s, %s\n  recorded: %s\n  now:      %s\n", what, seconds(difference.time),
              difference.where.c_str(), difference.recorded.c_str(), difference.now.c_str());
}

void print(const ReplayOptions& options, const RecordedRun& run, const ReplayedBoard& board) {
  const bool identical = !board.difference() && !board.other_thought();
  if (options.json) {
    nlohmann::ordered_json result{{"recording", options.file},
                                  {"mode", "host"},
                                  {"identical", identical},
                                  {"bytes_to_board", run.to_board.size()},
                                  {"bytes_to_host", run.to_host.size()},
                                  {"pairs", run.pairs.size()},
                                  {"behavior_records", run.thoughts.size()}};
    if (run.cut_off) result["cut_off_s"] = seconds(sim::time_of(run.end));
    if (!run.interrupted_by.empty()) result["recording_interrupted_by"] = run.interrupted_by;
    if (board.difference()) result["difference"] = json_of(*board.difference());
    if (board.other_thought()) result["behavior_difference"] = json_of(*board.other_thought());
    result["provenance"] = provenance_json();
    print_json(result);
    return;
  }
  print_lines(
      "the host alone ran again, with the recorded bytes of the board and the recorded pictures\n");
  if (run.cut_off)
    print_lines("%s: compared up to its last complete step at %.6f s\n", early_end(run).c_str(),
                seconds(sim::time_of(run.end)));
  if (identical) {
    print_lines(
        "identical: the host sent the same %s at the same times, and the behavior wrote the same "
        "%s\nreplayed to the host: %s from the board, %s of pictures\n",
        counted(run.to_board.size(), "byte").c_str(),
        counted(run.thoughts.size(), "record").c_str(), counted(run.to_host.size(), "byte").c_str(),
        counted(run.pairs.size(), "pair").c_str());
    return;
  }
  if (board.other_thought())
    print("first difference in the behavior's records", *board.other_thought());
  if (board.difference()) print("first difference in the sent bytes", *board.difference());
}

}  // namespace

Result<bool> host_can_run_alone(const sim::McapRecording& recording, const std::string& behavior) {
  const auto found = KAZ_TRY(behavior::named_behavior(behavior));
  return !found.needs_camera || recording.has_messages("/eyes/left");
}

Result<bool> replay_host(const ReplayOptions& options, const sim::McapRecording& recording,
                         RunOptions run_options) {
  const auto possible = KAZ_TRY(host_can_run_alone(recording, run_options.behavior));
  if (!possible)
    return fail(Fault::usage, options.file + ": the recording has no pictures, but " +
                                  run_options.behavior +
                                  " needs pictures; record with --record-pictures, or give --whole "
                                  "to run the simulation again too");
  auto run = KAZ_TRY(RecordedRun::of(recording, options.file));
  const bool cut_off = run.cut_off;
  if (run.to_board.empty() && run.thoughts.empty())
    return fail(Fault::usage,
                options.file + ": contains nothing that the host sent; record the run again");
  if (options.on_camera) KAZ_TRY(options.on_camera(run.camera));
  ReplayedBoard board(run);
  run_options.open_backend =
      [&board, &run,
       &options](host::Interrupt& interrupt) -> Result<std::unique_ptr<SessionBackend>> {
    return std::make_unique<ReplayBackend>(board, run, options, interrupt);
  };
  HostObserver observer(observer_of(options), board);
  const auto ran = tools::run(std::move(run_options), observer);
  // A host that does something else cannot go on, which is the result. Other errors are its own.
  const auto& stopped = board.error();
  if (stopped && stopped->fault == Fault::usage)
    return fail(Fault::usage, options.file + ": " + stopped->message + "; record the run again");
  if (!ran) print_interrupted(ran.error(), options, "host");
  if (!ran && (!stopped || observer.failed_by_itself() || ran.error().fault == Fault::interrupted))
    return tl::unexpected(ran.error());
  board.finish();
  if (!options.quiet) print(options, run, board);
  if (options.quiet && cut_off && run.end > 0)
    std::fprintf(stderr, "%s: %s; processed up to its last complete step at %.6f s\n",
                 options.file.c_str(), early_end(run).c_str(), seconds(sim::time_of(run.end)));
  return !board.difference() && !board.other_thought();
}

}  // namespace kaz::tools
