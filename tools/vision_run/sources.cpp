// `kaz vision run` on stereo pairs: of files, of a live camera, of a recording.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "host/camera/capture.h"
#include "host/link/wall_clock.h"
#include "host/robot/robot.h"
#include "shared/base/counted.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/kept/kept_run.h"
#include "tools/replay/replay.h"
#include "tools/run/backend.h"
#include "tools/run/live_camera.h"
#include "tools/run/run_observer.h"
#include "tools/vision/picture_pairs.h"
#include "tools/vision/report.h"
#include "tools/vision_run/others_recording.h"
#include "tools/vision_run/recorded_pictures.h"
#include "tools/vision_run/stereo_run.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/rectify.h"
#include "vision/image/picture_file.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

tl::unexpected<Error> same_picture(const PicturePair& files) {
  return fail(Fault::usage,
              "'" + files.left + "' and '" + files.right +
                  "' are the same picture: give --left and --right pictures of two eyes");
}

// Reads and rectifies pairs of files.
struct PairReader {
  vision::StereoCalibration calibration;
  vision::Rectifier rectifier;

  Result<vision::StereoImages> read(const PicturePair& files) const {
    vision::StereoImages raw, rectified;
    for (const auto& [path, image] :
         {std::pair(&files.left, &raw.left), std::pair(&files.right, &raw.right)}) {
      auto read = KAZ_TRY(vision::read_picture(*path));
      if (read.width != calibration.width || read.height != calibration.height)
        return fail(Fault::usage, *path + ": its size is " + std::to_string(read.width) + " x " +
                                      std::to_string(read.height) + ": must be " +
                                      std::to_string(calibration.width) + " x " +
                                      std::to_string(calibration.height) +
                                      ", as in the calibration");
      *image = std::move(read);
    }
    if (raw.left.rgb == raw.right.rgb) return same_picture(files);
    rectifier.rectify(raw, rectified);
    return rectified;
  }
};

tl::unexpected<Error> only_others_have_topics() {
  return fail(Fault::usage,
              "--topics is only valid with a recording of another program; leave out --topics");
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

// For a run that a recording is of.
class RecordingObserver final : public RunObserver {
 public:
  RecordingObserver(const VisionOptions& options, const OutputFolder& folder, std::uint64_t count)
      : options_(options), folder_(folder), max_(count) {}
  void begin_vision(vision::Pipeline& pipeline) override {
    report_.emplace(pipeline, options_, &folder_, max_);
  }
  void end_vision(const vision::Pipeline& pipeline) override {
    statistics = module_statistics_json(pipeline);
    text = module_statistics_text(pipeline);
  }
  bool has_all_pictures() const override { return report_ && report_->full(); }
  VisionReport* report() { return report_ ? &*report_ : nullptr; }
  Json statistics;
  std::string text;

 private:
  VisionOptions options_;
  const OutputFolder& folder_;
  std::uint64_t max_;
  std::optional<VisionReport> report_;
};

// The camera, and the robot that has it, if there is one at a port.
struct LiveSource {
  std::unique_ptr<SessionBackend> backend;
  std::optional<host::Robot> robot;
  LiveCamera alone;
  std::optional<host::Capture> capture;
  vision::Camera* camera = nullptr;

  Result<void> open(const RecordedOptions& options, host::Interrupt& interrupt) {
    if (options.robot.empty()) {
      auto connected = KAZ_TRY(open_live_camera(options.in, options.calibration));
      alone = std::move(connected);
      camera = alone.camera.get();
      return {};
    }
    BackendOptions rig_options;
    rig_options.robot = options.robot;
    rig_options.address = options.address;
    rig_options.camera = options.in;
    rig_options.calibration = options.calibration;
    auto opened = KAZ_TRY(SessionBackend::open(rig_options, interrupt));
    backend = std::move(opened);
    auto connected =
        host::Robot::connect(backend->boards(), backend->clock(), {.watchdog = Time::zero()});
    const std::string port = backend->port() ? backend->port()->name() : "";
    if (!connected) return tl::unexpected(with_earlier_notes(connected.error(), port));
    for (const std::string& sentence : earlier_notes(port))
      std::fprintf(stderr, "kaz vision: %s\n", sentence.c_str());
    robot.emplace(std::move(*connected));
    if (auto seen = backend->open_camera(); !seen) return seen;
    capture.emplace(backend->camera(), *robot);
    camera = &*capture;
    return {};
  }
};

}  // namespace

