// Scans keys and numbers of a calibration file, in the YAML or JSON that cv::FileStorage writes. Internal to
// vision/.
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV 4.6's parser crashes on some damaged files, so this file has a separate scanner. The scanner ignores
// nesting. A matrix is a key and numbers within brackets. The matrix keywords (rows, cols, dt, data) may be
// between key and numbers.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::vision {

struct CalibrationEntry {
  std::vector<std::string_view> values;  // one value if scalar
  // Size of the matrix as text; empty: the file does not state the size.
  std::string_view rows, cols;
  bool list = false;   // values within brackets
  bool closed = true;  // false: the file ends within the list
  int times = 0;       // number of occurrences of the key
};

// Returns the entries by key. The entries contain views into `content`, which must outlive the entries.
std::map<std::string, CalibrationEntry, std::less<>> scan_calibration(std::string_view content);

// Parses a number. .Nan and .Inf are accepted and give non-finite numbers. Returns false for anything else.
bool calibration_number(std::string_view value, double& number);

}  // namespace kaz::vision
