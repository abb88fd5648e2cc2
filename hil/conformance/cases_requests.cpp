// Cases of docs/reference/protocol.md, chapter Requests, replies, repetitions.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

void append(Bytes& to, const Bytes& more) {
  for (const std::uint8_t byte : more) to.push_back(byte);
}

constexpr long kSettingRamp = 77;

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
  to.add("tick-from-reset", "The tick counts from the board's reset.", "REQ-1", [](Board& b) {
    b.wait(300);
    const long before = b.state()["tick"];
    b.reset_by_command();
    within("tick after a reset", b.state()["tick"], 0, 200 + 3 * b.slack().count() / 1'000'000);
    check(before > 200, "the tick does not run");
  });
  to.add("refusal-whole", "A refused request changes nothing at all.", "REQ-2", [](Board& b) {
    const Reply before = b.done("settings", Put().u8(0));
    // The last field is wrong, all before it are right.
    b.refused("gains", Put().u32(1).u16(1000).u16(100).u16(10).u8(KZ_FRICTION_MAX + 1),
              KZ_REFUSED_RANGE, 4);
    b.refused("heartbeat", Put().u8(50).u8(3), KZ_REFUSED_RANGE, 1);
    const Reply after = b.done("settings", Put().u8(0));
    for (const char* name : {"kp", "kd", "dead_band", "friction"}) {
      equal(name, after[name], before[name]);
    }
    check(b.done("identify")["watchdog_10ms"] != 50, "half of a refused heartbeat was done");
  });
  to.add(
      "refusal-form", "A refusal carries number and type of the request.", "REQ-2", [](Board& b) {
        // No new message gets one of these: requests are 0x01 to 0x3F (messages.def).
        for (const int type : {0x00, 0x40, 0x5A, 0x7F}) {
          b.refused_type(static_cast<std::uint8_t>(type), {}, KZ_REFUSED_UNKNOWN_TYPE, kNoDetail);
        }
      });
  to.add("unknown-type", "Every type that is no request's is refused with UNKNOWN_TYPE.", "REQ-3",
         [](Board& b) {
           for (int type = 0; type < 0x80; ++type) {
             bool known = false;
             for (const Message& one : messages()) known |= one.code == type;
             if (!known) {
               b.refused_type(static_cast<std::uint8_t>(type), {}, KZ_REFUSED_UNKNOWN_TYPE,
                              kNoDetail);
             }
           }
         });
  to.add("unknown-type-long", "Also with fields.", "REQ-3", [](Board& b) {
    b.refused_type(0x70, Bytes(KZ_PAYLOAD_MAX, 0x11), KZ_REFUSED_UNKNOWN_TYPE, kNoDetail);
  });
  to.add("answered-once", "Each request is answered once.", "REQ-6", [](Board& b) {
    for (const char* name : {"identify", "state", "health", "statistics", "self_test", "clear"}) {
      b.done(name);
      b.silence(20);
    }
    b.refused_type(0x7F, {}, KZ_REFUSED_UNKNOWN_TYPE);
    b.silence(20);
  });
  to.add("answered-hundred", "A hundred requests, a hundred answers.", "REQ-6", [](Board& b) {
    for (int n = 0; n < 100; ++n)
      b.done(n % 2 ? "heartbeat" : "read_targets", n % 2 ? Put().u8(0).u8(0) : Put().u32(n));
    b.silence(20);
  });
}

