// Contact parameters of a pair of surfaces.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contact_surface.h"

#include <algorithm>

namespace kaz::sim {

Surface joined(const Surface& a, const Surface& b) {
  const Surface& livelier = a.restitution >= b.restitution ? a : b;
  return {.mu = std::min(a.mu, b.mu),
          .softness = a.softness + b.softness,
          .restitution = livelier.restitution,
          .bounce_threshold = livelier.bounce_threshold,
          .rolling_resistance = std::max(a.rolling_resistance, b.rolling_resistance)};
}

}  // namespace kaz::sim
