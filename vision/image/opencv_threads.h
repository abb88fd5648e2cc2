// Control of OpenCV's own threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::vision {

// Makes OpenCV compute on the calling thread, for the rest of the process. Programs with one thread per
// module should call keep_opencv_on_callers_threads(), because OpenCV's worker threads wait for work by
// spinning. Another reason is the inverse search of flow.h. OpenCV splits the search into one stripe per
// thread and restarts the search in each stripe, so the number of threads changes the flow slightly.
void keep_opencv_on_callers_threads();

}  // namespace kaz::vision
