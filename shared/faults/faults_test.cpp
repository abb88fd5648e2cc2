// Faults as text, and their effects on a line.
// SPDX-License-Identifier: Apache-2.0
#include "shared/faults/faults.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "shared/faults/link_faults.h"

namespace kaz::faults {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Fault fault_of(const std::string& line) {
  const auto fault = parse(line);
  EXPECT_TRUE(fault) << line << ": " << (fault ? "" : fault.error().message);
  return fault.value_or(Fault{});
}

std::string error_of(const std::string& line) {
  const auto fault = parse(line);
  return fault ? "" : fault.error().message;
}

TEST(Faults, ALineSaysWhenHowLongWhatAndWhere) {
  const Fault fault = fault_of("at 1.250 s for 0.2 s pot_open joint 3");
  EXPECT_EQ(fault.name, Name::pot_open);
  EXPECT_EQ(fault.at, milliseconds(1250));
  EXPECT_EQ(fault.length, milliseconds(200));
  EXPECT_EQ(fault.joint, 3);
  EXPECT_EQ(fault.value, 1.0);
  EXPECT_TRUE(fault.active(milliseconds(1250)));
  EXPECT_TRUE(fault.active(milliseconds(1449)));
  EXPECT_FALSE(fault.active(milliseconds(1450)));
  EXPECT_FALSE(fault.active(milliseconds(1249)));
}

TEST(Faults, WayAndValueStandInEitherOrder) {
  const Fault a = fault_of("at 2 s for 500 ms link_drop 0.05 to board");
  EXPECT_EQ(a, fault_of("at 2 s for 500 ms link_drop to board chance 0.05"));
  EXPECT_EQ(a.way, Way::to_board);
  EXPECT_EQ(a.value, 0.05);
  EXPECT_EQ(fault_of("power_sag 2 V"), fault_of("at 0 s power_sag drop 2"));
  EXPECT_EQ(fault_of("joint_stuck joint l_knee").joint, 12);
}

TEST(Faults, WithoutForItLasts) {
  EXPECT_TRUE(fault_of("at 1 s link_cut").active(seconds(1'000'000)));
}

TEST(Faults, ErrorsSayWhatWasExpectedAndWhatStandsThere) {
  EXPECT_EQ(error_of("at soon pot_open joint 3"),
            "expected a time such as `1.25 s` or `200 ms` after `at`, found `soon`");
  EXPECT_EQ(error_of("at 1 h pot_open joint 3"), "expected `s` or `ms` after `at 1`, found `h`");
  EXPECT_NE(error_of("at 1 s pot_lost").find("pot_stuck"), std::string::npos);
  EXPECT_EQ(error_of("pot_open joint 18"),
            "expected a joint, 0 to 17 or a name such as `neck_pan`, found `18`");
  EXPECT_EQ(error_of("pot_open"),
            "expected `joint` and its number or name after `pot_open`, found the end of the line");
  EXPECT_EQ(error_of("link_drop 1.5"), "expected a chance from 0 to 1 of `link_drop`, found `1.5`");
  EXPECT_EQ(error_of("link_drop to nowhere"),
            "expected `board` or `host` after `to`, found `nowhere`");
  EXPECT_EQ(error_of("link_cut now"),
            "expected the end of the line after `at 0 s link_cut`, found `now`");
  EXPECT_NE(error_of("link_drop nan"), "");
  EXPECT_EQ(error_of("at 1 s for 0 s link_cut"), "expected a time above 0 after `for`, found `0`");
  EXPECT_EQ(error_of("power_sag 1 9"),
            "expected the end of the line after `at 0 s power_sag drop 1 V`, found `9`");
  EXPECT_NE(error_of("link_drop 0.1 0.2"), "");
  EXPECT_NE(error_of("pot_noisy joint 3 sigma 1 sigma 400"), "");
  EXPECT_NE(error_of("link_cut to board to host"), "");
}

TEST(Faults, ATimeMayBeInMilliseconds) {
  EXPECT_EQ(fault_of("link_delay 20 ms"), fault_of("link_delay 0.02 s"));
  EXPECT_EQ(fault_of("link_delay 20 ms to host"), fault_of("link_delay to host time 0.02"));
  EXPECT_NE(error_of("link_delay 2000 ms"), "");
  EXPECT_NE(error_of("link_drop 20 ms"), "");
}

TEST(Faults, AScheduleNamesTheLineThatIsWrong) {
  const auto good = Schedule::parse("# nothing yet\n\nat 1 s power_reset  # once\n", "f");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->faults().size(), 1u);
  const auto bad = Schedule::parse("at 1 s power_reset\nat 2 s power_rest\n", "my.faults");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message.rfind("my.faults:2: expected the name of a fault", 0), 0u);
  EXPECT_EQ(bad.error().fault, kaz::Fault::usage);
  EXPECT_FALSE(Schedule::load("/nowhere/at/all"));
}

