// nod: moves the head up and down. The example that docs/howto/own-behavior.md prints.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "host/behavior/control_cycle.h"

namespace kaz::behavior {

extern const Behavior kNod;  // defined below; behaviors.def declares those listed there

namespace {

constexpr Option kOptions[] = {
    {.name = "times", .initial = "2", .min = 1, .max = 10, .text = "number of nods", .whole = true}};

Result<Outcome> run(Context& context) {
  KAZ_TRY(require_joints(context, kNod.name, {host::neck_tilt}));
  KAZ_TRY(hold_still(context.robot));
  context.sink.phase(context.clock.now(), kNod.name, "nod");

  ControlCycle cycle(context);
  double deepest = 0;
  const double times = context.options.number("times");
  for (int half = 0; half < 2 * static_cast<int>(times); ++half) {
    const host::JointTarget tilt[] = {{host::neck_tilt, half % 2 == 0 ? 0.3 : 0.0}};
    const Time end = context.clock.now() + from_seconds(0.4);
    while (context.clock.now() < end) {
      // Sends the target, waits for the next control cycle.
      const auto input = KAZ_TRY(cycle.next(tilt));
      deepest = std::max(deepest, input.posture.angle[host::neck_tilt]);
    }
  }
  return Outcome{deepest > 0.25, "the robot has nodded", {{"deepest_rad", deepest}}};
}

}  // namespace

constinit const Behavior kNod{
    .name = "nod", .text = "move the head up and down", .options = kOptions, .run = run};

}  // namespace kaz::behavior
