// The bare machine: its memory, how programs end and write, what is an error, what is counted.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/flat/flat.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kaz::h8s {
namespace {

using Reason = FlatStop::Reason;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kCode = 0x1000;

const Engine kEngines[] = {Engine::reference, Engine::interpreter, Engine::translator};

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::string digits;
  for (const char ch : text) {
    if (ch != ' ') digits += ch;
  }
  for (std::size_t k = 0; k + 1 < digits.size(); k += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(k, 2), nullptr, 16)));
  return bytes;
}

// mov.w #0xdead,r1; mov.w #0xbeef,r2; mov.w #0x2a00,r0; sleep: ends with status 42.
const char* const kExit42 = "7901DEAD 7902BEEF 79002A00 0180";

Flat machine(const std::string& code, std::uint32_t at = kCode, Engine engine = Engine::translator,
             bool semihost = true) {
  Flat flat({engine, semihost, 1});
  Image image;
  image.segments.push_back({at, at, ".text", from_hex(code)});
  image.entry = at;
  EXPECT_TRUE(flat.load(image).has_value());
  return flat;
}

TEST(Flat, StartsWithZeroMemoryAndRegisters) {
  Flat flat = machine("0000");
  const Registers r = flat.registers();
  EXPECT_EQ(r.pc, kCode);
  EXPECT_EQ(r.ccr, 0x80);
  for (const std::uint32_t er : r.er) EXPECT_EQ(er, 0u);
  for (std::uint32_t at = 0; at < 0x1000000; at += 0xfff1) EXPECT_EQ(flat.peek(at), 0);
  EXPECT_EQ(flat.now(), 0);
}

TEST(Flat, EndsWithTheProgramsStatusAndCountsIt) {
  for (const Engine engine : kEngines) {
    Flat flat = machine(kExit42, kCode, engine);
    const FlatStop stop = flat.run();
    EXPECT_EQ(stop.reason, Reason::exited);
    EXPECT_EQ(stop.status, 42);
    EXPECT_EQ(flat.instructions(), 4);
    EXPECT_EQ(flat.now(), 3 * 2 + 2);
    EXPECT_EQ(flat.run().status, 42);
  }
}

TEST(Flat, OnlyTheLowHalvesOfTheMarkCount) {
  // As above with the upper halves of ER0 to ER2 filled first.
  Flat flat = machine("7A0012345678 0F81 0F82" + std::string(kExit42));
  EXPECT_EQ(flat.run().status, 42);
}

TEST(Flat, AnyOtherSleepIsAnError) {
  const char* programs[] = {"0180", "7901DEAD 7902BEEF 79002A01 0180",
                            "7901DEAE 7902BEEF 79002A00 0180", "7901DEAD 7902BEEE 79002A00 0180"};
  for (const char* program : programs) {
    const FlatStop stop = machine(program).run();
    EXPECT_EQ(stop.reason, Reason::asleep) << program;
    EXPECT_NE(stop.text.find("SLEEP"), std::string::npos);
    EXPECT_NE(stop.text.find("opcode 0x0180"), std::string::npos);
    EXPECT_EQ(stop.text.find('\n'), std::string::npos);
  }
  EXPECT_EQ(machine(kExit42, kCode, Engine::translator, false).run().reason, Reason::asleep);
}

struct Written {
  int stream;
  std::string text;
};

// mov.l #descriptor,er0; mov.l #address,er1; mov.l #length,er2; jsr @@0xc7:8.
std::string write_call(std::uint32_t descriptor, std::uint32_t address, std::uint32_t length) {
  char text[64];
  std::snprintf(text, sizeof text, "7A00%08X 7A01%08X 7A02%08X 5FC7", descriptor, address, length);
  return text;
}

