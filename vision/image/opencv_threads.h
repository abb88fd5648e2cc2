// Whether OpenCV shares its work between threads of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::vision {

// From now on each call of OpenCV works on its caller's thread, in the whole process. For programs whose
// modules have a thread each: OpenCV's other threads wait for work by running, and the inverse search of
// flow.h begins anew in each stripe of the picture, of which there are as many as threads.
void keep_opencv_on_callers_threads();

}  // namespace kaz::vision