Result<bool> run_on_pairs(const RecordedOptions& options) {
  const auto vision = vision_options(options);
  if (!vision) return tl::unexpected(vision.error());
  if (auto fits =
          refuse(*vision, {"flow", "moving", "floor"},
                 "pairs of files contain only pictures, but this module also needs their times or "
                 "the robot's posture; use a recording, or a live camera with --robot");
      !fits)
    return tl::unexpected(fits.error());
  if (!options.robot.empty())
    return fail(Fault::usage,
                "--robot is only valid with a live camera, not with --left and --right");
  if (options.calibration.empty())
    return fail(Fault::usage, "stereo pairs need --calibration FILE (kaz calibrate stereo)");
  const auto files = KAZ_TRY(find_pairs(options.left, options.right));
  for (const PicturePair& pair : files) {
    std::error_code error;
    if (std::filesystem::equivalent(pair.left, pair.right, error)) return same_picture(pair);
  }
  const auto calibration = KAZ_TRY(vision::read_calibration(options.calibration));
  KAZ_TRY(check_nearest(options, calibration.rectified));
  const auto folder = KAZ_TRY(OutputFolder::begin(options.out, vision_output()));
  const PairReader reader{calibration, vision::Rectifier(calibration)};

  vision::Pipeline pipeline({vision::Pace::lockstep, Time(0)});
  KAZ_TRY(add_modules(*vision, pipeline));
  VisionReport report(pipeline, *vision, &folder);
  Progress progress("kaz vision", options.json);
  const std::size_t count =
      options.frames > 0 ? std::min<std::size_t>(options.frames, files.size()) : files.size();
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  bool interrupted = false;
  // Nothing says when the pictures were taken: a second apart, so that each is a frame of its own.
  for (std::size_t i = 0; i < count; ++i) {
    if ((interrupted = interrupt.requested())) break;
    const PicturePair& pair = files[i];
    const std::string left = file_name(pair.left);
    progress.update(static_cast<double>(i) / static_cast<double>(count), left);
    const Json facts{{"left", left}, {"right", file_name(pair.right)}};
    auto images = reader.read(pair);
    if (!images) {
      report.add_error(facts, images.error().message);
      continue;
    }
    vision::FrameInfo info;
    info.sequence = i;
    info.exposure = std::chrono::seconds(i);
    info.camera = calibration.rectified;
    report.begin(i, left, facts);
    pipeline.submit(vision::stereo_pair(std::move(info), std::move(*images)));
    pipeline.finish();
  }
  if (!interrupted) progress.update(1, "done");
  progress.done();
  return finish(report, module_statistics_json(pipeline), module_statistics_text(pipeline), options,
                *vision, folder, interrupted);
}

Result<bool> run_on_camera(const RecordedOptions& options) {
  const auto vision = vision_options(options);
  if (!vision) return tl::unexpected(vision.error());
  if (options.robot.empty()) {
    if (auto fits =
            refuse(*vision, {"moving", "floor"},
                   "needs the robot's posture: give --robot PORT, with the port of the robot that "
                   "carries these cameras");
        !fits)
      return tl::unexpected(fits.error());
  }
  if (options.view_deg != 0)
    return fail(Fault::usage,
                is_real_camera(options.in)
                    ? "--view is only valid with folders of pictures; real cameras need "
                      "--calibration FILE (kaz calibrate stereo)"
                    : "--view is only valid with folders of pictures; " + options.in +
                          " has its own camera model: leave out --view");
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  host::WallClock clock(&interrupt);
  const auto folder = KAZ_TRY(OutputFolder::open(options.out, vision_output()));
  LiveSource source;
  KAZ_TRY(source.open(options, interrupt));
  KAZ_TRY(check_nearest(options, source.camera->model()));
  KAZ_TRY(folder.clear());

  vision::Pipeline pipeline({vision::Pace::realtime, Time(0)});
  KAZ_TRY(add_modules(*vision, pipeline));
  VisionReport report(pipeline, *vision, &folder, options.frames);
  Progress progress("kaz vision", options.json);
  std::string end;
  const Time begun = clock.now();
  while (end.empty() && !report.full()) {
    // The board's state between pictures: what frames get their posture from.
    if (source.robot) {
      if (auto state = source.robot->state(); !state) {
        end = state.error().message;
        break;
      }
    }
    for (;;) {
      auto pair = source.camera->poll();
      if (!pair) end = pair.error().message;
      if (!pair || !*pair) break;
      pipeline.submit(std::move(**pair));
    }
    pipeline.poll(clock.now());
    const std::string statistics = module_statistics_text(pipeline);
    const std::string state =
        counted(report.frames().size(), "pair") + (statistics.empty() ? "" : "; ") + statistics;
    if (options.frames == 0)  // until somebody ends it
      progress.show(seconds(clock.now() - begun), state);
    else
      progress.update(
          static_cast<double>(report.frames().size()) / static_cast<double>(options.frames), state);
    if (auto slept = clock.sleep_until(clock.now() + std::chrono::milliseconds(5)); !slept)
      end = slept.error().message;
  }
  pipeline.finish();
  progress.done();
  if (interrupt.requested() || report.full()) end.clear();
  if (const std::string summary = source.alone.summary(); !summary.empty())
    std::fprintf(stderr, "kaz vision: cameras: %s\n", summary.c_str());
  return finish(report, module_statistics_json(pipeline), module_statistics_text(pipeline), options,
                *vision, folder, interrupt.requested() && !report.full(), end);
}

