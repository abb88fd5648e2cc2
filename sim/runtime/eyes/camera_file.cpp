// Reads camera.json.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>

#include "shared/base/angle.hpp"
#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "sim/render/camera.h"
#include "sim/runtime/eyes/eyes.h"

namespace kaz::sim {
namespace {

// Target member and bounds of a number; `unit` converts from the file's unit. The bounds exclude what the
// rest does not support: pictures too large for the published stream, fisheye lenses.
struct Entry {
  const char* key;
  double low, high;
  bool needed;
  double* to;
  double unit = 1;
};

Result<void> read(const nlohmann::json& json, const std::string& path, const Entry& e) {
  const auto found = json.find(e.key);
  if (found == json.end() && !e.needed) return {};
  if (found == json.end() || !found->is_number())
    return fail(Fault::usage, path + ": the number \"" + e.key + "\" is missing");
  const double value = found->get<double>();
  if (!(value >= e.low && value <= e.high))
    return fail(Fault::usage, path + ": \"" + e.key + "\" is " + json_sample(*found) +
                                  ": must be " + nlohmann::json(e.low).dump() + " to " +
                                  nlohmann::json(e.high).dump());
  *e.to = value * e.unit;
  return {};
}

// The distorted radius must increase monotonically up to the corners: each pixel has one direction.
bool grows(const EyeModel& eye) {
  const vision::Lens lens{1, 1, 0, 0, eye.distortion};
  const double side = std::tan(0.5 * eye.lens_view_rad);
  const double corner =
      lens.distort({side, 0}).x() * std::hypot(1.0, static_cast<double>(eye.height) / eye.width);
  double before = 0;
  for (double r = 0.01; r < 20; r += 0.01) {
    const double now = lens.distort({r, 0}).x();
    if (now <= before) return false;
    // Margin beyond the corners for the tolerances of centre and focal length.
    if (r > side && now > 1.05 * corner) return true;
    before = now;
  }
  return false;
}

}  // namespace

Result<CameraFile> CameraFile::load(const std::string& path) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = KAZ_TRY(
      read_whole_file(path, max_bytes, "give a camera file such as shared/robot/kaz/camera.json"));
  const auto parsed = parse_bounded_json(text);
  if (!parsed)
    return fail(Fault::usage,
                path + ": " + parsed.error().message + "; see shared/robot/kaz/camera.json");
  const nlohmann::json& json = *parsed;
  if (!json.is_object())
    return fail(Fault::usage, path + ": is not a JSON object; see shared/robot/kaz/camera.json");
  CameraFile camera;
  EyeModel& eye = camera.eye;
  double width = 0, height = 0, unit = 1;
  const Entry entries[] = {
      {"width", 16, 4096, true, &width},
      {"height", 16, 4096, true, &height},
      {"horizontal_view_deg", 10, 150, true, &eye.rectified_view_rad, kDegree},
      {"rate_hz", 0.5, 500, true, &camera.rate_hz},
      {"latency_s", 0, 1, true, &camera.latency_s},
      {"jitter_s", 0, 0.1, false, &camera.jitter_s},
      {"unit", 0, 1e9, false, &unit},
      {"lens_view_deg", 10, 150, false, &eye.lens_view_rad, kDegree},
      {"k1", -2, 2, false, &eye.distortion[0]},
      {"k2", -2, 2, false, &eye.distortion[1]},
      {"p1", -0.1, 0.1, false, &eye.distortion[2]},
      {"p2", -0.1, 0.1, false, &eye.distortion[3]},
      {"k3", -2, 2, false, &eye.distortion[4]},
      {"vignetting", 0, 0.95, false, &eye.vignetting},
      {"exposure", 0.01, 100, false, &eye.noise.exposure},
      {"full_well_e", 100, 1e6, false, &eye.noise.full_well_e},
      {"read_noise_e", 0, 1000, false, &eye.noise.read_noise_e},
  };
  for (const Entry& entry : entries) {
    KAZ_TRY(read(json, path, entry));
  }
  eye.width = static_cast<int>(width);
  eye.height = static_cast<int>(height);
  camera.unit = static_cast<std::uint64_t>(unit);
  if (!grows(eye))
    return fail(
        Fault::usage,
        path +
            ": with these \"k1\", \"k2\" and \"k3\", the distorted "
            "radius does not increase up to the picture's corners; see docs/explanation/vision.md");
  return camera;
}

vision::CameraModel CameraFile::model() const {
  vision::CameraModel model = camera_of_view(eye.width, eye.height, eye.rectified_view_rad);
  model.baseline_m = baseline_m;
  return model;
}

vision::StereoCalibration CameraFile::calibration() const {
  if (!ideal) return make_calibration(eye, unit, baseline_m);
  vision::StereoCalibration calibration;
  const vision::CameraModel& c = calibration.rectified = model();
  calibration.width = c.width;
  calibration.height = c.height;
  calibration.left.lens = calibration.right.lens = {c.fx, c.fy, c.cx, c.cy, {}};
  return calibration;
}

std::string text_of(const CameraFile& camera) {
  const vision::CameraModel c = camera.model();
  std::string text = std::to_string(c.width) + " " + std::to_string(c.height);
  for (const double number : {c.fx, c.fy, c.cx, c.cy, c.baseline_m, camera.latency_s}) {
    char digits[40];
    std::snprintf(digits, sizeof digits, " %.17g", number);
    text += digits;
  }
  return text;
}

}  // namespace kaz::sim
