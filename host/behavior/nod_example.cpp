// nod: says yes. An example of a behaviour, printed in docs/host.md.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/nod_example.h"

#include <algorithm>

#include "host/behavior/control_cycle.h"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {{"times", "2", "", 1, 10, "how often"}};

Result<Outcome> run(Context& context) {
  if (auto held = hold_still(context.robot); !held) return tl::unexpected(held.error());
  context.sink.phase(context.clock.now(), kNod.name, "nod");

  ControlCycle cycle(context);
  double deepest = 0;
  const double times = context.options.number("times");
  for (int half = 0; half < 2 * static_cast<int>(times); ++half) {
    const host::JointTarget tilt[] = {{host::neck_tilt, half % 2 == 0 ? 0.3 : 0.0}};
    const Time end = context.clock.now() + from_seconds(0.4);
    while (context.clock.now() < end) {
      const auto input = cycle.next(tilt);  // sends the target, waits for the next beat
      if (!input) return tl::unexpected(input.error());
      deepest = std::max(deepest, input->posture.angle[host::neck_tilt]);
    }
  }
  return Outcome{deepest > 0.25, "the robot has nodded", {{"deepest_rad", deepest}}};
}

}  // namespace

constinit const Behavior kNod{"nod", "say yes", false, kOptions, run};

}  // namespace kaz::behavior
