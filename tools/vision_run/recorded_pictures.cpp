// `kaz vision run`: the modules of vision on pictures in a folder.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision_run/recorded_pictures.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "shared/base/counted.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/drawing/figure.h"
#include "tools/vision/color_file.h"
#include "tools/vision/report.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/rectify.h"
#include "vision/color/ball.h"
#include "vision/color/ball_outline.h"
#include "vision/image/picture_file.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using vision::BallObservation;
using vision::Image;

Result<std::vector<std::string>> pictures_in(const std::string& folder) {
  std::error_code error;
  if (fs::is_regular_file(folder, error)) return std::vector{folder};
  std::vector<std::string> paths;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::string ending = at->path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* known : {".png", ".jpg", ".jpeg", ".ppm", ".pgm"}) {
      if (ending == known && at->is_regular_file(error)) paths.push_back(at->path().string());
    }
  }
  if (error) return fail(Fault::usage, "--in '" + folder + "' cannot be read: " + error.message());
  if (paths.empty())
    return fail(Fault::usage, "--in '" + folder + "' contains no picture (.png .jpg .ppm .pgm)");
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Pictures as a pinhole would give them, and that pinhole.
class Lens {
 public:
  static Result<Lens> of(const RecordedOptions& options) {
    Lens lens;
    lens.view_deg_ = options.view_deg;
    if (options.calibration.empty()) return lens;
    const auto calibration = KAZ_TRY(vision::read_calibration(options.calibration));
    lens.calibration_ = calibration;
    lens.rectifier_.emplace(calibration);
    return lens;
  }
  bool has_model() const { return rectifier_ || view_deg_ > 0; }
  // Makes of a picture of the left eye what its model is of.
  Result<vision::CameraModel> prepare(Image& image) const {
    if (rectifier_) {
      if (image.width != calibration_.width || image.height != calibration_.height)
        return fail(Fault::usage, "its size is " + std::to_string(image.width) + " x " +
                                      std::to_string(image.height) + ": must be " +
                                      std::to_string(calibration_.width) + " x " +
                                      std::to_string(calibration_.height) +
                                      ", as in the calibration");
      vision::StereoImages raw{image, image}, rectified;
      rectifier_->rectify(raw, rectified);
      image = std::move(rectified.left);
      return calibration_.rectified;
    }
    const double focal = 0.5 * image.width / std::tan(view_deg_ * 3.14159265358979323846 / 360);
    return vision::CameraModel{image.width,
                               image.height,
                               focal,
                               focal,
                               0.5 * (image.width - 1),
                               0.5 * (image.height - 1),
                               0};
  }

 private:
  vision::StereoCalibration calibration_;
  std::optional<vision::Rectifier> rectifier_;
  double view_deg_ = 0;
};

struct Looked {
  std::string picture, error;
  BallObservation ball;
  std::vector<vision::BallOutline> outlines;  // all balls, best first; only without a camera model
  double ms = 0;
};

// Finds the ball with its distance if the lens has a camera model, else all balls in pixels.
class PictureSearch {
 public:
  PictureSearch(const Lens& lens, const vision::BallOptions& ball)
      : lens_(lens), balls_(ball), outlines_({.color = ball.color}) {}

  bool measures() const { return lens_.has_model(); }
  // Rectifies `image` if the lens has a calibration.
  void search(Image& image, Looked& looked) {
    vision::FrameInfo info;
    if (measures()) {
      const auto camera = lens_.prepare(image);
      if (!camera) {
        looked.error = camera.error().message;
        return;
      }
      info.camera = *camera;
    }
    const auto begin = std::chrono::steady_clock::now();
    if (measures()) {
      looked.ball = balls_.detect(image, info);
    } else {
      looked.outlines = outlines_.find(image);
    }
    looked.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (looked.ball.error) looked.error = looked.ball.error->message;
    if (!looked.outlines.empty()) looked.ball = in_pixels(looked.outlines.front());
  }
  const vision::Mask& mask() const { return measures() ? balls_.mask() : outlines_.mask(); }

 private:
  static BallObservation in_pixels(const vision::BallOutline& outline) {
    BallObservation ball;
    ball.found = true;
    ball.center_u = outline.center_u;
    ball.center_v = outline.center_v;
    ball.radius_px = outline.radius_px;
    ball.confidence = outline.confidence;
    return ball;
  }