TEST(Faults, EveryKindComesBackFromItsText) {
  Schedule schedule;
  for (const Kind& kind : kinds()) {
    Fault fault{kind.id, milliseconds(5), milliseconds(7), -1, Way::both, kind.initial};
    if (kind.target == Target::joint) fault.joint = 17;
    if (kind.target == Target::line) fault.way = Way::to_host;
    EXPECT_EQ(fault_of(text_of(fault)), fault) << text_of(fault);
    schedule.add(fault);
    EXPECT_LE(kind.low, kind.initial);
    EXPECT_GE(kind.high, kind.initial);
    for (const int joint : {-2, -1, 0, 17, 18, 1 << 30}) {
      fault.joint = joint;
      const bool is_joint = joint >= 0 && joint <= 17;
      EXPECT_EQ(fault.is_possible(), kind.target == Target::joint ? is_joint : joint == -1);
    }
  }
  const auto again = Schedule::parse(schedule.text(), "text");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(std::ranges::equal(schedule.faults(), again->faults()));
}

TEST(Faults, WhatOnlyTheSimulatorDoesIsNamed) {
  EXPECT_FALSE(Schedule({fault_of("link_cut")}).only_simulated());
  EXPECT_EQ(Schedule({fault_of("link_cut"), fault_of("power_sag")}).only_simulated(), "power_sag");
}

// Of 1000 bytes: how many arrive, are changed, duplicated.
struct Passed {
  int bytes = 0, changed = 0, framing = 0;
};
Passed thousand(const std::string& line) {
  const Schedule schedule({fault_of(line)});
  LinkFaults faults(3, Way::to_board);
  Passed passed;
  for (int i = 0; i < 1000; ++i) {
    const LineBytes out = faults.pass(schedule, Time::zero(), {0x5A, false});
    for (std::size_t k = 0; k < out.count; ++k) {
      ++passed.bytes;
      passed.changed += out.bytes[k].value != 0x5A;
      passed.framing += out.bytes[k].framing_error;
    }
  }
  return passed;
}

TEST(Schedule, NamesTheFaultsThatNeverBegan) {
  const Schedule schedule({fault_of("at 1 s power_reset"), fault_of("at 5 s for 1 s link_cut"),
                           fault_of("at 4.999 s power_reset")});
  EXPECT_TRUE(schedule.not_begun(milliseconds(5001)).empty());
  EXPECT_EQ(not_begun_text({}), "");
  EXPECT_EQ(not_begun_text(schedule.not_begun(milliseconds(5000))),
            "1 fault never began, because the run ended before it: at 5 s for 1 s link_cut");
  EXPECT_EQ(not_begun_text(schedule.not_begun(Time::zero())).substr(0, 51),
            "3 faults never began, because the run ended before ");
}

TEST(LinkFaults, HappenWithTheirChance) {
  EXPECT_EQ(thousand("link_cut").bytes, 0);
  EXPECT_NEAR(thousand("link_drop 0.2").bytes, 800, 50);
  EXPECT_NEAR(thousand("link_duplicate 0.2").bytes, 1200, 50);
  EXPECT_NEAR(thousand("link_insert 0.2").bytes, 1200, 50);
  EXPECT_NEAR(thousand("link_flip 0.2").changed, 200, 50);
  EXPECT_EQ(thousand("link_flip 1").changed, 1000);
  EXPECT_EQ(thousand("link_drop 1 to host").bytes, 1000);
}

TEST(LinkFaults, DelayAddsUp) {
  const Schedule schedule({fault_of("link_delay 0.02 s"), fault_of("link_delay 0.03")});
  LinkFaults faults(3, Way::to_host);
  EXPECT_EQ(faults.pass(schedule, Time::zero(), {1, false}).delay, milliseconds(50));
}

TEST(LinkFaults, BaudErrorUpToFivePerCentIsHarmless) {
  for (int value = 0; value < 256; ++value) {
    for (const double error : {-0.05, 0.0, 0.05}) {
      const LineByte got = sampled(static_cast<std::uint8_t>(value), error);
      EXPECT_EQ(got.value, value);
      EXPECT_FALSE(got.framing_error);
    }
  }
  // The stop bit, sampled at 9.5 receiver's bits, is the sender's bit 8, the highest of the data.
  EXPECT_TRUE(sampled(0x00, -0.06).framing_error);
  EXPECT_FALSE(sampled(0x80, -0.06).framing_error);
  // At half the speed every bit is read twice, from the start bit on.
  EXPECT_EQ(sampled(0xFF, -0.5).value, 0xFE);
}

}  // namespace
}  // namespace kaz::faults
