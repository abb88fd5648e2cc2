// Control law of an identified servo on a virtual bus.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/identified_law.h"

#include <cmath>

namespace kaz::sim {

BusCommand IdentifiedLaw::delayed(const BusCommand& now, double step_s) {
  // In the middle of the first step that sees it, a command is one step old.
  const double steps = std::round(params_->delay / step_s - 1);
  const std::size_t kept = steps > 0 ? static_cast<std::size_t>(steps) : 0;
  if (past_.empty()) past_.assign(kept, now);
  past_.push_back(now);
  while (past_.size() > kept + 1) past_.pop_front();
  return past_.front();
}

}  // namespace kaz::sim
