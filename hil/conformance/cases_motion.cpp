// Cases of docs/reference/protocol.md, chapter Motion: enabling, targets, ramps.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>

#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

constexpr long kStill = 80;  // 100 urad: noise, friction and one code of the potentiometer
// 100 urad, for a joint that bears nothing: half of 0.4 degrees of play, 3.5 mrad; stiction at 12 per
// rad, 6 mrad; noise, one code and the motion of the gear in its gap, 5 mrad. In simulated time the
// joint has no play.
constexpr long kReached = 145;

long target_of(Board& b, int joint) {
  return b.done("read_targets", Put().u32(1L << joint)).number("angle", joint);
}

// A target that is inside the limits, `step` away from where the joint is.
long some_way(Board& b, int joint, long step) {
  const long at = b.angle(joint);
  return at > 0 ? at - step : at + step;
}

void near(const std::string& what, long got, long wanted, long tolerance) {
  within(what, got, wanted - tolerance, wanted + tolerance);
}

// At its gains after a reset a joint that bears nothing may move within the play of its gear; at these it
// rests. In simulated time it has no play.
void soften(Board& b, std::uint32_t mask) {
  if (!b.exact()) b.done("gains", Put().u32(mask).u16(12 * 256).u16(614).u16(0).u8(0));
}

void expect_still(Board& b, int joint, long at) {
  for (int n = 0; n < 10; ++n) {
    near("angle of joint " + std::to_string(joint), b.angle(joint), at,
         b.exact() ? kStill : kReached);
    b.wait(20);
  }
}

void add_enable(Chapter& to) {
  to.add(
      "off-after-reset", "All motors are off after a reset.", "MOVE-1",
      [](Board& b) {
        b.expect_off();
        const Reply joints = b.joints(0x1FF);
        for (int j = 0; j < 9; ++j)
          equal("flags & ON", joints.number("faults", j) & KZ_JOINT_ON, 0);
        b.refused("targets", Put().u32(1).u16(100).s16(0), KZ_REFUSED_DISABLED, 0);
      },
      kNothing);
  to.add("off-after-reset-while-on",
         "All motors are off after a reset, even if they were on earlier.", "MOVE-1", [](Board& b) {
           b.enable(0x3);
           b.enable(0);
           b.reset_by_command();
           b.expect_off();
         });
  to.add("enable-keeps-still", "A joint does not move when it is switched on.", "MOVE-2",
         [](Board& b) {
           const long at = b.angle(0);
           b.enable(1);
           near("target", target_of(b, 0), at, kStill);
           expect_still(b, 0, at);
         });
  to.add(
      "enable-where-turned",
      "A joint that was turned by hand does not move when it is switched on.", "MOVE-2",
      [](Board& b) {
        b.bench().place_joint(0, 0.7);
        b.wait(20);
        b.enable(1);
        near("target", target_of(b, 0), 7000, kStill);
        expect_still(b, 0, 7000);
      },
      kMotion | kBench);
  to.add("enable-all-still", "All 18 joints switched on at once do not move.", "MOVE-2",
         [](Board& b) {
           const Reply before = b.state();
           b.enable(KZ_ALL_JOINTS);
           b.stay_alive(200);
           const Reply after = b.state();
           for (int j = 0; j < KZ_JOINTS; ++j) {
             near("angle of joint " + std::to_string(j), after.number("angle", j),
                  before.number("angle", j), b.exact() ? kStill : kReached);
           }
         });
  to.add("enable-others-off", "`enable` switches all other joints off.", "MOVE-2", [](Board& b) {
    b.enable(0x7);
    b.enable(0x2);
    const Reply joints = b.joints(0x7);
    for (int j = 0; j < 3; ++j) {
      equal("ON flag of joint " + std::to_string(j), joints.number("faults", j) & KZ_JOINT_ON,
            j == 1 ? KZ_JOINT_ON : 0);
    }
    b.enable(0);
    b.expect_off();
  });
  to.add("enable-forgets-targets", "`enable` does not restore an earlier target.", "MOVE-2",
         [](Board& b) {
           b.enable(1);
           b.target(0, some_way(b, 0, 4000), 1000);
           b.stay_alive(150);
           b.enable(0);
           b.wait(100);
           const long at = b.angle(0);
           b.enable(1);
           near("target", target_of(b, 0), at, kStill);
           expect_still(b, 0, at);
         });
  to.add("enable-keeps-others", "`enable` keeps the target of a joint that is already on.",
         "MOVE-2", [](Board& b) {
           b.enable(1);
           const long to_angle = some_way(b, 0, 2000);
           b.target(0, to_angle, 400);
           b.stay_alive(100);
           b.enable(0x3);
           equal("target", target_of(b, 0), to_angle);
         });
  to.add("enable-while-latched", "`enable` is refused while a shutdown is latched.", "MOVE-3",
         [](Board& b) {
           b.done("stop");
           b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_STOP);
           b.expect_off();
           b.done("clear");
           b.enable(1);
         });
  to.add(
      "enable-nothing-while-latched",
      "`enable` with an empty mask is accepted even while a "
      "shutdown is latched.",
      "MOVE-3",
      [](Board& b) {
        b.done("stop");
        equal("mask", b.done("enable", Put().u32(0))["mask"], 0);
      },
      kNothing);
  for (const int code : {0, 3, 1020, 1023}) {
    to.add(("enable-pot-" + std::to_string(code)).c_str(),
           "`enable` is refused for a joint whose potentiometer reads A/D code " +
               std::to_string(code) + ".",
           "MOVE-3",
           [code](Board& b) {
             b.bench().set_analog(0, code);  // joint 0
             b.wait(20);
             b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_POT);
             b.refused("enable", Put().u32(3), KZ_REFUSED_FAULT, KZ_SHUTDOWN_POT);
             b.enable(2);
             b.expect_alive();
           },
           kMotion | kBench);
  }
  for (const bool high : {false, true}) {
    to.add(
        high ? "enable-overvoltage" : "enable-undervoltage",
        "`enable` is refused while the supply is out of range.", "MOVE-3",
        [high](Board& b) {
          b.bench().set_analog(KZ_ANALOG_SUPPLY, high ? 880 : 200);  // 13.2 V, 3 V
          b.wait(30);
          b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT,
                    high ? KZ_SHUTDOWN_OVERVOLTAGE : KZ_SHUTDOWN_UNDERVOLTAGE);
          b.expect_off();
        },
        kBench);
  }
}

