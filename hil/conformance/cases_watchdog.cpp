// Cases of docs/reference/protocol.md, chapter Safety: the link watchdog and its two reactions.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

// 100 urad. Between two readings of a healthy joint at its gains after a reset: it hunts across its gear's
// play by 9.7 to 15.7 mrad (docs/howto/bench.md), and a reading has noise. Whoever goes on with a ramp, or
// lets go, is off by far more.
constexpr long kHunting = 200;

// Silence until after the watchdog's limit; it must have come in the right millisecond.
void lose_link(Board& b, int limit_ms) {
  const long last = b.done("heartbeat", Put().u8(0).u8(0))["tick"];
  b.wait(limit_ms + 30);
  const Reply health = b.health();
  equal("reason", health.reason(), KZ_SHUTDOWN_LINK_LOST);
  within("time from the last request to the reaction, ms", health["shutdown_tick"] - last,
         limit_ms - 1, limit_ms + 2);
}

// Talks for 300 ms in a way that must not feed the watchdog of 90 ms.
void starves(Board& b, const std::function<Bytes()>& talk) {
  b.enable(1);
  for (int n = 0; n < 10; ++n) {
    b.write(talk());
    b.wait(30);
    b.forget_frames();
  }
  equal("reason", b.health().reason(), KZ_SHUTDOWN_LINK_LOST);
  b.expect_off();
}

void feeds(Board& b, const std::function<Bytes()>& talk) {
  b.enable(1);
  for (int n = 0; n < 10; ++n) {
    b.write(talk());
    b.wait(30);
    b.forget_frames();
  }
  const Reply state = b.state();
  equal("reason", state.reason(), KZ_SHUTDOWN_NONE);
  check(state.flag(KZ_STATUS_ENABLED), "the motors were switched off");
}

void add_limits(Chapter& to) {
  to.add(
      "default",
      "If no request arrives within the default limit, the link watchdog switches the motors off.",
      "SAFE-5", [](Board& b) {
        const int limit = static_cast<int>(b.done("identify")["watchdog_10ms"]) * 10;
        within("limit, ms", limit, 10, 99);  // within 100 ms of the last good frame
        b.enable(1);
        lose_link(b, limit);
        b.expect_off();
      });
  for (const int limit : {2, 10, 50, 100}) {
    to.add(
        "limit-" + std::to_string(limit * 10),
        "If `heartbeat` sets the link watchdog's limit to " + std::to_string(limit * 10) +
            " ms, the watchdog uses this limit.",
        "SAFE-5",
        [limit](Board& b) {
          b.watchdog(limit);
          b.enable(1);
          lose_link(b, limit * 10);
        },
        limit < 10 ? kMotion | kExact : kMotion);
  }
  to.add(
      "not-before", "If the pause between requests is shorter than the limit, the motors stay on.",
      "SAFE-5",
      [](Board& b) {
        b.enable(1);
        for (int n = 0; n < 5; ++n) {
          b.done("heartbeat", Put().u8(0).u8(0));
          b.wait(80);
          check(b.state().flag(KZ_STATUS_ENABLED), "the motors were switched off too early");
        }
      },
      kMotion | kExact);
  to.add(
      "pins-in-time", "The motors have no power 100 ms after the last valid request.", "SAFE-5",
      [](Board& b) {
        b.bench().block_joint(0, true);
        b.enable(1);
        b.bench().place_joint(0, 0.2);
        b.stay_alive(60);
        check(b.bench().drive(0) != 0, "the motor is not driven before the silence");
        b.done("heartbeat", Put().u8(0).u8(0));
        b.wait(97);
        check(b.bench().drive(0) == 0, "the motor still has power");
      },
      kMotion | kBench);
  to.add(
      "off-nothing", "While all motors are off, silence causes no shutdown.", "SAFE-5",
      [](Board& b) {
        b.wait(400);
        equal("reason", b.state().reason(), KZ_SHUTDOWN_NONE);
      },
      kNothing);
  to.add("any-request-feeds", "Any valid request resets the link watchdog, even a refused one.",
         "SAFE-5", [](Board& b) {
           int n = 0;
           feeds(b, [&] {
             return ++n % 2 ? b.request_bytes("state")
                            : frame_of(b.address, 0x7F, b.new_sequence(), {});
           });
         });
  to.add("all-boards-feeds", "A request to all boards resets the link watchdog.", "SAFE-5",
         [](Board& b) {
           feeds(b, [&] {
             return frame_of(KZ_ADDRESS_ALL, KZ_TYPE_heartbeat, b.new_sequence(),
                             Put().u8(0).u8(0));
           });
         });
  to.add("repetition-feeds", "A repetition resets the link watchdog.", "SAFE-5", [](Board& b) {
    const Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
    feeds(b, [&] { return wire; });
  });
  to.add("others-starve", "Requests to other boards do not reset the link watchdog.", "SAFE-8",
         [](Board& b) {
           const std::uint8_t other = b.other_than_home(2);
           starves(b, [&] { return frame_of(other, KZ_TYPE_identify, b.new_sequence(), {}); });
         });
  to.add("damaged-starve", "Damaged frames do not reset the link watchdog.", "SAFE-8",
         [](Board& b) {
           starves(b, [&] {
             Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
             wire[wire.size() - 2] ^= 1;
             return wire;
           });
         });
  to.add("replies-starve", "Replies do not reset the link watchdog.", "SAFE-8", [](Board& b) {
    starves(b, [&] { return frame_of(b.address, 0x81, b.new_sequence(), {}); });
  });
  to.add("noise-starves", "Noise and zeros do not reset the link watchdog.", "SAFE-8",
         [](Board& b) { starves(b, [&] { return Bytes{0, 0, 0x55, 0xAA, 0, 0}; }); });
}

