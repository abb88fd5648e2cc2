// Faults between the tick's output and TxD0, planted in the running firmware: both comparisons detect them.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "sim/mcu/compare_testing.h"
#include "sim/mcu/compare_wire.h"
#include "sim/mcu/h8_mcu.h"

namespace kaz::sim {
namespace {

using Plant = std::function<void(H8Mcu&)>;

std::uint32_t address_of(const H8Mcu& mcu, const char* symbol) {
  return mcu.chip().symbols().address_of(symbol).value();
}

// The first occurrence of these two bytes after `symbol`.
std::uint32_t find(const H8Mcu& mcu, const char* symbol, std::uint16_t word) {
  std::uint32_t at = address_of(mcu, symbol);
  for (int left = 64; left > 0; --left, at += 2)
    if (mcu.chip().peek16(at) == word) return at;
  ADD_FAILURE() << symbol << " has no " << std::hex << word;
  return 0;
}

// Before mov.b r0l,@SCI0_TDR:8 in the transmit interrupt: applies `fault` to one byte of 300.
void plant_at_tdr(H8Mcu& mcu, std::function<void(h8s::Registers&)> fault) {
  const auto count = std::make_shared<int>(0);  // the chip calls copies of a hook
  mcu.chip().set_hook(find(mcu, "kz_serial_transmit", 0x38DB),
                      [count, fault = std::move(fault)](h8s::Chip& chip) {
                        if (++*count % 300 == 0) {
                          auto registers = chip.registers();
                          fault(registers);
                          chip.set_registers(registers);
                        }
                        return h8s::HookAction::go_on;
                      });
}

void plant_other_byte(H8Mcu& mcu) {
  plant_at_tdr(mcu, [](h8s::Registers& registers) { registers.er[0] ^= 0x04; });
}

// TDR is not written, nor its flag cleared: the interrupt continues after BCLR.
void plant_lost_byte(H8Mcu& mcu) {
  plant_at_tdr(mcu, [](h8s::Registers& registers) { registers.pc += 6; });
}

// The loader has checked the image: from here on BRR is set to 5 instead of 4.
void plant_other_rate(H8Mcu& mcu) {
  const std::uint32_t from = address_of(mcu, "kz_serial_init");
  mcu.chip().set_hook(address_of(mcu, "kz_main"), [from](h8s::Chip& chip) {
    for (std::uint32_t at = from; at < from + 64; at += 2) {
      // An instruction with #4, then mov.b rXl,@SCI0_BRR:8.
      if ((chip.peek16(at).value() & 0xF0FF) != 0x30D9 || chip.peek(at - 1) < 4 ||
          chip.peek(at - 1) > 5)
        continue;
      chip.poke(at - 1, 5);
      return h8s::HookAction::go_on;
    }
    ADD_FAILURE() << "kz_serial_init does not set BRR as expected";
    return h8s::HookAction::go_on;
  });
}

// The same while replies are sent: one store to TDR goes to BRR. With another rate from the start the board
// would receive nothing valid and not reply.
void plant_rate_changed_later(H8Mcu& mcu) {
  const std::uint32_t store = find(mcu, "kz_serial_transmit", 0x38DB);
  const auto count = std::make_shared<int>(0);
  mcu.chip().set_hook(store, [store, count](h8s::Chip& chip) {
    ++*count;
    if (*count == 300) {
      auto registers = chip.registers();
      registers.er[0] = (registers.er[0] & ~0xFFu) | 5;
      chip.set_registers(registers);
    }
    chip.poke(store + 1, *count == 300 ? 0xD9 : 0xDB);
    return h8s::HookAction::go_on;
  });
}

CompareReport ticks_with(const Plant& plant) {
  CompareOptions options = firmware_comparison(3000);
  options.prepare_h8 = plant;
  return compare_or_fail(options);
}

TEST(Line, BytesAreDecodedAtThePin) {
  const CompareReport report = ticks_with(nullptr);
  EXPECT_TRUE(report.equal()) << report.text();
  EXPECT_GT(report.line_bytes, 3000);
  EXPECT_LE(report.bytes_sent - report.line_bytes, 1);
}

TEST(Line, TickComparisonSeesAnotherByte) {
  const CompareReport report = ticks_with(plant_other_byte);
  ASSERT_FALSE(report.equal());
  EXPECT_EQ(report.differences[0].field, "line.byte");
  EXPECT_EQ(report.differences[0].native ^ report.differences[0].h8, 4);
}

TEST(Line, TickComparisonSeesAnotherRate) {
  const CompareReport report = ticks_with(plant_rate_changed_later);
  ASSERT_FALSE(report.equal());
  EXPECT_TRUE(report.differences[0].field.starts_with("line.")) << report.text();
}

TEST(Line, TickComparisonSeesALostByte) {
  const CompareReport report = ticks_with(plant_lost_byte);
  ASSERT_FALSE(report.equal());
  EXPECT_TRUE(report.differences[0].field.starts_with("line.")) << report.text();
}

TEST(Line, WireComparisonSeesThem) {
  for (const Plant& plant :
       {Plant(plant_other_byte), Plant(plant_other_rate), Plant(plant_lost_byte)}) {
    WireOptions options;
    options.image_path = KAZ_FIRMWARE_IMAGE;
    options.conversations = 2;
    options.prepare_h8 = plant;
    const auto report = compare_wire(options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(report->equal());
  }
}

}  // namespace
}  // namespace kaz::sim
