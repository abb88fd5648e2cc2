// Cases of docs/reference/protocol.md, chapter Timing.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

constexpr double kByteMs = 10.0 / 115.2;

}  // namespace

void add_timing_cases(Cases& all) {
  Chapter to(all, "timing", kNothing);
  to.add(
      "reply", "The first byte of a reply comes 1.0 to 2.2 ms after the request's last byte.",
      "TIME-1",
      [](Board& b) {
        for (int n = 0; n < 24; ++n) {
          // Requests at all phases of the board's tick.
          b.wait(3);
          for (int i = 0; i < n % 5; ++i) b.write({0});
          const Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
          const Time sent = b.now();
          b.write(wire);
          const auto frame = b.next(20);
          check(frame.has_value(), "no reply");
          // 15 bytes in a row; those written before the request go first.
          const double out = kByteMs * static_cast<double>(wire.size() + n % 5);
          const double first = 1e3 * seconds(frame->at - sent) - out - 14 * kByteMs;
          check(first >= 0.95 && first <= 2.35,
                "the first byte came after " + std::to_string(first) + " ms");
        }
      },
      kExact);
  to.add("reply-coarse", "A reply is complete within 20 ms.", "TIME-1", [](Board& b) {
    for (int n = 0; n < 20; ++n) {
      const Time sent = b.now();
      b.done("state");
      const double took = 1e3 * seconds(b.now() - sent);
      check(took < 20 + 2e3 * seconds(b.slack()), "the reply took " + std::to_string(took) + " ms");
    }
  });
  to.add(
      "fresh-angle",
      "The angle in `state_reply` was sampled at most 1 ms before the reply's "
      "`tick`.",
      "TIME-2",
      [](Board& b) {
        for (int n = 0; n < 8; ++n) {
          b.wait(3 + n % 2);
          const double angle = 0.05 * (n + 1);
          const std::uint8_t sequence = b.new_sequence();
          // Its last byte is there 0.8 ms from now, and a tick begins after that.
          b.write(b.request_bytes("state", {}, sequence));
          b.bench().place_joint(4, -angle);
          within("angle", b.take("state", sequence).number("angle", 4),
                 -static_cast<long>(angle * 10000) - 40, -static_cast<long>(angle * 10000) + 40);
        }
      },
      kBench);
  to.add(
      "targets-effect", "Targets that arrive in one tick take effect in the next tick.", "TIME-3",
      [](Board& b) {
        b.done("gains", Put().u32(1).u16(KZ_KP_MAX).u16(0).u16(0).u8(0));
        b.done("limits", Put().u32(1).u16(KZ_RAMP_MAX).s16(-15000).s16(15000));
        b.bench().block_joint(0, true);
        b.enable(1);
        b.wait(5);
        check(b.bench().drive(0) == 0, "the motor is driven before the first target");
        const Bytes wire = b.request_bytes("targets", Put().u32(1).u16(0).s16(5000));
        b.write(wire);
        const double out = kByteMs * static_cast<double>(wire.size());
        // Heard in the tick behind its end, computed in the next one, at the pins with the third.
        b.wait(static_cast<int>(out + 4.5));
        check(b.bench().drive(0) > 0, "4 ms after the request `targets`, the motor is still off");
      },
      kMotion | kBench);
  to.add("after-reset", "Within 0.2 s after a reset, the board begins to answer requests.",
         "TIME-4", [](Board& b) { b.reset_by_command(); });
  to.add(
      "after-power-on", "Within 0.2 s after power-on, the board begins to answer requests.",
      "TIME-4",
      [](Board& b) {
        b.bench().set_power(false);
        b.wait(100);
        b.bench().set_power(true);
        b.wait(200);
        b.expect_alive();
        b.expect_off();
      },
      kBench);
}

}  // namespace kaz::hil
