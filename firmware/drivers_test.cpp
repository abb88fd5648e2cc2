// The drivers of serial line, converter, clock and outputs, on the emulated chip.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "firmware/chip_testing.h"
#include "shared/board/table.h"
#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

class LateTick : public TestChip {
 protected:
  static constexpr std::uint32_t delay = 0x1E000;  // flash that the image does not use

  // The tick that begins takes so much longer, in a loop of 3 states a round before the joints' loop.
  void delay_tick(States states) {
    const std::uint32_t loop = address_of("kz_joint_loop");
    const auto rounds = static_cast<std::uint16_t>(states / 3);
    std::vector<u8> code = {0x79, 0x02, 0,    0,     // mov.w #rounds,r2
                            0x1b, 0x52, 0x46, 0xfc,  // dec.w #1,r2; bne
                            0x5a, 0,    0,    0};    // jmp @kz_joint_loop
    code[2] = static_cast<u8>(rounds >> 8);
    code[3] = static_cast<u8>(rounds);
    for (unsigned i = 0; i < 3; ++i) code[9 + i] = static_cast<u8>(loop >> (16 - 8 * i));
    ASSERT_TRUE(chip().poke(delay, code));
    chip().set_hook(loop, [loop](h8s::Chip& here) {
      auto registers = here.registers();
      registers.pc = delay;
      here.set_registers(registers);
      here.clear_hook(loop);
      return h8s::HookAction::go_on;
    });
  }
  // Snapshots of a delayed tick and of those that follow it.
  std::vector<kz_tick_input> after_delay(States states) {
    std::vector<kz_tick_input> inputs;
    EXPECT_GE(run_to("kz_tick_begin"), 0);
    delay_tick(states);
    mcu->on_tick([&inputs](const TickRecord& tick) { inputs.push_back(tick.input); });
    run(6 * ms + states);
    mcu->on_tick([](const TickRecord&) {});
    return inputs;
  }
};

// A tick is measured from when it was due. One that is due meanwhile begins late, more of them are missed.
TEST_F(LateTick, IsMeasuredInFullAndCounted) {
  run(100 * ms);
  for (const int ticks : {0, 1, 2, 3}) {
    const int delayed = static_cast<int>(ticks * ms + ms / 4);
    const auto inputs = after_delay(delayed);
    ASSERT_GE(inputs.size(), 3u);
    // The A/D interrupts during the delay come on top.
    const int usual = inputs[0].busy_8states * 8, busy = inputs[1].busy_8states * 8;
    const int late = busy - static_cast<int>(ticks * ms);
    EXPECT_NEAR(busy, usual + delayed, 1000) << ticks;
    EXPECT_EQ(inputs[1].missed, std::max(0, ticks - 1)) << ticks;
    EXPECT_EQ(inputs[1].tick, inputs[0].tick + static_cast<unsigned>(std::max(1, ticks))) << ticks;
    EXPECT_EQ(inputs[2].missed, 0) << ticks;
    EXPECT_NEAR(inputs[2].busy_8states * 8, ticks == 0 ? usual : usual + late, 1000) << ticks;
    EXPECT_EQ(inputs[2].worst_8states, inputs[1].busy_8states) << ticks;
  }
}

// The compare match comes around the reading of the counter, with the interrupt held off: 3 states apart.
TEST_F(LateTick, IsMeasuredRightWhereItEndsAsTheNextIsDue) {
  run(100 * ms);
  int early = 0, late = 0;
  for (int delayed = 13'900; delayed < 14'200; delayed += 3) {
    const auto inputs = after_delay(delayed);
    ASSERT_GE(inputs.size(), 3u);
    const int usual = inputs[0].busy_8states * 8, busy = inputs[1].busy_8states * 8;
    ASSERT_NEAR(busy, usual + delayed, 1000) << delayed;
    ++(busy < ms ? early : late);
  }
  EXPECT_GT(early, 20);
  EXPECT_GT(late, 20);
}

