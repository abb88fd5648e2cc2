// What is asked of the ball's distance.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/pictures.h"

namespace kaz::vision_table {

double due(int width, double distance_m) {
  if (width == 320) return distance_m <= 0.6 ? 0.03 : distance_m <= 0.8 ? 0.05 : 0.12;
  return distance_m <= 1.0 ? 0.03 : 0.06;
}

}  // namespace kaz::vision_table