void add_repetitions(Chapter& to) {
  to.add("repeated-answered", "A repetition is answered again, with a fresh tick.", "REQ-7",
         [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           const Bytes wire = b.request_bytes("state", {}, sequence);
           b.write(wire);
           const Reply first = b.take("state", sequence);
           b.wait(20);
           b.write(wire);
           const Reply second = b.take("state", sequence);
           within("ticks between the replies", second["tick"] - first["tick"], 15, 2000);
           equal("repetitions", b.statistics()["repetitions"], 1);
         });
  to.add("repeated-not-done", "A repetition is not done again.", "REQ-7", [](Board& b) {
    const std::uint8_t sequence = b.new_sequence();
    const Bytes wire =
        b.request_bytes("limits", Put().u32(1).u16(kSettingRamp).s16(-500).s16(500), sequence);
    b.write(wire);
    b.take("limits", sequence);
    b.done("limits", Put().u32(1).u16(20).s16(-400).s16(400));
    b.write(wire);
    b.take("limits", sequence);
    equal("ramp", b.done("settings", Put().u8(0))["ramp"], 20);
  });
  for (int others = 0; others <= 3; ++others) {
    to.add(("repeated-after-" + std::to_string(others)).c_str(),
           "A repetition is known with this many other requests between.", "REQ-7",
           [others](Board& b) {
             const std::uint8_t sequence = b.new_sequence();
             const Bytes wire = b.request_bytes("stop", {}, sequence);
             b.write(wire);
             b.take("stop", sequence);
             b.done("clear");
             // `clear` was the first of them.
             for (int n = 1; n < others; ++n) b.done("heartbeat", Put().u8(0).u8(0));
             if (others == 0) return;
             b.write(wire);
             b.take("stop", sequence);
             equal("reason of a shutdown", b.state().reason(), KZ_SHUTDOWN_NONE);
           });
  }
  to.add("repeated-refusal", "A refused request is refused again.", "REQ-7", [](Board& b) {
    const std::uint8_t sequence = b.new_sequence();
    const Bytes wire = b.request_bytes("heartbeat", Put().u8(101).u8(0), sequence);
    for (int n = 0; n < 2; ++n) {
      b.write(wire);
      b.take_refusal(KZ_TYPE_heartbeat, sequence, KZ_REFUSED_RANGE, 0);
    }
    equal("repetitions", b.statistics()["repetitions"], 1);
  });
  to.add("same-number-other-contents", "Other contents under the same number are a new request.",
         "REQ-8", [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           for (const int limit : {20, 30, 40}) {
             b.write(b.request_bytes("heartbeat", Put().u8(limit).u8(0), sequence));
             b.take("heartbeat", sequence);
             equal("watchdog", b.done("identify")["watchdog_10ms"], limit);
           }
           equal("repetitions", b.statistics()["repetitions"], 0);
         });
  to.add("same-number-other-type", "Another type under the same number is a new request.", "REQ-8",
         [](Board& b) {
           const std::uint8_t sequence = b.new_sequence();
           b.write(b.request_bytes("stop", {}, sequence));
           b.take("stop", sequence);
           b.write(b.request_bytes("clear", {}, sequence));
           b.take("clear", sequence);
           equal("reason of a shutdown", b.state().reason(), KZ_SHUTDOWN_NONE);
         });
  to.add("forgotten", "The fifth request behind it makes it new again.", "REQ-8", [](Board& b) {
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
  to.add("two-under-way", "Two requests at once are both answered, in their order.", "REQ-9",
         [](Board& b) {
           const std::uint8_t first = b.new_sequence(), second = b.new_sequence();
           Bytes wire = b.request_bytes("state", {}, first);
           append(wire, b.request_bytes("identify", {}, second));
           b.write(wire);
           b.take("state", first);
           b.take("identify", second);
           b.silence(20);
         });
  to.add("two-done-in-order", "And they are done in their order.", "REQ-9", [](Board& b) {
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
  to.add("third-busy", "A third request is refused with BUSY.", "REQ-10", [](Board& b) {
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
      check(frame.has_value(), "one of three requests at once has no answer");
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
  to.add("last-of-many-busy", "Of several such only the last is answered.", "REQ-10", [](Board& b) {
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
      check(frame->sequence != number[2], "a request that a later one displaced was answered");
      last |= frame->sequence == number[3] && frame->type == KZ_TYPE_refused;
    }
    equal("answers behind the first", answers, 2);
    check(last, "the last request was not refused");
  });
  to.add("busy-not-done", "A request refused with BUSY is not done.", "REQ-10", [](Board& b) {
    Bytes wire = b.request_bytes("state");
    append(wire, b.request_bytes("health"));
    append(wire, b.request_bytes("heartbeat", Put().u8(66).u8(KZ_REACTION_HOLD)));
    b.write(wire);
    while (b.next(30)) continue;
    const Reply who = b.done("identify");
    check(who["watchdog_10ms"] != 66 && who["reaction"] != KZ_REACTION_HOLD,
          "a request that was refused with BUSY was done");
  });
  to.add("stop-overtakes", "`stop` is done though a reply is being sent and a request waits.",
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
           check(stopped, "stop waited until the board had answered another request");
           check(answered, "stop was not answered");
         });
  to.add("stop-repeated", "A repeated `stop` is answered and latches nothing anew.", "REQ-11",
         [](Board& b) {
           const std::uint8_t stop = b.new_sequence();
           const Bytes wire = b.request_bytes("stop", {}, stop);
           b.write(wire);
           b.take("stop", stop);
           b.done("clear");
           b.write(wire);
           b.take("stop", stop);
           equal("reason of a shutdown", b.state().reason(), KZ_SHUTDOWN_NONE);
         });
}

}  // namespace

void add_request_cases(Cases& all) {
  Chapter to(all, "request", kNothing);
  add_answers(to);
  add_repetitions(to);
  add_queue(to);
}

}  // namespace kaz::hil
