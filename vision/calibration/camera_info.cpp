// camera_info files of ROS, one for each eye.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/camera_info.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "vision/calibration/calibration_reader.h"

namespace kaz::vision {
namespace {

// The shortest text that gives the same number. YAML 1.1 needs a point: 1e-05 would be a text.
std::string exact_number(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string matrix_text(const char* key, int rows, std::span<const double> values) {
  std::string text = std::string(key) + ":\n  rows: " + std::to_string(rows) +
                     "\n  cols: " + std::to_string(values.size() / static_cast<std::size_t>(rows)) +
                     "\n  data: [";
  for (std::size_t k = 0; k < values.size(); ++k)
    text += (k > 0 ? ", " : "") + exact_number(values[k]);
  return text + "]\n";
}

std::string eye_text(const StereoCalibration& c, const StereoCalibration::Eye& eye,
                     const char* camera, double baseline_m) {
  const Lens& lens = eye.lens;
  const CameraModel& m = c.rectified;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> r = eye.rectified_from_camera;
  return camera_info_file(
      {.width = static_cast<std::uint32_t>(c.width),
       .height = static_cast<std::uint32_t>(c.height),
       .model = "plumb_bob",
       .d = {lens.distortion.begin(), lens.distortion.end()},
       .k = {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1},
       .r = {r.data(), r.data() + 9},
       .p = {m.fx, 0, m.cx, 0.0 - m.fx * baseline_m, 0, m.fy, m.cy, 0, 0, 0, 1, 0}},
      camera);
}

Result<Lens> lens_of(const CalibrationReader& file) {
  const std::string_view model = file.word("distortion_model");
  if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial")
    return file.bad("distortion_model is " + std::string(model) +
                    ": must be plumb_bob, or rational_polynomial with k4 to k6 of 0; calibrate "
                    "again with one of these models");
  return file.lens("camera_matrix", "distortion_coefficients");
}

}  // namespace

std::string camera_info_file(const CameraInfo& info, const std::string& camera_name) {
  const bool is_word =
      !info.model.empty() && info.model.size() < 40 && std::ranges::all_of(info.model, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_';
      });
  const std::string model = info.model.empty() ? "plumb_bob" : is_word ? info.model : "unknown";
  const std::vector<double> d = info.d.empty() ? std::vector<double>(5) : info.d;
  return "image_width: " + std::to_string(info.width) +
         "\nimage_height: " + std::to_string(info.height) + "\ncamera_name: " + camera_name + "\n" +
         matrix_text("camera_matrix", 3, info.k) + "distortion_model: " + model + "\n" +
         matrix_text("distortion_coefficients", 1, d) +
         matrix_text("rectification_matrix", 3, info.r) +
         matrix_text("projection_matrix", 3, info.p);
}

std::optional<CameraInfoPair> camera_info_paths(const std::string& path) {
  const auto comma = path.find(',');
  if (comma == std::string::npos || comma == 0 || comma + 1 == path.size()) return std::nullopt;
  return CameraInfoPair{path.substr(0, comma), path.substr(comma + 1)};
}

Result<StereoCalibration> parse_camera_info(const CameraInfoPair& contents,
                                            const CameraInfoPair& names) {
  const CalibrationReader left(contents.left, names.left), right(contents.right, names.right);
  StereoCalibration c;
  c.width = KAZ_TRY(left.side("image_width"));
  c.height = KAZ_TRY(left.side("image_height"));
  const int width = KAZ_TRY(right.side("image_width"));
  const int height = KAZ_TRY(right.side("image_height"));
  if (width != c.width || height != c.height)
    return right.bad("its pictures have " + std::to_string(width) + " x " + std::to_string(height) +
                     " px, those of " + names.left + " have " + std::to_string(c.width) + " x " +
                     std::to_string(c.height) + " px: both eyes must have the same size");
  c.left.lens = KAZ_TRY(lens_of(left));
  c.right.lens = KAZ_TRY(lens_of(right));
  KAZ_TRY(take_rectification({left, "rectification_matrix", "projection_matrix"},
                             {right, "rectification_matrix", "projection_matrix"}, c));
  return c;
}

CameraInfoPair camera_info_text(const StereoCalibration& c) {
  return {eye_text(c, c.left, "left", 0), eye_text(c, c.right, "right", c.rectified.baseline_m)};
}

}  // namespace kaz::vision
