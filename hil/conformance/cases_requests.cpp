// Cases of docs/reference/protocol.md, chapter Requests, replies, repetitions.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

void append(Bytes& to, const Bytes& more) {
  for (const std::uint8_t byte : more) to.push_back(byte);
}

constexpr long kSettingRamp = 77;

// A request that is executed now, and whose same bytes come again later.
class Repeated {
 public:
  Repeated(Board& board, const char* name, const Bytes& fields = {})
      : board_(board),
        name_(name),
        sequence_(board.new_sequence()),
        wire_(board.request_bytes(name, fields, sequence_)) {
    again();
  }
  Reply again() const {
    board_.write(wire_);
    return board_.take(name_, sequence_);
  }

 private:
  Board& board_;
  std::string name_;
  std::uint8_t sequence_;
  Bytes wire_;
};

void add_answers(Chapter& to) {
  to.add(
      "tick-runs", "The tick in replies is the board's time in milliseconds.", "REQ-1",
      [](Board& b) {
        const Reply first = b.state();
        const Time from = first.frame().at;
        b.wait(200);
        const Reply second = b.state();
        const long passed =
            std::chrono::duration_cast<std::chrono::milliseconds>(second.frame().at - from).count();
        const long slack = 2 + b.slack().count() / 1'000'000;
        within("ticks in " + std::to_string(passed) + " ms", second["tick"] - first["tick"],
               passed - slack, passed + slack);
      });
  to.add("tick-from-reset", "The tick in replies counts from the board's reset.", "REQ-1",
         [](Board& b) {
           b.wait(300);
           const long before = b.state()["tick"];
           b.reset_by_command();
           within("tick after a reset", b.state()["tick"], 0,
                  200 + 3 * b.slack().count() / 1'000'000);
           check(before > 200, "the tick does not advance");
         });
  to.add("refusal-whole", "A refused request has no effect.", "REQ-2", [](Board& b) {
    const Reply before = b.done("settings", Put().u8(0));
    // The last field is wrong, all before it are right.
    b.refused("gains", Put().u32(1).u16(1000).u16(100).u16(10).u8(KZ_FRICTION_MAX + 1),
              KZ_REFUSED_RANGE, 4);
    b.refused("heartbeat", Put().u8(50).u8(3), KZ_REFUSED_RANGE, 1);
    const Reply after = b.done("settings", Put().u8(0));
    for (const char* name : {"kp", "kd", "dead_band", "friction"}) {
      equal(name, after[name], before[name]);
    }
    check(b.done("identify")["watchdog_10ms"] != 50, "a refused `heartbeat` was partly executed");
  });
  to.add("refusal-form", "A refusal has the sequence number and type of its request.", "REQ-2",
         [](Board& b) {
           // No new message gets one of these: requests are 0x01 to 0x3F (messages.def).
           for (const int type : {0x00, 0x40, 0x5A, 0x7F}) {
             b.refused_type(static_cast<std::uint8_t>(type), {}, KZ_REFUSED_UNKNOWN_TYPE,
                            kNoDetail);
           }
         });
  to.add("unknown-type", "Every unknown type is refused with UNKNOWN_TYPE.", "REQ-3", [](Board& b) {
    for (int type = 0; type < 0x80; ++type) {
      bool known = false;
      for (const Message& one : messages()) known |= one.code == type;
      if (!known) {
        b.refused_type(static_cast<std::uint8_t>(type), {}, KZ_REFUSED_UNKNOWN_TYPE, kNoDetail);
      }
    }
  });
  to.add("unknown-type-long", "An unknown type with fields is refused with UNKNOWN_TYPE.", "REQ-3",
         [](Board& b) {
           b.refused_type(0x70, Bytes(KZ_PAYLOAD_MAX, 0x11), KZ_REFUSED_UNKNOWN_TYPE, kNoDetail);
         });
  to.add("answered-once", "Each request is answered exactly once.", "REQ-6", [](Board& b) {
    for (const char* name : {"identify", "state", "health", "statistics", "self_test", "clear"}) {
      b.done(name);
      b.silence(20);
    }
    b.refused_type(0x7F, {}, KZ_REFUSED_UNKNOWN_TYPE);
    b.silence(20);
  });
  to.add("answered-hundred", "100 requests get 100 replies.", "REQ-6", [](Board& b) {
    for (int n = 0; n < 100; ++n)
      b.done(n % 2 ? "heartbeat" : "read_targets", n % 2 ? Put().u8(0).u8(0) : Put().u32(n));
    b.silence(20);
  });
}