void add_reactions(Chapter& to) {
  to.add("limp", "LIMP: all motors are switched off, and stay off until `clear` and `enable`.",
         "SAFE-6", [](Board& b) {
           b.enable(0x3);
           b.wait(150);
           const Reply state = b.state();
           equal("reason", state.reason(), KZ_SHUTDOWN_LINK_LOST);
           check(!state.flag(KZ_STATUS_HOLDING), "HOLDING is set");
           b.expect_off();
           b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_LINK_LOST);
           b.done("clear");
           b.expect_off();
           b.enable(0x3);
         });
  to.add("limp-after-reset", "A reset restores the reaction LIMP.", "SAFE-6", [](Board& b) {
    b.watchdog(0, KZ_REACTION_HOLD);
    b.reset_by_command();
    b.enable(1);
    b.wait(150);
    b.expect_off();
  });
  to.add("hold", "HOLD: the motors stay on, HOLDING is set, and the shutdown reason is LINK_LOST.",
         "SAFE-7", [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(0x3);
           b.wait(150);
           const Reply state = b.state();
           equal("reason", state.reason(), KZ_SHUTDOWN_LINK_LOST);
           check(state.flag(KZ_STATUS_HOLDING), "HOLDING is not set");
           check(state.flag(KZ_STATUS_ENABLED), "the motors are off");
           for (int j = 0; j < 2; ++j) {
             equal("ON", b.joints(3).number("faults", j) & KZ_JOINT_ON, KZ_JOINT_ON);
           }
         });
  to.add("hold-ends-ramps", "HOLD: each ramp stops at its current command.", "SAFE-7",
         [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(1);
           const long from = b.angle(0), goal = from > 0 ? from - 8000 : from + 8000;
           b.target(0, goal, 1000);
           b.wait(200);
           check(!b.state().flag(KZ_STATUS_MOVING), "MOVING is set");
           const long at = b.angle(0);
           within("distance moved before the reaction", goal > from ? at - from : from - at, 200,
                  1400);
           for (int n = 0; n < 5; ++n) {
             b.wait(60);
             within("angle while holding", b.angle(0), at - kHunting, at + kHunting);
           }
         });
  to.add(
      "hold-drives", "HOLD: the motor drives against a hand that turns the joint.", "SAFE-7",
      [](Board& b) {
        b.watchdog(0, KZ_REACTION_HOLD);
        b.enable(1);
        b.wait(200);
        b.bench().block_joint(0, true);
        b.bench().place_joint(0, 0.1);
        b.wait(20);
        check(b.bench().drive(0) < -0.1, "the motor does not drive against the hand");
      },
      kMotion | kBench);
  to.add("hold-refuses", "HOLD: `targets` and `enable` are refused with FAULT.", "SAFE-7",
         [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(1);
           b.wait(150);
           b.refused("targets", Put().u32(1).u16(100).s16(0), KZ_REFUSED_FAULT,
                     KZ_SHUTDOWN_LINK_LOST);
           b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_LINK_LOST);
           check(b.state().flag(KZ_STATUS_HOLDING), "HOLDING is no longer set");
         });
  to.add("hold-nothing-off", "HOLD: `enable` with an empty mask switches the joints off.", "SAFE-7",
         [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(1);
           b.wait(150);
           b.done("enable", Put().u32(0));
           b.expect_off();
         });
  to.add("hold-clear",
         "HOLD: `clear` switches the motors off. After `clear`, `enable` sets a joint's target to "
         "the joint's present angle.",
         "SAFE-7", [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(1);
           b.wait(150);
           const Reply cleared = b.done("clear");
           check(!cleared.flag(KZ_STATUS_ENABLED) && !cleared.flag(KZ_STATUS_HOLDING),
                 "the motors are on after `clear`");
           b.expect_off();
           const long at = b.angle(0);
           b.enable(1);
           b.stay_alive(100);
           within("angle", b.angle(0), at - kHunting, at + kHunting);
         });
  to.add("hold-stop", "HOLD: `stop` switches the motors off, and the reason remains LINK_LOST.",
         "SAFE-3", [](Board& b) {
           b.watchdog(0, KZ_REACTION_HOLD);
           b.enable(1);
           b.wait(150);
           b.done("stop");
           b.expect_off();
           equal("reason", b.state().reason(), KZ_SHUTDOWN_LINK_LOST);
         });
}

}  // namespace

void add_watchdog_cases(Cases& all) {
  Chapter to(all, "watchdog", kMotion);
  add_limits(to);
  add_reactions(to);
}

}  // namespace kaz::hil
