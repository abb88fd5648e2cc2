// What the firmware finds at its start: tests of RAM and converter, cause of the reset, the loader's
// wait; the shared line's transmitter; when the watchdog is fed.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/restart.h"

#include <cstdio>

#include "firmware/chip_testing.h"
#include "shared/protocol/messages.h"
#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

constexpr std::uint32_t ram = 0xFFE080, ram_end = 0xFFF000, mark = 0xFFFF00;

class Start : public TestChip {
 protected:
  u8 cause() { return startup().reset_cause; }
  // Makes the function return at once, with `er0` as its result.
  void skip(const char* function, std::uint32_t er0) {
    const std::uint32_t rts = address_of("kz_tick_end");
    chip().set_hook(address_of(function), [rts, er0](h8s::Chip& here) {
      auto registers = here.registers();
      registers.er[0] = er0;
      registers.pc = rts;
      here.set_registers(registers);
      return h8s::HookAction::go_on;
    });
  }
  void set_mark(std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i) chip().poke(mark + i, static_cast<u8>(value >> (24 - 8 * i)));
  }
};

TEST_F(Start, FindsEverythingHealthy) {
  run(100 * ms);
  const kz_startup found = startup();
  EXPECT_EQ(found.reset_cause, KZ_RESET_POWER);
  EXPECT_EQ(found.tests_done, KZ_TEST_RAM | KZ_TEST_FLASH | KZ_TEST_CONVERTER | KZ_TEST_SUPPLY);
  EXPECT_EQ(found.tests_failed, 0);
  EXPECT_EQ(found.address, KZ_ADDRESS_DEFAULT);
  EXPECT_EQ(found.shared_line, 0);
  EXPECT_EQ(found.calibration, KZ_CALIBRATION_NOMINAL);
  EXPECT_EQ(at_start(), nominal_values);
  expect_no_misuse();
}

TEST_F(Start, TimeIsThatFromTheApplicationToTheFirstTick) {
  chip().reset();
  const States loader = run_to("kz_start");
  const States application = run_to("kz_tick_begin");
  ASSERT_GT(loader, 0);
  ASSERT_GT(application, 0);
  // What follows is no finding out: the servo's state is cleared, and the first tick waited for.
  EXPECT_LT(startup().start_8states * 8, application - ms);
  EXPECT_GT(startup().start_8states * 8, application - 2 * ms);
  std::printf("start: loader %.1f ms, application %.1f ms\n",
              static_cast<double>(loader) / static_cast<double>(ms),
              static_cast<double>(application) / static_cast<double>(ms));
  EXPECT_LT(loader + application, 100 * ms);
}

// Bytes all over RAM, each with another bit that does not take its value.
TEST_F(Start, RamTestFindsADamagedCellAnywhere) {
  for (std::uint32_t at = ram; at < ram_end; at += 61) {
    chip().power_on();
    ASSERT_GE(run_to("ram_written"), 0);
    chip().poke(at, static_cast<u8>(*chip().peek(at) ^ 1 << at % 8));
    ASSERT_GE(run_to("kz_tick_begin"), 0);
    EXPECT_EQ(startup().tests_failed, KZ_TEST_RAM) << std::hex << at;
  }
  chip().power_on();
  ASSERT_GE(run_to("kz_tick_begin"), 0);
  EXPECT_EQ(startup().tests_failed, 0);
}

// Some stuck cells show only when the complement is read, in the downward pass.
TEST_F(Start, RamTestReadsTheComplementToo) {
  const std::uint32_t at = 0xFFE800;
  chip().power_on();
  ASSERT_GE(run_to("ram_written"), 0);
  // Past this address in the upward pass, and before it is read in the downward pass.
  run(ms);
  const u8 complement = *chip().peek(at);
  EXPECT_EQ(complement, static_cast<u8>(~(at >> 8)));
  chip().poke(at, static_cast<u8>(complement ^ 0x10));
  ASSERT_GE(run_to("kz_tick_begin"), 0);
  EXPECT_EQ(startup().tests_failed, KZ_TEST_RAM);
}

TEST_F(Start, ConverterThatReadsItsReferenceWrongIsFound) {
  for (const double reads : {0.0, 0.48, 0.52, 1.0}) {
    reference = reads;
    mcu->power_cycle();
    run(100 * ms);
    EXPECT_EQ(startup().tests_failed, KZ_TEST_CONVERTER) << reads;
  }
}

TEST_F(Start, CauseOfAReset) {
  run(100 * ms);
  EXPECT_EQ(cause(), KZ_RESET_POWER);
  request_action(KZ_ACTION_RESET);
  run(5 * ms);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::watchdog);
  run(100 * ms);
  EXPECT_EQ(cause(), KZ_RESET_COMMAND);
  EXPECT_EQ(startup().tests_failed, 0);

  skip("kz_analog_ready", 0);  // no tick completes its work any more
  run(9 * ms);
  chip().clear_hook(address_of("kz_analog_ready"));
  run(100 * ms);
  EXPECT_EQ(cause(), KZ_RESET_WATCHDOG) << "the mark of the command is used up";

  // After power-on, or by its pin, whatever RAM holds.
  set_mark(KZ_RESTART_COMMAND);
  mcu->reset();
  run(100 * ms);
  EXPECT_EQ(cause(), KZ_RESET_POWER);
  set_mark(KZ_RESTART_LOADER);
  mcu->reset();
  run(100 * ms);
  EXPECT_EQ(cause(), KZ_RESET_POWER);
}

