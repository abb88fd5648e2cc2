// The keys and numbers of a calibration file, YAML or JSON as cv::FileStorage writes them.
// SPDX-License-Identifier: Apache-2.0
//
// A scanner of its own: the parser of OpenCV 4.6 crashes on some damaged files. It knows no levels: a
// matrix is a key, perhaps with the words of a matrix (rows, cols, dt, data) behind it, and numbers
// within brackets. Inside of vision/.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kaz::vision {

struct CalibrationEntry {
  std::vector<std::string_view> values;  // a scalar is one
  std::string_view rows, cols;           // of a matrix, as they are written; empty: not stated
  bool list = false;                     // within brackets
  bool closed = true;                    // false: the file ends within it
  int times = 0;                         // how often the key stands in the file
};

// Views into `content`, which has to stay.
std::map<std::string, CalibrationEntry, std::less<>> scan_calibration(std::string_view content);

// Parses a number, also .Nan and .Inf; false if it is something else.
bool calibration_number(std::string_view value, double& number);

}  // namespace kaz::vision