  const Lens& lens_;
  vision::BallFinder balls_;
  vision::OutlineFinder outlines_;
};

Image overlay(const Image& image, const vision::Mask& mask, const Looked& looked) {
  Image marked = image;
  const BallObservation& ball = looked.ball;
  const double size = std::max(10.0, image.width / 40.0);
  for (const vision::BallOutline& one : looked.outlines)
    figure::draw_circle(marked, one.center_u, one.center_v, one.radius_px + 2, figure::kYellow,
                        1.5);
  if (ball.found && looked.outlines.empty()) {
    figure::draw_circle(marked, ball.center_u, ball.center_v, ball.radius_px + 2, figure::kYellow,
                        1.5);
    char text[64];
    std::snprintf(text, sizeof text, "%.3f m", ball.distance_m);
    figure::draw_text(marked, ball.center_u + ball.radius_px + 6, ball.center_v + 4, text, size,
                      figure::kYellow);
  }
  const figure::Panel panels[] = {{std::move(marked), ball.found ? "ball" : "no ball"},
                                  {figure::mask_picture(mask, image), "color"}};
  return figure::compose(panels, 2, image.height);
}

Json outline_json(const vision::BallOutline& outline) {
  return {{"center_px", {outline.center_u, outline.center_v}},
          {"radius_px", outline.radius_px},
          {"confidence", outline.confidence}};
}

Json as_json(const Looked& looked, bool measures) {
  Json one{{"picture", looked.picture}};
  if (measures) {
    one.update(ball_json(looked.ball));
  } else {
    one["found"] = looked.ball.found;
    if (looked.ball.found) one.update(outline_json(looked.outlines.front()));
    one["balls"] = Json::array();
    for (const vision::BallOutline& outline : looked.outlines)
      one["balls"].push_back(outline_json(outline));
  }
  if (!looked.error.empty()) one["error"] = looked.error;
  return one;
}

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) all += c == '"' ? std::string("\"\"") : std::string(1, c);
  return all + "\"";
}

std::string csv(const std::vector<Looked>& all, bool measures) {
  std::string text =
      "picture,found,center_u_px,center_v_px,radius_px,distance_m,x_m,y_m,z_m,confidence,error\n";
  for (const Looked& one : all) {
    char numbers[200] = ",,,,,,,";
    const BallObservation& b = one.ball;
    const Eigen::Vector3d at = b.position();
    if (b.found && !measures)
      std::snprintf(numbers, sizeof numbers, "%.3f,%.3f,%.3f,,,,,%.3f", b.center_u, b.center_v,
                    b.radius_px, b.confidence);
    else if (b.found)
      std::snprintf(numbers, sizeof numbers, "%.3f,%.3f,%.3f,%.5f,%.5f,%.5f,%.5f,%.3f", b.center_u,
                    b.center_v, b.radius_px, b.distance_m, at.x(), at.y(), at.z(), b.confidence);
    text += quoted(one.picture) + "," + (b.found ? "1," : "0,") + numbers + "," +
            (one.error.empty() ? std::string() : quoted(one.error)) + "\n";
  }
  return text;
}

// One picture; its overlay is written, if it could be looked at.
Result<Looked> look(const std::string& path, PictureSearch& search, const OutputFolder& folder) {
  Looked looked{fs::path(path).filename().string(), {}, {}, {}, 0};
  auto image = vision::read_picture(path);
  if (!image) {
    looked.error = image.error().message.substr(path.size() + 2);
    return looked;
  }
  search.search(*image, looked);
  if (!looked.error.empty()) return looked;
  KAZ_TRY(figure::write_png(folder.path(looked.picture + ".ball.png"),
                            overlay(*image, search.mask(), looked)));
  return looked;
}

