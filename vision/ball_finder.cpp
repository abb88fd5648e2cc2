// BallFinder: one piece of work for each pair.
// SPDX-License-Identifier: Apache-2.0
#include "vision/ball_finder.h"

#include <algorithm>
#include <utility>

namespace kaz::vision {

// Outlives the finder while work is still on the executor.
struct BallFinder::Shared {
  explicit Shared(const BallOptions& options) : detector(options) {}
  BallDetector detector;  // worker's thread; an executor runs a module's work one by one
  std::vector<BallObservation> ready;  // caller's thread
};

BallFinder::BallFinder(Executor& executor, const BallFinderOptions& options)
    : executor_(executor), options_(options), shared_(std::make_shared<Shared>(options.ball)) {}

void BallFinder::submit(StereoPair pair) {
  const Time due = pair.info.exposure + options_.camera_latency + options_.latency;
  auto result = std::make_shared<BallObservation>();
  result->info = pair.info;
  Work work;
  work.module = this;
  work.due = due;
  work.run = [shared = shared_, result, pair = std::move(pair)](std::stop_token stop) {
    const Result<void> ran = run_guarded("the ball finder", [&] {
      const auto images = wait_for_images(pair, stop);
      if (images) {
        *result = shared->detector.detect((*images)->left, pair.info);
      } else {
        result->error = images.error();
      }
    });
    if (!ran) result->error = ran.error();
  };
  work.deliver = [shared = shared_, result] { shared->ready.push_back(std::move(*result)); };
  executor_.submit(std::move(work));
}

std::vector<BallObservation> BallFinder::poll(Time now) {
  executor_.poll(now);
  std::vector<BallObservation> ready = std::exchange(shared_->ready, {});
  std::stable_sort(ready.begin(), ready.end(),
                   [](const BallObservation& a, const BallObservation& b) {
                     return a.info.exposure < b.info.exposure;
                   });
  return ready;
}

}  // namespace kaz::vision
