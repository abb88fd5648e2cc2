// Control of OpenCV's own threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::vision {

// Makes OpenCV compute on the calling thread, for the rest of the process. Programs with one thread per
// module should call keep_opencv_on_callers_threads(), because OpenCV's worker threads wait for work by
// spinning. If OpenCV used several threads, the optical flow (flow.h) would also depend on the number of
// threads. OpenCV splits the search for the flow into one stripe per thread and restarts the search in each
// stripe.
void keep_opencv_on_callers_threads();

}  // namespace kaz::vision
