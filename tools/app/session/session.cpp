// One behaviour from start to end on a backend, with everything that is kept of it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/behavior/ball_detector.h"
#include "host/behavior/behavior.h"
#include "host/behavior/plugin.h"
#include "host/camera/capture.h"
#include "host/link/wall_clock.h"
#include "host/robot/measure_link.h"
#include "host/robot/robot.h"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/output.h"
#include "tools/app/kept/kept_run.h"
#include "tools/app/session/moments.h"
#include "tools/app/session/run_report.h"
#include "tools/app/session/score.h"
#include "tools/app/session/snapshots.h"
#include "tools/app/vision/report.h"

namespace kaz::tools {
namespace {

// Listens to the behaviour: progress for the user, truth for the score, moments for the snapshots, a
// record.
class Listener final : public behavior::Sink {
 public:
  Listener(SessionBackend& backend, Snapshots& snapshots, Progress& progress, Time start,
           double expected_s)
      : backend_(backend),
        snapshots_(snapshots),
        progress_(progress),
        start_(start),
        moments_(expected_s) {
    if (backend.simulation() != nullptr) probe_.emplace(*backend.simulation());
  }

  void phase(Time time, std::string_view behavior, std::string_view phase) override {
    recording_.phase(time, behavior, phase);
    phase_ = phase;
    record({{"behavior", behavior}, {"phase", phase}});
    progress_.announce(seconds(time - start_), phase_);
    if (const auto shown = moments_.on_phase(seconds(time - start_), behavior, phase))
      snapshots_.take(time, *shown);
  }

  void cycle(const behavior::CycleRow& row) override {
    recording_.cycle(row);
    if (probe_) probe_->sample();
    record({{"pan_target", row.pan_target}, {"tilt_target", row.tilt_target}});
    const double elapsed = seconds(row.time - start_);
    // Not a share: `seconds` of most behaviours is when they give up, not how long they take.
    progress_.show(elapsed, phase_);
    if (const auto shown = moments_.on_cycle(elapsed)) snapshots_.take(row.time, *shown);
  }

  void picture(const behavior::PictureRow& row) override {
    recording_.picture(row);
    record({{"exposure_ns", row.exposure.count()}, {"found", row.found}, {"error", row.error_rad}});
  }

  const behavior::Recording& recording() const { return recording_; }
  const TruthProbe* probe() const { return probe_ ? &*probe_ : nullptr; }

 private:
  void record(const nlohmann::ordered_json& value) { backend_.record_behavior(value.dump()); }

  SessionBackend& backend_;
  Snapshots& snapshots_;
  Progress& progress_;
  Time start_;
  std::string phase_;
  Moments moments_;
  std::optional<TruthProbe> probe_;
  behavior::Recording recording_;
};

// Updates viewers of the world whenever the host has waited or read the time: a host that keeps the
// line busy does nothing else.
class WatchedClock final : public host::Clock {
 public:
  WatchedClock(host::Clock& clock, sim::Simulation* simulation, Onlooker* onlooker,
               std::optional<Time> until, host::Interrupt& interrupt)
      : clock_(clock),
        simulation_(simulation),
        onlooker_(onlooker),
        until_(simulation == nullptr ? std::nullopt : until),
        interrupt_(interrupt) {}
  Time now() const override {
    const Time now = clock_.now();
    if (onlooker_ != nullptr && simulation_ != nullptr && now > looked_) {
      onlooker_->look(*simulation_);
      looked_ = now;
    }
    // Whatever waits without this clock, as for a reply or a picture, ends with the interrupt.
    if (until_ && now >= *until_) interrupt_.request();
    return now;
  }
  Result<void> sleep_until(Time t) override {
    auto slept = clock_.sleep_until(until_ ? std::min(t, *until_) : t);
    if (slept) now();
    if (!slept || !ended()) return slept;
    return tl::unexpected(host::Interrupt::error());
  }
  // The time is up that was given to the run.
  bool ended() const { return until_ && clock_.now() >= *until_; }