// Commands of joint 0 by telemetry over a time, by tick.
struct Commands {
  std::vector<std::pair<long, long>> samples;  // tick, command
};
Commands commands_of(Board& b, int joint, int ms) {
  Commands commands;
  for (const Frame& frame : b.telemetry(ms, true)) {
    const Reply sample(message("telemetry_commands"), frame);
    commands.samples.emplace_back(sample["tick"], sample.number("angle", joint));
  }
  check(commands.samples.size() > 5, "too few telemetry frames came");
  return commands;
}

void add_ramps(Chapter& to) {
  to.add("target-reached", "A joint reaches its target in the requested time.", "MOVE-4",
         [](Board& b) {
           soften(b, 1);
           b.enable(1);
           const long goal = some_way(b, 0, 3000);
           b.target(0, goal, 300);
           b.stay_alive(450);
           near("angle", b.angle(0), goal, b.exact() ? kStill : kReached);
         });
  to.add("ramp-straight", "The command is a linear ramp that takes the requested time.", "MOVE-4",
         [](Board& b) {
           b.enable(1);
           const long from = target_of(b, 0), goal = from > 0 ? from - 4000 : from + 4000;
           b.done("telemetry", Put().u16(10).u8(KZ_TELEMETRY_COMMANDS));
           const std::uint8_t sequence = b.new_sequence();
           b.write(b.request_bytes("targets", Put().u32(1).u16(400).s16(goal), sequence));
           const long start = b.take("targets", sequence)["tick"];
           for (const auto& [tick, command] : commands_of(b, 0, 500).samples) {
             const double share = std::min(1.0, static_cast<double>(tick - start) / 400);
             const long wanted = from + std::lround(share * static_cast<double>(goal - from));
             near("command " + std::to_string(tick - start) + " ms after the start of the ramp",
                  command, wanted, 25);
           }
         });
  to.add("ramp-limit", "If the requested time is too short, the ramp limit applies.", "MOVE-4",
         [](Board& b) {
           b.done("limits", Put().u32(1).u16(10).s16(-20000).s16(20000));
           b.enable(1);
           const long from = target_of(b, 0), goal = from > 0 ? from - 2000 : from + 2000;
           b.done("telemetry", Put().u16(10).u8(KZ_TELEMETRY_COMMANDS));
           const std::uint8_t sequence = b.new_sequence();
           b.write(b.request_bytes("targets", Put().u32(1).u16(50).s16(goal), sequence));
           const long start = b.take("targets", sequence)["tick"];
           for (const auto& [tick, command] : commands_of(b, 0, 300).samples) {
             const long distance = std::min(2000L, 10 * (tick - start));
             near("command", std::labs(command - from), distance, 30);
           }
         });
  to.add("ramp-from-command", "The ramp to a new target starts from the current command.", "MOVE-4",
         [](Board& b) {
           b.enable(1);
           const long from = target_of(b, 0), goal = some_way(b, 0, 4000);
           b.done("telemetry", Put().u16(5).u8(KZ_TELEMETRY_COMMANDS));
           b.target(0, goal, 400);
           Commands all = commands_of(b, 0, 200);
           b.target(0, from, 400);
           const Commands more = commands_of(b, 0, 300);
           all.samples.insert(all.samples.end(), more.samples.begin(), more.samples.end());
           for (std::size_t i = 1; i < all.samples.size(); ++i) {
             const auto [tick, command] = all.samples[i];
             const auto [before_tick, before] = all.samples[i - 1];
             within("change of the command in " + std::to_string(tick - before_tick) + " ms",
                    std::labs(command - before), 0, 10 * (tick - before_tick) + 10);
           }
         });
  to.add("ramp-zero-time", "With time 0, the joint moves at the ramp limit.", "MOVE-4",
         [](Board& b) {
           soften(b, 1);
           b.enable(1);
           const long goal = some_way(b, 0, 3000);
           b.target(0, goal, 0);
           b.stay_alive(250);
           near("angle", b.angle(0), goal, b.exact() ? kStill : kReached);
         });
  to.add("many-joints", "One message moves all 18 joints.", "MOVE-4", [](Board& b) {
    b.enable(KZ_ALL_JOINTS);
    const Reply from = b.state();
    Put fields;
    fields.u32(KZ_ALL_JOINTS).u16(300);
    std::vector<long> goals;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      goals.push_back(from.number("angle", j) + (j == 12 || j == 16 ? 1500 : -700));
      fields.s16(goals.back());
    }
    b.done("targets", fields);
    b.wait_until_still();
    b.stay_alive(400);
    const Reply targets = b.done("read_targets", Put().u32(KZ_ALL_JOINTS));
    const Reply after = b.state();
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto goal = goals[static_cast<std::size_t>(j)];
      equal("target of joint " + std::to_string(j), targets.number("angle", j), goal);
      // The hands are held softly (kp), so that friction keeps them back.
      // So does the weight of what hangs on a joint, which on a bench is nothing.
      const long tolerance = j == 5 || j == 9 ? 1200 : b.exact() ? kStill + 60 : 800;
      near("angle of joint " + std::to_string(j), after.number("angle", j), goal, tolerance);
    }
  });
  to.add("others-stay", "Joints outside the mask keep their targets.", "MOVE-4", [](Board& b) {
    b.enable(0x3);
    const long other = target_of(b, 1);
    b.target(0, some_way(b, 0, 1000), 100);
    b.stay_alive(150);
    equal("target of joint 1", target_of(b, 1), other);
  });
  to.add("moving-flag", "MOVING is set only during a ramp.", "MOVE-12", [](Board& b) {
    b.enable(1);
    check(!b.state().flag(KZ_STATUS_MOVING), "MOVING is set before the first target");
    b.target(0, some_way(b, 0, 1000), 200);
    b.wait(20);
    check(b.state().flag(KZ_STATUS_MOVING), "MOVING is not set during the ramp");
    equal("MOVING flag of the joint", b.joints(1).number("faults", 0) & KZ_JOINT_MOVING,
          KZ_JOINT_MOVING);
    b.stay_alive(250);
    check(!b.state().flag(KZ_STATUS_MOVING), "MOVING is set after the ramp");
  });
}

