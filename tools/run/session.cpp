// One behavior from start to end on a backend, with everything that is kept of it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <deque>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/behavior/ball_detector.h"
#include "host/behavior/behavior.h"
#include "host/behavior/plugin.h"
#include "host/behavior/pose_request.h"
#include "host/camera/capture.h"
#include "host/link/wall_clock.h"
#include "host/robot/measure_link.h"
#include "host/robot/robot.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/kept/kept_run.h"
#include "tools/run/leave_board.h"
#include "tools/run/live_camera.h"
#include "tools/run/map_picture.h"
#include "tools/run/moments.h"
#include "tools/run/robot_joints.h"
#include "tools/run/run_lateness.h"
#include "tools/run/run_report.h"
#include "tools/run/score.h"
#include "tools/run/snapshots.h"
#include "tools/vision/color_file.h"
#include "tools/vision/report.h"

namespace kaz::tools {
namespace {

using Steady = std::chrono::steady_clock;

// Listens to the behavior: progress for the user, truth for the score, moments for the snapshots, a
// record.
class Listener final : public behavior::Sink {
 public:
  Listener(SessionBackend& backend, behavior::Sink* other, Snapshots& snapshots, Progress& progress,
           Time start, double expected_s)
      : backend_(backend),
        other_(other),
        snapshots_(snapshots),
        progress_(progress),
        start_(start),
        moments_(expected_s) {
    if (backend.simulation() != nullptr) probe_.emplace(*backend.simulation());
  }

  void phase(Time time, std::string_view behavior, std::string_view phase) override {
    recording_.phase(time, behavior, phase);
    if (other_ != nullptr) other_->phase(time, behavior, phase);
    phase_ = phase;
    record({{"behavior", behavior}, {"phase", phase}});
    progress_.announce(seconds(time - start_), phase_);
    if (const auto shown = moments_.on_phase(seconds(time - start_), behavior, phase))
      snapshots_.take(time, *shown);
  }

  void cycle(const behavior::CycleRow& row) override {
    recording_.cycle(row);
    if (other_ != nullptr) other_->cycle(row);
    if (probe_) probe_->sample();
    record({{"pan_target", row.pan_target}, {"tilt_target", row.tilt_target}});
    const double elapsed = seconds(row.time - start_);
    // Not a share: `seconds` of most behaviors is when they give up, not how long they take.
    progress_.show(elapsed, phase_);
    if (const auto shown = moments_.on_cycle(elapsed)) snapshots_.take(row.time, *shown);
  }

  void picture(const behavior::PictureRow& row) override {
    recording_.picture(row);
    if (other_ != nullptr) other_->picture(row);
    record({{"exposure_ns", row.exposure.count()}, {"found", row.found}, {"error", row.error_rad}});
  }

  void map(const behavior::MapReport& report) override {
    map_ = map_picture(report);
    if (other_ != nullptr) other_->map(report);
    backend_.record_map(recorded_map(report));
  }

  const behavior::Recording& recording() const { return recording_; }
  void request(const std::string& line) { record({{"request", line}}); }

  // The newest; nothing of behaviors without.
  const std::optional<figure::Image>& map() const { return map_; }
  const TruthProbe* probe() const { return probe_ ? &*probe_ : nullptr; }

