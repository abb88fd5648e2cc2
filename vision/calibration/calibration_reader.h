// Reads the keys of a calibration file and checks their values. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "vision/calibration/calibration.h"
#include "vision/calibration/calibration_text.h"

namespace kaz::vision {

// All errors are Fault::usage and name the file and the key.
class CalibrationReader {
 public:
  // `content` and `name` must outlive the reader. `name`: name of the file for errors.
  CalibrationReader(const std::string& content, const std::string& name)
      : entries_(scan_calibration(content)), name_(name) {}

  tl::unexpected<Error> bad(const std::string& what) const;
  bool has(const char* key) const { return entries_.find(key) != entries_.end(); }
  // Returns the value of a key with one value; empty if the key is missing.
  std::string_view word(const char* key) const;
  // Returns the side of a picture, px.
  Result<int> side(const char* key) const;
  // Returns the numbers of a key, if their number is in `counts`. A count of {1} means a number, and all
  // other counts mean a matrix.
  Result<std::vector<double>> numbers(const char* key,
                                      const std::vector<std::size_t>& counts) const;
  Result<Eigen::Matrix3d> turn(const char* key) const;  // a rotation
  // Returns the lens with the camera matrix `matrix` and the coefficients `distortion`.
  Result<Lens> lens(const char* matrix, const char* distortion) const;

 private:
  Result<void> check_shape(const char* key, const CalibrationEntry& entry) const;

  std::map<std::string, CalibrationEntry, std::less<>> entries_;
  const std::string& name_;
};

// The file of one eye, with the keys of its rectification: a rotation and a 3 x 4 projection.
struct RectifiedEye {
  const CalibrationReader& file;
  const char* rotation;
  const char* projection;
};
// Sets the rectification of both eyes and `rectified`. The size of `calibration` must be set.
Result<void> take_rectification(const RectifiedEye& left, const RectifiedEye& right,
                                StereoCalibration& calibration);

// Whether a rectified pair has finite numbers, positive focal lengths and a positive baseline.
bool usable_pair(const CameraModel& camera);

}  // namespace kaz::vision
