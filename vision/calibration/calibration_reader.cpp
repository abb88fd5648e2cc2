// Checked values of a calibration file: numbers, matrices, rotations and lenses.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_reader.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "vision/image/picture_file.h"

namespace kaz::vision {
namespace {

constexpr int kLargestMatrixSide = 14;  // distortion in a row
constexpr double kLargest = 1e6;        // px, and m; their products are still written and read

}  // namespace

tl::unexpected<Error> CalibrationReader::bad(const std::string& what) const {
  return fail(Fault::usage, name_ + ": " + what);
}
std::string_view CalibrationReader::word(const char* key) const {
  const auto found = entries_.find(key);
  if (found == entries_.end() || found->second.values.size() != 1) return {};
  return found->second.values.front();
}

Result<int> CalibrationReader::side(const char* key) const {
  const auto values = numbers(key, {1});
  if (!values) return tl::unexpected(values.error());
  const double value = values->front();
  if (value != std::floor(value) || value < 2 || value > kLargestPictureSide)
    return bad(std::string(key) + " is " + std::string(entries_.find(key)->second.values[0]) +
               ": must be a whole number from 2 to " + std::to_string(kLargestPictureSide));
  return static_cast<int>(value);
}

// Rows and columns, where the file states them.
Result<void> CalibrationReader::check_shape(const char* key, const CalibrationEntry& entry) const {
  double numbers = 1;  // rows times columns; 0: not both are stated
  for (const auto& [name, text] : {std::pair{"rows", entry.rows}, {"cols", entry.cols}}) {
    double count = 0;
    if (!text.empty() && (!calibration_number(text, count) || count != std::floor(count) ||
                          count < 1 || count > kLargestMatrixSide))
      return bad(std::string(key) + " has " + name + ": " + std::string(text) +
                 "; a matrix has 1 to " + std::to_string(kLargestMatrixSide) + " rows and columns");
    numbers *= text.empty() ? 0 : count;
  }
  if (numbers > 0 && numbers != static_cast<double>(entry.values.size()))
    return bad(std::string(key) + " has rows: " + std::string(entry.rows) +
               " and cols: " + std::string(entry.cols) + ", but " +
               std::to_string(entry.values.size()) + " numbers");
  return {};
}

// As many as one of `counts`.
Result<std::vector<double>> CalibrationReader::numbers(
    const char* key, const std::vector<std::size_t>& counts) const {
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
    return bad(std::string(key) + " has " + std::to_string(entry.values.size()) + " numbers, not " +
               std::to_string(counts.front()));
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

Result<Eigen::Matrix3d> CalibrationReader::turn(const char* key) const {
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

Result<Lens> CalibrationReader::lens(const char* matrix, const char* distortion) const {
  const auto k = numbers(matrix, {9});
  if (!k) return tl::unexpected(k.error());
  const auto d = numbers(distortion, {5, 4, 8, 12, 14});
  if (!d) return tl::unexpected(d.error());
  if ((*k)[1] != 0 || (*k)[3] != 0 || (*k)[6] != 0 || (*k)[7] != 0 || (*k)[8] != 1)
    return bad(std::string(matrix) + " must have the form [fx 0 cx; 0 fy cy; 0 0 1]");
  if (!((*k)[0] > 0) || !((*k)[4] > 0))
    return bad(std::string(matrix) + " has a focal length that is not above 0");
  Lens lens{(*k)[0], (*k)[4], (*k)[2], (*k)[5], {}};
  std::copy_n(d->begin(), std::min<std::size_t>(5, d->size()), lens.distortion.begin());
  if (d->size() > 5 && std::any_of(d->begin() + 5, d->end(), [](double c) { return c != 0; }))
    return bad(std::string(distortion) +
               " has more than the five coefficients k1 k2 p1 p2 k3; calibrate without the "
               "rational, prism and tilted models");
  return lens;
}

bool usable_pair(const CameraModel& m) {
  const auto within = [](double value) { return std::abs(value) <= kLargest; };  // not NaN
  return m.fx > 0 && within(m.fx) && m.fy > 0 && within(m.fy) && within(m.cx) && within(m.cy) &&
         m.baseline_m > 0 && within(m.baseline_m);
}

Result<void> take_rectification(const RectifiedEye& left, const RectifiedEye& right,
                                StereoCalibration& c) {
  c.left.rectified_from_camera = KAZ_TRY(left.file.turn(left.rotation));
  c.right.rectified_from_camera = KAZ_TRY(right.file.turn(right.rotation));
  const auto p1 = KAZ_TRY(left.file.numbers(left.projection, {12}));
  const auto p2 = KAZ_TRY(right.file.numbers(right.projection, {12}));
  const std::string key = right.projection;
  const double fx = p1[0], fy = p1[5];
  if (!(fx > 0) || !(fy > 0))
    return left.file.bad(std::string(left.projection) + " has a focal length that is not above 0");
  for (const std::size_t at : {0, 1, 2, 4, 5, 6}) {
    if (std::abs(p1[at] - p2[at]) > 0.01)
      return right.file.bad(key +
                            " has another focal length or center than the left eye: rectify again "
                            "with OpenCV's flag CALIB_ZERO_DISPARITY");
  }
  if (std::abs(p2[7]) > 0.01 * std::abs(p2[3]))
    return right.file.bad(key + " puts one eye above the other; only eyes side by side are valid");
  c.rectified = {c.width, c.height, fx, fy, p1[2], p1[6], -p2[3] / fx};
  if (!(c.rectified.baseline_m > 0))
    return right.file.bad(
        key + " puts the right eye to the left of the left eye: check whether they are exchanged");
  if (!usable_pair(c.rectified))
    return right.file.bad(key + ", or that of the left eye, has a number above 1e6");
  return {};
}

}  // namespace kaz::vision
