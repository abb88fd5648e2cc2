// Reads and writes a stereo calibration as two camera_info files of ROS (camera_calibration_parsers, YAML).
// SPDX-License-Identifier: Apache-2.0
//
// Keys of a file: image_width, image_height, camera_name, camera_matrix, distortion_model,
// distortion_coefficients, rectification_matrix and projection_matrix. The baseline B is in the right file:
// projection_matrix[0][3] = -fx * B. The model plumb_bob has the coefficients k1 k2 p1 p2 k3. The model
// rational_polynomial is read if k4, k5 and k6 are 0. Other models, such as equidistant, are errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/calibration/calibration.h"

namespace kaz::vision {

// One text for each eye: paths, names or contents of files.
struct CameraInfoPair {
  std::string left, right;
};

// The fields of a camera_info message. Matrices are in row order; an empty list: the message has none.
struct CameraInfo {
  std::uint32_t width = 0, height = 0;
  std::string model;  // distortion_model
  std::vector<double> d, k, r, p;
};
// Returns the content of a file with these fields. Without `d`, the file has five zeros.
std::string camera_info_file(const CameraInfo& info, const std::string& camera_name);

// Splits "LEFT,RIGHT" at the first comma. nullopt: there is no comma, or a part is empty.
std::optional<CameraInfoPair> camera_info_paths(const std::string& path);

// Parses the contents of two files. Fails (usage) like parse_calibration(), and if the sizes of the pictures
// differ. `names`: names of the files for errors.
Result<StereoCalibration> parse_camera_info(const CameraInfoPair& contents,
                                            const CameraInfoPair& names);

// Returns the contents of the files, with the camera names "left" and "right". Each number is written so that
// it is read back unchanged. The baseline is a quotient, so it may change in the last digit.
CameraInfoPair camera_info_text(const StereoCalibration& calibration);

}  // namespace kaz::vision
