// Cases of docs/reference/protocol.md, chapter Settings.
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "hil/conformance/suite.h"
#include "shared/servo/servo.h"

namespace kaz::hil {
namespace {

Reply settings(Board& b, int joint) {
  return b.done("settings", Put().u8(joint));
}

// "rounded to what the loop can hold"
void rounded(const std::string& what, long got, long wanted) {
  const long tolerance = 8 + wanted / 50;
  within(what, got, wanted - tolerance, wanted + tolerance);
}

void expect_defaults(Board& b, int joint) {
  const Reply set = settings(b, joint);
  const bool hand = joint == 5 || joint == 9;
  equal("joint", set["joint"], joint);
  rounded("kp", set["kp"], hand ? KZ_KP_HAND : KZ_KP_DEFAULT);
  rounded("kd", set["kd"], KZ_KD_DEFAULT);
  equal("dead band", set["dead_band"], 0);
  equal("friction", set["friction"], 0);
  equal("ramp", set["ramp"], KZ_RAMP_DEFAULT);
}

// Drive of joint 0, its shaft held and turned by `error` against its command.
double drive_at_error(Board& b, double error) {
  b.bench().block_joint(0, true);
  b.enable(1);
  b.bench().place_joint(0, -error);
  b.stay_alive(45);
  return b.bench().drive(0);
}

void drive_within(double got, double low, double high) {
  check(got >= low && got <= high, "drive: expected " + std::to_string(low) + ".." +
                                       std::to_string(high) + ", got " + std::to_string(got));
}

}  // namespace

void add_settings_cases(Cases& all) {
  Chapter to(all, "settings", kNothing);
  for (const int joint : {0, 5, 9, 17}) {
    to.add("defaults-" + std::to_string(joint),
           "Joint " + std::to_string(joint) + " has the default settings after a reset.", "SET-4",
           [joint](Board& b) { expect_defaults(b, joint); });
  }
  to.add("gains-read-back", "`gains` sets the gains, and `settings` reads them back.", "SET-1",
         [](Board& b) {
           b.done("gains", Put().u32(1).u16(2560).u16(1024).u16(123).u8(17));
           const Reply set = settings(b, 0);
           rounded("kp", set["kp"], 2560);
           rounded("kd", set["kd"], 1024);
           equal("dead band", set["dead_band"], 123);
           equal("friction", set["friction"], 17);
           equal("ramp", set["ramp"], KZ_RAMP_DEFAULT);
         });
  to.add(
      "gains-extremes", "The lowest and the highest gains can be set and read back.", "SET-1",
      [](Board& b) {
        b.done(
            "gains",
            Put().u32(4).u16(KZ_KP_MAX).u16(KZ_KD_MAX).u16(KZ_DEAD_BAND_MAX).u8(KZ_FRICTION_MAX));
        const Reply set = settings(b, 2);
        rounded("kp", set["kp"], KZ_KP_MAX);
        rounded("kd", set["kd"], KZ_KD_MAX);
        equal("dead band", set["dead_band"], KZ_DEAD_BAND_MAX);
        equal("friction", set["friction"], KZ_FRICTION_MAX);
        b.done("gains", Put().u32(4).u16(0).u16(0).u16(0).u8(0));
        const Reply none = settings(b, 2);
        equal("kp", none["kp"], 0);
        equal("kd", none["kd"], 0);
      });
  to.add("gains-mask", "Joints outside the mask keep their gains.", "SET-1", [](Board& b) {
    b.done("gains", Put().u32(0x20001).u16(1000).u16(200).u16(5).u8(3));
    for (const int joint : {0, 17}) rounded("kp", settings(b, joint)["kp"], 1000);
    for (const int joint : {1, 5, 16}) expect_defaults(b, joint);
  });
  to.add(
      "gain-drives", "The duty is kp times the error.", "SET-1",
      [](Board& b) {
        b.done("gains", Put().u32(1).u16(1280).u16(0).u16(0).u8(0));  // 5 /rad
        drive_within(drive_at_error(b, 0.1), 0.42, 0.58);
      },
      kMotion | kBench);
  to.add(
      "dead-band", "An error inside the dead band causes no duty.", "SET-1",
      [](Board& b) {
        b.done("gains", Put().u32(1).u16(5120).u16(0).u16(500).u8(20));
        drive_within(drive_at_error(b, 0.04), 0, 0);
        b.bench().place_joint(0, -0.1);
        b.stay_alive(45);
        drive_within(b.bench().drive(0), 0.5, 1);
      },
      kMotion | kBench);
  to.add(
      "friction", "Friction compensation adds a duty with the sign of the error.", "SET-1",
      [](Board& b) {
        b.done("gains", Put().u32(1).u16(256).u16(0).u16(20).u8(51));  // 1 /rad, 0.2 of full duty
        drive_within(drive_at_error(b, 0.05), 0.22, 0.28);
        b.bench().place_joint(0, 0.05);
        b.stay_alive(45);
        drive_within(b.bench().drive(0), -0.28, -0.22);
      },
      kMotion | kBench);
  to.add("limits-read-back", "`limits` sets ramp and soft limits, and `settings` reads them back.",
         "SET-2", [](Board& b) {
           b.done("limits", Put().u32(2).u16(33).s16(-1234).s16(2345));
           const Reply set = settings(b, 1);
           equal("ramp", set["ramp"], 33);
           equal("lower", set["lower"], -1234);
           equal("upper", set["upper"], 2345);
           expect_defaults(b, 0);
         });
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    to.add("limits-cut-" + std::to_string(joint),
           "Limits beyond the mechanical limits of joint " + std::to_string(joint) +
               " are clipped to the mechanical limits.",
           "SET-2", [joint](Board& b) {
             const Reply before = settings(b, joint);
             b.done("limits", Put().u32(1L << joint).u16(60).s16(-32768).s16(32767));
             const Reply after = settings(b, joint);
             equal("lower", after["lower"], before["lower"]);
             equal("upper", after["upper"], before["upper"]);
             const struct {
               long lower, upper;
             } mechanics[KZ_JOINTS] = {
                 {-15707, 15707}, {-7853, 13089}, {-24434, 6981}, {-7853, 19198},  {-23561, 1745},
                 {-13962, 5235},  {-24434, 6981}, {-19198, 7853}, {-23561, 1745},  {-13962, 5235},
                 {-7853, 7853},   {-24434, 6981}, {-872, 24434},  {-13962, 10471}, {-7853, 7853},
                 {-24434, 6981},  {-872, 24434},  {-13962, 10471}};
             equal("lower", after["lower"], mechanics[joint].lower);
             equal("upper", after["upper"], mechanics[joint].upper);
           });
  }
  to.add("limits-crossed", "`limits` with `lower` above `upper` is refused with RANGE.", "SET-3",
         [](Board& b) {
           b.refused("limits", Put().u32(1).u16(60).s16(101).s16(100), KZ_REFUSED_RANGE);
           b.refused("limits", Put().u32(1).u16(60).s16(32767).s16(-32768), KZ_REFUSED_RANGE);
           b.done("limits", Put().u32(1).u16(60).s16(100).s16(100));
         });
  to.add("until-reset", "A reset restores the default settings.", "SET-4", [](Board& b) {
    const Reply before = settings(b, 3);
    b.done("gains", Put().u32(8).u16(100).u16(100).u16(100).u8(10));
    b.done("limits", Put().u32(8).u16(9).s16(-100).s16(100));
    b.watchdog(77, KZ_REACTION_HOLD);
    b.reset_by_command();
    expect_defaults(b, 3);
    const Reply after = settings(b, 3);
    equal("lower", after["lower"], before["lower"]);
    equal("upper", after["upper"], before["upper"]);
    check(b.done("identify")["watchdog_10ms"] != 77, "the link watchdog's limit survived a reset");
  });
  to.add("kept", "`enable`, `stop` and `clear` do not change the settings.", "SET-4", [](Board& b) {
    b.done("gains", Put().u32(1).u16(2560).u16(300).u16(7).u8(5));
    b.done("limits", Put().u32(1).u16(9).s16(-100).s16(100));
    b.done("stop");
    b.done("clear");
    b.done("enable", Put().u32(0));
    const Reply set = settings(b, 0);
    rounded("kp", set["kp"], 2560);
    equal("ramp", set["ramp"], 9);
    equal("upper", set["upper"], 100);
  });
  to.add(
      "narrower-for-targets", "A new, narrower limit applies to the next target.", "SET-5",
      [](Board& b) {
        b.enable(1);
        b.done("limits", Put().u32(1).u16(60).s16(-1000).s16(1000));
        b.refused("targets", Put().u32(1).u16(100).s16(1001), KZ_REFUSED_LIMIT, 0);
        b.done("targets", Put().u32(1).u16(100).s16(1000));
      },
      kMotion);
  to.add(
      "narrower-ends-ramp", "A ramp that would pass a new, narrower limit ends at the new limit.",
      "SET-5",
      [](Board& b) {
        b.enable(1);
        const long from = b.done("read_targets", Put().u32(1)).number("angle", 0);
        b.target(0, from + 5000, 1000);
        b.stay_alive(100);
        b.done("limits", Put().u32(1).u16(60).s16(-15000).s16(from + 2000));
        b.done("telemetry", Put().u16(10).u8(KZ_TELEMETRY_COMMANDS));
        for (const Frame& frame : b.telemetry(900, true)) {
          within("distance moved by the command",
                 Reply(message("telemetry_commands"), frame).number("angle", 0) - from, 0, 2000);
        }
        within("distance moved by the joint", b.angle(0) - from, 1900, 2100);
        check(!b.state().flag(KZ_STATUS_MOVING), "the ramp has not ended");
      },
      kMotion);
}

}  // namespace kaz::hil