void add_reading(Chapter& to) {
  to.add(
      "read-targets-off", "`read_targets` reports the angle of a joint that is off.", "MOVE-7",
      [](Board& b) {
        const Reply targets = b.done("read_targets", Put().u32(KZ_ALL_JOINTS));
        const Reply state = b.state();
        equal("mask", targets["mask"], KZ_ALL_JOINTS);
        for (int j = 0; j < KZ_JOINTS; ++j) {
          near("joint " + std::to_string(j), targets.number("angle", j), state.number("angle", j),
               kStill);
        }
      },
      kNothing);
  to.add("read-targets-on",
         "During a ramp, `read_targets` reports the target, not the present "
         "command.",
         "MOVE-7", [](Board& b) {
           b.enable(1);
           const long goal = some_way(b, 0, 3000);
           b.target(0, goal, 500);
           equal("target", target_of(b, 0), goal);
           b.stay_alive(100);
           equal("target during the ramp", target_of(b, 0), goal);
         });
  to.add(
      "state-angles", "`state` reports the angles of all joints.", "MOVE-8",
      [](Board& b) {
        for (int j = 0; j < KZ_JOINTS; ++j) b.bench().place_joint(j, 0.02 * j - 0.1);
        b.wait(20);
        const Reply state = b.state();
        for (int j = 0; j < KZ_JOINTS; ++j) {
          near("angle of joint " + std::to_string(j), state.number("angle", j), 200 * j - 1000, 40);
        }
        within("supply, mV", state["supply_mv"], 9900, 10100);
      },
      kBench);
  to.add(
      "joints-same-as-state", "`joints` reports the same angles as `state`.", "MOVE-8",
      [](Board& b) {
        const Reply state = b.state();
        for (int first = 0; first < KZ_JOINTS; first += 9) {
          const Reply joints = b.joints(0x1FFu << first);
          for (int j = first; j < first + 9; ++j) {
            near("angle of joint " + std::to_string(j), joints.number("angle", j),
                 state.number("angle", j), kStill);
            equal("duty of joint " + std::to_string(j), joints.number("duty", j), 0);
          }
        }
      },
      kNothing);
  to.add("joints-speed", "`joints` reports speed and duty of a moving joint.", "MOVE-8",
         [](Board& b) {
           b.enable(1);
           const long goal = some_way(b, 0, 5000);
           const int sign = goal > b.angle(0) ? 1 : -1;
           b.target(0, goal, 1000);  // 0.5 rad/s
           b.stay_alive(300);
           // The mean of many: at this speed a gear with friction goes by fits and starts.
           constexpr int kLooks = 20;
           long speed = 0, duty = 0;
           Reply joints = b.joints(1);
           for (int look = 0; look < kLooks; ++look) {
             b.wait(10);
             joints = b.joints(1);
             speed += sign * joints.number("speed", 0);
             duty += sign * joints.number("duty", 0);
           }
           within("speed, mrad/s", speed / kLooks, 200, 900);
           within("duty", duty / kLooks, 1, 255);
           within("load", joints.number("load", 0), 0, 255);
         });
  to.add(
      "joints-too-many", "`joints` is refused with RANGE for more than 9 joints.", "MOVE-8",
      [](Board& b) {
        b.joints(0x2AAAAu & KZ_ALL_JOINTS);  // 9 of them
        b.refused("joints", Put().u32(0x3FF), KZ_REFUSED_RANGE, 0);
        b.refused("joints", Put().u32(KZ_ALL_JOINTS), KZ_REFUSED_RANGE, 0);
        b.joints(0);
      },
      kNothing);
  for (int j = 0; j < KZ_JOINTS; ++j) {
    to.add(
        ("off-no-power-" + std::to_string(j)).c_str(),
        "The motor of joint " + std::to_string(j) + " gets no power while only this joint is off.",
        "MOVE-9",
        [j](Board& b) {
          b.enable(KZ_ALL_JOINTS & ~(1u << j));
          b.bench().place_joint(j, b.bench().angle_rad(j) + 0.05);
          for (int n = 0; n < 5; ++n) {
            b.stay_alive(10);
            check(b.bench().drive(j) == 0, "the motor has power");
          }
          equal("ON", b.done("joints", Put().u32(1L << j)).number("faults", j) & KZ_JOINT_ON, 0);
        },
        kMotion | kBench);
  }
}

}  // namespace

void add_motion_cases(Cases& all) {
  Chapter to(all, "motion", kMotion);
  add_enable(to);
  add_ramps(to);
  add_reading(to);
}

}  // namespace kaz::hil
