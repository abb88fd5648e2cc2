// Every interrupt vector of the part: acceptance to the state, frames, priorities, address break.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s::testing {
namespace {

struct Source {
  unsigned vector;
  int icr;  // 8 * register + bit; -1: none
};
// Hardware manual, interrupt controller: table of sources.
constexpr Source kVectors[] = {{16, 7},  {17, 6},  {18, 5},  {24, 2},  {25, 1},  {26, 0},  {27, -1},
                               {28, 15}, {48, 14}, {49, 14}, {50, 14}, {51, 14}, {52, 14}, {53, 14},
                               {54, 14}, {64, 11}, {65, 11}, {66, 11}, {68, 10}, {69, 10}, {70, 10},
                               {72, 9},  {73, 9},  {74, 9},  {75, 9},  {80, 23}, {81, 23}, {82, 23},
                               {83, 23}, {84, 22}, {85, 22}, {86, 22}, {87, 22}};

// A machine on nops in RAM, vector n leading to 0x4000 + 16 n, which is `bra .`.
struct Bench {
  Machine m;
  Chip chip;
  explicit Bench(int mode = 2, std::uint8_t ccr = 0) : m(options(mode)) {
    std::uint8_t* flash = m.memory_at(0);
    const unsigned size = mode == 2 ? 4 : 2;
    for (unsigned v = 0; v < 104; ++v) {
      const unsigned to = 0x4000 + 16 * v;
      flash[size * v + size - 2] = static_cast<std::uint8_t>(to >> 8);
      flash[size * v + size - 1] = static_cast<std::uint8_t>(to);
      if (size == 4) flash[4 * v] = flash[4 * v + 1] = 0;
      flash[to] = 0x40;
      flash[to + 1] = 0xfe;
    }
    for (std::uint32_t a = 0xe200; a < 0xe400; ++a) *m.memory_at(0xff0000 | a) = 0;
    m.forget_all_code();
    m.set_pc(0xffe200);
    m.cpu.er[7] = 0xffeff0;
    set_ccr(m.cpu, ccr);
    m.run(chip, m.cpu.now + 1, false);  // the first instruction after reset
  }
  static Options options(int mode) {
    Options o;
    o.mode = mode;
    return o;
  }
  void run(States until) { m.run(chip, until, false); }
  std::uint32_t handler(unsigned v) const { return 0x4000 + 16 * v; }
};

// Nops end at each state: taken 4 states after the request, not 3; then 8 states, 7 in normal mode.
TEST(Vectors, AcceptanceToTheState) {
  for (const int mode : {2, 3}) {
    for (const Source& s : kVectors) {
      Bench b(mode);
      const States at = b.m.cpu.now;
      b.m.irq.set(s.vector, true, at);
      b.run(at + 4);
      const std::uint32_t before = b.m.pc();
      EXPECT_EQ(before & 0xffff, 0xe202u + 8) << s.vector;
      b.m.run(b.chip, kNever, true);
      EXPECT_EQ(b.m.pc(), b.handler(s.vector)) << s.vector;
      EXPECT_EQ(b.m.cpu.now, at + 4 + (mode == 2 ? 8 : 7));
      // Frame: CCR (twice in normal mode), then the next instruction.
      const std::uint8_t* frame = b.m.memory_at(b.m.cpu.er[7]);
      EXPECT_EQ(b.m.cpu.er[7] & 0xffff, 0xefecu);
      EXPECT_EQ(frame[0], 0);
      EXPECT_EQ(frame[1], mode == 2 ? 0xff : 0x00);
      EXPECT_EQ(frame[2] << 8 | frame[3], 0xe20a);
      EXPECT_EQ(ccr(b.m.cpu) & 0xc0, 0x80);
    }
  }
}

TEST(Vectors, MaskedByIInModeZeroWhateverIcr) {
  for (const Source& s : kVectors) {
    Bench b(2, 0x80);
    for (std::uint32_t k = 0; k < 3; ++k) b.m.io_write(0xfffee8 + k, 0xff);
    b.m.irq.set(s.vector, true, b.m.cpu.now);
    b.run(b.m.cpu.now + 40);
    EXPECT_EQ(b.m.pc() >> 8, 0xffe2u) << s.vector;
  }
}

// Mode 1 with I = 1, UI = 0: only sources whose own ICR bit is set; entry sets UI.
TEST(Vectors, EachIcrBitRaisesItsSources) {
  for (const Source& s : kVectors) {
    for (int bit = 0; bit < 24; ++bit) {
      Bench b(2, 0x80);
      b.m.io_write(0xffffc4, 0x19);
      b.m.io_write(0xfffee8 + static_cast<std::uint32_t>(bit / 8),
                   static_cast<std::uint8_t>(1u << bit % 8));
      b.m.irq.set(s.vector, true, b.m.cpu.now);
      b.run(b.m.cpu.now + 20);
      const bool taken = b.m.pc() == b.handler(s.vector);
      EXPECT_EQ(taken, bit == s.icr) << s.vector << ' ' << bit;
      if (taken) {
        EXPECT_EQ(ccr(b.m.cpu) & 0xc0, 0xc0);
      }
    }
  }
}

// All at once: in vector order; with ICR set for a source, that one first.
TEST(Vectors, Priorities) {
  for (const Source& raised : kVectors) {
    Bench b;
    const States at = b.m.cpu.now;
    if (raised.icr >= 0)
      b.m.io_write(0xfffee8 + static_cast<std::uint32_t>(raised.icr / 8),
                   static_cast<std::uint8_t>(1u << raised.icr % 8));
    for (const Source& s : kVectors) b.m.irq.set(s.vector, true, at);
    unsigned first = 16;
    for (const Source& s : kVectors) {
      if (raised.icr < 0 || s.icr != raised.icr) continue;
      first = s.vector;
      break;
    }
    b.run(at + 10);
    EXPECT_EQ(b.m.pc(), b.handler(first)) << raised.vector;
  }
}

TEST(Vectors, NmiBeforeAllAndByTheChosenEdge) {
  for (const bool rising : {false, true}) {
    Bench b(2, 0xc0);
    b.m.io_write(0xffffc4, rising ? 0x0d : 0x09);
    b.m.set_nmi(!rising);
    b.run(b.m.cpu.now + 20);
    EXPECT_EQ(b.m.pc() >> 8, 0xffe2u);
    for (const Source& s : kVectors) b.m.irq.set(s.vector, true, b.m.cpu.now);
    const States at = b.m.cpu.now;
    b.m.set_nmi(rising);
    b.run(at + 12);
    EXPECT_EQ(b.m.pc(), b.handler(7));
  }
}

TEST(Vectors, AddressBreak) {
  for (const bool enabled : {false, true}) {
    Bench b;
    b.m.io_write(0xfffef5, 0xff);
    b.m.io_write(0xfffef6, 0xe2);
    b.m.io_write(0xfffef7, 0x21);  // bit 0 does not exist
    EXPECT_EQ(b.m.io_read(0xfffef7), 0x20);
    b.m.io_write(0xfffef4, enabled ? 1 : 0);
    b.run(b.m.cpu.now + 40);
    EXPECT_EQ(b.m.pc() == b.handler(27), enabled);
    if (!enabled) continue;
    const std::uint8_t* frame = b.m.memory_at(b.m.cpu.er[7]);
    EXPECT_EQ(frame[2] << 8 | frame[3], 0xe220 + 8);  // decided on while four nops run
    EXPECT_EQ(b.m.io_read(0xfffef4), 0x01);
  }
}

// IRQ sense modes: low level, falling, rising, both.
TEST(Vectors, IrqSenseModes) {
  for (unsigned sense = 0; sense < 4; ++sense) {
    for (unsigned n = 0; n < 3; ++n) {
      Bench b(2, 0x80);
      const unsigned bit = 2 - n, mask = 1u << n;
      b.m.set_input(4, bit, true);
      b.m.io_write(0xfffeed, static_cast<std::uint8_t>(sense << 2 * n));
      const auto flag = [&] { return (b.m.io_peek(0xfffeeb).value() & mask) != 0; };
      const auto clear = [&] {
        b.m.io_read(0xfffeeb);
        b.m.io_write(0xfffeeb, 0);
      };
      EXPECT_FALSE(flag());
      b.m.set_input(4, bit, false);
      EXPECT_EQ(flag(), sense != 2) << sense;
      clear();
      EXPECT_EQ(flag(), sense == 0);  // the level is still there
      b.m.set_input(4, bit, true);
      EXPECT_EQ(flag(), sense != 1);
      clear();
      EXPECT_FALSE(flag());
    }
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
