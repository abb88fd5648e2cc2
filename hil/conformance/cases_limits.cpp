// Cases of docs/reference/protocol.md, chapter Motion: what is refused, and what no request can do.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>

#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

Bytes one_target(int joint, long angle, int duration_ms) {
  return Put().u32(1L << joint).u16(duration_ms).s16(angle);
}

// Soft limits of a joint as the board reports them.
std::pair<long, long> limits_of(Board& b, int joint) {
  const Reply set = b.done("settings", Put().u8(joint));
  return {set["lower"], set["upper"]};
}

// The command of joint 0 must stay inside while `then` runs in between.
void commands_inside(Board& b, int ms, long lower, long upper) {
  for (const Frame& frame : b.telemetry(ms, true)) {
    const Reply sample(message("telemetry_commands"), frame);
    within("command", sample.number("angle", 0), lower, upper);
  }
}

void add_refusals(Chapter& to) {
  for (int j = 0; j < KZ_JOINTS; ++j) {
    to.add("joint-" + std::to_string(j),
           "Targets at the soft limits of joint " + std::to_string(j) +
               " are accepted. Targets beyond the limits are refused with LIMIT.",
           "MOVE-6", [j](Board& b) {
             const auto [lower, upper] = limits_of(b, j);
             check(lower < upper, "the joint's lower limit is not below the upper one");
             b.enable(1u << j);
             b.refused("targets", one_target(j, lower - 1, 5000), KZ_REFUSED_LIMIT, j);
             b.refused("targets", one_target(j, upper + 1, 5000), KZ_REFUSED_LIMIT, j);
             b.refused("targets", one_target(j, -32768, 5000), KZ_REFUSED_LIMIT, j);
             b.refused("targets", one_target(j, 32767, 5000), KZ_REFUSED_LIMIT, j);
             b.done("targets", one_target(j, lower, 60000));
             b.done("targets", one_target(j, upper, 60000));
           });
    to.add(
        "off-" + std::to_string(j),
        "A target for joint " + std::to_string(j) +
            " is refused with DISABLED while the joint is off.",
        "MOVE-5",
        [j](Board& b) { b.refused("targets", one_target(j, 0, 100), KZ_REFUSED_DISABLED, j); },
        kNothing);
  }
  to.add("whole-limit",
         "If one target of a message is outside its joint's limits, the message has no effect.",
         "MOVE-6", [](Board& b) {
           b.enable(0x7);
           const Reply before = b.done("read_targets", Put().u32(7));
           b.refused("targets",
                     Put().u32(7).u16(500).s16(before.number("angle", 0) + 500).s16(20000).s16(0),
                     KZ_REFUSED_LIMIT, 1);
           const Reply after = b.done("read_targets", Put().u32(7));
           for (int j = 0; j < 3; ++j)
             equal("target", after.number("angle", j), before.number("angle", j));
           check(!b.state().flag(KZ_STATUS_MOVING), "a refused message started a ramp");
         });
  to.add("whole-disabled",
         "If a message has a target for a joint that is off, the message has no effect.", "MOVE-5",
         [](Board& b) {
           b.enable(0x5);
           const Reply before = b.done("read_targets", Put().u32(5));
           b.refused("targets", Put().u32(7).u16(500).s16(500).s16(500).s16(-500),
                     KZ_REFUSED_DISABLED, 1);
           const Reply after = b.done("read_targets", Put().u32(5));
           equal("target of joint 0", after.number("angle", 0), before.number("angle", 0));
           equal("target of joint 2", after.number("angle", 2), before.number("angle", 2));
         });
}

