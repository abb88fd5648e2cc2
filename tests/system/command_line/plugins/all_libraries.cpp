// A plug-in that calls each library whose headers it may use, also what the program itself does not call.
// SPDX-License-Identifier: Apache-2.0

#include "host/behavior/composition.h"
#include "host/behavior/plugin.h"
#include "host/map/local_map.h"
#include "host/motion/reach.h"
#include "shared/faults/faults.h"
#include "shared/protocol/frame.h"
#include "vision/depth/depth.h"

namespace {

using namespace kaz;
using behavior::Context;
using behavior::Outcome;

Result<Outcome> run(Context& context) {
  const auto map = KAZ_TRY(map::LocalMap::make());
  const auto faults = KAZ_TRY(faults::Schedule::parse("", "nothing"));
  const vision::DepthFinder depth;
  const auto pickup = motion::Pickup::plan(host::Side::left, {0.1, 0.05}, 0.02);
  const std::uint8_t body[] = {1, 5, 5};
  std::uint8_t frame[KZ_FRAME_MAX];
  const bool coded = kz_frame_encode(body, sizeof body, frame) == 9;
  // A behavior of Kaz's as a step of one's own.
  const auto stood =
      KAZ_TRY(behavior::sequence("all-libraries", {{"stand", behavior::kStand.run}})(context));
  return Outcome{stood.success && coded && map.cells() > 0 && !faults.only_simulated(),
                 pickup ? "all of it is there, and a pickup" : "all of it is there",
                 {},
                 {}};
}

// The options of `stand`, which runs as a step.
const behavior::Behavior kAll{"all-libraries", "calls each library", false,
                              behavior::kStand.options, run};

}  // namespace

KAZ_BEHAVIOR_PLUGIN(kAll);
