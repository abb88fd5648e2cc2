// Calibration files: written by cv::FileStorage, read key by key with nothing taken on trust.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "shared/base/files.hpp"
#include "vision/calibration/calibration_text.h"
#include "vision/image/opencv_quiet.h"
#include "vision/image/picture_file.h"

namespace kaz::vision {
namespace {

constexpr int kLargestMatrixSide = 14;         // distortion in a row
constexpr std::size_t kLargestFile = 1 << 16;  // bytes; ours are of 3000
constexpr double kLargest = 1e6;  // px, and m; their products are still written and read

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

// A file's keys; remembers its name for messages.
class Reader {
 public:
  Reader(const std::string& content, const std::string& name)
      : entries_(scan_calibration(content)), name_(name) {}

  tl::unexpected<Error> bad(const std::string& what) const {
    return fail(Fault::usage, name_ + ": " + what);
  }
  bool has(const char* key) const { return entries_.find(key) != entries_.end(); }

  Result<int> side(const char* key) const {
    const auto values = numbers(key, {1});
    if (!values) return tl::unexpected(values.error());
    const double value = values->front();
    if (value != std::floor(value) || value < 2 || value > kLargestPictureSide)
      return bad(std::string(key) + " is " + std::string(entries_.find(key)->second.values[0]) +
                 ": must be a whole number from 2 to " + std::to_string(kLargestPictureSide));
    return static_cast<int>(value);
  }

  // Rows and columns, where the file states them.
  Result<void> check_shape(const char* key, const CalibrationEntry& entry) const {
    double numbers = 1;  // rows times columns; 0: not both are stated
    for (const auto& [name, text] : {std::pair{"rows", entry.rows}, {"cols", entry.cols}}) {
      double count = 0;
      if (!text.empty() && (!calibration_number(text, count) || count != std::floor(count) ||
                            count < 1 || count > kLargestMatrixSide))
        return bad(std::string(key) + " has " + name + ": " + std::string(text) +
                   "; a matrix has 1 to " + std::to_string(kLargestMatrixSide) +
                   " rows and columns");
      numbers *= text.empty() ? 0 : count;
    }
    if (numbers > 0 && numbers != static_cast<double>(entry.values.size()))
      return bad(std::string(key) + " has rows: " + std::string(entry.rows) +
                 " and cols: " + std::string(entry.cols) + ", but " +
                 std::to_string(entry.values.size()) + " numbers");
    return {};
  }

  // As many as one of `counts`.
  Result<std::vector<double>> numbers(const char* key,
                                      const std::vector<std::size_t>& counts) const {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return bad(std::string(key) + " is missing");
    const CalibrationEntry& entry = found->second;
    if (entry.times > 1) return bad(std::string("has ") + key + " twice");
    if (!entry.repeated.empty())
      return bad(std::string(key) + " has " + std::string(entry.repeated) + " twice; remove one");
    if (!entry.closed) return bad(std::string("ends within ") + key);
    if (entry.list == (counts.front() == 1))
      return bad(std::string(key) + (entry.list ? " is not a number" : " is not a matrix"));
    if (std::find(counts.begin(), counts.end(), entry.values.size()) == counts.end())
      return bad(std::string(key) + " has " + std::to_string(entry.values.size()) +
                 " numbers, not " + std::to_string(counts.front()));
    KAZ_TRY(check_shape(key, entry));
    std::vector<double> values(entry.values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!calibration_number(entry.values[i], values[i]))
        return bad(std::string(key) + " has an element that is not a number");
      if (!std::isfinite(values[i]) || std::abs(values[i]) > 1e12)
        return bad(std::string(key) + " has a number that is not finite or exceeds 1e12");
    }
    return values;
  }

  Result<Eigen::Matrix3d> turn(const char* key) const {
    const auto values = numbers(key, {9});
    if (!values) return tl::unexpected(values.error());
    const Eigen::Matrix3d m =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values->data());
    // Files written by hand have few digits.
    if ((m * m.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-3 ||
        m.determinant() < 0)
      return bad(std::string(key) +
                 " is not a rotation: its rows must be orthonormal and its determinant 1");
    return m;
  }

  Result<Lens> lens(const char* matrix, const char* short_matrix, const char* distortion,
                    const char* short_distortion) const {
    const char* k_key = !has(matrix) && has(short_matrix) ? short_matrix : matrix;
    const char* d_key = !has(distortion) && has(short_distortion) ? short_distortion : distortion;
    const auto k = numbers(k_key, {9});
    if (!k) return tl::unexpected(k.error());
    const auto d = numbers(d_key, {5, 4, 8, 12, 14});
    if (!d) return tl::unexpected(d.error());
    if ((*k)[1] != 0 || (*k)[3] != 0 || (*k)[6] != 0 || (*k)[7] != 0 || (*k)[8] != 1)
      return bad(std::string(k_key) + " must have the form [fx 0 cx; 0 fy cy; 0 0 1]");
    if (!((*k)[0] > 0) || !((*k)[4] > 0))
      return bad(std::string(k_key) + " has a focal length that is not above 0");
    Lens lens{(*k)[0], (*k)[4], (*k)[2], (*k)[5], {}};
    std::copy_n(d->begin(), std::min<std::size_t>(5, d->size()), lens.distortion.begin());
    if (d->size() > 5 && std::any_of(d->begin() + 5, d->end(), [](double c) { return c != 0; }))
      return bad(std::string(d_key) +
                 " has more than the five coefficients k1 k2 p1 p2 k3; calibrate without the "
                 "rational, prism and tilted models");
    return lens;
  }

