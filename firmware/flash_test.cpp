// Calibration and address in the emulated chip's flash: stored, read back, worn, refused, and never
// lost with the power.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "firmware/chip_testing.h"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

class Flash : public TestChip {
 protected:
  void SetUp() override {
    TestChip::SetUp();
    run(100 * ms);
  }
  // Requests a store, then cuts power at each of many states of it, from the end of a tick on to the
  // tick after. `check` gets the chip as it is with power applied again.
  template <class Check>
  int cut_everywhere(States step, Check check) {
    chip().poke(address_of("kz_output") + offsetof(kz_tick_output, action),
                KZ_ACTION_STORE_CALIBRATION);
    const std::uint32_t end = address_of("kz_tick_begin");
    bool over = false;
    chip().set_hook(end, [&over](h8s::Chip&) {
      over = true;
      return h8s::HookAction::stop;
    });
    int cuts = 0;
    for (States at = chip().now(); !over; at += step) {
      chip().run_until(at);
      h8s::Chip cut = chip().clone();
      cut.power_on();
      check(cut);
      ++cuts;
      if (testing::Test::HasFailure()) break;
    }
    chip().clear_hook(end);
    return cuts;
  }
  // States between two cuts: one is the exhaustive form (minutes).
  static States cut_step(States usual) {
    const char* given = std::getenv("KAZ_POWER_CUT_STATES");
    return given ? std::max(1L, std::atol(given)) : usual;
  }
};

TEST_F(Flash, StoredCalibrationIsInUseAfterPowerOn) {
  EXPECT_EQ(at_start(), nominal_values);
  EXPECT_EQ(startup().calibration, KZ_CALIBRATION_NOMINAL);
  const Calibration mine = Calibration::number(1);
  EXPECT_EQ(store(mine).result, KZ_RESULT_DONE);
  EXPECT_EQ(input().calibration_sequence, 1);
  run_to("kz_tick_end");
  run_to("kz_tick_begin");
  EXPECT_EQ(input().result, KZ_RESULT_NONE);
  mcu->power_cycle();
  run(100 * ms);
  EXPECT_EQ(at_start(), mine);
  EXPECT_EQ(startup().calibration, KZ_CALIBRATION_A);
  EXPECT_EQ(input().calibration_sequence, 1);
  expect_no_misuse();
}

// The manual's steps, waits and pulses are kept (else the chip reports misuse), in both blocks.
TEST_F(Flash, BlocksTakeTurnsAndWearIsCounted) {
  States longest = 0;
  for (int i = 1; i <= 35; ++i) {
    const Outcome outcome = store(Calibration::number(i));
    ASSERT_EQ(outcome.result, KZ_RESULT_DONE) << i;
    longest = std::max(longest, outcome.deaf);
    EXPECT_EQ(stored_in(chip()), Calibration::number(i));
    EXPECT_EQ(input().calibration_sequence, i);
    EXPECT_EQ(input().erases_a, (i - 1) / 20) << i;
    EXPECT_EQ(input().erases_b, (i + 9) / 20) << i;
  }
  const auto& worn = chip().flash_statistics();
  EXPECT_EQ(worn.blocks[1].erasures, 1);
  EXPECT_EQ(worn.blocks[2].erasures, 2);
  EXPECT_EQ(worn.blocks[1].reprogrammed + worn.blocks[2].reprogrammed, 0);
  for (const unsigned other : {0u, 3u, 4u, 5u, 6u, 7u, 8u, 9u}) {
    EXPECT_EQ(worn.blocks[other].erase_pulses, 0);
    EXPECT_EQ(worn.blocks[other].program_pulses, 0);
  }
  EXPECT_EQ(worn.errors, 0);
  expect_no_misuse();
  std::printf("store: deaf for at most %.1f ms, healthy flash\n",
              static_cast<double>(longest) / static_cast<double>(ms));
}

TEST_F(Flash, NoTickIsLostFromTheCount) {
  run_to("kz_tick_begin");
  const kz_tick_input first = input();
  const States from = chip().now();
  for (int i = 1; i <= 12; ++i) {
    const Outcome outcome = store(Calibration::number(i));
    EXPECT_EQ(outcome.result, KZ_RESULT_DONE);
    EXPECT_GE(outcome.missed, 1);
    EXPECT_NEAR(static_cast<double>(outcome.deaf) / static_cast<double>(ms), outcome.missed, 2.0);
  }
  run_to("kz_tick_end");
  run_to("kz_tick_begin");
  EXPECT_EQ(input().missed, 0);
  EXPECT_NEAR(static_cast<double>(chip().now() - from) / static_cast<double>(ms),
              input().tick - first.tick, 0.1);
}