void add_motion(Chapter& to) {
  to.add("command-inside", "No sequence of targets moves the command out of the soft limits.",
         "MOVE-10", [](Board& b) {
           const long middle = b.angle(0);
           b.done("limits", Put().u32(1).u16(120).s16(middle - 1500).s16(middle + 1500));
           b.enable(1);
           b.done("telemetry", Put().u16(5).u8(KZ_TELEMETRY_COMMANDS));
           for (int n = 0; n < 20; ++n) {
             const long goal = n % 2 ? middle + 1500 : middle - 1500;
             b.done("targets", one_target(0, goal, static_cast<int>(b.random()() % 60)));
             commands_inside(b, 40, middle - 1500, middle + 1500);
           }
         });
  to.add("ramp-of-command", "No sequence of targets moves the command faster than the ramp limit.",
         "MOVE-10", [](Board& b) {
           b.done("limits", Put().u32(1).u16(20).s16(-15000).s16(15000));
           b.enable(1);
           b.done("telemetry", Put().u16(5).u8(KZ_TELEMETRY_COMMANDS));
           long last_tick = 0, last = 0;
           for (int n = 0; n < 15; ++n) {
             const long goal = static_cast<long>(b.random()() % 6000) - 3000;
             b.done("targets", one_target(0, goal, static_cast<int>(b.random()() % 100)));
             for (const Frame& frame : b.telemetry(50, true)) {
               const Reply sample(message("telemetry_commands"), frame);
               const long tick = sample["tick"], command = sample.number("angle", 0);
               if (last_tick != 0) {
                 within("command step", std::labs(command - last), 0, 20 * (tick - last_tick));
               }
               last_tick = tick;
               last = command;
             }
           }
         });
  to.add(
      "outside-moves-inward",
      "If a joint outside its soft limits gets a target, the ramp starts at the joint's present "
      "angle and leads inward.",
      "MOVE-10",
      [](Board& b) {
        b.done("limits", Put().u32(1).u16(60).s16(-3000).s16(3000));
        b.bench().place_joint(0, 0.45);
        b.wait(20);
        b.enable(1);
        within("angle", b.angle(0), 4400, 4600);
        b.done("telemetry", Put().u16(5).u8(KZ_TELEMETRY_COMMANDS));
        b.done("targets", one_target(0, 2000, 300));
        long last = 4600;
        for (const Frame& frame : b.telemetry(500, true)) {
          const long command = Reply(message("telemetry_commands"), frame).number("angle", 0);
          within("command", command, 1990, last);
          last = command;
        }
        within("angle", b.angle(0), 1900, 2100);
      },
      kMotion | kBench);
  for (const bool upper : {false, true}) {
    const std::string side = upper ? "upper" : "lower";
    const int sign = upper ? 1 : -1;
    to.add(
        "no-drive-beyond-" + side,
        "The position loop does not drive a joint farther beyond its " + side + " soft limit.",
        "MOVE-11",
        [sign](Board& b) {
          b.done("limits", Put().u32(1).u16(120).s16(-2000).s16(2000));
          b.enable(1);
          b.done("targets", one_target(0, sign * 1900, 100));
          b.stay_alive(300);
          for (const double angle : {0.21, 0.25, 0.30}) {  // turned out by hand
            b.bench().place_joint(0, sign * angle);
            b.stay_alive(10);
            check(sign * b.bench().drive(0) <= 0,
                  "the motor drives the joint farther beyond its limit");
          }
        },
        kMotion | kBench);
    to.add(
        "at-limit-flag-" + side,
        "AT_LIMIT is reported for a joint beyond its " + side + " soft limit.", "MOVE-11",
        [sign](Board& b) {
          b.done("limits", Put().u32(1).u16(120).s16(-2000).s16(2000));
          b.bench().place_joint(0, sign * 0.22);
          b.wait(20);
          b.enable(1);
          equal("AT_LIMIT", b.joints(1).number("faults", 0) & KZ_JOINT_AT_LIMIT, KZ_JOINT_AT_LIMIT);
          check(sign * b.bench().drive(0) <= 0,
                "the motor drives the joint farther beyond its limit");
        },
        kMotion | kBench);
    to.add(
        "no-drive-back-out-" + side,
        "If a joint is switched on beyond its " + side +
            " soft limit and then turned inward by hand, the motor does not drive the joint "
            "outward.",
        "MOVE-11",
        [sign](Board& b) {
          b.done("limits", Put().u32(1).u16(120).s16(-2000).s16(2000));
          b.bench().place_joint(0, sign * 0.5);
          b.wait(20);
          b.enable(1);
          b.bench().place_joint(0, sign * 0.35);
          for (int n = 0; n < 10; ++n) {
            b.stay_alive(5);
            check(sign * b.bench().drive(0) <= 0,
                  "the motor drives the joint farther beyond its limit");
          }
        },
        kMotion | kBench);
    to.add(
        "no-overshoot-" + side,
        "With the highest gains and ramp limit, a joint does not pass its " + side + " soft limit.",
        "MOVE-11",
        [sign](Board& b) {
          b.done("gains", Put().u32(1).u16(KZ_KP_MAX).u16(0).u16(0).u8(KZ_FRICTION_MAX));
          b.done("limits", Put().u32(1).u16(KZ_RAMP_MAX).s16(-3000).s16(3000));
          b.watchdog(100);
          b.enable(1);
          for (int n = 0; n < 4; ++n) {
            b.done("targets", one_target(0, -sign * 2000, 0));
            b.wait(150);
            b.done("targets", one_target(0, sign * 3000, 0));
            for (int ms = 0; ms < 150; ++ms) {
              b.wait(1);
              check(sign * b.bench().angle_rad(0) <= 0.31,
                    "the shaft is at " + std::to_string(b.bench().angle_rad(0)) + " rad");
            }
          }
        },
        kMotion | kBench);
  }
}

}  // namespace

void add_limit_cases(Cases& all) {
  Chapter to(all, "limits", kMotion);
  add_refusals(to);
  add_motion(to);
}

}  // namespace kaz::hil
