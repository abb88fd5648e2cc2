// Programs made by the cross compiler, run on the chip and held against the same computed here.
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <sstream>

#include "sim/h8s/chip/chip_testing.h"

namespace on_this_machine {
#define main mix
#include "sim/h8s/testdata/mix.c"
#undef main
}  // namespace on_this_machine

namespace kaz::h8s::testing {
namespace {

std::string guest(const std::string& name) {
  return std::string(KAZ_H8S_GUESTS) + "/" + name;
}

Chip loaded(const std::string& file, std::uint16_t rounds) {
  const auto image = load_image(guest(file));
  EXPECT_TRUE(image.has_value()) << image.error().message;
  Chip chip;
  EXPECT_TRUE(chip.load(*image).has_value());
  chip.power_on(0);
  const std::uint32_t at = chip.symbols().address_of("rounds").value();
  chip.poke(at, static_cast<std::uint8_t>(rounds >> 8));
  chip.poke(at + 1, static_cast<std::uint8_t>(rounds));
  return chip;
}

std::uint16_t crc16(const std::vector<std::uint8_t>& data) {
  unsigned crc = 0xffff;
  for (const std::uint8_t byte : data) {
    crc ^= static_cast<unsigned>(byte) << 8;
    for (int k = 0; k < 8; ++k) crc = (crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1) & 0xffff;
  }
  return static_cast<std::uint16_t>(crc);
}

TEST(Guest, Crc) {
  ASSERT_EQ(crc16({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0x29b1);  // published check value
  std::vector<std::uint8_t> data;
  for (unsigned k = 0; k < 1024; ++k) data.push_back(static_cast<std::uint8_t>(k * 7 + (k >> 8)));
  for (const char* file : {"crc.coff", "crc0.coff"}) {
    Chip chip = loaded(file, 3);
    EXPECT_EQ(chip.run_until(100'000'000).reason, Stop::Reason::asleep_forever);
    EXPECT_EQ(chip.peek16(chip.symbols().address_of("result").value()), crc16(data));
    EXPECT_TRUE(chip.misuse().empty());
  }
}

TEST(Guest, Matrix) {
  std::int64_t trace = 0;
  for (int i = 0; i < 16; ++i)
    for (int k = 0; k < 16; ++k) trace += std::int64_t{i * 100 - k * 37} * (i * 55 - k * 91);
  for (const char* file : {"matrix.coff", "matrix0.coff"}) {
    Chip chip = loaded(file, 2);
    EXPECT_EQ(chip.run_until(100'000'000).reason, Stop::Reason::asleep_forever);
    EXPECT_EQ(
        static_cast<std::int32_t>(chip.peek32(chip.symbols().address_of("result").value()).value()),
        trace);
  }
}

TEST(Guest, Mix) {
  on_this_machine::rounds = 100;
  on_this_machine::mix();
  for (const char* file : {"mix.coff", "mix0.coff"}) {
    Chip chip = loaded(file, 100);
    EXPECT_EQ(chip.run_until(100'000'000).reason, Stop::Reason::asleep_forever);
    EXPECT_EQ(chip.peek16(chip.symbols().address_of("result").value()), on_this_machine::result);
    EXPECT_TRUE(chip.misuse().empty());
  }
}

TEST(Guest, SRecordHoldsTheSameFlash) {
  const auto coff = load_image(guest("crc.coff")), srecord = load_image(guest("crc.srec"));
  ASSERT_TRUE(coff.has_value() && srecord.has_value());
  Chip a, b;
  ASSERT_TRUE(a.load(*coff).has_value() && b.load(*srecord).has_value());
  for (std::uint32_t at = 0; at < 0x20000; ++at) ASSERT_EQ(a.peek(at), b.peek(at)) << at;
  EXPECT_EQ(coff->entry, srecord->entry);
}

TEST(Guest, ReportNamesFunctionAndLine) {
  Chip chip = loaded("matrix0.coff", 1);
  const std::uint32_t multiply = chip.symbols().address_of("multiply").value();
  chip.set_breakpoint(multiply);
  const Stop stop = chip.run_until(100'000'000);
  ASSERT_EQ(stop.reason, Stop::Reason::breakpoint);
  EXPECT_NE(stop.report.find("_multiply (matrix.c:"), std::string::npos) << stop.report;
  EXPECT_NE(stop.report.find("_main+"), std::string::npos) << stop.report;  // the back-trace
}

// Each line of every.s as the assembler encodes it, and our disassembler's text for those bytes.
TEST(Guest, AssemblerAndDisassemblerAgreeOnEveryForm) {
  std::ifstream source(KAZ_H8S_TESTDATA "/every.s");
  ASSERT_TRUE(source.is_open());
  const auto image = load_image(guest("every.coff"));
  ASSERT_TRUE(image.has_value()) << image.error().message;
  Chip chip;
  ASSERT_TRUE(chip.load(*image).has_value());
  std::uint32_t at = image->symbols.address_of("every").value();
  std::string line;
  int checked = 0;
  while (std::getline(source, line)) {
    if (line.rfind("  ", 0) != 0 || line.find('.') == 2) continue;
    const std::string wanted = line.substr(2);
    int length = 0;
    EXPECT_EQ(chip.disassemble(at, &length), wanted) << std::hex << at;
    at += static_cast<std::uint32_t>(length);
    ++checked;
  }
  EXPECT_EQ(at, image->symbols.address_of("every_end").value());
  EXPECT_GT(checked, 250);
}

}  // namespace
}  // namespace kaz::h8s::testing