// The ring takes 64 bytes; of more than 48 that wait only the last 16 are certain to be whole.
TEST_F(LateTick, ReportsThatBytesWereLost) {
  run(100 * ms);
  for (const bool many : {false, true}) {
    std::vector<u8> bytes;
    for (int i = 1; i <= (many ? 85 : 40); ++i) bytes.push_back(static_cast<u8>(i));
    sim::send(*mcu, bytes);
    const auto inputs = after_delay(5 * ms);
    ASSERT_GE(inputs.size(), 4u);
    const int before = inputs[0].rx_count;  // the delayed tick took these
    EXPECT_EQ(inputs[1].rx_count, KZ_RX_PER_TICK);
    EXPECT_EQ(inputs[1].rx_flags[0], many ? KZ_RX_LOST : 0);
    if (many) {
      EXPECT_GT(inputs[1].rx[0], before + 48 - KZ_RX_PER_TICK);
    } else {
      EXPECT_EQ(inputs[1].rx[0], before + 1);
    }
    for (int i = 1; i < KZ_RX_PER_TICK; ++i) {
      EXPECT_EQ(inputs[1].rx[i], inputs[1].rx[i - 1] + 1);
      EXPECT_EQ(inputs[1].rx_flags[i], 0);
    }
    EXPECT_EQ(inputs[2].rx[0], inputs[1].rx[KZ_RX_PER_TICK - 1] + 1);
    EXPECT_EQ(inputs[2].rx_flags[0], 0) << "reported once";
    run(20 * ms);
  }
}

// The non-maskable interrupt has no purpose on this board.
class Received : public TestChip {
 protected:
  // Sends 1, 2, 3, ...; those in `damaged` with a framing error. All that the snapshots hold of them.
  struct Byte {
    int value, flags;
  };
  std::vector<Byte> snapshots_of(int count, const std::set<int>& damaged, States longest) {
    std::vector<Byte> bytes;
    mcu->on_tick([&bytes](const TickRecord& tick) {
      for (int i = 0; i < tick.input.rx_count; ++i)
        bytes.push_back({tick.input.rx[i], tick.input.rx_flags[i]});
    });
    States at = mcu->now();
    for (int value = 1; value <= count; ++value) {
      at += KZ_STATES_PER_BYTE;
      mcu->receive({static_cast<u8>(value), at, damaged.contains(value)});
    }
    run(longest);
    mcu->on_tick([](const TickRecord&) {});
    return bytes;
  }
};

// The ring goes round once: a flag of its first turn must not stand beside a byte of the second.
TEST_F(Received, FlagsStandBesideTheirBytesAlone) {
  run(100 * ms);
  const std::set<int> damaged = {1, 66};
  const auto bytes = snapshots_of(90, damaged, 20 * ms);
  ASSERT_EQ(bytes.size(), 90u);
  for (int i = 0; i < 90; ++i) {
    EXPECT_EQ(bytes[i].value, i + 1);
    EXPECT_EQ(bytes[i].flags != 0, damaged.contains(i + 1)) << i + 1;
  }
}

// Interrupts held off for three bytes' time: the second byte is an overrun, the first is taken once.
TEST_F(Received, ByteBeforeAnOverrunIsTakenOnce) {
  run(100 * ms);
  ASSERT_GE(run_to("kz_tick_begin"), 0);
  constexpr std::uint32_t free_flash = 0x1E000;
  const std::uint32_t loop = address_of("kz_joint_loop");
  std::vector<u8> code = {0x04, 0x80, 0x79, 0x02, 5000 / 3 >> 8, 5000 / 3 & 0xff,  // orc; mov.w
                          0x1b, 0x52, 0x46, 0xfc, 0x06,          0x7f,
                          0x5a, 0,    0,    0};  // dec, bne, andc, jmp
  for (unsigned i = 0; i < 3; ++i) code[13 + i] = static_cast<u8>(loop >> (16 - 8 * i));
  ASSERT_TRUE(chip().poke(free_flash, code));
  chip().set_hook(loop, [loop](h8s::Chip& here) {
    auto registers = here.registers();
    registers.pc = free_flash;
    here.set_registers(registers);
    here.clear_hook(loop);
    return h8s::HookAction::go_on;
  });
  const auto bytes = snapshots_of(8, {}, 10 * ms);
  ASSERT_GE(bytes.size(), 5u);
  EXPECT_LT(bytes.size(), 8u) << "nothing was overrun";
  int flagged = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i > 0) {
      EXPECT_GT(bytes[i].value, bytes[i - 1].value);
    }
    flagged += bytes[i].flags == KZ_RX_OVERRUN;
  }
  EXPECT_EQ(flagged, 1);
}

