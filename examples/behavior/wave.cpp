// wave: raises the right arm and waves. A behavior outside of Kaz's tree, which `kaz run ./wave.so` loads.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>

#include "host/behavior/control_cycle.h"
#include "host/behavior/plugin.h"

namespace {

using namespace kaz;
using behavior::Context;
using behavior::Outcome;

constexpr behavior::Option kOptions[] = {{.name = "times",
                                          .initial = "3",
                                          .min = 1,
                                          .max = 10,
                                          .text = "how often it waves",
                                          .whole = true}};

// The right arm, rad: pitch negative forwards and up, roll negative outwards, elbow negative bent.
struct Arm {
  double pitch, roll, elbow;
};
constexpr Arm kDown{0, 0, 0}, kIn{-2.0, -0.2, -0.6}, kOut{-2.0, -0.9, -0.6};

// Moves the arm in `duration`. Returns the outermost roll measured meanwhile.
Result<double> move(behavior::ControlCycle& cycle, host::Clock& clock, const Arm& arm,
                    Time duration) {
  const host::JointTarget joints[] = {
      {host::r_sh_pitch, arm.pitch}, {host::r_sh_roll, arm.roll}, {host::r_elbow, arm.elbow}};
  std::span<const host::JointTarget> targets = joints;
  double outermost = 0;
  const Time end = clock.now() + duration;
  while (clock.now() < end) {
    // Sent once, with the whole duration as the board's ramp; then the state is read until the time is over.
    const auto input = KAZ_TRY(cycle.next(targets, duration));
    targets = {};
    outermost = std::min(outermost, input.posture.angle[host::r_sh_roll]);
  }
  return outermost;
}

Result<Outcome> run(Context& context) {
  KAZ_TRY(behavior::require_joints(context, "wave",
                                   {host::r_sh_pitch, host::r_sh_roll, host::r_elbow}));
  KAZ_TRY(behavior::hold_still(context.robot));
  context.sink.phase(context.clock.now(), "wave", "wave");

  behavior::ControlCycle cycle(context);
  KAZ_TRY(move(cycle, context.clock, kIn, from_seconds(1.0)));
  double outermost = 0;
  for (int wave = 0; wave < static_cast<int>(context.options.number("times")); ++wave) {
    const double out = KAZ_TRY(move(cycle, context.clock, kOut, from_seconds(0.5)));
    outermost = std::min(outermost, out);
    KAZ_TRY(move(cycle, context.clock, kIn, from_seconds(0.5)));
  }
  KAZ_TRY(move(cycle, context.clock, kDown, from_seconds(1.0)));
  return Outcome{outermost < -0.7, "the robot has waved", {{"outermost_rad", outermost}}, {}};
}

constinit const behavior::Behavior kWave{
    .name = "wave", .text = "raise the right arm and wave", .options = kOptions, .run = run};

}  // namespace

KAZ_BEHAVIOR_PLUGIN(kWave);
