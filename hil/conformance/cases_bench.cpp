// Cases of docs/reference/protocol.md, chapter Bench.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "hil/conformance/suite.h"
#include "shared/servo/snapshot.h"

namespace kaz::hil {
namespace {

Bytes key(int seconds) {
  return Put().u16(KZ_KEY).u8(seconds);
}

Bytes drive(int joint, int duty, int ms) {
  return Put().u8(joint).s16(duty).u16(ms);
}

void unlock(Board& b, int seconds = 20) {
  check(b.done("unlock", key(seconds)).flag(KZ_STATUS_UNLOCKED), "UNLOCKED is not set");
}

bool driven(Board& b) {
  return b.state().flag(KZ_STATUS_RAW_DRIVE);
}

void drive_is(Board& b, int joint, double wanted) {
  const double got = b.bench().drive(joint);
  check(std::abs(got - wanted) < 0.01, "drive of joint " + std::to_string(joint) + ": expected " +
                                           std::to_string(wanted) + ", got " + std::to_string(got));
}

void add_lock(Chapter& to) {
  to.add(
      "unlock", "`unlock` sets UNLOCKED, and `unlock` with 0 seconds clears UNLOCKED.", "BENCH-1",
      [](Board& b) {
        unlock(b);
        check(b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is not set");
        check(!b.done("unlock", key(0)).flag(KZ_STATUS_UNLOCKED), "UNLOCKED is set");
        b.refused("raw_drive", drive(0, 0, 10), KZ_REFUSED_LOCKED);
      },
      kNothing);
  to.add(
      "unlock-time",
      "`unlock` with 1 second unlocks the board for 1 s. Then the board locks again.", "BENCH-1",
      [](Board& b) {
        unlock(b, 1);
        b.wait(900);
        check(b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is not set after 0.9 s");
        b.wait(150);
        check(!b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is set after 1.05 s");
      },
      kNothing);
  to.add(
      "unlock-again",
      "If `unlock` arrives while the board is unlocked, the new time replaces the remaining time.",
      "BENCH-1",
      [](Board& b) {
        unlock(b, 1);
        b.wait(600);
        unlock(b, 1);
        b.wait(600);
        check(b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is not set");
      },
      kNothing);
  to.add("unlock-armed", "`unlock` is refused with ARMED while a motor is on.", "BENCH-1",
         [](Board& b) {
           b.enable(1);
           b.refused("unlock", key(5), KZ_REFUSED_ARMED);
         });
  to.add(
      "unlock-key", "A wrong key is refused with RANGE.", "BENCH-1",
      [](Board& b) {
        for (const int wrong : {0, 0x5A4B, 0xFFFF, KZ_KEY ^ 1}) {
          b.refused("unlock", Put().u16(wrong).u8(5), KZ_REFUSED_RANGE, 0);
        }
        check(!b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is set");
      },
      kNothing);
  to.add(
      "unlock-reset", "A reset locks the board.", "BENCH-1",
      [](Board& b) {
        unlock(b, 60);
        b.reset_by_command();
        check(!b.state().flag(KZ_STATUS_UNLOCKED), "UNLOCKED is set");
      },
      kNothing);
  to.add(
      "locked", "Without `unlock`, `raw_drive` and `set_address` are refused with LOCKED.",
      "BENCH-2",
      [](Board& b) {
        b.refused("raw_drive", drive(0, 50, 100), KZ_REFUSED_LOCKED);
        b.refused("set_address", Put().u8(1).u8(0), KZ_REFUSED_LOCKED);
        b.expect_off();
      },
      kNothing);
}

void add_raw(Chapter& to) {
  to.add(
      "raw", "`raw_drive` sets the flag RAW_DRIVE for the requested time. Then the motor is off.",
      "BENCH-3",
      [](Board& b) {
        unlock(b);
        check(b.done("raw_drive", drive(0, 40, 100)).flag(KZ_STATUS_RAW_DRIVE),
              "RAW_DRIVE is not set");
        b.wait(60);
        check(driven(b), "RAW_DRIVE is not set after 60 ms");
        b.wait(50);
        check(!driven(b), "RAW_DRIVE is set after 110 ms");
        b.expect_off();
      },
      kMotion | kExact);
  for (const int joint : {0, 5, 6, 9, 12, 17}) {
    for (const int duty : {60, -60}) {
      to.add(
          "raw-pins-" + std::to_string(joint) + (duty > 0 ? "-forth" : "-back"),
          "`raw_drive` drives only motor " + std::to_string(joint) +
              ", with the requested duty and direction.",
          "BENCH-3",
          [joint, duty](Board& b) {
            unlock(b);
            b.done("raw_drive", drive(joint, duty, 50));
            b.wait(10);
            for (int j = 0; j < KZ_JOINTS; ++j) drive_is(b, j, j == joint ? duty / 255.0 : 0);
            b.wait(60);
            b.expect_off();
          },
          kMotion | kBench);
    }
  }
  to.add(
      "raw-full", "At full duty, the PWM pin of the driven motor is constantly high.", "BENCH-3",
      [](Board& b) {
        unlock(b);
        b.bench().block_joint(0, true);
        b.done("raw_drive", drive(0, 255, 20));
        b.wait(5);
        drive_is(b, 0, 1);
      },
      kMotion | kBench);
  to.add("raw-armed", "`raw_drive` is refused with ARMED while a joint is enabled.", "BENCH-3",
         [](Board& b) {
           unlock(b);
           b.enable(2);
           b.refused("raw_drive", drive(0, 50, 100), KZ_REFUSED_ARMED);
         });
  to.add("raw-latched", "`raw_drive` is refused with FAULT while a shutdown is latched.", "BENCH-3",
         [](Board& b) {
           unlock(b);
           b.done("stop");
           b.refused("raw_drive", drive(0, 50, 100), KZ_REFUSED_FAULT, KZ_SHUTDOWN_STOP);
           b.expect_off();
         });
  to.add(
      "raw-replaced", "Another `raw_drive` replaces the current raw drive.", "BENCH-4",
      [](Board& b) {
        unlock(b);
        b.done("raw_drive", drive(0, 40, 500));
        b.wait(10);
        b.done("raw_drive", drive(1, -50, 500));
        b.wait(5);
        drive_is(b, 0, 0);
        drive_is(b, 1, -50 / 255.0);
      },
      kMotion | kBench);
  to.add("raw-zero", "Duty 0 ends a raw drive.", "BENCH-4", [](Board& b) {
    unlock(b);
    b.done("raw_drive", drive(0, 40, 1000));
    b.done("raw_drive", drive(0, 0, 1000));
    b.wait(5);
    check(!driven(b), "RAW_DRIVE is set");
    b.expect_off();
  });
  to.add(
      "raw-zero-faulty", "Duty 0 ends a raw drive even if the potentiometer is faulty.", "BENCH-4",
      [](Board& b) {
        unlock(b);
        b.done("raw_drive", drive(0, 40, 1000));
        b.bench().set_analog(0, 0);
        b.wait(5);
        check(!b.done("raw_drive", drive(0, 0, 1000)).flag(KZ_STATUS_RAW_DRIVE),
              "RAW_DRIVE is set");
      },
      kMotion | kBench);
  to.add("raw-enable", "`enable` ends a raw drive.", "BENCH-4", [](Board& b) {
    unlock(b);
    b.done("raw_drive", drive(0, 40, 1000));
    b.done("enable", Put().u32(0));
    b.wait(5);
    check(!driven(b), "RAW_DRIVE is set");
    b.expect_off();
  });
  to.add("raw-stop", "`stop` ends a raw drive.", "BENCH-4", [](Board& b) {
    unlock(b);
    b.done("raw_drive", drive(0, 40, 1000));
    b.done("stop");
    b.wait(5);
    check(!driven(b), "RAW_DRIVE is set");
    b.expect_off();
    equal("reason", b.state().reason(), KZ_SHUTDOWN_STOP);
  });
  to.add("raw-lock", "When the board locks again, a raw drive ends.", "BENCH-4", [](Board& b) {
    unlock(b, 1);
    b.wait(500);
    b.done("raw_drive", drive(0, 20, 2000));
    b.stay_alive(400);
    check(driven(b), "RAW_DRIVE is not set");
    b.stay_alive(200);
    check(!driven(b), "RAW_DRIVE is set");
    b.expect_off();
  });
}

void add_safe(Chapter& to) {
  for (const int sign : {1, -1}) {
    to.add(
        std::string("raw-limit-") + (sign > 0 ? "upper" : "lower"),
        sign > 0 ? "`raw_drive` does not drive a joint beyond its upper soft limit."
                 : "`raw_drive` does not drive a joint beyond its lower soft limit.",
        "BENCH-5",
        [sign](Board& b) {
          b.done("limits", Put().u32(1).u16(60).s16(-3000).s16(3000));
          unlock(b);
          b.bench().place_joint(0, sign * 0.31);
          b.wait(80);  // to the board that was a fast motion, which it would brake
          b.done("raw_drive", drive(0, sign * 100, 200));
          for (int n = 0; n < 20; ++n) {
            b.wait(3);
            check(sign * b.bench().drive(0) <= 0,
                  "the motor drives the joint farther beyond its limit");
          }
          b.done("raw_drive", drive(0, -sign * 60, 200));
          b.wait(5);
          drive_is(b, 0, -sign * 60 / 255.0);  // inward it is
        },
        kMotion | kBench);
    to.add(
        std::string("raw-overshoot-") + (sign > 0 ? "upper" : "lower"),
        sign > 0
            ? "A `raw_drive` at full duty moves a joint at most 0.03 rad past its upper soft limit."
            : "A `raw_drive` at full duty moves a joint at most 0.03 rad past its lower soft "
              "limit.",
        "BENCH-5",
        [sign](Board& b) {
          b.done("limits", Put().u32(1).u16(60).s16(-3000).s16(3000));
          unlock(b);
          b.bench().place_joint(0, -sign * 0.25);
          b.wait(10);
          b.done("raw_drive", drive(0, sign * 255, 500));
          for (int ms = 0; ms < 500; ++ms) {
            if (ms % 30 == 0) b.write(b.request_bytes("heartbeat", Put().u8(0).u8(0)));
            b.wait(1);
            check(sign * b.bench().angle_rad(0) <= 0.33,
                  "the shaft is at " + std::to_string(b.bench().angle_rad(0)) + " rad");
          }
        },
        kMotion | kBench);
  }
  to.add("raw-link",
         "The link watchdog ends a raw drive, even if the reaction of this watchdog is HOLD.",
         "BENCH-5", [](Board& b) {
           for (const int reaction : {KZ_REACTION_LIMP, KZ_REACTION_HOLD}) {
             b.watchdog(0, reaction);
             unlock(b);
             b.done("raw_drive", drive(0, 20, 2000));
             b.wait(130);
             const Reply state = b.state();
             check(!state.flag(KZ_STATUS_RAW_DRIVE), "RAW_DRIVE is set");
             equal("reason", state.reason(), KZ_SHUTDOWN_LINK_LOST);
             b.expect_off();
             b.done("clear");
           }
         });
  to.add(
      "raw-supply", "A low supply ends a raw drive.", "BENCH-5",
      [](Board& b) {
        unlock(b);
        b.done("raw_drive", drive(0, 20, 2000));
        b.bench().set_analog(KZ_ANALOG_SUPPLY, 100);
        b.stay_alive(60);
        b.expect_off();
        equal("reason", b.state().reason(), KZ_SHUTDOWN_UNDERVOLTAGE);
      },
      kMotion | kBench);
  to.add(
      "raw-pot", "A disconnected potentiometer ends a raw drive.", "BENCH-5",
      [](Board& b) {
        unlock(b);
        b.done("raw_drive", drive(0, 20, 2000));
        b.bench().set_analog(0, 0);
        b.wait(5);
        drive_is(b, 0, 0);
        b.stay_alive(60);
        b.expect_off();
      },
      kMotion | kBench);
}

void add_restarts(Chapter& to) {
  to.add(
      "reset", "The board replies to `reset` and then restarts with reset cause COMMAND.",
      "BENCH-6",
      [](Board& b) {
        b.wait(100);
        const long before = b.state()["tick"];
        b.reset_by_command();
        const Reply who = b.done("identify");
        check(who["tick"] < before + 100, "the reset did not restart the tick counter");
        equal("cause", who["reset_cause"], KZ_RESET_COMMAND);
      },
      kNothing);
  to.add("reset-armed", "`reset` and `loader` are refused with ARMED while a motor is on.",
         "BENCH-6", [](Board& b) {
           b.enable(1);
           b.refused("reset", Put().u16(KZ_KEY), KZ_REFUSED_ARMED);
           b.refused("loader", Put().u16(KZ_KEY), KZ_REFUSED_ARMED);
           check(b.state().flag(KZ_STATUS_ENABLED), "the motor was switched off");
         });
  to.add(
      "reset-unlatches", "A reset clears a latched shutdown.", "BENCH-6",
      [](Board& b) {
        b.done("stop");
        b.reset_by_command();
        equal("reason", b.state().reason(), KZ_SHUTDOWN_NONE);
      },
      kNothing);
  to.add(
      "loader",
      "`loader` stops the application and starts the loader. The loader runs for 3 s, and then "
      "restarts the application with reset cause COMMAND.",
      "BENCH-7",
      [](Board& b) {
        b.done("loader", Put().u16(KZ_KEY));
        b.wait(300);
        check(!b.answers(), "the application still replies");
        b.wait(3200);
        check(b.answers(), "3.5 s after `loader`, the application does not reply");
        const Reply who = b.done("identify");
        equal("cause", who["reset_cause"], KZ_RESET_COMMAND);
        b.expect_off();
      },
      kNothing);
  to.add("loader-armed", "`loader` is refused with ARMED while a motor is on.", "BENCH-7",
         [](Board& b) {
           b.enable(1);
           b.refused("loader", Put().u16(KZ_KEY), KZ_REFUSED_ARMED);
         });
}

}  // namespace

void add_bench_cases(Cases& all) {
  Chapter to(all, "bench", kMotion);
  add_lock(to);
  add_raw(to);
  add_safe(to);
  add_restarts(to);
}

}  // namespace kaz::hil