 private:
  mutable Time looked_{-1};
  host::Clock& clock_;
  sim::Simulation* simulation_;
  Onlooker* onlooker_;
  std::optional<Time> until_;
  host::Interrupt& interrupt_;
};

double expected_seconds(const behavior::OptionValues& values,
                        std::span<const behavior::Option> options) {
  for (const auto& option : options) {
    if (option.name == "seconds") return values.number("seconds");
  }
  return 10;
}

// Joints of a robot that is no Kaz; of Kaz none.
std::vector<std::string> other_joints(const sim::World& world) {
  const auto joints = world.joint_order();
  if (joints.empty() || host::joint_index(joints.front())) return {};
  return {joints.begin(), joints.end()};
}

// What `kaz replay` runs it again with.
std::vector<std::pair<std::string, std::string>> facts_of(const SessionOptions& options) {
  const BackendOptions& backend = options.backend;
  nlohmann::ordered_json robot{{"world", backend.world},
                               {"robot_file", backend.robot_file},
                               {"mcu", to_string(backend.mcu)},
                               {"image", backend.image},
                               {"sensors", to_string(backend.sensors)},
                               {"imu", backend.imu},
                               {"dynamics", backend.dynamics},
                               {"physics_step_ms", backend.physics_step_ms},
                               {"eyes", to_string(backend.eyes)},
                               {"eye_width", backend.eye_width},
                               {"supply_volts", backend.supply_volts},
                               {"seed", backend.seed}};
  // Recordings without it were drawn by OpenGL, and remain what they were.
  if (backend.renderer != sim::RendererKind::opengl)
    robot["renderer"] = to_string(backend.renderer);
  return {{"behavior", options.behavior},
          {"settings", nlohmann::json(options.settings).dump()},
          {"backend", robot.dump()}};
}

// What there is of a run that broke off is its recording up to there: it moves in all the same.
Error with_recording(Error error, sim::Simulation* simulation, const OutputFolder* folder,
                     bool recorded) {
  if (simulation == nullptr || folder == nullptr || !recorded) return error;
  const auto ended = simulation->finish_recording();
  if (!ended || ended->empty()) return error;
  if (const auto placed = place_recording(*folder))
    error.message += "; the recording up to there is " + *placed;
  return error;
}

// The machine's fault: with what is saved, reported to the caller, and kept as the run's outcome. On a
// full disk that result may be missing.
Error lost(Error error, const SessionOptions& options, const OutputFolder* folder) {
  if (folder != nullptr) {
    error = folder->explained(std::move(error));
    (void)folder->write_json("result.json", {{"outcome", "environment"},
                                             {"sentence", error.message},
                                             {"behavior", options.behavior},
                                             {"seed", options.backend.seed}});
  }
  if (options.on_loss) options.on_loss(error);
  return error;
}

}  // namespace

Result<bool> run_session(SessionOptions options) {
  const auto behavior = behavior::named_behavior(options.behavior);
  if (!behavior) return tl::unexpected(behavior.error());
  const auto values = KAZ_TRY(behavior::OptionValues::parse(behavior->options, options.settings));
  KAZ_TRY(parse_modules(options.vision.modules));
  options.backend.needs_camera = behavior->needs_camera;
  KAZ_TRY(check(options.backend));

  std::optional<OutputFolder> results;
  if (!options.out.empty()) {
    auto opened = OutputFolder::open(options.out, run_output());
    if (!opened && opened.error().fault == Fault::environment)
      return tl::unexpected(lost(opened.error(), options, nullptr));
    results = KAZ_TRY(std::move(opened));
  }
  const OutputFolder* folder = results ? &*results : nullptr;
  const bool recorded = folder != nullptr && options.backend.robot == "sim" &&
                        options.backend.recording.empty() && !options.open_backend;
  if (recorded) options.backend.recording = growing_recording(*folder);
  // Of a run that does not begin nothing is left.
  FileRemover remove_recording(recorded ? options.backend.recording : "");
  options.backend.facts = facts_of(options);

  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto backend = options.open_backend ? options.open_backend(interrupt)
                                      : SessionBackend::open(options.backend, interrupt);
  if (!backend) {
    Error error = backend.error();
    if (error.fault == Fault::environment && options.on_loss) options.on_loss(error);
    return tl::unexpected(std::move(error));
  }
  const bool real = (*backend)->port() != nullptr;
  const Time connecting = (*backend)->clock().now();
  const auto report_resumption = [&](const host::Resumption& resumption) {
    std::fprintf(stderr, "\n%s: after %.1f s %s; after %.2f s more it answered again\n",
                 options.label.c_str(), seconds(resumption.lost - connecting),
                 text(resumption.cause), seconds(resumption.resumed - resumption.lost));
  };
  host::WallClock uninterrupted;
  std::unique_ptr<KeptRun> kept;
  if (real) {
    auto begun = KAZ_TRY(KeptRun::begin((*backend)->link(), uninterrupted,
                                        {.verb = options.label,
                                         .port = (*backend)->port()->name(),
                                         .address = options.backend.address,
                                         .motors_off = false,
                                         .folder = ""}));
    kept = std::move(begun);
  }
  WatchedClock clock((*backend)->clock(), (*backend)->simulation(), options.onlooker, options.until,
                     interrupt);
  auto robot =
      host::Robot::connect((*backend)->link(), clock,
                           {.address = options.backend.address,
                            .on_resumed = report_resumption,
                            .frames_path = real ? temporary_file("frames.txt") : std::string()});
  if (!robot) return tl::unexpected(robot.error());
  if (real) {
    const auto trip = KAZ_TRY(host::measure_round_trip(*robot, *(*backend)->port()));
    if (!options.json || trip.slow) std::fprintf(stderr, "kaz: %s\n", trip.sentence.c_str());
  }

  KAZ_TRY((*backend)->open_camera());
  const bool sees = (*backend)->sees();
  if (behavior->needs_camera && !sees) return tl::unexpected(sim::Simulation::no_eyes());
  RememberingCamera camera((*backend)->camera());
  host::Capture capture(camera, *robot);
  vision::Pipeline pipeline({(*backend)->pace(), (*backend)->camera_latency()});
  VisionOptions modules = options.vision;
  modules.modules = "color," + modules.modules;
  KAZ_TRY(add_modules(modules, pipeline));
  DeliveryTable deliveries(pipeline);
  if (options.watcher != nullptr) options.watcher->begin(pipeline);
  behavior::PipelineBallDetector detector(capture, pipeline);
  Snapshots snapshots(camera, (*backend)->simulation(), options.vision.ball);
  if (folder != nullptr) KAZ_TRY(folder->clear());
  remove_recording.keep();
  Progress progress(options.label, options.json);
  const Time start = (*backend)->clock().now();
  Listener listener(**backend, snapshots, progress, start,
                    expected_seconds(values, behavior->options));

  Result<std::string> sha256;
  const auto wall_start = std::chrono::steady_clock::now();
  behavior::Context context{*robot,   robot->clock(), sees ? &detector : nullptr,
                            listener, values,         options.backend.seed};
  context.ball_radius_m = options.vision.ball.radius_m;
  if (const auto* simulation = (*backend)->simulation())
    context.other_joints = other_joints(simulation->world());
  std::optional<RunProfiler> profiler;
  if (options.profile) profiler.emplace();
  const Result<behavior::Outcome> outcome = [&] {
    const ProfileScope host("behaviour and link");
    return behavior->run(context);
  }();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  const double run_s = seconds((*backend)->clock().now() - start);
  std::optional<RunProfile> profile;
  if (profiler) profile = profiler->end(run_s);
  profiler.reset();
  if (options.on_end) options.on_end(outcome, run_s, run_s / wall_s);
  if (!outcome && clock.ended()) {  // options.until
    progress.done();
    pipeline.finish();
    if (options.watcher != nullptr) options.watcher->end(pipeline);
    KAZ_TRY((*backend)->simulation()->finish_recording());
    return false;
  }
  const bool interrupted = !outcome && outcome.error().fault == Fault::interrupted;
  std::optional<host::CleanUp> clean_up;
  if (interrupted) {
    // What follows is no part of the run, and not recorded.
    if ((*backend)->simulation() != nullptr)
      sha256 = (*backend)->simulation()->finish_recording(received_signal_name());
    clean_up.emplace(interrupt);
  }
  const auto health =
      outcome || interrupted ? robot->board_statistics() : Result<kz_statistics_reply>{};
  robot->disable_all();
  clean_up.reset();
  progress.done();
  const Result<void> left = kept ? kept->end() : Result<void>();
  pipeline.finish();
  if (options.watcher != nullptr) options.watcher->end(pipeline);
  if (!sha256) return tl::unexpected(lost(sha256.error(), options, folder));
  if (interrupted && !left)
    std::fprintf(stderr, "%s: %s\n", options.label.c_str(), left.error().message.c_str());
  if (interrupted && !options.keep_interrupted) return tl::unexpected(outcome.error());
  if (!outcome && !interrupted) {
    Error error =
        with_recording(together(outcome, left).error(), (*backend)->simulation(), folder, recorded);
    // In lockstep nothing but the robot can fail to answer; at a port it is the line, too.
    if (real && error.fault == Fault::environment) error = lost(std::move(error), options, folder);
    return tl::unexpected(std::move(error));
  }
  if (!health && !interrupted) return tl::unexpected(health.error());
  if (!interrupted) {
    KAZ_TRY(left);
  }

  const behavior::Outcome cut_short{
      false, "ended by " + std::string(received_signal_name()), {}, {}};
  RunReport report{options.behavior,
                   options.backend,
                   interrupted ? cut_short : *outcome,
                   run_s,
                   run_s / wall_s,
                   score(listener.recording(), listener.probe(), start),
                   robot->identity(),
                   health.value_or(kz_statistics_reply{}),
                   robot->statistics(),
                   start,
                   listener.recording(),
                   listener.probe(),
                   module_statistics_json(pipeline),
                   module_statistics_text(pipeline),
                   deliveries.text(),
                   interrupted,
                   std::move(profile),
                   *sha256};
  const auto written = write_report(report, (*backend)->simulation(), snapshots, folder, recorded);
  if (!written) return tl::unexpected(lost(written.error(), options, folder));
  if (!options.quiet) print_report(*written, report, options.out, options.json);
  if (!interrupted) return outcome->success;
  char until[48];
  std::snprintf(until, sizeof until, "interrupted at %.2f s", run_s);
  return fail(
      Fault::interrupted,
      until + (options.out.empty() ? std::string("; nothing was to be kept of it")
                                   : "; what there is of the run is kept in " + options.out));
}

}  // namespace kaz::tools
