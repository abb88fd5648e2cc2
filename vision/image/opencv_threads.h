// Control of OpenCV's own threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::vision {

// Makes OpenCV compute on the thread of its caller, from now on and in the whole process. Programs with one
// thread per module should call this, because OpenCV's worker threads wait for work by spinning. Also, OpenCV
// splits the inverse search of flow.h into one stripe per thread and restarts the search in each stripe,
// which changes the flow slightly.
void keep_opencv_on_callers_threads();

}  // namespace kaz::vision