TEST_F(Flash, ABlockThatCannotBeErasedIsGivenUpInTime) {
  for (int i = 1; i <= 10; ++i) store(Calibration::number(i));
  // One cell of block B never reads as erased; `serve` runs all the while.
  const std::uint32_t serve = address_of("serve");
  chip().set_hook(serve, [](h8s::Chip& here) {
    here.poke(0xA00, 0x7F);
    return h8s::HookAction::go_on;
  });
  const Outcome outcome = store(Calibration::number(11));
  chip().clear_hook(serve);
  EXPECT_EQ(outcome.result, KZ_RESULT_FAILED);
  EXPECT_GT(outcome.deaf, 1000 * ms);  // it has tried
  EXPECT_LT(outcome.deaf, 3000 * ms);
  EXPECT_NEAR(static_cast<double>(outcome.deaf) / static_cast<double>(ms), outcome.missed, 2.0);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::power_on) << "the watchdog was fed";
  EXPECT_EQ(stored_in(chip()), Calibration::number(10));
  EXPECT_EQ(input().calibration_sequence, 10);
  std::printf("store: deaf for %.0f ms where erasing fails\n",
              static_cast<double>(outcome.deaf) / static_cast<double>(ms));
  EXPECT_EQ(store(Calibration::number(12)).result, KZ_RESULT_DONE);
}

// A line of which one cell never takes a 0: 1000 pulses, then no.
TEST_F(Flash, ALineThatCannotBeProgrammedIsGivenUpInTime) {
  store(Calibration::number(1));
  const std::uint32_t serve = address_of("serve"), line = calibration_at + 3 * KZ_STORE_LINE;
  chip().set_hook(serve, [](h8s::Chip& here) {
    here.poke(line + 1, 0xFF);
    return h8s::HookAction::go_on;
  });
  // `serve` runs before each pulse; the pulse itself is undone by a cell that lost it at once.
  chip().set_hook(address_of("programmed"), [](h8s::Chip& here) {
    here.poke(line + 1, 0xFF);
    return h8s::HookAction::go_on;
  });
  const Outcome outcome = store(Calibration::number(2));
  chip().clear_hook(serve);
  chip().clear_hook(address_of("programmed"));
  EXPECT_EQ(outcome.result, KZ_RESULT_FAILED);
  // With as much for each of three lines, and for an erasure above, it is less than 3 s.
  EXPECT_LT(outcome.deaf, 400 * ms);
  std::printf("store: deaf for %.0f ms where a line cannot be programmed\n",
              static_cast<double>(outcome.deaf) / static_cast<double>(ms));
  EXPECT_EQ(stored_in(chip()), Calibration::number(1));
  // The line is spoilt; the next copy goes behind it.
  EXPECT_EQ(store(Calibration::number(3)).result, KZ_RESULT_DONE);
  EXPECT_EQ(log().line, 4);
}

// Flash read under a pulse: the chip's error protection ends the pulse, and locks.
TEST_F(Flash, ErrorProtectionIsReportedUntilReset) {
  store(Calibration::number(1));
  const std::uint32_t serve = address_of("serve");
  for (int i = 2; i <= 10; ++i) store(Calibration::number(i));
  int calls = 0;
  chip().set_hook(serve, [&](h8s::Chip& here) {
    if (++calls > 2 && calls < 12 && here.flash_statistics().errors == 0) {
      auto registers = here.registers();
      registers.er[0] = 0x1000;  // where it counts a tick that is due
      here.set_registers(registers);
    }
    return h8s::HookAction::go_on;
  });
  const Outcome outcome = store(Calibration::number(11));
  chip().clear_hook(serve);
  EXPECT_EQ(chip().flash_statistics().errors, 1);
  EXPECT_EQ(outcome.result, KZ_RESULT_FAILED);
  EXPECT_LT(outcome.deaf, 50 * ms);
  EXPECT_EQ(stored_in(chip()), Calibration::number(10));
  EXPECT_EQ(store(Calibration::number(12)).result, KZ_RESULT_FAILED) << "locked until reset";
  mcu->reset();
  run(100 * ms);
  EXPECT_EQ(at_start(), Calibration::number(10));
  EXPECT_EQ(store(Calibration::number(13)).result, KZ_RESULT_DONE);
}

TEST_F(Flash, NothingIsWrittenWhileMotorsAreOn) {
  store(Calibration::number(1));
  ASSERT_GE(run_to("kz_tick_end"), 0);
  const auto before = blocks_of(chip());
  set_calibration(Calibration::number(2));
  const std::uint32_t output = address_of("kz_output");
  chip().poke(output + offsetof(kz_tick_output, p4), KZ_P4_ENABLE);
  chip().poke(output + offsetof(kz_tick_output, action), KZ_ACTION_STORE_CALIBRATION);
  EXPECT_GE(run_to("kz_tick_begin"), 0);
  EXPECT_EQ(input().result, KZ_RESULT_FAILED);
  EXPECT_EQ(blocks_of(chip()), before);
}

