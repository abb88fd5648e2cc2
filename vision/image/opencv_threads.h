// Control of OpenCV's own threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::vision {

// Makes OpenCV work on its caller's thread, from now on and in the whole process. For programs with one
// thread per module: OpenCV's worker threads wait for work by spinning. Also, the inverse search of flow.h
// starts again in each stripe of the picture, and there is one stripe per thread.
void keep_opencv_on_callers_threads();

}  // namespace kaz::vision
