// What the detector of the ball looks for.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "vision/color/ball.h"

int main() {
  const kaz::vision::BallFinder detector{kaz::vision::BallOptions{}};
  std::printf("looks for a ball of %.0f mm\n", 2000 * kaz::vision::BallOptions{}.radius_m);
}