TEST(Flat, WritesFromMemory) {
  for (const Engine engine : kEngines) {
    for (const std::uint32_t descriptor : {0u, 1u, 2u}) {
      Flat flat = machine(write_call(descriptor, 0xab002000, 5) + kExit42, kCode, engine);
      flat.poke(0x2000, from_hex("48656C6C6F"));
      std::vector<Written> written;
      flat.on_output([&](int stream, std::span<const std::uint8_t> bytes) {
        written.push_back({stream, {bytes.begin(), bytes.end()}});
        return true;
      });
      flat.run(Flat::kNoLimit, 4);
      Registers r = flat.registers();
      EXPECT_EQ(r.er[0], 5u);  // and nothing else has changed
      EXPECT_EQ(r.er[1], 0xab002000u);
      EXPECT_EQ(r.er[2], 5u);
      EXPECT_EQ(r.er[7], 0u);
      EXPECT_EQ(r.ccr, 0x80);
      EXPECT_EQ(r.pc, kCode + 20);
      EXPECT_EQ(flat.peek32(0xfffffc), 0u);
      EXPECT_EQ(flat.now(), 3 * 3 + 6);
      ASSERT_EQ(written.size(), 1u);
      EXPECT_EQ(written[0].stream, descriptor == 2 ? 2 : 1);
      EXPECT_EQ(written[0].text, "Hello");
      EXPECT_EQ(flat.run().status, 42);
      EXPECT_EQ(flat.instructions(), 8);
    }
  }
}

TEST(Flat, WritesAcrossTheTopAndLongerThanMemory) {
  Flat flat = machine(write_call(1, 0xfffffe, 0x1000005));
  flat.poke(0xfffffe, from_hex("41424344"));  // A B | C D at 0
  std::size_t total = 0;
  std::string first, last;
  flat.on_output([&](int, std::span<const std::uint8_t> bytes) {
    if (total == 0) first.assign(bytes.begin(), bytes.end());
    total += bytes.size();
    last.assign(bytes.end() - 3, bytes.end());
    return true;
  });
  flat.run(Flat::kNoLimit, 4);
  EXPECT_EQ(first, "AB");
  EXPECT_EQ(total, 0x1000005u);
  EXPECT_EQ(last, std::string("CD\0", 3));
  EXPECT_EQ(flat.registers().er[0], 0x1000005u);
}

TEST(Flat, RequestsThatDoNotExistAreNamed) {
  for (const unsigned code : {0xc5u, 0xc6u, 0xc8u, 0xc9u, 0xcau, 0xcbu, 0xccu}) {
    char text[8];
    std::snprintf(text, sizeof text, "5f%02x", code);
    const FlatStop stop = machine(text).run();
    EXPECT_EQ(stop.reason, Reason::bad_request);
    EXPECT_NE(stop.text.find("0x" + std::string(text + 2)), std::string::npos) << stop.text;
    EXPECT_NE(stop.text.find("PC 0x001000, opcode 0x" + std::string(text)), std::string::npos);
  }
  EXPECT_EQ(machine(write_call(3, 0, 1)).run().reason, Reason::bad_request);
}

TEST(Flat, NeighboursOfTheRequestsAreCalls) {
  for (const char* code : {"5FC4", "5FCD"}) {
    Flat flat = machine(code);
    flat.run(Flat::kNoLimit, 1);
    EXPECT_EQ(flat.registers().pc, 0u);
    EXPECT_EQ(flat.peek32(0xfffffc), kCode + 2);
  }
}

TEST(Flat, OutputThatCannotBeWrittenStops) {
  Flat flat = machine(write_call(1, 0, 1) + kExit42);
  flat.on_output([](int, std::span<const std::uint8_t>) { return false; });
  EXPECT_EQ(flat.run().reason, Reason::output_failed);
}