using Analog = TestChip;

// Every input of the multiplexers and of the inertial option has a level of its own.
TEST_F(Analog, CodesStandWhereTheirInputsAre) {
  const auto code_of = [](int index) { return 40 * index + 50; };
  mcu->set_analog([&](int channel, const PinLevels& levels, States) {
    int index = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
    if (channel == 3) index = KZ_ANALOG_YAW_RATE;
    if (channel == 4) index = KZ_ANALOG_FORWARD_FORCE;
    if (channel == 5) index = KZ_ANALOG_LEFT_FORCE;
    return (code_of(index) + 0.5) / KZ_POT_CODES;
  });
  run(100 * ms);
  const kz_tick_input snapshot = input();
  for (int i = 0; i < KZ_ANALOG; ++i) EXPECT_EQ(snapshot.analog[i], code_of(i)) << i;
  expect_no_misuse();
}

using Unexpected = TestChip;

TEST_F(Unexpected, InterruptSwitchesTheMotorsOffAndResets) {
  run(100 * ms);
  sim::send(*mcu, enable_frame(1, 1));
  run(5 * ms);
  ASSERT_NE(mcu->pins().p4 & KZ_P4_ENABLE, 0);
  chip().set_nmi(false);
  run(ms / 16);
  EXPECT_EQ(mcu->pins().p4 & KZ_P4_ENABLE, 0) << "at once, not by the watchdog";
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::power_on);
  run(9 * ms);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::watchdog);
}

using Outputs = TestChip;

// Of the PWM timer and of the 8-bit timers (docs/reference/firmware.md).
TEST_F(Outputs, HavePeriodsOf72And36KHz) {
  run(100 * ms);
  EXPECT_EQ(mcu->pins().tmo[0], 0) << "duty 0 is no pulse";
  EXPECT_EQ(mcu->pins().tmo[1], 0);
  // Joints 0, 5 and 9 stand on PW0, TMO0 and TMO1. Off their targets they are driven at less than full duty.
  sim::send(*mcu, enable_frame(1, 1u << 0 | 1u << 5 | 1u << 9));
  run(5 * ms);
  for (const int joint : {0, 5, 9}) {
    const int angle = kz_pot_angle(&kz_board_joints[joint], 512);
    sim::send(*mcu, target_frame(static_cast<u8>(2 + joint), joint, angle + 250));
    run(5 * ms);
  }
  run(20 * ms);
  const int duty = mcu->pins().pw[0];
  ASSERT_TRUE(duty >= 16 && duty <= 240) << duty << " counts make fewer than 16 pulses";
  std::map<h8s::Pin, int> rising;
  for (const h8s::Pin pin : {h8s::Pin::p10, h8s::Pin::p64, h8s::Pin::p67}) {
    chip().watch(pin, [&rising, pin](const h8s::PinEdge& edge) { rising[pin] += edge.level; });
  }
  run(10 * ms);
  EXPECT_NEAR(rising[h8s::Pin::p10], 720, 2);
  EXPECT_NEAR(rising[h8s::Pin::p64], 360, 2);
  EXPECT_NEAR(rising[h8s::Pin::p67], 360, 2);
}

}  // namespace
}  // namespace kaz::sim
