// `kaz vision run --left --right`: ball, depth and planes in recorded stereo pairs.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

#include "tools/figure/figure.h"
#include "tools/kaz/color_file.h"
#include "tools/kaz/output.h"
#include "tools/kaz/picture_pairs.h"
#include "tools/kaz/recorded_pictures.h"
#include "vision/calibration_file.h"
#include "vision/picture_file.h"
#include "vision/plane_segments.h"
#include "vision/rectify.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;
using vision::Image;
using Latencies = std::map<std::string, std::vector<double>>;  // ms by module

struct Modules {
  bool color = false, depth = false, planes = false;
};

Result<Modules> parse_modules(const std::string& text) {
  Modules modules;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    if (word == "color") {
      modules.color = true;
    } else if (word == "depth") {
      modules.depth = true;
    } else if (word == "planes") {
      modules.planes = true;
    } else {
      return fail(Fault::usage,
                  "--modules '" + word + "' is not known; there are color, depth, planes");
    }
  }
  return modules;
}

// Runs a module and notes how long it took.
template <class Work>
auto timed(Latencies& latencies, const char* module, Work work) {
  const auto begin = std::chrono::steady_clock::now();
  auto result = work();
  latencies[module].push_back(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  return result;
}

// Red is near, blue is far; black where there is no depth.
Image depth_picture(const vision::DepthImage& depth) {
  const float most = *std::max_element(depth.disparity_px.begin(), depth.disparity_px.end());
  Image image{depth.width, depth.height, {}};
  for (const float d : depth.disparity_px) {
    const double share = most > 0 ? d / most : 0;
    const auto code = [&](double at) {
      return static_cast<std::uint8_t>(
          d > 0 ? 255 * std::clamp(1.5 - 4 * std::abs(share - at), 0.0, 1.0) : 0);
    };
    for (const double at : {0.85, 0.55, 0.2}) image.rgb.push_back(code(at));
  }
  return image;
}

Image plane_picture(const Image& left, const vision::PlaneSegments& planes) {
  constexpr std::array<figure::Color, 6> kColors{figure::kGreen,  figure::kOrange, figure::kBlue,
                                                 figure::kPurple, figure::kRed,    figure::kYellow};
  Image image = left;
  for (std::size_t i = 0; i < planes.label.size(); ++i) {
    if (planes.label[i] == 0) continue;
    const auto plane = static_cast<std::size_t>(planes.segments[planes.label[i] - 1u].plane);
    const figure::Color& c = kColors[plane % kColors.size()];
    const double parts[] = {c.r, c.g, c.b};
    for (std::size_t k = 0; k < 3; ++k)
      image.rgb[3 * i + k] =
          static_cast<std::uint8_t>(0.5 * image.rgb[3 * i + k] + 127.5 * parts[k]);
  }
  return image;
}

Json depth_json(const vision::DepthImage& depth) {
  std::vector<double> known;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      if (depth.known(u, v)) known.push_back(depth.depth_m(u, v));
    }
  }
  Json json{{"known",
             static_cast<double>(known.size()) / static_cast<double>(depth.disparity_px.size())}};
  if (known.empty()) return json;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  json["median_m"] = *middle;
  return json;
}

Json planes_json(const vision::PlaneSegments& planes) {
  Json all = Json::array();
  for (const vision::PlaneSegment& s : planes.segments) {
    all.push_back({{"plane", s.plane},
                   {"normal", {s.normal.x(), s.normal.y(), s.normal.z()}},
                   {"distance_m", s.distance_m},
                   {"error_px", s.error_px},
                   {"error_m", s.error_m},
                   {"pixels", s.pixels},
                   {"box_px", {s.left, s.top, s.right, s.bottom}},
                   {"extent_m", {s.length_m, s.width_m}}});
  }
  return all;
}

// All that is made of pairs.
struct Looker {
  Modules modules;
  vision::StereoCalibration calibration;
  vision::Rectifier rectifier;
  vision::BallDetector ball;
  vision::DepthFinder depth;
  vision::PlaneSegmentFinder planes;
  Latencies latencies;

  Result<vision::StereoImages> read(const PicturePair& files) const {
    vision::StereoImages raw, rectified;
    for (const auto& [path, image] :
         {std::pair(&files.left, &raw.left), std::pair(&files.right, &raw.right)}) {
      auto read = vision::read_picture(*path);
      if (!read) return tl::unexpected(read.error());
      if (read->width != calibration.width || read->height != calibration.height)
        return fail(Fault::usage, *path + ": is of another size than the calibration's " +
                                      std::to_string(calibration.width) + " x " +
                                      std::to_string(calibration.height));
      *image = std::move(*read);
    }
    rectifier.rectify(raw, rectified);
    return rectified;
  }

