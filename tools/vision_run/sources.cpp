// `kaz vision run` on stereo pairs: of files, of a live camera, of a recording.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

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
#include "tools/vision_run/recorded_pictures.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/rectify.h"
#include "vision/depth/swapped_cameras.h"
#include "vision/image/picture_file.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

Result<VisionOptions> vision_options(const RecordedOptions& options) {
  VisionOptions vision;
  vision.modules = options.modules;
  vision.depth.nearest_m = options.nearest_m.value_or(vision.depth.nearest_m);
  const auto ball = KAZ_TRY(ball_options(options));
  vision.ball = ball;
  if (!options.exported.empty()) {
    std::istringstream words(options.exported);
    for (std::string word; std::getline(words, word, ',');) {
      if (word != "depth" && word != "points")
        return fail(Fault::usage, "--export '" + word + "': must be depth or points");
      (word == "depth" ? vision.export_depth : vision.export_points) = true;
    }
    if (("," + vision.modules + ",").find(",depth,") == std::string::npos)
      vision.modules += vision.modules.empty() ? "depth" : ",depth";
  }
  const auto modules = KAZ_TRY(parse_modules(vision.modules));
  if (options.nearest_m && std::ranges::find(modules, "depth") == modules.end())
    return fail(Fault::usage, "--nearest is only valid with module depth, which --modules " +
                                  vision.modules +
                                  " does not contain: add depth, or leave out --nearest");
  const bool of_a_ball = !options.color.empty() || options.radius_m != RecordedOptions().radius_m;
  if (of_a_ball && std::ranges::find(modules, "color") == modules.end())
    return fail(Fault::usage, std::string(options.color.empty() ? "--radius" : "--color") +
                                  " is only valid with module color, which --modules " +
                                  vision.modules +
                                  " does not contain: add color, or leave the option out");
  return vision;
}

// What --nearest can change with these eyes: the range of disparities has at least 16 px, and less than the
// picture's width.
Result<void> check_nearest(const RecordedOptions& options, const vision::CameraModel& camera) {
  constexpr double kMinDisparities_px = 16, kMillimetres = 1000;
  const double reach = camera.fx * camera.baseline_m;
  if (!options.nearest_m || !(reach > 0) || camera.width < 2) return {};
  const double given = *options.nearest_m,
               min = std::ceil(kMillimetres * reach / (camera.width - 1)) / kMillimetres,
               max = std::floor(kMillimetres * reach / kMinDisparities_px) / kMillimetres;
  if (given >= min && given <= max) return {};
  char text[200];
  std::snprintf(text, sizeof text,
                "--nearest %g: must be %.3f to %.3f m with these eyes; for example, 14 cm is 0.14",
                given, min, max);
  return fail(Fault::usage, text);
}

// Modules that need a sequence of pictures or the posture, where there is none.
Result<void> refuse(const VisionOptions& vision, std::initializer_list<std::string_view> modules,
                    const std::string& why) {
  const auto names = parse_modules(vision.modules);
  for (const std::string& name : *names) {
    if (std::find(modules.begin(), modules.end(), name) != modules.end())
      return fail(Fault::usage, "--modules " + name + ": " + why);
  }
  return {};
}

// The end of each kind: files and printed summary. `lost`: why the camera or the robot stopped; empty if
// none did.
Result<bool> finish(VisionReport& report, const Json& statistics, const std::string& text,
                    const RecordedOptions& options, const VisionOptions& vision,
                    const OutputFolder& folder, bool interrupted, const std::string& lost = "") {
  KAZ_TRY(report.end());
  // A signal that came while overlays were being written counts, too, if it cost any.
  const std::size_t not_written = report.files_not_written();
  interrupted = interrupted || not_written > 0;
  const std::string without = not_written == 0 ? ""
                                               : "; not written: " + counted(not_written, "file") +
                                                     " (overlays, exports) of the last pairs";
  KAZ_TRY(folder.write("frames.csv", report.table()));
  // With those that the ones named need.
  const auto modules = KAZ_TRY(parse_modules(vision.modules));
  Json result{{"modules", modules},
              {"frames_looked_at", report.looked_at()},
              {"vision", statistics},
              {"frames", report.frames()},
              {"provenance", provenance_json()}};
  if (report.cameras_swapped()) result["warning"] = vision::kSwappedCameras;
  if (interrupted) mark_interrupted(result);
  if (not_written > 0) result["files_not_written"] = not_written;
  if (!lost.empty()) result["ended_early"] = lost;
  KAZ_TRY(folder.write_json("result.json", result));
  if (report.looked_at() == 0 && !interrupted && lost.empty())
    return fail(Fault::failed,
                report.frames().empty()
                    ? "no pair of pictures was received"
                    : "none of " + counted(report.frames().size(), "pair") +
                          " could be processed; the first: " +
                          report.frames().front().value("error", std::string("no result")));
  const auto ended = [&]() -> Result<bool> {
    if (!lost.empty())
      return fail(Fault::environment,
                  lost + "; the results obtained earlier are kept in " + options.out + without);
    if (!interrupted) return true;
    return fail(Fault::interrupted,
                "interrupted; the results obtained before the interruption are kept in " +
                    options.out + without);
  };
  if (options.json) {
    print_json(result);
    return ended();
  }
  constexpr int kMaxReported = 10;
  int reported = 0;
  for (const Json& one : report.frames()) {
    if (!one.contains("error")) continue;
    if (++reported <= kMaxReported)
      print_lines("error: %s\n", one["error"].get<std::string>().c_str());
  }
  if (reported > kMaxReported)
    std::printf("... and %d more (frames.csv)\n", reported - kMaxReported);
  print_lines("%zu of %s processed%s%s\n", report.looked_at(),
              counted(report.frames().size(), "pair").c_str(),
              text.empty() ? "" : "; computing time per pair: ", text.c_str());
  if (report.cameras_swapped()) print_lines("warning: %s\n", vision::kSwappedCameras);
  std::printf("overlays, frames.csv and result.json are in %s\n", options.out.c_str());
  return ended();
}

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
  if (!options.calibration.empty() || options.view_deg != 0)
    return fail(
        Fault::usage,
        options.in + ": a recording contains its camera model: leave out --calibration and --view");
  const auto recorded = KAZ_TRY(sim::McapRecording::load_run(options.in));
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
  if (is_real_camera(options.in)) return run_on_camera(options);
  std::error_code error;
  const auto status = std::filesystem::status(options.in, error);
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