 private:
  // Names may hold bytes that are no UTF-8.
  void record(const nlohmann::ordered_json& value) {
    backend_.record_behavior(
        value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }

  SessionBackend& backend_;
  behavior::Sink* other_;
  Snapshots& snapshots_;
  Progress& progress_;
  Time start_;
  std::string phase_;
  Moments moments_;
  std::optional<TruthProbe> probe_;
  behavior::Recording recording_;
  std::optional<figure::Image> map_;
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

// Records the requests to the behavior, so that a replay can repeat them.
class RecordedRequests final : public behavior::Requests {
 public:
  RecordedRequests(const std::function<std::vector<std::string>(Time)>& source, Listener& listener)
      : source_(source), listener_(listener) {}
  std::vector<std::string> take(Time now) override {
    std::vector<std::string> lines = source_(now);
    for (const std::string& line : lines) listener_.request(line);
    return lines;
  }

 private:
  const std::function<std::vector<std::string>(Time)>& source_;
  Listener& listener_;
};

double expected_seconds(const behavior::OptionValues& values,
                        std::span<const behavior::Option> options) {
  for (const auto& option : options) {
    if (option.name == "seconds") return values.number("seconds");
  }
  return 10;
}

// The virtual robot, as one JSON object.
std::string robot_facts(const BackendOptions& backend) {
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
                               {"renderer", to_string(backend.renderer)},
                               {"supply_volts", backend.supply_volts},
                               {"seed", backend.seed}};
  if (!backend.memory.empty()) robot["memory"] = backend.memory;
  if (backend.suspended) robot["suspended"] = true;
  if (!backend.joints.empty()) robot["joints"] = backend.joints;
  return robot.dump();
}

// What `kaz replay` runs it again with.
std::vector<std::pair<std::string, std::string>> facts_of(const SessionOptions& options) {
  const BackendOptions& backend = options.backend;
  std::vector<std::pair<std::string, std::string>> facts{
      {"behavior", options.behavior}, {"settings", nlohmann::json(options.settings).dump()}};
  if (backend.robot != "sim") {
    facts.emplace_back("port", backend.robot);
  } else {
    facts.emplace_back("backend", robot_facts(backend));
  }
  // The ball that vision looks for, where it is not the usual one.
  if (const vision::BallOptions& ball = options.vision.ball; !is_usual(ball)) {
    nlohmann::ordered_json json = color_json(ball.color);
    json["radius_m"] = ball.radius_m;
    facts.emplace_back("ball", json.dump());
  }
  return facts;
}

// What there is of a run that broke off is its recording up to there: it moves in all the same. `by`: what
// broke it off, if not the robot.
Error with_recording(Error error, SessionBackend& backend, const OutputFolder* folder,
                     bool recorded, const std::string& by) {
  if (folder == nullptr || !recorded) return error;
  const auto ended = backend.finish_recording(by);
  if (!ended || ended->empty()) return error;
  if (const auto placed = place_recording(*folder))
    error.message += "; the recording until then is " + *placed;
  return error;
}

// A session's steps. Its members are in the order in which they are made: what is later refers to what is
// earlier, and goes first.
class Session {
 public:
  explicit Session(SessionOptions options) : options_(std::move(options)) {}

  Result<bool> run() {
    KAZ_TRY(prepare());
    KAZ_TRY(open_backend());
    KAZ_TRY(connect());
    KAZ_TRY(begin_vision());
    KAZ_TRY(begin());
    perform();
    if (options_.on_end) options_.on_end(outcome_, run_s_, run_s_ / wall_s_);
    if (!outcome_ && clock_->ended()) return end_in_time();
    settle();
    KAZ_TRY(check_end());
    return report();
  }

 private:
  Result<void> prepare();
  Result<void> open_backend();
  Result<void> connect();
  Result<void> begin_vision();
  Result<void> begin();
  void perform();
  Result<bool> end_in_time();
  void settle();
  void excuse_failure();
  Result<void> check_end();
  Result<bool> report();
  void write_end(const char* outcome, const char* cause, const std::string& sentence);
  Error lost(Error error);

  // In perform().
  void run_behavior(behavior::Context& context);
  void take_times();
  void check_outcome();
  void end_kept();

  // For what puts a bus of servos back; null for boards.
  std::function<std::string()> still_on() const {
    if (!names_servo_bus(options_.backend.robot)) return nullptr;
    return [this] { return backend_->still_on(); };
  }
  bool real() const { return backend_->port() != nullptr; }
  const OutputFolder* folder() const { return results_ ? &*results_ : nullptr; }
  bool interrupted() const { return !outcome_ && outcome_.error().fault == Fault::interrupted; }

  SessionOptions options_;
  behavior::Behavior behavior_;
  behavior::OptionValues values_;
  std::optional<OutputFolder> results_;
  bool recorded_ = false;  // the recording grows in that folder
  std::optional<FileRemover> remove_recording_;
  host::Interrupt interrupt_;
  std::optional<InterruptSignals> signals_;
  std::unique_ptr<SessionBackend> backend_;
  std::vector<std::unique_ptr<KeptRun>> kept_;  // of each board at a port
  std::optional<WatchedClock> clock_;
  std::optional<host::Robot> robot_;
  std::optional<RememberingCamera> camera_;
  std::optional<host::Capture> capture_;
  std::optional<vision::Pipeline> pipeline_;
  std::optional<DeliveryTable> deliveries_;
  std::optional<behavior::PipelineBallDetector> detector_;
  std::optional<behavior::PipelineFloorDetector> floor_;
  std::optional<Snapshots> snapshots_;
  std::optional<Progress> progress_;
  Time start_{};
  std::optional<sim::ScenePose> start_pose_;  // of a simulated world
  std::optional<Listener> listener_;
  std::optional<RecordedRequests> requests_;