TEST_F(Start, LoaderWaitsWithTheMotorsOffAndStartsTheApplication) {
  run(100 * ms);
  bool enabled = false, driven = false;
  request_action(KZ_ACTION_LOADER);
  run(5 * ms);
  ASSERT_EQ(chip().reset_cause(), h8s::ResetCause::watchdog);
  mcu->on_pins([&](States, const PinLevels& pins) { enabled |= (pins.p4 & KZ_P4_ENABLE) != 0; });
  driven = chip().output(h8s::Port::p4).driven != 0;
  EXPECT_FALSE(driven);
  const States first = run_to("kz_tick_begin", (KZ_LOADER_S + 1) * 1000 * ms);
  ASSERT_GE(first, 0);
  EXPECT_NEAR(static_cast<double>(first) / KZ_CLOCK_HZ, KZ_LOADER_S, 0.1);
  EXPECT_FALSE(enabled);
  EXPECT_EQ(cause(), KZ_RESET_COMMAND);

  // Power lost in the loader: an ordinary start.
  request_action(KZ_ACTION_LOADER);
  run(1000 * ms);
  mcu->power_cycle();
  ASSERT_GE(run_to("kz_tick_begin", 100 * ms), 0);
  EXPECT_EQ(cause(), KZ_RESET_POWER);
}

TEST_F(Start, OnlyATickThatCompletesItsWorkFeedsTheWatchdog) {
  run(100 * ms);
  int fed = 0, ticks = 0;
  chip().set_hook(address_of("kz_watchdog_feed"), [&fed](h8s::Chip&) {
    ++fed;
    return h8s::HookAction::go_on;
  });
  // From tick to tick: where the run ends between a tick and its feeding does not matter.
  int fed_at_first = 0, fed_at_last = 0;
  mcu->on_tick([&](const TickRecord&) {
    if (++ticks == 1) fed_at_first = fed;
    fed_at_last = fed;
  });
  run(50 * ms);
  EXPECT_EQ(fed_at_last - fed_at_first, ticks - 1);
  EXPECT_NEAR(ticks, 50, 1);

  // Ticks go on, but the converter never finishes.
  skip("kz_analog_ready", 0);
  run(1 * ms);  // the tick that was under way
  fed = ticks = 0;
  run(4 * ms);
  EXPECT_GE(ticks, 4);
  EXPECT_EQ(fed, 0);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::power_on);
  run(3 * ms);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::watchdog);
}

class SharedLine : public Start {
 protected:
  static constexpr u8 address = 5;
  void SetUp() override {
    Start::SetUp();
    // As kz_store writes it into a blank block.
    const std::vector<u8> blank(KZ_STORE_BLOCK, 0xFF);
    const u8* const images[] = {blank.data()};
    kz_store log;
    kz_store_plan plan;
    u8 data[KZ_STORE_DATA], line[KZ_STORE_LINE];
    kz_store_scan(&log, images, KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS);
    kz_store_plan_next(&log, &plan);
    kz_store_pack_address(data, address, 1);
    kz_store_encode(line, &log, &plan, 0, data);
    chip().poke(address_at, line);
    mcu->power_cycle();
    run(100 * ms);
  }
  h8s::Driver txd() { return chip().state(h8s::Pin::p50).driver; }
  void request_state(u8 sequence) {
    std::vector<u8> body{address, KZ_TYPE_state, sequence};
    std::vector<u8> wire(KZ_FRAME_MAX);
    wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
    sim::send(*mcu, wire);
  }
};

TEST_F(SharedLine, TxdFloatsWhileTheBoardIsSilent) {
  EXPECT_EQ(startup().shared_line, 1);
  EXPECT_EQ(startup().address, address);
  EXPECT_LT(txd(), h8s::Driver::port) << "nothing on the chip drives it";
  std::vector<h8s::PinEdge> edges;
  chip().watch(
      h8s::Pin::p50, [&edges](const h8s::PinEdge& edge) { edges.push_back(edge); }, true);
  for (u8 i = 1; i <= 3; ++i) {
    edges.clear();
    request_state(i);
    run(10 * ms);
    const auto bytes = mcu->take_transmitted();
    const auto bodies = bodies_of(bytes);
    ASSERT_EQ(bodies.size(), 1u);
    EXPECT_EQ(bodies[0][0], address);
    EXPECT_EQ(bodies[0][1], KZ_TYPE_state_reply);
    for (std::size_t b = 1; b < bytes.size(); ++b)
      EXPECT_EQ(bytes[b].at - bytes[b - 1].at, KZ_STATES_PER_BYTE);
    ASSERT_GT(edges.size(), 10u);
    EXPECT_EQ(edges.front().driver, h8s::Driver::sci);
    EXPECT_TRUE(edges.front().level) << "it begins with mark, not with a bit";
    EXPECT_LT(edges.back().driver, h8s::Driver::port);
    // Let go when the last stop bit has passed, as soon as the interrupt is served.
    EXPECT_GE(edges.back().at, bytes.back().at);
    EXPECT_LT(edges.back().at, bytes.back().at + 4 * KZ_STATES_PER_BIT);
    EXPECT_LT(txd(), h8s::Driver::port);
  }
  expect_no_misuse();
}

TEST_F(Start, TxdIsDrivenAllTheTimeOnALineOfItsOwn) {
  run(100 * ms);
  for (int i = 0; i < 30; ++i) {
    if (i == 5) send(*mcu, frame_of(KZ_TYPE_state, 1, {}));
    run(ms);
    EXPECT_EQ(chip().state(h8s::Pin::p50).driver, h8s::Driver::sci);
  }
  EXPECT_EQ(bodies_of(mcu->take_transmitted()).size(), 1u);
}

}  // namespace
}  // namespace kaz::sim