TEST(Flat, UndefinedInstructionsStopWithPlaceAndWord) {
  // A hole of the opcode map, then the H8S/2600's CLRMAC, MAC, LDMAC, STMAC and the E clock's
  // MOVFPE.
  for (const char* code : {"0001", "01A0", "0160 6D12", "0320", "0220", "6A40 1234"}) {
    for (const Engine engine : kEngines) {
      Flat flat = machine(std::string("0000") + code, kCode, engine);
      const FlatStop stop = flat.run(1000);
      EXPECT_EQ(stop.reason, Reason::undefined_instruction) << code;
      EXPECT_EQ(stop.pc, kCode + 2);
      EXPECT_EQ(flat.instructions(), 1);
      std::string word = "opcode 0x" + std::string(code).substr(0, 4);
      for (char& ch : word) ch = static_cast<char>(std::tolower(ch));
      EXPECT_NE(stop.text.find("PC 0x001002, " + word), std::string::npos) << stop.text;
      EXPECT_EQ(stop.text.find('\n'), std::string::npos);
    }
  }
}

TEST(Flat, OddPcIsAnError) {
  // jmp @0x2001; bra to an odd displacement; rts to an odd address.
  struct Case {
    const char* code;
    std::uint32_t pc;
  };
  for (const Case& c : {Case{"5A002001", 0x2001}, {"4003", kCode + 5}, {"5470", 0x000001}}) {
    for (const Engine engine : kEngines) {
      Flat flat = machine(c.code, kCode, engine);
      flat.poke(3, 1);
      const FlatStop stop = flat.run(1000);
      EXPECT_EQ(stop.reason, Reason::odd_pc) << c.code;
      EXPECT_EQ(stop.pc, c.pc);
      EXPECT_EQ(flat.instructions(), 1);
    }
  }
  Flat flat;
  Image image;
  image.segments.push_back({0, 0, "all", Bytes(4)});
  image.entry = 0x101;
  ASSERT_TRUE(flat.load(image).has_value());
  const FlatStop stop = flat.run();
  EXPECT_EQ(stop.reason, Reason::odd_pc);
  EXPECT_NE(stop.text.find("PC 0x000101"), std::string::npos) << stop.text;
}

TEST(Flat, LimitsAreExact) {
  for (const Engine engine : kEngines) {
    Flat flat = machine("40FE", kCode, engine);  // bra to itself, 2 states
    FlatStop stop = flat.run(Flat::kNoLimit, 1'000'001);
    EXPECT_EQ(stop.reason, Reason::reached);
    EXPECT_EQ(flat.instructions(), 1'000'001);
    EXPECT_EQ(flat.now(), 2'000'002);
    EXPECT_NE(stop.text.find("PC 0x001000, opcode 0x40fe"), std::string::npos) << stop.text;
    stop = flat.run(2'000'005);
    EXPECT_EQ(flat.now(), 2'000'006);
  }
}

// eepmov.w of 300 bytes behind loads of R4, ER5 and ER6.
TEST(Flat, BlockMoveIsOneInstructionHoweverItIsCut) {
  const std::string code = "7904012C 7A0500003000 7A0600FFFFF0 7BD4598F 40FE";
  for (const Engine engine : kEngines) {
    Flat whole = machine(code, kCode, engine), cut = machine(code, kCode, engine);
    for (std::uint32_t k = 0; k < 300; ++k) {
      whole.poke(0x3000 + k, static_cast<std::uint8_t>(k * 7));
      cut.poke(0x3000 + k, static_cast<std::uint8_t>(k * 7));
    }
    whole.run(Flat::kNoLimit, 4);
    EXPECT_EQ(whole.now(), 2 + 3 + 3 + 4 + 2 * 300);
    for (States t = 1; cut.instructions() < 4; t += 37) cut.run(t, 4);
    EXPECT_EQ(cut.now(), whole.now());
    EXPECT_EQ(cut.registers(), whole.registers());
    for (std::uint32_t k = 0; k < 300; ++k)  // across the top of memory
      ASSERT_EQ(cut.peek(0xfffff0 + k), static_cast<std::uint8_t>(k * 7));
  }
}

