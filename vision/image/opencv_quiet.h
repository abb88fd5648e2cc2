// Suppresses OpenCV's error output in the whole process while an OpenCvQuiet object exists. OpenCV still
// reports errors as exceptions. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

namespace kaz::vision {

class OpenCvQuiet {
 public:
  OpenCvQuiet() : before_(cv::redirectError(&nothing, nullptr, &before_data_)) {}
  ~OpenCvQuiet() { cv::redirectError(before_, before_data_); }
  OpenCvQuiet(const OpenCvQuiet&) = delete;
  OpenCvQuiet& operator=(const OpenCvQuiet&) = delete;

 private:
  static int nothing(int, const char*, const char*, const char*, int, void*) { return 0; }
  void* before_data_ = nullptr;
  cv::ErrorCallback before_;
};

}  // namespace kaz::vision