void add_repetitions(Chapter& to) {
  to.add("repeated-answered",
         "If a request is repeated, the board sends a new reply with a new tick.", "REQ-7",
         [](Board& b) {
           const Repeated state(b, "state");
           const Reply first = state.again();
           b.wait(20);
           const Reply second = state.again();
           within("ticks between the replies", second["tick"] - first["tick"], 15, 2000);
           equal("repetitions", b.statistics()["repetitions"], 2);
         });
  for (int others = 0; others <= 3; ++others) {
    to.add(("repeated-after-" + std::to_string(others)).c_str(),
           "With " + std::to_string(others) +
               " other requests between a request and its repetition, the board recognizes the "
               "repetition.",
           "REQ-7", [others](Board& b) {
             const Repeated first(b, "limits", Put().u32(1).u16(kSettingRamp).s16(-500).s16(500));
             for (int n = 0; n < others; ++n)
               b.done("limits", Put().u32(1).u16(20 + n).s16(-400).s16(400));
             first.again();
             const long ramp = b.done("settings", Put().u8(0))["ramp"];
             equal("ramp", ramp, others == 0 ? kSettingRamp : 19 + others);
             equal("repetitions", b.statistics()["repetitions"], 1);
           });
  }
  to.add("repeated-refusal", "A repetition of a refused request is refused again.", "REQ-7",
         [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           const Bytes wire = b.request_bytes("heartbeat", Put().u8(101).u8(0), sequence);
           for (int n = 0; n < 2; ++n) {
             b.write(wire);
             b.take_refusal(KZ_TYPE_heartbeat, sequence, KZ_REFUSED_RANGE, 0);
           }
           equal("repetitions", b.statistics()["repetitions"], 1);
         });
  to.add("same-number-other-contents",
         "The same sequence number with other contents is a new request.", "REQ-8", [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           for (const int limit : {20, 30, 40}) {
             b.write(b.request_bytes("heartbeat", Put().u8(limit).u8(0), sequence));
             b.take("heartbeat", sequence);
             equal("watchdog", b.done("identify")["watchdog_10ms"], limit);
           }
           equal("repetitions", b.statistics()["repetitions"], 0);
         });
  to.add("same-number-other-type", "The same sequence number with another type is a new request.",
         "REQ-8", [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           b.write(b.request_bytes("stop", {}, sequence));
           b.take("stop", sequence);
           b.write(b.request_bytes("clear", {}, sequence));
           b.take("clear", sequence);
           equal("shutdown reason", b.state().reason(), KZ_SHUTDOWN_NONE);
         });
  to.add("forgotten", "After five other requests, a repeated request is executed as a new request.",
         "REQ-8", [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           const Bytes wire = b.request_bytes("heartbeat", Put().u8(44).u8(0), sequence);
           b.write(wire);
           b.take("heartbeat", sequence);
           for (int n = 0; n < 5; ++n) b.done("heartbeat", Put().u8(20 + n).u8(0));
           b.write(wire);
           b.take("heartbeat", sequence);
           equal("watchdog", b.done("identify")["watchdog_10ms"], 44);
         });
}