  // Adds to `json` and `panels`. An error: this pair cannot be looked at.
  Result<void> look(const vision::StereoImages& pair, Json& json,
                    std::vector<figure::Panel>& panels) {
    vision::FrameInfo info;
    info.camera = calibration.rectified;
    Image left = pair.left;
    if (modules.color) {
      const auto seen = timed(latencies, "color", [&] { return ball.detect(pair.left, info); });
      if (seen.error) return tl::unexpected(*seen.error);
      json["ball"] = ball_json(seen);
      if (seen.found)
        figure::draw_circle(left, seen.center_u, seen.center_v, seen.radius_px + 2,
                            figure::kYellow);
    }
    panels.push_back({left, "left, rectified"});
    if (modules.color) panels.push_back({figure::mask_picture(ball.mask(), pair.left), "colour"});
    if (!modules.depth && !modules.planes) return {};
    vision::DepthImage image;
    if (auto done = timed(latencies, "depth", [&] { return depth.find(pair, info, image); }); !done)
      return done;
    json["depth"] = depth_json(image);
    panels.push_back({depth_picture(image), "depth: red near, blue far"});
    if (!modules.planes) return {};
    vision::PlaneSegments found;
    if (auto done = timed(latencies, "planes", [&] { return planes.find(image, found); }); !done)
      return done;
    json["planes"] = planes_json(found);
    panels.push_back({plane_picture(pair.left, found), "planes"});
    return {};
  }
};

std::string csv_line(const Json& one) {
  const auto number = [](const Json& of, const char* key) {
    return of.contains(key) ? of[key].dump() : std::string();
  };
  const Json ball = one.value("ball", Json::object()), depth = one.value("depth", Json::object());
  std::string planes;
  if (one.contains("planes")) planes = std::to_string(one["planes"].size());
  return one["left"].dump() + "," + number(ball, "found") + "," + number(ball, "distance_m") + "," +
         number(depth, "known") + "," + number(depth, "median_m") + "," + planes + "," +
         number(one, "trouble") + "\n";
}

Json latency_json(const Latencies& latencies) {
  Json json = Json::object();
  for (auto [module, ms] : latencies) {
    std::sort(ms.begin(), ms.end());
    json[module] = {{"median", ms[ms.size() / 2]}, {"most", ms.back()}};
  }
  return json;
}

Result<Outcome> report(const Looker& looker, const Json& pairs, std::size_t looked_at,
                       const RecordedOptions& options, const OutputFolder& folder) {
  std::string table = "left,ball,ball_distance_m,depth_known,depth_median_m,planes,trouble\n";
  for (const Json& one : pairs) table += csv_line(one);
  const auto written =
      figure::write_file(folder.path("pairs.csv"),
                         {reinterpret_cast<const std::uint8_t*>(table.data()), table.size()});
  if (!written) return tl::unexpected(written.error());
  const Json result{{"modules", options.modules},
                    {"pairs_looked_at", looked_at},
                    {"latency_ms", latency_json(looker.latencies)},
                    {"pairs", pairs}};
  if (auto done = folder.write_json("result.json", result); !done)
    return tl::unexpected(done.error());
  if (looked_at == 0)
    return fail(Fault::failed, "none of the " + std::to_string(pairs.size()) +
                                   " pairs could be looked at; the first: " +
                                   pairs.front()["trouble"].get<std::string>());
  if (options.json) {
    std::printf("%s\n", result.dump(2).c_str());
    return Outcome(true);
  }
  for (const Json& one : pairs) {
    if (one.contains("trouble"))
      std::printf("left out: %s\n", one["trouble"].get<std::string>().c_str());
  }
  std::printf("%zu of %zu pairs looked at;", looked_at, pairs.size());
  for (const auto& [module, ms] : result["latency_ms"].items())
    std::printf(" %s %.2f ms,", module.c_str(), ms["median"].get<double>());
  std::printf(" a pair (median); overlays, pairs.csv and result.json in %s\n", options.out.c_str());
  return Outcome(true);
}

}  // namespace

Result<Outcome> run_on_pairs(const RecordedOptions& options) {
  const auto modules = parse_modules(options.modules);
  if (!modules) return tl::unexpected(modules.error());
  if (options.calibration.empty())
    return fail(Fault::usage, "stereo pairs need --calibration FILE (kaz calibrate stereo)");
  const auto files = find_pairs(options.left, options.right);
  if (!files) return tl::unexpected(files.error());
  const auto calibration = vision::read_calibration(options.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  const auto ball = ball_options(options);
  if (!ball) return tl::unexpected(ball.error());
  vision::DepthOptions depth;
  depth.nearest_m = options.nearest_m;
  const auto folder = OutputFolder::open(options.out);
  if (!folder) return tl::unexpected(folder.error());
  Looker looker{*modules,
                *calibration,
                vision::Rectifier(*calibration),
                vision::BallDetector(*ball),
                vision::DepthFinder(depth),
                vision::PlaneSegmentFinder(),
                {}};
  Json pairs = Json::array();
  std::size_t looked_at = 0;
  Progress progress("kaz vision", options.json);
  for (const PicturePair& pair : *files) {
    const auto name = [](const std::string& path) {
      return std::filesystem::path(path).filename().string();
    };
    progress.update(static_cast<double>(pairs.size()) / static_cast<double>(files->size()),
                    name(pair.left));
    Json one{{"left", name(pair.left)}, {"right", name(pair.right)}};
    const auto images = looker.read(pair);
    std::vector<figure::Panel> panels;
    const Result<void> done =
        images ? looker.look(*images, one, panels) : Result<void>(tl::unexpected(images.error()));
    if (!done) {
      one["trouble"] = images ? pair.left + ": " + done.error().message : done.error().message;
    } else {
      ++looked_at;
      const auto written = figure::write_png(folder->path(name(pair.left) + ".pair.png"),
                                             figure::compose(panels, 2, calibration->height));
      if (!written) return tl::unexpected(written.error());
    }
    pairs.push_back(one);
  }
  progress.update(1, "done");
  progress.done();
  return report(looker, pairs, looked_at, options, *folder);
}

}  // namespace kaz::tools