Result<bool> report(const std::vector<Looked>& all, const RecordedOptions& options,
                    const vision::ColorRange& color, bool measures, const OutputFolder& folder,
                    bool interrupted) {
  KAZ_TRY(folder.write("ball.csv", csv(all, measures)));
  std::vector<double> ms;
  Json pictures = Json::array();
  int found = 0;
  for (const Looked& one : all) {
    pictures.push_back(as_json(one, measures));
    found += one.ball.found;
    if (one.error.empty()) ms.push_back(one.ms);
  }
  std::sort(ms.begin(), ms.end());
  Json result{{"modules", {"color"}},
              {"pictures_in", options.in},
              {"pictures_looked_at", ms.size()},
              {"balls", found},
              {"color", color_json(color)}};
  if (measures) result["radius_m"] = options.radius_m;
  if (!ms.empty()) result["latency_ms"] = {{"median", ms[ms.size() / 2]}, {"max", ms.back()}};
  result["pictures"] = pictures;
  result["provenance"] = provenance_json();
  if (interrupted) mark_interrupted(result);
  KAZ_TRY(folder.write_json("result.json", result));
  if (ms.empty() && !interrupted)
    return fail(Fault::failed, "none of " + counted(all.size(), "picture") + " in '" + options.in +
                                   "' could be processed; the first, '" + all.front().picture +
                                   "': " + all.front().error);
  if (options.json) {
    print_json(result);
  } else {
    for (const Looked& one : all) {
      if (!one.error.empty())
        std::printf("left out: %s: %s\n", one.picture.c_str(), one.error.c_str());
    }
    std::printf(
        "%s in %zu of %s, %.2f ms per picture (median); overlays, ball.csv and result.json in %s\n",
        counted(found, "ball").c_str(), ms.size(), counted(all.size(), "picture").c_str(),
        ms[ms.size() / 2], options.out.c_str());
  }
  if (interrupted)
    return fail(
        Fault::interrupted,
        "interrupted; the results obtained before the interruption are kept in " + options.out);
  return true;
}

}  // namespace

const OutputKind& vision_output() {
  static const OutputKind kind{"vision run",
                               {"result.json", "frames.csv", "ball.csv", "*.vision.png",
                                "*.ball.png", "*.depth.png", "*.points.ply"}};
  return kind;
}

Result<vision::BallOptions> ball_options(const RecordedOptions& options) {
  vision::BallOptions ball;
  ball.radius_m = options.radius_m;
  if (!options.color.empty()) {
    const auto color = KAZ_TRY(read_color(options.color));
    ball.color = color;
  }
  return ball;
}

Result<bool> run_on_pictures(const RecordedOptions& options) {
  if (options.modules != "color")
    return fail(Fault::usage, "--modules '" + options.modules +
                                  "': only color is possible with single pictures. Pairs (--left, "
                                  "--right), recordings and cameras have more modules: " +
                                  module_names());
  if (!options.exported.empty())
    return fail(Fault::usage, "--export " + options.exported +
                                  ": single pictures have no depth; give pairs (--left, --right), "
                                  "a recording or a camera");
  if (options.nearest_m)
    return fail(Fault::usage,
                "--nearest is only valid with depth, which single pictures do not have: leave out "
                "--nearest, or give pairs (--left, --right)");
  if (!options.calibration.empty() && options.view_deg != 0)
    return fail(Fault::usage,
                "--calibration and --view are both camera models: give only one of them");
  auto paths = KAZ_TRY(pictures_in(options.in));
  if (options.frames > 0 && options.frames < paths.size()) paths.resize(options.frames);
  const auto lens = KAZ_TRY(Lens::of(options));
  const auto ball = KAZ_TRY(ball_options(options));
  std::error_code error;
  if (fs::equivalent(options.in, options.out, error))
    return fail(Fault::usage, "--out is the folder of --in: choose another folder for the results");
  const auto folder = KAZ_TRY(OutputFolder::begin(options.out, vision_output()));
  PictureSearch search(lens, ball);
  std::vector<Looked> all;
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  {
    Progress progress("kaz vision", options.json);
    for (const std::string& path : paths) {
      if (interrupt.requested()) break;
      progress.update(static_cast<double>(all.size()) / static_cast<double>(paths.size()),
                      fs::path(path).filename().string());
      auto looked = KAZ_TRY(look(path, search, folder));
      all.push_back(std::move(looked));
    }
    if (all.size() == paths.size()) progress.update(1, "done");
  }
  const bool interrupted = all.size() < paths.size();
  return report(all, options, ball.color, search.measures(), folder, interrupted);
}

}  // namespace kaz::tools