  // How it went.
  Result<behavior::Outcome> outcome_;
  bool threw_ = false;
  std::optional<RunLatenessMeter> lateness_meter_;  // at a port
  std::optional<RunLateness> lateness_;
  bool machine_failed_ = false;
  Steady::time_point wall_start_;
  double run_s_ = 0, wall_s_ = 0;
  std::vector<faults::Fault> not_begun_;
  std::optional<RunProfile> profile_;
  Result<kz_statistics_reply> health_;
  Result<void> left_;           // the board, as it was found or not
  Result<std::string> sha256_;  // of the recording, once it has ended
};

// Checks and locks what can be without opening anything.
Result<void> Session::prepare() {
  behavior_ = KAZ_TRY(behavior::named_behavior(options_.behavior));
  values_ = KAZ_TRY(behavior::OptionValues::parse(behavior_.options, options_.settings));
  KAZ_TRY(parse_modules(options_.vision.modules));
  // As the behavior itself says, but before a folder has anything of it.
  if (behavior_.takes_requests && !options_.requests)
    return fail(Fault::usage, behavior::kNoRequests);
  if (!options_.open_backend)
    options_.backend.joints = KAZ_TRY(other_joints(options_.backend.robot_file));
  options_.backend.needs_camera = behavior_.needs_camera;
  KAZ_TRY(check(options_.backend));

  if (!options_.out.empty()) {
    auto opened = OutputFolder::open(options_.out, run_output());
    if (!opened && opened.error().fault == Fault::environment)
      return tl::unexpected(lost(opened.error()));
    results_ = KAZ_TRY(std::move(opened));
  }
  recorded_ = results_ && options_.backend.recording.empty() && !options_.open_backend;
  if (recorded_) options_.backend.recording = growing_recording(*results_);
  // Of a run that does not begin nothing is left.
  remove_recording_.emplace(recorded_ ? options_.backend.recording : "");
  options_.backend.facts = facts_of(options_);
  return {};
}

Result<void> Session::open_backend() {
  signals_.emplace(interrupt_);
  auto backend = options_.open_backend ? options_.open_backend(interrupt_)
                                       : SessionBackend::open(options_.backend, interrupt_);
  if (!backend) {
    Error error = backend.error();
    if (error.fault == Fault::environment && options_.on_loss) options_.on_loss(error);
    return tl::unexpected(std::move(error));
  }
  backend_ = std::move(*backend);
  return {};
}

Result<void> Session::connect() {
  const Time connecting = backend_->clock().now();
  const auto report_loss = [this, connecting](const host::Loss& loss) {
    // Not the link: the virtual robot stopped where its recording could not be written.
    if (backend_->recording_failed()) return;
    std::fprintf(stderr, "\n%s: after %.1f s %s; retrying for up to %.3g s: %s\n",
                 options_.label.c_str(), seconds(loss.at - connecting), text(loss.cause),
                 seconds(loss.at_most), loss.why.c_str());
  };
  const auto report_resumption = [this, connecting](const host::Resumption& resumption) {
    if (resumption.reported) {
      std::fprintf(
          stderr, "\n%s: the link is back after %.2f s%s\n", options_.label.c_str(),
          seconds(resumption.resumed - resumption.lost),
          resumption.cause == host::Resumption::Cause::reset ? "; the board was reset" : "");
      return;
    }
    std::fprintf(stderr, "\n%s: after %.1f s %s; the board answered again %.2f s later\n",
                 options_.label.c_str(), seconds(resumption.lost - connecting),
                 text(resumption.cause), seconds(resumption.resumed - resumption.lost));
  };
  if (real()) {
    for (const host::RobotBoard& board : backend_->boards())
      kept_.push_back(KAZ_TRY(KeptRun::begin(*board.link, backend_->clock(), interrupt_,
                                             {.verb = options_.label,
                                              .port = board.link->name(),
                                              .address = board.address,
                                              .motors_off = false,
                                              .still_on = still_on(),
                                              .notes = false})));
  }
  clock_.emplace(backend_->clock(), backend_->simulation(), options_.onlooker, options_.until,
                 interrupt_);
  auto robot = host::Robot::connect(backend_->boards(), *clock_,
                                    {.reaction = options_.backend.reaction,
                                     .reconnect = from_seconds(options_.backend.reconnect_s),
                                     .on_lost = report_loss,
                                     .on_resumed = report_resumption,
                                     .frames_path = !real()    ? std::string()
                                                    : results_ ? results_->path("frames.txt")
                                                               : temporary_file("frames.txt"),
                                     .joint_names = options_.backend.joints});
  if (!robot) {
    // With several boards each has its address in the file.
    std::string& sentence = robot.error().message;
    constexpr std::string_view kOption = "give --address ";
    if (const auto at = sentence.find(kOption);
        options_.backend.robot.starts_with("boards:") && at != std::string::npos)
      sentence.replace(
          at, kOption.size(),
          "change the board's address in " + options_.backend.robot.substr(7) + " to ");
    return tl::unexpected(robot.error());
  }
  robot_ = std::move(*robot);
  // A bus of servos has no board whose answers would show what the line takes.
  if (!real() || names_servo_bus(options_.backend.robot)) return {};
  const auto trip = KAZ_TRY(host::measure_round_trip(*robot_, *backend_->port()));
  if (!options_.json || trip.slow)
    std::fprintf(stderr, "%s: %s\n", options_.label.c_str(), trip.sentence.c_str());
  return {};
}

Result<void> Session::begin_vision() {
  KAZ_TRY(backend_->open_camera());
  if (behavior_.needs_camera && !backend_->sees())
    return tl::unexpected(sim::Simulation::no_eyes());
  camera_.emplace(backend_->camera(), options_.on_pair);
  capture_.emplace(*camera_, *robot_);
  pipeline_.emplace(vision::PipelineOptions{backend_->pace(), backend_->camera_latency()});
  VisionOptions modules = options_.vision;
  const auto names = KAZ_TRY(parse_modules(modules.modules));
  for (const auto& [needed, name] : {std::pair{true, "color"}, {behavior_.needs_floor, "floor"}}) {
    if (needed && std::ranges::find(names, name) == names.end())
      modules.modules = std::string(name) + "," + modules.modules;
  }
  KAZ_TRY(add_modules(modules, *pipeline_));
  deliveries_.emplace(*pipeline_);
  if (options_.watcher != nullptr) options_.watcher->begin(*pipeline_);
  detector_.emplace(*capture_, *pipeline_);
  if (behavior_.needs_floor) floor_.emplace(*pipeline_);
  // Not by interrupt_, which also ends a run that has had its time.
  snapshots_.emplace(*camera_, backend_->simulation(), options_.vision.ball,
                     [] { return received_signal() != 0; });
  return {};
}

// From here on the results are this run's.
Result<void> Session::begin() {
  if (results_) {
    const auto cleared = results_->clear();
    if (!cleared && cleared.error().fault == Fault::environment)
      return tl::unexpected(lost(cleared.error()));
    KAZ_TRY(cleared);
  }
  remove_recording_->keep();
  progress_.emplace(options_.label, options_.json);
  start_ = backend_->clock().now();
  if (const auto* simulation = backend_->simulation()) start_pose_ = simulation->world().pose();
  listener_.emplace(*backend_, options_.listener, *snapshots_, *progress_, start_,
                    expected_seconds(values_, behavior_.options));
  return {};
}

void Session::perform() {
  wall_start_ = Steady::now();
  behavior::Context context{*robot_,    robot_->clock(), backend_->sees() ? &*detector_ : nullptr,
                            *listener_, values_,         options_.backend.seed};
  context.ball_radius_m = options_.vision.ball.radius_m;
  if (floor_ && backend_->sees()) context.floor = &*floor_;
  if (options_.requests && behavior_.takes_requests)
    context.requests = &requests_.emplace(options_.requests, *listener_);
  if (real()) context.camera = "camera " + options_.backend.camera;
  context.other_joints = options_.backend.joints;
  if (is_real_camera(options_.backend.camera)) context.camera_patience = kCameraPatience;
  std::optional<RunProfiler> profiler;
  if (options_.profile) profiler.emplace();
  // Also where the link is lost and comes back when the run has given up.
  for (const auto& kept : kept_) kept->switch_motors_off();
  if (real()) lateness_meter_.emplace(backend_->link(), interrupt_);
  {
    const ProfileScope host("behavior and link");
    run_behavior(context);
  }
  take_times();
  if (profiler) profile_ = profiler->end(run_s_);
  if (threw_ && options_.on_throw) options_.on_throw();
  check_outcome();
}

void Session::take_times() {
  wall_s_ = std::chrono::duration<double>(Steady::now() - wall_start_).count();
  run_s_ = seconds(backend_->clock().now() - start_);
  not_begun_ = backend_->faults_not_begun();
}

// An exception is an error as others: motors go off, files are finished.
void Session::run_behavior(behavior::Context& context) {
  try {
    outcome_ = behavior_.run(context);
  } catch (...) {
    threw_ = true;
    outcome_ = tl::unexpected(behavior::thrown_error(options_.behavior));
  }
}

// Completes the outcome of the behavior, and makes it agree with a received interrupt.
void Session::check_outcome() {
  if (received_signal() != 0 && interrupt_.requested()) {
    outcome_ = tl::unexpected(host::Interrupt::error());
  } else if (!outcome_) {
    Error& error = outcome_.error();
    if (error.fault == Fault::interrupted && !clock_->ended()) error.fault = Fault::failed;
    if (error.message.empty())
      error.message = options_.behavior + " returned an error without a message";
    // The robot has failed, as one has that has found no ball: of this there is a whole report.
    if (error.fault == Fault::failed && !threw_ && !clock_->ended())
      outcome_ = behavior::Outcome{false, std::string(error.message), {}, "error"};
  } else if (outcome_->sentence.empty()) {
    outcome_->sentence = options_.behavior + " returned an outcome without a sentence";
  }
}

// A failure while this program or the simulator at the port was late is the machine's. Not one that an error
// has caused: that the board has switched its motors off is true on any machine.
void Session::excuse_failure() {
  if (!outcome_ || outcome_->success || outcome_->cause == "error") return;
  if (!lateness_ || lateness_->excuse.empty()) return;
  machine_failed_ = true;
  outcome_->sentence = "the result is undecided; the run failed (" + outcome_->sentence +
                       "), but possibly not because of the robot: " + lateness_->excuse +
                       "; end other programs and try again";
}

void Session::end_kept() {
  for (const auto& kept : kept_) {
    auto ended = kept->end();
    if (!ended && left_) left_ = std::move(ended);
  }
}

// The time of SessionOptions::until has come.
Result<bool> Session::end_in_time() {
  progress_->done();
  pipeline_->finish();
  if (options_.watcher != nullptr) options_.watcher->end(*pipeline_);
  KAZ_TRY(backend_->finish_recording());
  return false;
}

// Motors off, and the board as it was found; everything that goes on meanwhile ends.
void Session::settle() {
  std::optional<host::CleanUp> clean_up;
  if (interrupted()) {
    // What follows is no part of the run, and not recorded.
    sha256_ = backend_->finish_recording(received_signal_name());
    clean_up.emplace(interrupt_);
  }
  if (outcome_ || interrupted()) health_ = robot_->board_statistics();
  const auto off = robot_->disable_all();
  clean_up.reset();
  // Behind the motors' end: it takes up to 0.1 s, in which nothing is sent, and would let the board's
  // link watchdog expire. A simulator that is asked after it has stopped answering would be waited for.
  if (lateness_meter_ && (outcome_ || interrupted())) lateness_ = lateness_meter_->end();
  excuse_failure();
  progress_->done();
  // At once: putting the board back, which tries again, may take seconds.
  if (!off && real()) {
    const std::string on = backend_->still_on();
    std::fprintf(stderr, "%s: %s\n", options_.label.c_str(),
                 (on.empty() ? off.error().message : on).c_str());
  }
  end_kept();
  pipeline_->finish();
  if (options_.watcher != nullptr) options_.watcher->end(*pipeline_);
}

// The error of a run of which there is nothing more to report.
Result<void> Session::check_end() {
  if (!sha256_) return tl::unexpected(lost(sha256_.error()));
  if (interrupted()) {
    if (!left_)
      std::fprintf(stderr, "%s: %s\n", options_.label.c_str(), left_.error().message.c_str());
    if (!options_.keep_interrupted) return tl::unexpected(outcome_.error());
    return {};
  }
  if (!outcome_) {
    const bool unrecorded = backend_->recording_failed();
    Error error = with_recording(together(outcome_, left_).error(), *backend_, folder(), recorded_,
                                 threw_ ? "an exception" : "");
    // For an evaluation nothing but the robot can fail to answer in lockstep, unless the recording
    // cannot be written; at a port it is the line, too.
    if ((real() || threw_ || unrecorded) && error.fault == Fault::environment)
      error = lost(std::move(error));
    else if (threw_)
      write_end("failed", "crashed", error.message);
    else if (error.fault == Fault::environment)
      write_end("environment", "", error.message);
    return tl::unexpected(std::move(error));
  }
  if (!health_) return tl::unexpected(health_.error());
  if (outcome_->success || left_) return left_;
  std::fprintf(stderr, "%s: %s\n", options_.label.c_str(), left_.error().message.c_str());
  return {};
}

// The end of a run that broke off, as its result. On a full disk it may be missing, and the table sooner.
void Session::write_end(const char* outcome, const char* cause, const std::string& sentence) {
  if (folder() == nullptr) return;
  nlohmann::ordered_json result =
      broken_off_json(outcome, sentence, options_.behavior, options_.backend);
  if (*cause != '\0') result["cause"] = cause;
  if (wall_s_ > 0) add_times(result, run_s_, run_s_ / wall_s_);
  if (pipeline_) {
    if (auto vision = module_statistics_json(*pipeline_); !vision.empty())
      result["vision"] = std::move(vision);
  }
  (void)folder()->write_json("result.json", result);
  if (deliveries_) (void)folder()->write("vision.csv", deliveries_->text());
}

// The machine's fault: reported to the caller, and kept as the run's outcome.
Error Session::lost(Error error) {
  write_end("environment", "", error.message);
  if (options_.on_loss) options_.on_loss(error);
  return error;
}

Result<bool> Session::report() {
  if (!interrupted() && options_.worth_keeping && !options_.worth_keeping()) {
    if (recorded_) remove_recording_.emplace(options_.backend.recording);
    return outcome_->success;
  }
  if (!interrupted()) sha256_ = backend_->finish_recording();
  if (!sha256_) return tl::unexpected(lost(sha256_.error()));
  const behavior::Outcome cut_short{
      false, "ended by " + std::string(received_signal_name()), {}, {}};
  const RunReport report{options_.behavior,
                         options_.backend,
                         interrupted() ? cut_short : *outcome_,
                         run_s_,
                         run_s_ / wall_s_,
                         score(listener_->recording(), listener_->probe(), start_),
                         robot_->identity(),
                         health_.value_or(kz_statistics_reply{}),
                         robot_->statistics(),
                         start_,
                         listener_->recording(),
                         listener_->probe(),
                         module_statistics_json(*pipeline_),
                         module_statistics_text(*pipeline_),
                         deliveries_->text(),
                         interrupted(),
                         std::move(profile_),
                         *sha256_,
                         backend_->camera_warning(),
                         lateness_,
                         machine_failed_,
                         &listener_->map(),
                         not_begun_,
                         std::move(start_pose_),
                         behavior_.needs_camera};
  sim::Simulation* const simulation = backend_->simulation();
  const auto written = write_report(report, simulation, *snapshots_, folder(), recorded_);
  if (!written) {
    // The run's outcome is known, whatever its folder holds.
    const auto without = write_report(report, simulation, *snapshots_, nullptr, false);
    if (without && options_.json && !options_.quiet)
      print_report(*without, report, options_.out, true);
    return tl::unexpected(lost(written.error()));
  }
  const bool undrawn = !interrupted() && written->contains("interrupted");
  if (!options_.quiet) print_report(*written, report, options_.out, options_.json);
  if (!not_begun_.empty())
    std::fprintf(stderr, "%s: %s\n", options_.label.c_str(),
                 faults::not_begun_text(not_begun_).c_str());
  if (machine_failed_) {
    Error error{Fault::environment, outcome_->sentence};
    if (options_.on_loss) options_.on_loss(error);
    return tl::unexpected(std::move(error));
  }
  if (undrawn)
    return fail(Fault::interrupted, "interrupted while pictures were drawn; the run had ended (" +
                                        outcome_->sentence +
                                        "), and the results so far are kept in " + options_.out);
  if (!interrupted()) return outcome_->success;
  char until[48];
  std::snprintf(until, sizeof until, "interrupted at %.2f s", run_s_);
  return fail(Fault::interrupted,
              until + (options_.out.empty() ? std::string("; without --out, nothing is kept")
                                            : "; the results so far are kept in " + options_.out));
}

}  // namespace

Result<bool> run_session(SessionOptions options) {
  return Session(std::move(options)).run();
}

}  // namespace kaz::tools