void add_queue(Chapter& to) {
  to.add("two-under-way", "Two pending requests are both answered, in order of arrival.", "REQ-9",
         [](Board& b) {
           const std::uint8_t first = b.new_sequence(), second = b.new_sequence();
           Bytes wire = b.request_bytes("state", {}, first);
           append(wire, b.request_bytes("identify", {}, second));
           b.write(wire);
           b.take("state", first);
           b.take("identify", second);
           b.silence(20);
         });
  to.add("two-done-in-order", "Two pending requests are executed in order of arrival.", "REQ-9",
         [](Board& b) {
           const std::uint8_t first = b.new_sequence(), second = b.new_sequence(),
                              third = b.new_sequence();
           b.write(b.request_bytes("state", {}, first));
           b.wait(2);
           Bytes wire = b.request_bytes("heartbeat", Put().u8(55).u8(0), second);
           b.write(wire);
           b.take("state", first);
           b.take("heartbeat", second);
           b.write(b.request_bytes("identify", {}, third));
           equal("watchdog", b.take("identify", third)["watchdog_10ms"], 55);
         });
  to.add("third-busy", "A third pending request is refused with BUSY.", "REQ-10", [](Board& b) {
    std::uint8_t number[3];
    Bytes wire;
    const char* const names[] = {"state", "health", "identify"};
    for (int n = 0; n < 3; ++n) {
      number[n] = b.new_sequence();
      append(wire, b.request_bytes(names[n], {}, number[n]));
    }
    b.write(wire);
    b.take("state", number[0]);
    // Both are answered behind `state`; which of the two comes first is not said.
    bool health = false, busy = false;
    for (int n = 0; n < 2; ++n) {
      const auto frame = b.next(50);
      check(frame.has_value(), "one of three pending requests got no reply");
      if (frame->sequence == number[1]) health = frame->type == (KZ_TYPE_health | KZ_REPLY);
      if (frame->sequence == number[2]) {
        const Reply refusal(message("refused"), *frame);
        busy = refusal["reason"] == KZ_REFUSED_BUSY && refusal["request"] == KZ_TYPE_identify;
      }
    }
    check(health, "the waiting request was not answered");
    check(busy, "the third request was not refused with BUSY");
    b.silence(20);
  });
  to.add("last-of-many-busy",
         "If a third and a fourth request arrive while two requests are pending, the board refuses "
         "the fourth request, and sends no reply to the third request.",
         "REQ-10", [](Board& b) {
           std::uint8_t number[4];
           Bytes wire;
           const char* const names[] = {"state", "health", "identify", "self_test"};
           for (int n = 0; n < 4; ++n) {
             number[n] = b.new_sequence();
             append(wire, b.request_bytes(names[n], {}, number[n]));
           }
           b.write(wire);
           b.take("state", number[0]);
           bool last = false;
           int answers = 0;
           while (const auto frame = b.next(30)) {
             ++answers;
             check(frame->sequence != number[2], "the third of four requests was answered");
             last |= frame->sequence == number[3] && frame->type == KZ_TYPE_refused;
           }
           equal("number of replies after the reply to `state`", answers, 2);
           check(last, "the last request was not refused");
         });
  to.add("busy-not-done", "A request refused with BUSY is not executed.", "REQ-10", [](Board& b) {
    Bytes wire = b.request_bytes("state");
    append(wire, b.request_bytes("health"));
    append(wire, b.request_bytes("heartbeat", Put().u8(66).u8(KZ_REACTION_HOLD)));
    b.write(wire);
    while (b.next(30)) continue;
    const Reply who = b.done("identify");
    check(who["watchdog_10ms"] != 66 && who["reaction"] != KZ_REACTION_HOLD,
          "a request that was refused with BUSY was executed");
  });
  to.add("stop-overtakes",
         "`stop` is executed at once, even while the board sends a reply and another request "
         "waits.",
         "REQ-11", [](Board& b) {
           const std::uint8_t first = b.new_sequence(), second = b.new_sequence(),
                              stop = b.new_sequence();
           Bytes wire = b.request_bytes("state", {}, first);
           append(wire, b.request_bytes("health", {}, second));
           append(wire, b.request_bytes("stop", {}, stop));
           b.write(wire);
           b.take("state", first);
           // The reply to `health` is made after `stop` was heard: it shows what was latched.
           bool stopped = false, answered = false;
           while (const auto frame = b.next(30)) {
             if (frame->sequence == second) {
               stopped = Reply(message("health_reply"), *frame).reason() == KZ_SHUTDOWN_STOP;
             }
             answered |= frame->sequence == stop && frame->type == (KZ_TYPE_stop | KZ_REPLY);
           }
           check(stopped, "`stop` waited until the board had answered another request");
           check(answered, "`stop` was not answered");
         });
  to.add("stop-repeated", "If `stop` is repeated after `clear`, the shutdown is latched again.",
         "REQ-12", [](Board& b) {
           const Repeated stop(b, "stop");
           b.done("clear");
           equal("reason in the reply", stop.again().reason(), KZ_SHUTDOWN_STOP);
           equal("shutdown reason", b.state().reason(), KZ_SHUTDOWN_STOP);
           equal("repetitions", b.statistics()["repetitions"], 0);
         });
}

