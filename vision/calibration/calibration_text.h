// Scans keys and numbers of a calibration file, YAML or JSON as cv::FileStorage writes them. Internal to
// vision/.
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV 4.6's parser crashes on some damaged files, so this is a separate scanner. It has no levels. A
// matrix is a key and numbers within brackets, possibly with the matrix keywords (rows, cols, dt, data)
// between.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::vision {

struct CalibrationEntry {
  std::vector<std::string_view> values;  // one value if scalar
  std::string_view rows, cols;           // matrix size as text; empty: not stated
  bool list = false;                     // values within brackets
  bool closed = true;                    // false: the file ends within the list
  int times = 0;                         // number of occurrences of the key
};

// Returns the entries by key. They are views into `content`, which must outlive them.
std::map<std::string, CalibrationEntry, std::less<>> scan_calibration(std::string_view content);

// Parses a number, including .Nan and .Inf, both as non-finite. Returns false for anything else.
bool calibration_number(std::string_view value, double& number);

}  // namespace kaz::vision