TEST_F(Flash, StoredAddressIsInForceAfterReset) {
  for (int i = 0; i < 40; ++i) {  // more than its block has lines
    ASSERT_GE(run_to("kz_tick_end"), 0);
    set_state("new_address", 0, 1 + i % 14);
    set_state("new_shared_line", 0, i % 2);
    EXPECT_EQ(done(KZ_ACTION_STORE_ADDRESS).result, KZ_RESULT_DONE) << i;
  }
  EXPECT_EQ(startup().address, KZ_ADDRESS_DEFAULT);
  EXPECT_EQ(startup().shared_line, 0);
  EXPECT_EQ(chip().flash_statistics().blocks[3].erasures, 1);
  mcu->reset();
  run(100 * ms);
  EXPECT_EQ(startup().address, 1 + 39 % 14);
  EXPECT_EQ(startup().shared_line, 1);
  EXPECT_EQ(startup().calibration, KZ_CALIBRATION_NOMINAL);
  expect_no_misuse();
}

// Power lost anywhere in a store that erases: the old copy or the new one, in the flash and as the
// firmware finds it at its next start.
TEST_F(Flash, PowerLostAnywhereLeavesTheOldOrTheNewCopy) {
  const Calibration newer = Calibration::number(99);
  for (const int copies : {0, 4, 10}) {
    chip().power_on();
    for (std::uint32_t at = calibration_at; at < address_at; ++at) chip().poke(at, 0xFF);
    run(100 * ms);
    for (int i = 1; i <= copies; ++i) store(Calibration::number(i));
    ASSERT_GE(run_to("kz_tick_end"), 0);
    set_calibration(newer);
    const auto old = stored_in(chip());
    const std::uint32_t first_tick = address_of("kz_tick_begin");
    int olds = 0, news = 0, torn = 0, starts = 0;
    const auto blocks_before = blocks_of(chip());
    const int cuts = cut_everywhere(cut_step(copies == 10 ? 512 : 256), [&](h8s::Chip& cut) {
      const auto left = stored_in(cut);
      ASSERT_TRUE(left == old || left == newer);
      ++(left == newer ? news : olds);
      torn += left == old && blocks_of(cut) != blocks_before;
      if ((olds + news) % 64 != 0) return;
      ++starts;
      cut.set_breakpoint(first_tick);
      ASSERT_EQ(cut.run_until(100 * ms).reason, h8s::Stop::Reason::breakpoint);
      std::array<u8, h8_layout::kStartupSize> bytes{};
      ASSERT_TRUE(cut.peek(address_of("kz_startup_found"), bytes));
      const kz_startup found = h8_layout::decode_startup(bytes);
      const Calibration expected = left ? *left : nominal_values;
      EXPECT_TRUE(std::equal(expected.centre.begin(), expected.centre.end(), found.pot_centre));
      EXPECT_TRUE(std::equal(expected.scale.begin(), expected.scale.end(), found.pot_scale));
    });
    EXPECT_GT(olds, 10);
    EXPECT_GT(news, 2);
    EXPECT_GT(torn, 10);
    std::printf(
        "power cut at %d states of a store%s: %d old copies (%d behind a torn write), %d new, %d "
        "started from\n",
        cuts, copies == 10 ? " that erases" : "", olds, torn, news, starts);
  }
}

// Cut again and again, with the store begun anew each time.
TEST_F(Flash, PowerLostAgainAndAgainNeverCostsTheLastCopy) {
  std::mt19937 random(11);
  Calibration kept = Calibration::number(0);
  store(kept);
  int done_count = 0, torn = 0;
  for (int i = 1; i <= 150; ++i) {
    const Calibration next = Calibration::number(i);
    ASSERT_GE(run_to("kz_tick_end"), 0) << chip().report();
    set_calibration(next);
    request_action(KZ_ACTION_STORE_CALIBRATION);
    const auto before = blocks_of(chip());
    chip().run_until(chip().now() + static_cast<States>(random() % (12 * ms)));
    mcu->power_cycle();
    const auto left = stored_in(chip());
    ASSERT_TRUE(left == kept || left == next) << "cut " << i;
    torn += left == kept && blocks_of(chip()) != before;
    done_count += left == next;
    kept = *left;
    ASSERT_GE(run_to("kz_tick_begin"), 0);
    ASSERT_EQ(at_start(), kept) << "cut " << i;
  }
  EXPECT_GT(torn, 20);
  EXPECT_GT(done_count, 20);
  EXPECT_EQ(store(Calibration::number(200)).result, KZ_RESULT_DONE);
  std::printf("150 power cuts in a row: %d stored, %d torn\n", done_count, torn);
}

}  // namespace
}  // namespace kaz::sim
