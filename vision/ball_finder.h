// Looks for the ball in every stereo pair's left picture, on an executor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "vision/ball.h"
#include "vision/pipeline.h"

namespace kaz::vision {

struct BallFinderOptions {
  BallOptions ball;
  Time camera_latency = std::chrono::milliseconds(0);  // exposure to arrival at the host
  Time latency = std::chrono::milliseconds(5);  // arrival to result (design section 3: colour 5 ms)
};

class BallFinder {
 public:
  // The executor may be shared between modules and must outlive this.
  BallFinder(Executor& executor, const BallFinderOptions& options);

  // Never waits, though the pair's pixels may still be on their way.
  void submit(StereoPair pair);
  // Observations that have become ready since the last call, in order of exposure; those without a
  // ball too (found is false), and those that failed (error is set).
  std::vector<BallObservation> poll(Time now);

 private:
  struct Shared;
  Executor& executor_;
  BallFinderOptions options_;
  std::shared_ptr<Shared> shared_;
};

}  // namespace kaz::vision
