// Options, checks and the end of runs on stereo pairs.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision_run/stereo_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "shared/base/counted.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "vision/depth/swapped_cameras.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

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

Result<void> refuse(const VisionOptions& vision, std::initializer_list<std::string_view> modules,
                    const std::string& why) {
  const auto names = parse_modules(vision.modules);
  for (const std::string& name : *names) {
    if (std::find(modules.begin(), modules.end(), name) != modules.end())
      return fail(Fault::usage, "--modules " + name + ": " + why);
  }
  return {};
}

Result<bool> finish(VisionReport& report, const Json& statistics, const std::string& text,
                    const RecordedOptions& options, const VisionOptions& vision,
                    const OutputFolder& folder, bool interrupted, const std::string& lost) {
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

}  // namespace kaz::tools
