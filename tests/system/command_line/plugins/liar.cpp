// A plug-in that claims to have done what it has not: its option `claims` says what. It waits, then lies.
// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "host/behavior/control_cycle.h"
#include "host/behavior/plugin.h"

namespace {

using namespace kaz;
using behavior::Context;
using behavior::Outcome;

bool is_any(std::string_view /*text*/) {
  return true;
}

// Those that the judges of Kaz's behaviors read, and what is claimed.
constexpr behavior::Option kOptions[] = {
    {"claims", "catch-ball",
     "approach-ball|catch-ball|get-up|go-forward|navigate|search-ball|stand|track-ball|turn-left|"
     "turn-right",
     0, 0, "what it claims to have done"},
    {"distance", "0.5", "", -2, 5, "metres that it does not walk"},
    {"angle", "45", "", 1, 360, "degrees that it does not turn"},
    {"seconds", "3.5", "", 0.1, 60, "time that it waits, s"},
    {"goal", "ball", "X,Y, X,Y,DEGREES or ball", 0, 0, "where it does not go", false, is_any}};

Result<Outcome> run(Context& context) {
  const std::string_view claim = context.options.choice("claims");
  // It lies at the start of get-up, and without motors it stays so.
  if (claim != "get-up") KAZ_TRY(behavior::hold_still(context.robot));
  context.sink.phase(context.clock.now(), "liar", "wait");
  behavior::ControlCycle cycle(context);
  const Time end = context.clock.now() + from_seconds(context.options.number("seconds"));
  // A robot that does nothing stands; this one leans until it falls.
  constexpr host::JointTarget kLean[] = {{host::l_ankle_pitch, 0.6}, {host::r_ankle_pitch, 0.6}};
  while (context.clock.now() < end) {
    if (claim == "stand") {
      KAZ_TRY(cycle.next(kLean, std::chrono::milliseconds(300)));
    } else {
      KAZ_TRY(cycle.next({}));
    }
  }
  // Numbers as the honest ones report them: a ball straight before the eye, at arm's length, in the hand.
  return Outcome{true,
                 "all is done",
                 {{"ball_bearing_deg", 0},
                  {"ball_elevation_deg", 0},
                  {"ball_ahead_m", 0.1},
                  {"ball_left_m", 0.047},
                  {"tracking_within_3deg", 1},
                  {"held_s", 3}},
                 {}};
}

const behavior::Behavior kLiar{"liar", "claims what it has not done", false, kOptions, run};

}  // namespace

KAZ_BEHAVIOR_PLUGIN(kLiar);