Result<bool> run_on_recording(const RecordedOptions& options) {
  const auto vision = KAZ_TRY(vision_options(options));
  std::error_code unknown;
  if (std::filesystem::file_size(options.in, unknown) == 0 && !unknown)
    return fail(Fault::usage, options.in + ": the file is empty");
  const auto recorded = KAZ_TRY(sim::McapRecording::load(options.in));
  if (!recorded.has_kaz_metadata && !recorded.messages.empty())
    return run_on_others_recording(options, recorded, vision);
  if (!options.calibration.empty() || options.view_deg != 0)
    return fail(
        Fault::usage,
        options.in + ": a recording contains its camera model: leave out --calibration and --view");
  if (!options.topics.empty()) return only_others_have_topics();
  KAZ_TRY(recorded.check_run(options.in));
  if (!recorded.has_messages("/eyes/left"))
    return fail(
        Fault::usage,
        options.in + ": the recording has no pictures; record the run with --record-pictures");
  const auto folder = KAZ_TRY(OutputFolder::open(options.out, vision_output()));
  RecordingObserver observer(vision, folder, options.frames);
  ReplayOptions replayed;
  replayed.label = "kaz vision run";
  replayed.file = options.in;
  replayed.mode = ReplayMode::host;
  replayed.quiet = true;
  replayed.json = options.json;
  replayed.vision = vision;
  replayed.observer = &observer;
  replayed.max_pairs = options.frames;
  replayed.on_camera = [&](const vision::CameraModel& camera) -> Result<void> {
    KAZ_TRY(check_nearest(options, camera));
    return folder.clear();
  };
  const auto ran = replay(replayed);
  // The replay's own catching of signals has ended, while overlays are still being written.
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const bool interrupted = !ran && ran.error().fault == Fault::interrupted;
  if (!ran && (!interrupted || observer.report() == nullptr)) return tl::unexpected(ran.error());
  if (observer.report() == nullptr)
    return fail(Fault::usage, options.in + ": no module processed the recording's pictures");
  const std::size_t pairs = recorded.count("/eyes/left");
  if (ran && !*ran && !observer.has_all_pictures() && observer.report()->frames().size() < pairs)
    std::fprintf(
        stderr,
        "kaz vision run: only %zu of %zu recorded pairs were processed, because the repeated run "
        "differed from the recording after these pairs. Perhaps the version of Kaz has changed; "
        "`kaz replay --host %s` prints the first difference\n",
        observer.report()->frames().size(), pairs, options.in.c_str());
  return finish(*observer.report(), observer.statistics, observer.text, options, vision, folder,
                interrupted);
}

Result<bool> run_on_source(const RecordedOptions& options) {
  std::error_code error;
  const auto status = std::filesystem::status(options.in, error);
  if (!options.topics.empty() && (status.type() != std::filesystem::file_type::regular ||
                                  vision::looks_like_picture(options.in)))
    return only_others_have_topics();
  if (is_real_camera(options.in)) return run_on_camera(options);
  if (!options.robot.empty() && status.type() != std::filesystem::file_type::socket)
    return fail(Fault::usage, "--robot is only valid with a live camera, but '" + options.in +
                                  "' is not a live camera");
  switch (status.type()) {
    case std::filesystem::file_type::directory:
      // Of a folder that kaz run made its recording is meant.
      if (options.calibration.empty() && options.view_deg == 0 &&
          std::filesystem::exists(options.in + "/recording.mcap", error)) {
        RecordedOptions recording = options;
        recording.in += "/recording.mcap";
        return run_on_recording(recording);
      }
      return run_on_pictures(options);
    case std::filesystem::file_type::socket:
      return run_on_camera(options);
    case std::filesystem::file_type::regular:
      return vision::looks_like_picture(options.in) ? run_on_pictures(options)
                                                    : run_on_recording(options);
    case std::filesystem::file_type::not_found:
      return fail(Fault::usage,
                  "--in '" + options.in + "': there is no such folder, recording or socket");
    default:
      return fail(Fault::usage,
                  "--in '" + options.in + "' is not a folder, recording or camera socket");
  }
}

}  // namespace kaz::tools
