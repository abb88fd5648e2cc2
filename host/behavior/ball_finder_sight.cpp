// Hands new pairs to the ball finder and takes what it has found.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/ball_finder_sight.h"

namespace kaz::behavior {

Result<std::vector<vision::BallObservation>> BallFinderSight::poll(Time now) {
  while (true) {
    auto pair = camera_.poll();
    if (!pair) return tl::unexpected(pair.error());
    if (!*pair) break;
    finder_.submit(std::move(**pair));
  }
  auto observations = finder_.poll(now);
  for (const vision::BallObservation& observation : observations) {
    if (observation.error) return tl::unexpected(*observation.error);
  }
  return observations;
}

}  // namespace kaz::behavior
