// Cases of docs/reference/protocol.md, chapter Safety, but the link watchdog.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"
#include "shared/servo/servo.h"

namespace kaz::hil {
namespace {

// Time from a disturbance until all motors are off, ms; fails if they are on after `at_most`.
long ms_until_off(Board& b, int at_most) {
  for (int ms = 0; ms <= at_most; ++ms) {
    if (!b.state().flag(KZ_STATUS_ENABLED)) {
      b.expect_off();
      return ms;
    }
    b.wait(1);
  }
  throw Failed{"the motors are still on after " + std::to_string(at_most) + " ms"};
}

void expect_latched(Board& b, int reason, int detail) {
  const Reply health = b.health();
  equal("shutdown reason", health.reason(), reason);
  equal("shutdown detail", health["detail"], detail);
  check(health["shutdown_tick"] != 0 && health["shutdown_tick"] <= health["tick"],
        "the shutdown tick is 0 or in the future");
}

// The input goes to a code at which the board must shut down, then back.
void shut_down_by(Board& b, int input, int code, int reason, int detail, int limit_ms) {
  b.enable(0x3);
  const long before = b.state()["tick"];
  b.bench().set_analog(input, code);
  b.wait(limit_ms / 2);
  check(b.state().flag(KZ_STATUS_ENABLED), "the motors were switched off too early");
  ms_until_off(b, 60);
  expect_latched(b, reason, detail);
  within("time until the shutdown, ms", b.health()["shutdown_tick"] - before, limit_ms - 2,
         limit_ms + 15);
  b.refused("clear", {}, KZ_REFUSED_FAULT, reason);
  b.bench().set_analog(input, {});
  b.wait(30);
  b.done("clear");
  b.expect_off();
  b.enable(0x3);
}

// The input goes to a code that must not matter.
void no_shut_down(Board& b, int input, int code, int ms) {
  b.enable(0x3);
  b.bench().set_analog(input, code);
  b.stay_alive(ms);
  b.bench().set_analog(input, {});
  b.stay_alive(50);
  const Reply state = b.state();
  equal("shutdown reason", state.reason(), KZ_SHUTDOWN_NONE);
  check(state.flag(KZ_STATUS_ENABLED), "the motors were switched off");
}

void add_latch(Chapter& to) {
  to.add(
      "latched-refuses", "While STOP is latched, no joint can be switched on or moved.", "SAFE-1",
      [](Board& b) {
        b.enable(0x3);
        b.done("stop");
        b.expect_off();
        b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_STOP);
        const Frame frame = b.raw_request(KZ_TYPE_targets, Put().u32(1).u16(100).s16(0));
        equal("type of the reply to `targets`", frame.type, KZ_TYPE_refused);
        b.stay_alive(200);
        b.expect_off();
        equal("reason", b.state().reason(), KZ_SHUTDOWN_STOP);
      },
      kMotion);
  to.add(
      "clear", "`clear` resets the latch, and motors stay off.", "SAFE-2",
      [](Board& b) {
        b.enable(0x3);
        b.done("stop");
        equal("reason in the reply", b.done("clear").reason(), KZ_SHUTDOWN_NONE);
        b.stay_alive(60);
        b.expect_off();
        const Reply health = b.health();
        equal("shutdown tick", health["shutdown_tick"], 0);
        equal("detail", health["detail"], kNoDetail);
        b.enable(1);
      },
      kMotion);
  to.add(
      "clear-nothing", "`clear` is accepted even if no shutdown is latched.", "SAFE-2",
      [](Board& b) { b.done("clear"); }, kNothing);
  to.add("first-reason-kept", "A second shutdown reason does not replace the first reason.",
         "SAFE-3", [](Board& b) {
           b.enable(0x3);
           b.bench().set_analog(1, 0);  // joint 1
           ms_until_off(b, 60);
           const long tick = b.health()["shutdown_tick"];
           b.done("stop");
           b.bench().set_analog(KZ_ANALOG_SUPPLY, 100);
           b.wait(60);
           expect_latched(b, KZ_SHUTDOWN_POT, 1);
           equal("shutdown tick", b.health()["shutdown_tick"], tick);
         });
  to.add("stop-first", "After `stop`, a sensor fault does not change the reason.", "SAFE-3",
         [](Board& b) {
           b.enable(0x3);
           b.done("stop");
           b.bench().set_analog(0, 0);
           b.wait(60);
           expect_latched(b, KZ_SHUTDOWN_STOP, kNoDetail);
         });
}

void add_stop(Chapter& to) {
  to.add(
      "stop", "`stop` switches all motors off and is latched.", "SAFE-4",
      [](Board& b) {
        b.enable(KZ_ALL_JOINTS);
        const Reply stopped = b.done("stop");
        equal("reason", stopped.reason(), KZ_SHUTDOWN_STOP);
        check(!stopped.flag(KZ_STATUS_ENABLED), "the reply reports that a motor is on");
        b.expect_off();
        expect_latched(b, KZ_SHUTDOWN_STOP, kNoDetail);
      },
      kMotion);
  to.add("stop-at-once", "The motors have no power 3 ms after `stop`.", "SAFE-4", [](Board& b) {
    b.bench().block_joint(0, true);
    b.enable(1);
    b.bench().place_joint(0, 0.2);
    b.stay_alive(40);
    check(b.bench().drive(0) != 0, "the motor is not driven before `stop`");
    b.write(b.request_bytes("stop"));  // 9 bytes: 0.8 ms
    b.wait(4);
    check(b.bench().drive(0) == 0, "the motor still has power");
  });
  to.add(
      "stop-all-boards", "`stop` to all boards switches all motors off.", "SAFE-4",
      [](Board& b) {
        b.enable(0x3);
        b.write(frame_of(KZ_ADDRESS_ALL, KZ_TYPE_stop, b.new_sequence(), {}));
        b.silence(15);
        b.expect_off();
        expect_latched(b, KZ_SHUTDOWN_STOP, kNoDetail);
      },
      kMotion);
  to.add(
      "stop-off", "`stop` is latched even while all motors are off.", "SAFE-4",
      [](Board& b) {
        b.done("stop");
        expect_latched(b, KZ_SHUTDOWN_STOP, kNoDetail);
      },
      kNothing);
}

void add_sensors(Chapter& to) {
  for (const int code : {0, KZ_POT_LOWEST - 1, KZ_POT_HIGHEST + 1, 1023}) {
    to.add("pot-" + std::to_string(code),
           "A potentiometer with A/D code " + std::to_string(code) + " causes the shutdown POT.",
           "SAFE-9",
           [code](Board& b) { shut_down_by(b, 1, code, KZ_SHUTDOWN_POT, 1, KZ_POT_FAULT_MS); });
  }
  for (const int code : {KZ_POT_LOWEST, KZ_POT_HIGHEST}) {
    to.add("pot-valid-" + std::to_string(code),
           "A potentiometer with A/D code " + std::to_string(code) + " is valid.", "SAFE-9",
           [code](Board& b) {
             b.enable(0x1);
             b.bench().set_analog(1, code);  // of a joint whose angle moves nothing
             b.stay_alive(40);
             b.enable(0x3);
             b.stay_alive(60);
             check(b.state().reason() != KZ_SHUTDOWN_POT, "POT is latched");
           });
  }
  to.add("pot-short", "A potentiometer disconnected for 10 ms causes no shutdown.", "SAFE-9",
         [](Board& b) { no_shut_down(b, 0, 0, 10); });
  to.add("pot-no-power",
         "If a joint's potentiometer is disconnected, the joint's motor loses power immediately.",
         "SAFE-9", [](Board& b) {
           b.bench().block_joint(0, true);
           b.enable(1);
           b.bench().place_joint(0, 0.2);
           b.stay_alive(40);
           check(b.bench().drive(0) != 0, "the motor is not driven before the fault");
           b.bench().set_analog(0, 0);
           b.wait(4);
           check(b.bench().drive(0) == 0,
                 "the motor has power although the potentiometer is disconnected");
         });
  to.add("pot-of-off-joint", "A faulty potentiometer causes no shutdown while its joint is off.",
         "SAFE-9", [](Board& b) {
           b.enable(0x2);
           b.bench().set_analog(0, 0);
           b.stay_alive(100);
           equal("reason", b.state().reason(), KZ_SHUTDOWN_NONE);
           equal("POT flag", b.joints(1).number("faults", 0) & KZ_JOINT_POT, KZ_JOINT_POT);
         });
  to.add("supply-low", "A low supply causes the shutdown UNDERVOLTAGE.", "SAFE-10", [](Board& b) {
    shut_down_by(b, KZ_ANALOG_SUPPLY, 260, KZ_SHUTDOWN_UNDERVOLTAGE, kNoDetail,  // 3.9 V
                 KZ_SUPPLY_FAULT_MS);
  });
  to.add("supply-high", "A high supply causes the shutdown OVERVOLTAGE.", "SAFE-10", [](Board& b) {
    shut_down_by(b, KZ_ANALOG_SUPPLY, 870, KZ_SHUTDOWN_OVERVOLTAGE, kNoDetail,  // 13.05 V
                 KZ_SUPPLY_FAULT_MS);
  });
  to.add("supply-short", "A supply that sags for 10 ms causes no shutdown.", "SAFE-10",
         [](Board& b) { no_shut_down(b, KZ_ANALOG_SUPPLY, 100, 10); });
  for (const int code : {268, 866}) {  // 4.02 and 12.99 V
    to.add("supply-valid-" + std::to_string(code),
           "A supply just within its limits causes no shutdown.", "SAFE-10",
           [code](Board& b) { no_shut_down(b, KZ_ANALOG_SUPPLY, code, 200); });
  }
  to.add("supply-off-joints", "While all motors are off, a low supply causes no shutdown.",
         "SAFE-10", [](Board& b) {
           b.bench().set_analog(KZ_ANALOG_SUPPLY, 100);
           b.wait(100);
           equal("reason", b.state().reason(), KZ_SHUTDOWN_NONE);
           const Reply health = b.health();
           within("supply, mV", health["supply_mv"], 1485, 1515);
           within("lowest supply, mV", health["supply_lowest_mv"], 1485, 1515);
           b.bench().set_analog(KZ_ANALOG_SUPPLY, {});
           b.wait(30);
           const Reply after = b.health();
           within("supply, mV", after["supply_mv"], 9900, 10100);
           within("lowest supply, mV", after["supply_lowest_mv"], 1485, 1515);
         });
  to.add("temperature", "Hot motor drivers cause the shutdown TEMPERATURE.", "SAFE-11",
         [](Board& b) {
           b.enable(0x3);
           b.bench().set_analog(KZ_ANALOG_TEMPERATURE, 870);
           ms_until_off(b, 100);
           expect_latched(b, KZ_SHUTDOWN_TEMPERATURE, kNoDetail);
           b.refused("clear", {}, KZ_REFUSED_FAULT, KZ_SHUTDOWN_TEMPERATURE);
           b.bench().set_analog(KZ_ANALOG_TEMPERATURE, {});
           b.wait(60);
           b.done("clear");
         });
  to.add("temperature-valid",
         "A driver temperature of 84 degrees causes no shutdown, and `health` reports this "
         "temperature.",
         "SAFE-11", [](Board& b) {
           no_shut_down(b, KZ_ANALOG_TEMPERATURE, 840, 200);
           b.bench().set_analog(KZ_ANALOG_TEMPERATURE, 840);
           b.stay_alive(60);
           within("temperature, 0.1 degC", b.health()["temperature_dc"], 839, 841);
         });
  for (const int code : {KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE - 2,
                         KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE + 2}) {
    to.add("reference-" + std::to_string(code),
           "A reference voltage with A/D code " + std::to_string(code) +
               " causes the shutdown REFERENCE.",
           "SAFE-12", [code](Board& b) {
             shut_down_by(b, KZ_ANALOG_REFERENCE, code, KZ_SHUTDOWN_REFERENCE, kNoDetail,
                          KZ_REFERENCE_FAULT_MS);
           });
  }
  for (const int code :
       {KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE, KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE}) {
    to.add("reference-valid-" + std::to_string(code),
           "A reference voltage with A/D code " + std::to_string(code) + " is valid.", "SAFE-12",
           [code](Board& b) { no_shut_down(b, KZ_ANALOG_REFERENCE, code, 100); });
  }
}

void add_motors(Chapter& to) {
  to.add("stall", "A blocked motor at full drive causes the shutdown STALL.", "SAFE-13",
         [](Board& b) {
           b.enable(0x3);
           b.bench().block_joint(1, true);
           b.target(1, 5000, 0);
           const Time start = b.now();
           while (b.state().flag(KZ_STATUS_ENABLED)) {
             check(seconds(b.now() - start) < 5, "no shutdown came in 5 s at full drive");
             b.wait(20);
           }
           expect_latched(b, KZ_SHUTDOWN_STALL, 1);
           b.expect_off();
         });
  to.add("overload", "A blocked motor at 0.6 of full duty causes the shutdown STALL or OVERLOAD.",
         "SAFE-13", [](Board& b) {
           b.done("gains", Put().u32(2).u16(1536).u16(614).u16(0).u8(0));  // 6 /rad
           b.enable(0x3);
           b.bench().block_joint(1, true);
           b.target(1, 1000, 0);  // 0.6 of full duty
           const Time start = b.now();
           while (b.state().flag(KZ_STATUS_ENABLED)) {
             check(seconds(b.now() - start) < 60, "no shutdown came in 60 s under load");
             b.wait(40);
           }
           const Reply health = b.health();
           check(health.reason() == KZ_SHUTDOWN_OVERLOAD || health.reason() == KZ_SHUTDOWN_STALL,
                 "the reason is " + std::to_string(health.reason()));
           equal("detail", health["detail"], 1);
         });
  to.add(
      "moving-freely", "A motor that turns freely back and forth causes no shutdown.", "SAFE-13",
      [](Board& b) {
        b.enable(0x3);
        for (int n = 0; n < 10; ++n) {
          b.target(0, n % 2 ? 3000 : -3000, 300);
          b.stay_alive(350);
        }
        equal("reason", b.state().reason(), KZ_SHUTDOWN_NONE);
      },
      kMotion);
  to.add(
      "no-missed-tick", "If requests are sent without pause, no tick is missed.", "SAFE-14",
      [](Board& b) {
        b.enable(KZ_ALL_JOINTS);
        for (int n = 0; n < 50; ++n) {
          b.done("read_targets", Put().u32(KZ_ALL_JOINTS));
          b.joints(0x1FF);
        }
        check(!b.state().flag(KZ_STATUS_MISSED_TICK), "MISSED_TICK is set");
      },
      kMotion);
  to.add(
      "flash-is-no-missed-tick",
      "Ticks that are lost during a flash write do not count as missed "
      "ticks.",
      "SAFE-14",
      [](Board& b) {
        b.done("store_calibration", {}, 3000);
        const Reply counts = b.statistics();
        check(!counts.flag(KZ_STATUS_MISSED_TICK), "MISSED_TICK is set");
        equal("missed ticks", counts["missed_ticks"], 0);
        check(!counts.flag(KZ_STATUS_UNCALIBRATED),
              "UNCALIBRATED is set after the calibration was stored");
      },
      kFlash);
}

}  // namespace

void add_safety_cases(Cases& all) {
  Chapter to(all, "safety", kMotion | kBench);
  add_latch(to);
  add_stop(to);
  add_sensors(to);
  add_motors(to);
}

}  // namespace kaz::hil
