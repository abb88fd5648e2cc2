// Scans a calibration file for keys and numbers. The file is YAML or JSON as written by cv::FileStorage, or
// YAML of ROS. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV 4.6's parser crashes on some damaged files, so calibration files are read with this scanner. The
// scanner ignores nesting. A matrix consists of a key and numbers within brackets. The matrix keywords (rows,
// cols, dt, data) may be between key and numbers.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::vision {

struct CalibrationEntry {
  std::vector<std::string_view> values;  // a scalar has one value
  // Size of the matrix, as text. Empty if the file does not state the size.
  std::string_view rows, cols;
  bool list = false;   // true: the values are within brackets
  bool closed = true;  // false: the file ends within the list
  int times = 0;       // number of occurrences of the key
  // The matrix keyword that occurs twice, such as "data", or empty.
  std::string_view repeated;
};

// Returns the entries by key. The entries contain views into `content`, which must outlive the entries.
std::map<std::string, CalibrationEntry, std::less<>> scan_calibration(std::string_view content);

// Parses a number. .Nan and .Inf are accepted and give non-finite numbers. Returns false for anything else.
bool calibration_number(std::string_view value, double& number);

}  // namespace kaz::vision