 private:
  std::map<std::string, CalibrationEntry, std::less<>> entries_;
  const std::string& name_;
};

// Whether a rectified pair has numbers with which one can compute.
bool usable(const CameraModel& m) {
  const auto within = [](double value) { return std::abs(value) <= kLargest; };  // not NaN
  return m.fx > 0 && within(m.fx) && m.fy > 0 && within(m.fy) && within(m.cx) && within(m.cy) &&
         m.baseline_m > 0 && within(m.baseline_m);
}

// R1, R2, P1, P2 of the file.
Result<void> take_rectification(const Reader& file, StereoCalibration& c) {
  const auto r1 = file.turn("R1"), r2 = file.turn("R2");
  if (!r1) return tl::unexpected(r1.error());
  if (!r2) return tl::unexpected(r2.error());
  const auto p1 = file.numbers("P1", {12}), p2 = file.numbers("P2", {12});
  if (!p1) return tl::unexpected(p1.error());
  if (!p2) return tl::unexpected(p2.error());
  const double fx = (*p1)[0], fy = (*p1)[5];
  if (!(fx > 0) || !(fy > 0)) return file.bad("P1 has a focal length that is not above 0");
  for (const int i : {0, 1, 2, 4, 5, 6}) {
    const auto at = static_cast<std::size_t>(i);
    if (std::abs((*p1)[at] - (*p2)[at]) > 0.01)
      return file.bad(
          "P1 and P2 have different focal lengths or centers: rectify again with OpenCV's flag "
          "CALIB_ZERO_DISPARITY");
  }
  c.left.rectified_from_camera = *r1;
  c.right.rectified_from_camera = *r2;
  c.rectified = {c.width, c.height, fx, fy, (*p1)[2], (*p1)[6], -(*p2)[3] / fx};
  if (!(c.rectified.baseline_m > 0))
    return file.bad(
        "P2 puts the right eye to the left of the left eye: check whether they are exchanged");
  if (!usable(c.rectified)) return file.bad("P1 or P2 has a number above 1e6");
  return {};
}

Result<StereoCalibration> take(const Reader& file) {
  StereoCalibration c;
  const auto width = file.side("image_width"), height = file.side("image_height");
  if (!width) return tl::unexpected(width.error());
  if (!height) return tl::unexpected(height.error());
  c.width = *width;
  c.height = *height;
  const auto left =
      KAZ_TRY(file.lens("camera_matrix_left", "M1", "distortion_coefficients_left", "D1"));
  const auto right =
      KAZ_TRY(file.lens("camera_matrix_right", "M2", "distortion_coefficients_right", "D2"));
  c.left.lens = left;
  c.right.lens = right;
  const bool rectified = file.has("R1") || file.has("R2") || file.has("P1") || file.has("P2");
  if (rectified) {
    KAZ_TRY(take_rectification(file, c));
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
  if (!usable(c.rectified))
    return fail(Fault::usage,
                "these lenses cannot be rectified: the rectified pictures have no common part");
  return {};
}

Result<StereoCalibration> parse_calibration(const std::string& content, const std::string& name) {
  const auto bad = [&](const std::string& what) { return fail(Fault::usage, name + ": " + what); };
  if (content.empty()) return bad("is empty");
  if (content.size() > kLargestFile)
    return bad("is larger than 64 KB, the limit for calibration files");
  return take(Reader(content, name));
}

Result<StereoCalibration> read_calibration(const std::string& path) {
  const auto content = KAZ_TRY(read_whole_file(path, kLargestFile, "give a calibration file"));
  return parse_calibration(content, path);
}

Result<CalibrationFormat> calibration_format(const std::string& path) {
  const auto ends = [&](const char* ending) { return path.ends_with(ending); };
  if (ends(".yml") || ends(".yaml")) return CalibrationFormat::yaml;
  if (ends(".json")) return CalibrationFormat::json;
  return fail(Fault::usage, "the calibration file '" + path + "' must end with .yml or .json");
}

std::string calibration_text(const StereoCalibration& c, CalibrationFormat format,
                             const std::vector<std::pair<std::string, double>>& notes,
                             const std::string& date) {
  const int kind = format == CalibrationFormat::json ? cv::FileStorage::FORMAT_JSON
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
