// The sense of where the ball is, as behaviours have it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "vision/color/ball.h"

namespace kaz::behavior {

class BallSight {
 public:
  virtual ~BallSight() = default;
  // What vision found out since the last call, in order of exposure; pictures without a ball too.
  // Never waits. Fails when no more pictures will come; the message says why.
  virtual Result<std::vector<vision::BallObservation>> poll(Time now) = 0;
};

}  // namespace kaz::behavior
