// Calibration files: written by cv::FileStorage, read key by key with nothing taken on trust.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "shared/base/files.hpp"
#include "vision/calibration/calibration_reader.h"
#include "vision/calibration/calibration_xml.h"
#include "vision/calibration/camera_info.h"
#include "vision/image/opencv_quiet.h"

namespace kaz::vision {
namespace {

constexpr std::size_t kLargestFile = 1 << 16;  // bytes; ours are of 3000

cv::Mat camera_matrix(const Lens& lens) {
  return (cv::Mat_<double>(3, 3) << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
}

cv::Mat distortion_row(const Lens& lens) {
  cv::Mat_<double> row(1, 5);
  std::copy(lens.distortion.begin(), lens.distortion.end(), row.begin());
  return row;
}

template <class Matrix>
cv::Mat mat(const Matrix& eigen) {
  cv::Mat result;
  cv::eigen2cv(eigen, result);
  return result;
}

Eigen::Matrix3d to_eigen(const cv::Mat& m) {
  Eigen::Matrix3d result;
  cv::cv2eigen(m, result);
  return result;
}

Result<StereoCalibration> take(const CalibrationReader& file) {
  if (file.has("camera_matrix"))
    return file.bad("is the calibration of one camera; Kaz needs both: give LEFT.yaml,RIGHT.yaml");
  // Written by OpenCV's calibration sample; its value is a flag.
  if (const auto fisheye = file.word("fisheye_model"); !fisheye.empty() && fisheye != "0")
    return file.bad("fisheye_model is " + std::string(fisheye) +
                    ": fisheye lenses are not supported; calibrate without the fisheye model");
  StereoCalibration c;
  const auto width = file.side("image_width"), height = file.side("image_height");
  if (!width) return tl::unexpected(width.error());
  if (!height) return tl::unexpected(height.error());
  c.width = *width;
  c.height = *height;
  const auto key = [&](const char* name, const char* short_name) {
    return !file.has(name) && file.has(short_name) ? short_name : name;
  };
  c.left.lens = KAZ_TRY(
      file.lens(key("camera_matrix_left", "M1"), key("distortion_coefficients_left", "D1")));
  c.right.lens = KAZ_TRY(
      file.lens(key("camera_matrix_right", "M2"), key("distortion_coefficients_right", "D2")));
  const bool rectified = file.has("R1") || file.has("R2") || file.has("P1") || file.has("P2");
  if (rectified) {
    KAZ_TRY(take_rectification({file, "R1", "P1"}, {file, "R2", "P2"}, c));
    if (!file.has("R") && !file.has("T")) return c;
  }
  const auto r = KAZ_TRY(file.turn("R"));
  const auto t = file.numbers("T", {3});
  if (!t) return tl::unexpected(t.error());
  const Eigen::Vector3d to(t->data());
  if (!rectified) {
    if (auto done = rectify_pair(c, r, to); !done) return file.bad(done.error().message);
    return c;
  }
  // 0.1 degree and a hundredth of the baseline: more is not the rounding of a short file.
  if ((c.right_from_left() - r).cwiseAbs().maxCoeff() > 2e-3 ||
      (c.left_origin_in_right() - to).norm() > 0.01 * c.rectified.baseline_m)
    return file.bad("R and T do not match R1, R2 and P2: they come from different calibrations");
  return c;
}

}  // namespace

Result<void> rectify_pair(StereoCalibration& c, const Eigen::Matrix3d& right_from_left,
                          const Eigen::Vector3d& left_origin_in_right) {
  const Eigen::Vector3d right_in_left = -right_from_left.transpose() * left_origin_in_right;
  if (!(right_in_left.norm() > 0))
    return fail(Fault::usage, "T is 0: both eyes are at the same place");
  if (right_in_left.head<2>().cwiseAbs().maxCoeff() != std::abs(right_in_left.x()))
    return fail(Fault::usage,
                "T puts one eye above the other; only eyes side by side are rectified");
  if (right_in_left.x() < 0)
    return fail(
        Fault::usage,
        "T puts the right eye to the left of the left eye: check whether they are exchanged");
  const OpenCvQuiet quiet;
  try {
    cv::Mat r1, r2, p1, p2, q;
    cv::stereoRectify(camera_matrix(c.left.lens), distortion_row(c.left.lens),
                      camera_matrix(c.right.lens), distortion_row(c.right.lens),
                      cv::Size(c.width, c.height), mat(right_from_left), mat(left_origin_in_right),
                      r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY, 0);
    c.left.rectified_from_camera = to_eigen(r1);
    c.right.rectified_from_camera = to_eigen(r2);
    c.rectified = {c.width,
                   c.height,
                   p1.at<double>(0, 0),
                   p1.at<double>(1, 1),
                   p1.at<double>(0, 2),
                   p1.at<double>(1, 2),
                   -p2.at<double>(0, 3) / p2.at<double>(0, 0)};
  } catch (const cv::Exception& error) {
    return fail(Fault::usage, "these lenses cannot be rectified (" + error.err + ")");
  }
  if (!usable_pair(c.rectified))
    return fail(Fault::usage,
                "these lenses cannot be rectified: the rectified pictures have no common part");
  return {};
}

Result<StereoCalibration> parse_calibration(const std::string& content, const std::string& name) {
  const auto bad = [&](const std::string& what) { return fail(Fault::usage, name + ": " + what); };
  if (content.empty()) return bad("is empty");
  if (content.size() > kLargestFile)
    return bad("is larger than 64 KB, the limit for calibration files");
  if (!looks_like_xml(content)) return take(CalibrationReader(content, name));
  const std::string yaml = KAZ_TRY(calibration_xml_as_yaml(content, name));
  return take(CalibrationReader(yaml, name));
}

Result<StereoCalibration> read_calibration(const std::string& path) {
  const auto content_of = [](const std::string& file) {
    return read_whole_file(file, kLargestFile, "give a calibration file");
  };
  std::error_code error;
  if (const auto pair = camera_info_paths(path); pair && !std::filesystem::exists(path, error)) {
    const auto left = KAZ_TRY(content_of(pair->left)), right = KAZ_TRY(content_of(pair->right));
    return parse_camera_info({left, right}, *pair);
  }
  const auto content = KAZ_TRY(content_of(path));
  return parse_calibration(content, path);
}

Result<CalibrationFormat> calibration_format(const std::string& path) {
  const auto is_yaml = [](const std::string& name) {
    return name.ends_with(".yml") || name.ends_with(".yaml");
  };
  if (const auto pair = camera_info_paths(path)) {
    if (is_yaml(pair->left) && is_yaml(pair->right)) return CalibrationFormat::camera_info;
  } else {
    if (is_yaml(path)) return CalibrationFormat::yaml;
    if (path.ends_with(".json")) return CalibrationFormat::json;
    if (path.ends_with(".xml")) return CalibrationFormat::xml;
  }
  return fail(Fault::usage, "the calibration file '" + path +
                                "' must end with .yml, .yaml, .json or .xml; two files for ROS "
                                "must be LEFT.yaml,RIGHT.yaml");
}

std::string calibration_text(const StereoCalibration& c, CalibrationFormat format,
                             const std::vector<std::pair<std::string, double>>& notes,
                             const std::string& date) {
  const int kind = format == CalibrationFormat::json  ? cv::FileStorage::FORMAT_JSON
                   : format == CalibrationFormat::xml ? cv::FileStorage::FORMAT_XML
                                                      : cv::FileStorage::FORMAT_YAML;
  cv::FileStorage file("", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | kind);
  const CameraModel& m = c.rectified;
  cv::Mat p1 = (cv::Mat_<double>(3, 4) << m.fx, 0, m.cx, 0, 0, m.fy, m.cy, 0, 0, 0, 1, 0);
  cv::Mat p2 = p1.clone();
  p2.at<double>(0, 3) = -m.fx * m.baseline_m;
  const cv::Mat q = (cv::Mat_<double>(4, 4) << 1, 0, 0, -m.cx, 0, m.fx / m.fy, 0,
                     -m.cy * m.fx / m.fy, 0, 0, 0, m.fx, 0, 0, 1 / m.baseline_m, 0);
  file << "image_width" << c.width << "image_height" << c.height;
  file << "camera_matrix_left" << camera_matrix(c.left.lens);
  file << "distortion_coefficients_left" << distortion_row(c.left.lens);
  file << "camera_matrix_right" << camera_matrix(c.right.lens);
  file << "distortion_coefficients_right" << distortion_row(c.right.lens);
  file << "R" << mat(c.right_from_left()) << "T" << mat(c.left_origin_in_right());
  file << "R1" << mat(c.left.rectified_from_camera) << "R2" << mat(c.right.rectified_from_camera);
  file << "P1" << p1 << "P2" << p2 << "Q" << q;
  for (const auto& [key, value] : notes) file << key << value;
  if (!date.empty()) file << "calibration_time" << date;
  return file.releaseAndGetString();
}

}  // namespace kaz::vision
