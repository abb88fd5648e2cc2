// Calibration files of OpenCV's kind: YAML or JSON of cv::FileStorage, written and read.
// SPDX-License-Identifier: Apache-2.0
//
// Keys: image_width, image_height, camera_matrix_left, distortion_coefficients_left (and _right),
// R, T (m, from the left to the right camera as cv::stereoCalibrate gives them), and the
// rectification R1, R2, P1, P2, Q. In place of the long names those of OpenCV's own stereo sample are
// read too: M1, D1, M2, D2. A file without R1, R2, P1, P2 is rectified as cv::stereoRectify does it
// (CALIB_ZERO_DISPARITY, alpha 0: hardly any black edges).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vision/calibration/calibration.h"

namespace kaz::vision {

// Errors name the file and the key. Refused: what is missing or not finite, lenses with more than
// five coefficients that are not 0, turns that are none, eyes above each other or exchanged, and R, T
// that do not fit R1, R2, P2.
Result<StereoCalibration> read_calibration(const std::string& path);
// The same of a file's content; `name` stands in the errors.
Result<StereoCalibration> parse_calibration(const std::string& content, const std::string& name);

enum class CalibrationFormat { yaml, json };
// From the ending of a file's name: .yml .yaml .json.
Result<CalibrationFormat> calibration_format(const std::string& path);

// The content of such a file, 17 digits a number. `notes`: further keys of how it was made. `date`: when, as
// calibration_time, the key of OpenCV's calibration sample; empty: the file has none.
std::string calibration_text(const StereoCalibration& calibration, CalibrationFormat format,
                             const std::vector<std::pair<std::string, double>>& notes = {},
                             const std::string& date = "");

// Fills in rectified_from_camera and `rectified` from the lenses and the transform from the left camera to
// the right one, x_right = R x_left + T (m). Errors for eyes above each other or exchanged.
Result<void> rectify_pair(StereoCalibration& calibration, const Eigen::Matrix3d& right_from_left,
                          const Eigen::Vector3d& left_origin_in_right);

}  // namespace kaz::vision
