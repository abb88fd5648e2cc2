// Cases of docs/reference/protocol.md, chapter Telemetry.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

const char* const kFrames[] = {"telemetry_state", "telemetry_commands", "telemetry_drives",
                               "telemetry_health"};

Reply read(const Frame& frame) {
  for (const char* name : kFrames) {
    if (message(name).code == frame.type) return {message(name), frame};
  }
  throw Failed{"a telemetry frame of unknown type " + std::to_string(frame.type)};
}

}  // namespace

void add_telemetry_cases(Cases& all) {
  Chapter to(all, "telemetry", kNothing);
  for (int n = 0; n < 4; ++n) {
    to.add(std::string("frame-") + kFrames[n],
           "The board sends only the selected telemetry frame, once per period.", "TEL-1",
           [n](Board& b) {
             const long first_tick = b.done("telemetry", Put().u16(20).u8(1 << n))["tick"];
             long last = first_tick;
             const auto frames = b.telemetry(210, true);
             within("frames in 210 ms", static_cast<long>(frames.size()), 9, 11);
             int sequence = frames.front().sequence;
             for (const Frame& frame : frames) {
               equal("type", frame.type, message(kFrames[n]).code);
               equal("address", frame.address, b.address);
               equal("sequence number", frame.sequence, sequence++ & 0xFF);
               within("ticks since the previous frame", read(frame)["tick"] - last, 19, 21);
               last = read(frame)["tick"];
             }
           });
  }
  to.add("contents", "Telemetry and replies report the same values.", "TEL-1", [](Board& b) {
    b.done("telemetry", Put().u16(50).u8(15));
    const auto frames = b.telemetry(220, true);
    b.done("telemetry", Put().u16(0).u8(0));
    const Reply health = b.health();
    // What several replies range over: one reading has the potentiometer's noise, and a frame has it as well.
    // Between two readings there may be two codes of 49 units.
    std::array<long, KZ_JOINTS> lowest{}, highest{};
    for (int n = 0; n < 8; ++n) {
      const Reply state = b.state();
      for (int j = 0; j < KZ_JOINTS; ++j) {
        const auto at = static_cast<std::size_t>(j);
        const long angle = state.number("angle", j);
        lowest[at] = n == 0 ? angle : std::min(lowest[at], angle);
        highest[at] = n == 0 ? angle : std::max(highest[at], angle);
      }
    }
    int seen[4] = {};
    for (const Frame& frame : frames) {
      const Reply one = read(frame);
      ++seen[frame.type - 0xC0];
      check(one.flag(KZ_STATUS_TELEMETRY), "TELEMETRY is not set");
      if (frame.type == KZ_TYPE_telemetry_health) {
        within("temperature", one["temperature_dc"], health["temperature_dc"] - 20,
               health["temperature_dc"] + 20);
        equal("detail", one["detail"], kNoDetail);
        continue;
      }
      for (int j = 0; j < KZ_JOINTS; ++j) {
        if (frame.type == KZ_TYPE_telemetry_drives) {
          equal("duty of joint " + std::to_string(j), one.number("duty", j), 0);
        } else {
          const auto at = static_cast<std::size_t>(j);
          within("angle of joint " + std::to_string(j), one.number("angle", j), lowest[at] - 80,
                 highest[at] + 80);
        }
      }
    }
    for (int n = 0; n < 4; ++n) within(std::string("frames ") + kFrames[n], seen[n], 3, 5);
  });
  for (const int period : {5, 7, 100}) {
    to.add("period-" + std::to_string(period),
           "Telemetry keeps a period of " + std::to_string(period) + " ms.", "TEL-1",
           [period](Board& b) {
             const int selection = KZ_TELEMETRY_HEALTH;  // 24 bytes: 2.1 ms
             b.done("telemetry", Put().u16(period).u8(selection));
             const auto frames = b.telemetry(period * 10 + 5, true);
             within("frames", static_cast<long>(frames.size()), 8, 11);
             // Replies to the heartbeats come before telemetry: some frames wait for them.
             within("ticks from the first to the last frame",
                    read(frames.back())["tick"] - read(frames.front())["tick"],
                    period * (static_cast<long>(frames.size()) - 1) - 4,
                    period * (static_cast<long>(frames.size()) + 1));
           });
  }
  to.add("end", "Period 0 ends telemetry.", "TEL-1", [](Board& b) {
    b.done("telemetry", Put().u16(10).u8(15));
    b.telemetry(60, true);
    const Reply ended = b.done("telemetry", Put().u16(0).u8(0));
    check(!ended.flag(KZ_STATUS_TELEMETRY), "TELEMETRY is set");
    b.telemetry(20, true);
    equal("frames after telemetry has ended", static_cast<long>(b.telemetry(100, true).size()), 0);
  });
  to.add("none-selected", "With selection 0, no frame is sent.", "TEL-1", [](Board& b) {
    b.done("telemetry", Put().u16(10).u8(0));
    equal("frames", static_cast<long>(b.telemetry(60, true).size()), 0);
  });
  to.add("after-reset", "After a reset, no telemetry is sent.", "TEL-1", [](Board& b) {
    b.done("telemetry", Put().u16(10).u8(1));
    b.reset_by_command();
    equal("frames", static_cast<long>(b.telemetry(60, true).size()), 0);
  });
  for (int period = 1; period < KZ_TELEMETRY_PERIOD_MIN_MS; ++period) {
    to.add("too-fast-" + std::to_string(period),
           "A telemetry period of " + std::to_string(period) + " ms is refused with RANGE.",
           "TEL-2", [period](Board& b) {
             b.refused("telemetry", Put().u16(period).u8(1), KZ_REFUSED_RANGE, 0);
             equal("frames", static_cast<long>(b.telemetry(30, true).size()), 0);
           });
  }
  to.add("dropped",
         "If the line cannot carry all frames, the board drops and counts telemetry frames, but "
         "drops no replies.",
         "TEL-3", [](Board& b) {
           const long before = b.statistics()["telemetry_dropped"];
           b.done("telemetry", Put().u16(5).u8(15));  // 190 bytes every 5 ms: 57 go
           for (int n = 0; n < 10; ++n) {
             b.done("heartbeat", Put().u8(0).u8(0), 40);
             b.wait(20);
           }
           b.done("telemetry", Put().u16(0).u8(0), 40);
           b.telemetry(30, true);
           const long dropped = b.statistics()["telemetry_dropped"] - before;
           within("frames dropped in 250 ms", dropped, 50, 400);
         });
  to.add("reply-first", "A reply waits at most until the current telemetry frame has been sent.",
         "TEL-3", [](Board& b) {
           b.done("telemetry", Put().u16(5).u8(15));
           b.wait(30);
           for (int n = 0; n < 10; ++n) {
             const Time start = b.now();
             b.done("heartbeat", Put().u8(0).u8(0), 40);
             // 11 bytes out, the rest of a frame of 53, two ticks, 15 bytes back.
             const long took = (b.now() - start).count() / 1'000'000;
             within("round trip, ms", took, 0, 12 + b.slack().count() / 250'000);
             b.wait(7);
           }
         });
  to.add("ends-with-link",
         "If no request arrives within the link watchdog's limit, telemetry ends, even while the "
         "motors are off.",
         "TEL-4", [](Board& b) {
           b.done("telemetry", Put().u16(10).u8(1));
           const auto frames = b.telemetry(300, false);
           within("frames while the host sends no requests", static_cast<long>(frames.size()), 6,
                  10);
           const Reply state = b.state();
           check(!state.flag(KZ_STATUS_TELEMETRY), "TELEMETRY is set");
           equal("shutdown reason", state.reason(), KZ_SHUTDOWN_NONE);
           equal("frames after telemetry has ended",
                 static_cast<long>(b.telemetry(60, true).size()), 0);
         });
  to.add("lives-with-link", "Telemetry continues while the host sends requests.", "TEL-4",
         [](Board& b) {
           b.done("telemetry", Put().u16(20).u8(1));
           within("frames in 600 ms", static_cast<long>(b.telemetry(600, true).size()), 27, 31);
         });
}

}  // namespace kaz::hil
