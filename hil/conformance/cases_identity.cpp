// Cases of docs/reference/protocol.md, chapters Identity and Status.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
void add_identity_cases(Cases& all) {
  Chapter to(all, "identity", kNothing);
  to.add("identify", "`identify` reports version, joints, capabilities and reset cause.", "ID-1",
         [](Board& b) {
           const Reply who = b.done("identify");
           equal("protocol version", who["protocol_version"], KZ_PROTOCOL_VERSION);
           equal("joints", who["joints"], KZ_JOINTS);
           check(who["firmware_version"] != 0, "firmware version is 0");
           check(who["build_id"] != 0, "build id is 0");
           within("reset cause", who["reset_cause"], 0, 2);
           const long expected = KZ_CAPABILITY_TELEMETRY | KZ_CAPABILITY_CALIBRATION |
                                 KZ_CAPABILITY_RAW_DRIVE | KZ_CAPABILITY_LOADER;
           equal("capabilities", who["capabilities"], expected);
         });
  to.add("version-place",
         "In the fields of the reply to `identify`, the fifth byte is the "
         "protocol version.",
         "ID-1", [](Board& b) {
           equal("fifth byte", b.done("identify").frame().fields[4], KZ_PROTOCOL_VERSION);
         });
  to.add("watchdog-default",
         "After a reset, `identify` reports the link watchdog's default reaction, LIMP.", "ID-1",
         [](Board& b) {
           const Reply who = b.done("identify");
           within("watchdog, 10 ms", who["watchdog_10ms"], 1, 9);
           equal("reaction", who["reaction"], KZ_REACTION_LIMP);
         });
  to.add("watchdog-set",
         "`heartbeat` sets the watchdog's limit and reaction. If a field of `heartbeat` "
         "is 0, the setting of that field does not change. `identify` reports the limit and the "
         "reaction.",
         "ID-1", [](Board& b) {
           b.watchdog(25, KZ_REACTION_HOLD);
           b.watchdog(0, 0);
           Reply who = b.done("identify");
           equal("watchdog", who["watchdog_10ms"], 25);
           equal("reaction", who["reaction"], KZ_REACTION_HOLD);
           b.watchdog(100, 0);
           b.watchdog(0, KZ_REACTION_LIMP);
           who = b.done("identify");
           equal("watchdog", who["watchdog_10ms"], 100);
           equal("reaction", who["reaction"], KZ_REACTION_LIMP);
         });
  to.add("answered-while-latched", "Queries are answered while a shutdown is latched.", "ID-2",
         [](Board& b) {
           b.done("stop");
           for (const char* name :
                {"identify", "state", "health", "statistics", "self_test", "inertial"}) {
             equal(std::string(name) + ": reason in the status", b.done(name).reason(),
                   KZ_SHUTDOWN_STOP);
           }
         });
  to.add("self-test", "The self-tests ran at start, and none failed.", "ID-3", [](Board& b) {
    const Reply tests = b.done("self_test");
    equal("failed tests", tests["failed"] & ~KZ_TEST_SUPPLY, 0);
    check((tests["done"] & (KZ_TEST_RAM | KZ_TEST_FLASH | KZ_TEST_CONVERTER)) != 0,
          "no self-test ran at start");
    equal("image CRC", tests["image_crc"], b.done("identify")["image_crc"]);
    equal("shutdown reason", tests.reason(), KZ_SHUTDOWN_NONE);
  });
  to.add(
      "self-test-failed",
      "If the A/D converter fails its self-test at start, the board shuts down, and `clear` is "
      "refused.",
      "ID-3",
      [](Board& b) {
        b.bench().set_analog(KZ_ANALOG_REFERENCE, 400);
        b.bench().reset();
        b.wait(200);
        const Reply tests = b.done("self_test");
        equal("failed tests", tests["failed"] & KZ_TEST_CONVERTER, KZ_TEST_CONVERTER);
        equal("shutdown reason", tests.reason(), KZ_SHUTDOWN_SELF_TEST);
        b.bench().set_analog(KZ_ANALOG_REFERENCE, {});
        b.wait(50);
        b.refused("clear", {}, KZ_REFUSED_FAULT, KZ_SHUTDOWN_SELF_TEST);
        b.refused("enable", Put().u32(1), KZ_REFUSED_FAULT, KZ_SHUTDOWN_SELF_TEST);
        b.expect_off();
      },
      kBench);
  to.add("statistics-frames", "`statistics` counts frames.", "ID-4", [](Board& b) {
    const long before = b.statistics()["frames"];
    for (int n = 0; n < 10; ++n) b.done("heartbeat", Put().u8(0).u8(0));
    equal("frames", b.statistics()["frames"] - before, 11);
  });
  to.add("statistics-refusals", "`statistics` counts refusals separately from repetitions.", "ID-4",
         [](Board& b) {
           const Reply before = b.statistics();
           for (int n = 0; n < 5; ++n)
             b.refused("heartbeat", Put().u8(101).u8(0), KZ_REFUSED_RANGE);
           for (int n = 0; n < 3; ++n) b.refused_type(0x7E, {}, KZ_REFUSED_UNKNOWN_TYPE);
           const Reply after = b.statistics();
           equal("refusals", after["refusals"] - before["refusals"], 8);
           equal("repetitions", after["repetitions"] - before["repetitions"], 0);
         });
  to.add("statistics-repetitions", "`statistics` counts repetitions.", "ID-4", [](Board& b) {
    const std::uint8_t sequence = b.new_sequence();
    const Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0), sequence);
    for (int n = 0; n < 5; ++n) {
      b.write(wire);
      b.take("heartbeat", sequence);
    }
    equal("repetitions", b.statistics()["repetitions"], 4);
  });
  to.add("statistics-after-reset", "A reset clears all counts.", "ID-4", [](Board& b) {
    b.refused_type(0x7E, {}, KZ_REFUSED_UNKNOWN_TYPE);
    b.reset_by_command();
    const Reply counts = b.statistics();
    equal("refusals", counts["refusals"], 0);
    equal("repetitions", counts["repetitions"], 0);
    within("frames", counts["frames"], 1, 12);
  });
  to.add("ticks-in-time", "No request makes the board miss a tick.", "ID-4", [](Board& b) {
    for (int n = 0; n < 20; ++n) {
      b.done("joints", Put().u32(0x1FF));
      b.done("calibration");
    }
    const Reply counts = b.statistics();
    equal("missed ticks", counts["missed_ticks"], 0);
    check(counts["worst_8states"] >= counts["busy_8states"],
          "`worst_8states` is less than `busy_8states`");
    check(!counts.flag(KZ_STATUS_MISSED_TICK), "MISSED_TICK is set");
  });
}

}  // namespace kaz::hil