TEST(Flat, AddressesAreTheChips) {
  // mov.b r0l,@0x20:8; mov.b r0l,@0x8000:16; mov.l @0xfffffe:32,er1; mov.w @0x3001:32,r2.
  const std::string code = "F85A 3820 6A888000 01006B2100FFFFFE 6B2200003001 40FE";
  for (const Engine engine : kEngines) {
    Flat flat = machine(code, kCode, engine);
    flat.poke(0xfffffe, from_hex("1122"));
    flat.poke(0, from_hex("3344"));
    flat.poke(0x3000, from_hex("5566"));
    flat.run(Flat::kNoLimit, 5);
    EXPECT_EQ(flat.peek(0xffff20), 0x5a);
    EXPECT_EQ(flat.peek(0xff8000), 0x5a);
    EXPECT_EQ(flat.registers().er[1], 0x11223344u);
    EXPECT_EQ(flat.registers().er[2], 0x5566u);
  }
}

TEST(Flat, ExecutionWrapsAtTheTop) {
  for (const Engine engine : kEngines) {
    // mov.l #0x12345678,er0 begins in the last word and goes on at 0, where a second time sleeps.
    Flat flat = machine("7A00", 0xfffffe, engine);
    flat.poke(0, from_hex("12345678 F955 0180"));
    const FlatStop stop = flat.run(1000);
    EXPECT_EQ(stop.reason, Reason::asleep);
    EXPECT_EQ(flat.registers().er[0], 0x12345678u);
    EXPECT_EQ(flat.registers().er[1], 0x55u);
    EXPECT_EQ(flat.instructions(), 3);
    EXPECT_EQ(stop.pc, 6u);
  }
}

TEST(Flat, ProgramsMayChangeThemselves) {
  // Loop: mov.b #n,r0l with n raised by each round through memory; the operand is that of the
  // instruction itself, across the top of memory in the second placement.
  for (const std::uint32_t at : {0x1000u, 0xfffffeu}) {
    for (const Engine engine : kEngines) {
      // F8 00 mov.b #0,r0l / 8801 add.b #1,r0l / 6AA8 aaaaaaaa mov.b r0l,@at+1 / 40F4 bra -12
      char code[64];
      std::snprintf(code, sizeof code, "F800 8801 6AA8%08X 40F4", at + 1);
      Flat flat({engine, true, 1});
      flat.poke(at, from_hex(code));
      Registers r;
      r.pc = at;
      flat.set_registers(r);
      flat.run(Flat::kNoLimit, 4 * 50);
      EXPECT_EQ(flat.peek(at + 1), 50) << at;
    }
  }
}

TEST(Flat, TrapStacksFourBytesAndReturns) {
  // mov.l #0xff001001,er7 (upper byte and bit 0 are not the stack's); trapa #1; sleep. Vector 9.
  for (const Engine engine : kEngines) {
    Flat flat = machine("7A07FF004000 5710 0180", kCode, engine);
    flat.poke(9 * 4, from_hex("00005000"));
    flat.poke(0x5000, from_hex("5670"));
    flat.run(Flat::kNoLimit, 2);
    EXPECT_EQ(flat.registers().pc, 0x5000u);
    EXPECT_EQ(flat.registers().er[7], 0xff003ffcu);
    EXPECT_EQ(flat.peek32(0x3ffc), 0x88000000u | (kCode + 8));
    EXPECT_EQ(flat.now(), 3 + 8);
    EXPECT_EQ(flat.run(100).reason, Reason::asleep);
    EXPECT_EQ(flat.registers().er[7], 0xff004000u);
    EXPECT_EQ(flat.now(), 3 + 8 + 5 + 2);
  }
}

