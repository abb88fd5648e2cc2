// Reading camera.json.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "sim/runtime/eyes.h"

namespace kaz::sim {
namespace {

struct Bounds {
  const char* key;
  double low, high;
};

// Within what the rest is made for: a picture fits the published stream, a view is no fisheye.
constexpr Bounds bounds[] = {
    {"width", 16, 4096},  {"height", 16, 4096},  {"horizontal_view_deg", 10, 150},
    {"baseline_m", 0, 1}, {"rate_hz", 0.1, 500}, {"latency_s", 0, 1},
};

}  // namespace

Result<CameraFile> CameraFile::load(const std::string& path) {
  std::ifstream file(path);
  if (!file) return fail(Fault::usage, "cannot read the camera file " + path + "; check the path");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object())
    return fail(Fault::usage, path + ": is no JSON object; see shared/robot/kaz/camera.json");
  for (const Bounds& b : bounds) {
    const auto entry = json.find(b.key);
    if (entry == json.end() || !entry->is_number())
      return fail(Fault::usage, path + ": the number \"" + b.key + "\" is missing");
    const double value = entry->get<double>();
    if (!(value >= b.low && value <= b.high))
      return fail(Fault::usage, path + ": \"" + b.key + "\" is " + entry->dump() +
                                    " but must lie between " + nlohmann::json(b.low).dump() +
                                    " and " + nlohmann::json(b.high).dump());
  }
  CameraFile camera;
  camera.width = json["width"].get<int>();
  camera.height = json["height"].get<int>();
  camera.horizontal_view_rad =
      json["horizontal_view_deg"].get<double>() * (std::numbers::pi / 180.0);
  camera.baseline_m = json["baseline_m"].get<double>();
  camera.rate_hz = json["rate_hz"].get<double>();
  camera.latency_s = json["latency_s"].get<double>();
  return camera;
}

Pinhole CameraFile::pinhole() const {
  return Pinhole::from_horizontal_view(width, height, horizontal_view_rad);
}

vision::CameraModel CameraFile::model() const {
  const Pinhole pinhole_model = pinhole();
  return {.width = width,
          .height = height,
          .fx = pinhole_model.fx,
          .fy = pinhole_model.fy,
          .cx = pinhole_model.cx,
          .cy = pinhole_model.cy,
          .baseline_m = baseline_m};
}

}  // namespace kaz::sim
