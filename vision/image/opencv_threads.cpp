// OpenCV's switch for its threads.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/opencv_threads.h"

#include <opencv2/core/utility.hpp>

namespace kaz::vision {

void keep_opencv_on_callers_threads() {
  cv::setNumThreads(1);
}

}  // namespace kaz::vision
