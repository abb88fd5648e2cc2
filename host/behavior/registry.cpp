// All behaviours there are.
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "host/behavior/approach.h"
#include "host/behavior/behavior.h"
#include "host/behavior/catch_ball.h"
#include "host/behavior/get_up.h"
#include "host/behavior/go_forward.h"
#include "host/behavior/search_ball.h"
#include "host/behavior/stand.h"
#include "host/behavior/track_ball.h"
#include "host/behavior/turn.h"

namespace kaz::behavior {

std::span<const Behavior> behaviors() {
  static const std::array all{kApproachBall, kCatchBall, kGetUp,    kGoForward, kSearchBall,
                              kStand,        kTrackBall, kTurnLeft, kTurnRight};
  return all;
}

Result<Behavior> find_behavior(std::string_view name) {
  std::string names;
  for (const Behavior& behavior : behaviors()) {
    if (behavior.name == name) return behavior;
    names += (names.empty() ? "" : ", ") + std::string(behavior.name);
  }
  return fail(Fault::usage,
              "there is no behaviour `" + std::string(name) + "`: it is one of " + names);
}

}  // namespace kaz::behavior
