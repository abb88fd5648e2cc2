// Reads and writes calibration files: cv::FileStorage's YAML, JSON and XML, and ROS's camera_info.
// SPDX-License-Identifier: Apache-2.0
//
// Keys: image_width, image_height, camera_matrix_left, distortion_coefficients_left (and _right). R and T are
// rotation and translation (m) from the left to the right camera, as cv::stereoCalibrate returns them. R1,
// R2, P1, P2 and Q describe the rectification. The short names M1, D1, M2 and D2 of OpenCV's stereo sample
// are also accepted. If a file has none of the keys R1, R2, P1 and P2, the rectification is computed by
// cv::stereoRectify with CALIB_ZERO_DISPARITY and alpha = 0. With alpha = 0, rectified pictures have hardly
// any black edges. The path "LEFT,RIGHT" names two camera_info files (camera_info.h).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vision/calibration/calibration.h"

namespace kaz::vision {

// Reads a calibration. Errors name the file and the key. Errors:
// - missing, repeated or non-finite values.
// - fisheye lenses, and lenses with more than five non-zero coefficients.
// - matrices that are not rotations.
// - exchanged eyes, or one eye above the other.
// - R and T that contradict R1, R2 and P2.
Result<StereoCalibration> read_calibration(const std::string& path);
// Like read_calibration(), but for the content of a file. Errors contain `name`.
Result<StereoCalibration> parse_calibration(const std::string& content, const std::string& name);

enum class CalibrationFormat { yaml, json, xml, camera_info };
// Returns the format that belongs to the extension of a file name: .yml, .yaml, .json or .xml. "LEFT,RIGHT"
// is camera_info if both names end with .yml or .yaml. Any other name is an error.
Result<CalibrationFormat> calibration_format(const std::string& path);

// Returns the content of a calibration file, with 17 digits per number. `format` must not be camera_info
// (camera_info_text() writes these files). `notes` are additional keys and numbers, for example about how
// the calibration was made. `date` is written as calibration_time, a key of OpenCV's calibration sample. If
// `date` is empty, the key is left out.
std::string calibration_text(const StereoCalibration& calibration, CalibrationFormat format,
                             const std::vector<std::pair<std::string, double>>& notes = {},
                             const std::string& date = "");

// Computes `rectified` and, for each eye, `rectified_from_camera`. The computation uses the lenses and the
// given transform between the cameras, `x_right = R x_left + T` (m). Errors: the eyes are at the same
// position or exchanged; one eye is above the other; the lenses cannot be rectified.
Result<void> rectify_pair(StereoCalibration& calibration, const Eigen::Matrix3d& right_from_left,
                          const Eigen::Vector3d& left_origin_in_right);

}  // namespace kaz::vision