TEST(Flat, TheStackMayBeAnywhere) {
  // jsr with ER7 = 0: the return address goes to the top of memory; then with ER7 odd.
  for (const Engine engine : kEngines) {
    Flat flat = machine("5E002000", kCode, engine);
    flat.poke(0x2000, from_hex("5470"));
    flat.run(Flat::kNoLimit, 2);
    EXPECT_EQ(flat.registers().pc, kCode + 4);
    EXPECT_EQ(flat.registers().er[7], 0u);
    Registers r = flat.registers();
    r.er[7] = 0x3001;
    r.pc = kCode;
    flat.set_registers(r);
    flat.run(Flat::kNoLimit, 3);
    EXPECT_EQ(flat.peek32(0x2ffc), kCode + 4);
  }
}

// Hot code calls, returns, stores in all sizes and at last jumps to an odd address: at every boundary
// the engines agree on everything.
TEST(Flat, EnginesAgreeOnHotCode) {
  const std::string code =
      "7A0700FFFFFE"  // mov.l #0xfffffe,er7: the first push wraps below the top
      "7A0600000000"  // mov.l #0,er6
      "79050200"      // mov.w #0x200,r5
      "5E001030"      // loop: jsr @0x1030
      "0B06"          // adds #1,er6
      "6BA500FFFFF0"  // mov.w r5,@0xfffff0:32
      "6BA0007FFFF2"  // mov.w r0,@0x7ffff2:32
      "1B55"          // dec.w #1,r5
      "46EA"          // bne loop
      "7A0100001041"  // mov.l #0x1041,er1
      "5910";         // jmp @er1: odd
  const std::string sub =
      "01006DF6"  // push.l er6
      "6D76"
      "6D75"  // pop.w r6, pop.w r5: the halves of er6, and away with them
      "6DF5"
      "6DF6"      // push both again
      "01006D76"  // pop.l er6
      "68E8"      // mov.b r0l,@er6
      "8801"      // add.b #1,r0l
      "5470";     // rts
  Image image;
  image.segments.push_back({kCode, kCode, ".text", from_hex(code)});
  image.segments.push_back({0x1030, 0x1030, ".sub", from_hex(sub)});
  image.entry = kCode;
  std::vector<Flat> machines;
  for (const Engine engine : kEngines) {
    machines.emplace_back(FlatOptions{engine, true, 3});
    ASSERT_TRUE(machines.back().load(image).has_value());
  }
  for (States until = 13;; until += 13 + until % 7) {
    const FlatStop first = machines[0].run(until);
    for (Flat& flat : machines) {
      const FlatStop stop = flat.run(until);
      ASSERT_EQ(stop.reason, first.reason) << until;
      ASSERT_EQ(stop.text, first.text);
      ASSERT_EQ(flat.now(), machines[0].now());
      ASSERT_EQ(flat.instructions(), machines[0].instructions());
      ASSERT_EQ(flat.registers(), machines[0].registers()) << until;
      ASSERT_EQ(flat.peek32(0xfffffa), machines[0].peek32(0xfffffa));
      ASSERT_EQ(flat.peek32(0x7ffff0), machines[0].peek32(0x7ffff0));
    }
    if (first.reason != Reason::reached) break;
  }
  EXPECT_EQ(machines[0].run().reason, Reason::odd_pc);
  EXPECT_EQ(machines[0].registers().er[5], 0u);
}

TEST(Flat, LoadRefusesWhatCannotRun) {
  Flat flat;
  Image image;
  image.segments.push_back({0x400, 0xffffff, "tail", {1, 2}});
  image.entry = 0;
  auto ok = flat.load(image);
  ASSERT_FALSE(ok.has_value());
  EXPECT_NE(ok.error().message.find("'tail'"), std::string::npos);
  image.segments[0].run_address = 0xfffffe;
  EXPECT_TRUE(flat.load(image).has_value());
  EXPECT_EQ(flat.peek(0xffffff), 2);
  image.normal_mode = true;
  EXPECT_FALSE(flat.load(image).has_value());
  image.normal_mode = false;
  image.entry.reset();
  EXPECT_FALSE(flat.load(image).has_value());
}

}  // namespace
}  // namespace kaz::h8s