// Each repetition here is known: at most three other requests are between.
void add_switching_off(Chapter& to) {
  for (int others = 2; others <= 3; ++others) {
    to.add(
        ("stop-repeated-after-" + std::to_string(others)).c_str(),
        "With " + std::to_string(others) +
            " other requests between `stop` and its repetition, the board executes the repetition.",
        "REQ-12",
        [others](Board& b) {
          const Repeated stop(b, "stop");
          b.done("clear");
          b.enable(0x3);
          if (others == 3) b.done("heartbeat", Put().u8(0).u8(0));
          const Reply reply = stop.again();
          check(!reply.flag(KZ_STATUS_ENABLED), "the reply reports that a motor is on");
          equal("reason in the reply", reply.reason(), KZ_SHUTDOWN_STOP);
          b.expect_off();
        },
        kMotion);
  }
  to.add(
      "stop-repeated-all-boards", "A repeated `stop` to all boards is executed.", "REQ-12",
      [](Board& b) {
        const Bytes wire = frame_of(KZ_ADDRESS_ALL, KZ_TYPE_stop, b.new_sequence(), {});
        b.write(wire);
        b.silence(15);
        b.done("clear");
        b.enable(0x3);
        b.write(wire);
        b.silence(15);
        b.expect_off();
        equal("shutdown reason", b.state().reason(), KZ_SHUTDOWN_STOP);
      },
      kMotion);
  to.add(
      "off-repeated", "A repeated `enable` with an empty mask switches all joints off.", "REQ-12",
      [](Board& b) {
        const Repeated off(b, "enable", Put().u32(0));
        b.enable(0x3);
        equal("joints that are on", off.again()["mask"], 0);
        b.expect_off();
      },
      kMotion);
  to.add(
      "enable-repeated",
      "A repeated `enable` switches off the joints outside its mask, but does not switch on any "
      "joint.",
      "REQ-12",
      [](Board& b) {
        const Repeated enable(b, "enable", Put().u32(0x5));
        b.enable(0x3);
        equal("joints that are on", enable.again()["mask"], 0x1);
        b.enable(0x2);
        equal("joints that are on", enable.again()["mask"], 0);
        b.expect_off();
      },
      kMotion);
  to.add(
      "clear-repeated",
      "If the link watchdog holds joints, a repeated `clear` switches the joints off, but keeps "
      "the shutdown reason.",
      "REQ-12",
      [](Board& b) {
        b.watchdog(0, KZ_REACTION_HOLD);
        const Repeated clear(b, "clear");
        b.enable(0x1);
        b.wait(120);
        check(b.state().flag(KZ_STATUS_HOLDING), "HOLDING is not set");
        const Reply reply = clear.again();
        check(!reply.flag(KZ_STATUS_HOLDING), "HOLDING is set in the reply");
        equal("reason in the reply", reply.reason(), KZ_SHUTDOWN_LINK_LOST);
        b.expect_off();
      },
      kMotion);
  to.add(
      "lock-repeated", "A repeated `unlock` with 0 seconds ends a raw drive.", "REQ-12",
      [](Board& b) {
        const Repeated lock(b, "unlock", Put().u16(KZ_KEY).u8(0));
        b.done("unlock", Put().u16(KZ_KEY).u8(5));
        b.done("raw_drive", Put().u8(0).s16(40).u16(500));
        check(!lock.again().flag(KZ_STATUS_RAW_DRIVE), "RAW_DRIVE is set in the reply");
        b.expect_off();
      },
      kMotion);
  for (const int joint : {0, 1}) {
    to.add(
        joint == 0 ? "raw-zero-repeated" : "raw-repeated",
        joint == 0 ? "A repeated `raw_drive` with duty 0 ends a raw drive."
                   : "If a `raw_drive` for motor B is repeated during a raw drive of motor A, the "
                     "board ends the raw drive of motor A, and does not start motor B.",
        "REQ-12",
        [joint](Board& b) {
          b.done("unlock", Put().u16(KZ_KEY).u8(5));
          const Repeated first(b, "raw_drive", Put().u8(joint).s16(40 * joint).u16(500));
          b.done("raw_drive", Put().u8(0).s16(40).u16(500));
          check(!first.again().flag(KZ_STATUS_RAW_DRIVE), "RAW_DRIVE is set in the reply");
          b.expect_off();
        },
        kMotion);
  }
}

}  // namespace

void add_request_cases(Cases& all) {
  Chapter to(all, "request", kNothing);
  add_answers(to);
  add_repetitions(to);
  add_queue(to);
  add_switching_off(to);
}

}  // namespace kaz::hil
