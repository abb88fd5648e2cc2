// The firmware on the emulated chip: start, tick, line, loader, watchdog, what a tick costs.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/image_testing.h"
#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "sim/h8s/chip/chip.h"
#include "sim/mcu/h8_layout.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/walking_load_testing.h"

namespace kaz::sim {
namespace {

constexpr States ms = KZ_STATES_PER_TICK;
constexpr u32 all_joints = (1u << KZ_JOINTS) - 1;

class Firmware : public testing::Test {
 protected:
  void SetUp() override {
    auto loaded = H8Mcu::load(firmware_image());
    ASSERT_TRUE(loaded) << loaded.error().message;
    mcu = std::move(*loaded);
    mcu->set_analog([this](int channel, const PinLevels& levels, States at) {
      const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
      if (input == KZ_ANALOG_SUPPLY) return 667.5 / KZ_POT_CODES;
      return 0.5 + swing * std::sin(6.0 * static_cast<double>(at) / KZ_CLOCK_HZ + input);
    });
  }

  void run(States states) {
    const auto ran = mcu->run_until(mcu->now() + states);
    ASSERT_TRUE(ran) << ran.error().message;
  }

  void send(u8 type, const std::vector<u8>& fields) {
    std::vector<u8> body = {KZ_ADDRESS_DEFAULT, type, ++sequence};
    body.insert(body.end(), fields.begin(), fields.end());
    u8 wire[KZ_FRAME_MAX];
    const int length = kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire);
    wire_free = std::max(wire_free, mcu->now());
    for (int i = 0; i < length; ++i) {
      wire_free += KZ_STATES_PER_BYTE;
      mcu->receive({wire[i], wire_free, false});
    }
  }
  void enable(u32 mask) {
    const kz_enable request = {.mask = mask};
    std::vector<u8> fields(KZ_SIZE_enable);
    kz_pack_enable(&request, fields.data());
    send(KZ_TYPE_enable, fields);
  }
  void walk(double phase) {
    kz_targets request = {};
    request.mask = all_joints;
    request.duration_ms = 10;
    for (int i = 0; i < KZ_JOINTS; ++i) {
      const int middle = (kz_board_joints[i].lower + kz_board_joints[i].upper) / 2;
      request.angle[i] = static_cast<s16>(middle + std::lround(1000 * std::sin(phase + i)));
    }
    std::vector<u8> fields(KZ_SIZE_targets);
    fields.resize(kz_pack_targets(&request, fields.data()));
    send(KZ_TYPE_targets, fields);
  }

  h8s::Chip& chip() { return mcu->chip(); }
  u32 address_of(const char* symbol) { return chip().symbols().address_of(symbol).value(); }

  std::unique_ptr<H8Mcu> mcu;
  double swing = 0;
  u8 sequence = 0;
  States wire_free = 0;
};

TEST_F(Firmware, TicksEveryMillisecondToTheState) {
  std::vector<States> at;
  chip().set_hook(address_of("kz_clock_interrupt"), [&](h8s::Chip& here) {
    at.push_back(here.now());
    return h8s::HookAction::go_on;
  });
  run(200 * ms);
  ASSERT_GT(at.size(), 100u);
  // The requests are 18,432 states apart; each waits for the end of an instruction, or wakes the
  // CPU.
  for (std::size_t i = 1; i < at.size(); ++i)
    EXPECT_NEAR(static_cast<double>(at[i] - at[0]),
                static_cast<double>(ms) * static_cast<double>(i), 40);
}

TEST_F(Firmware, IsUpWithin100MsAndKeepsTheMotorsOff) {
  bool ticked = false;
  mcu->on_tick([&](const TickRecord&) { ticked = true; });
  mcu->on_pins([&](States, const PinLevels& pins) {
    EXPECT_EQ(pins.p4 & KZ_P4_ENABLE, 0);
    EXPECT_EQ(*std::max_element(pins.pw.begin(), pins.pw.end()), 0);
  });
  run(100 * ms);
  EXPECT_TRUE(ticked);
}

TEST_F(Firmware, AnswersAt115200BaudWithTheImagesCrc) {
  run(100 * ms);
  send(KZ_TYPE_identify, {});
  run(10 * ms);
  const auto bytes = mcu->take_transmitted();
  ASSERT_EQ(bytes.size(), 1u + 1 + 3 + KZ_SIZE_identify_reply + 3 + 1);
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  u8 last = KZ_RECEIVE_MORE;
  for (const SerialByte& byte : bytes) last = kz_receive(&receiver, byte.value, 0);
  ASSERT_EQ(last, KZ_RECEIVE_FRAME);
  kz_identify_reply identity;
  ASSERT_EQ(kz_unpack_identify_reply(&identity, receiver.body + KZ_HEADER_SIZE,
                                     static_cast<u8>(receiver.length - KZ_HEADER_SIZE)),
            1);
  EXPECT_EQ(identity.image_crc, chip().peek16(0x11FE));  // of the header (shared/flash/image.h)
  EXPECT_EQ(identity.reset_cause, KZ_RESET_POWER);
  // Within a tick's bytes there is no gap.
  EXPECT_EQ(bytes[5].at - bytes[0].at, 5 * KZ_STATES_PER_BYTE);
}

TEST_F(Firmware, DrivesTheMotorsOfMovedJoints) {
  run(100 * ms);
  enable(all_joints);
  run(5 * ms);
  for (int i = 0; i < 10; ++i) {
    walk(0.5);
    run(10 * ms);
  }
  const PinLevels& pins = mcu->pins();
  EXPECT_NE(pins.p4 & KZ_P4_ENABLE, 0);
  // Expected duty: kp times the control error, target minus the joint's angle, which is mid-scale.
  const auto duty = [](int joint, double kp_per_rad) {
    const int target = (kz_board_joints[joint].lower + kz_board_joints[joint].upper) / 2 +
                       static_cast<int>(std::lround(1000 * std::sin(0.5 + joint)));
    const int error = target - kz_pot_angle(&kz_board_joints[joint], 512);
    return std::min(255.0, std::abs(error) * kp_per_rad * 255 / KZ_ANGLE_PER_RAD);
  };
  EXPECT_NEAR(pins.pw[0], duty(0, 16), 1.0);
  EXPECT_NEAR(pins.pw[1], duty(1, 16), 1.0);
  EXPECT_NEAR(pins.tmo[0], duty(5, 0.8), 1.0);
}

TEST_F(Firmware, ADamagedApplicationIsNotStarted) {
  for (const u32 address : {0x1000u, 0x11E0u, 0x11E4u, 0x11ECu, 0x1200u, 0x1800u}) {
    chip().power_on();
    chip().poke(address, static_cast<u8>(*chip().peek(address) ^ 1));
    const auto stop = chip().run_until(chip().now() + 100 * ms);
    // The flash writer waits in RAM.
    EXPECT_EQ(stop.reason, h8s::Stop::Reason::reached) << std::hex << address;
    EXPECT_GE(chip().registers().pc, 0xFFE080u) << std::hex << address;
    EXPECT_EQ(chip().output(h8s::Port::p4).driven, 0);
    chip().poke(address, static_cast<u8>(*chip().peek(address) ^ 1));
  }
}

TEST_F(Firmware, AHangingTickIsResetWithTheMotorsOff) {
  run(100 * ms);
  enable(1);
  run(5 * ms);
  ASSERT_NE(mcu->pins().p4 & KZ_P4_ENABLE, 0);
  const u32 endless = address_of("kz_unexpected");
  chip().set_hook(address_of("kz_joint_loop"), [&](h8s::Chip& here) {
    auto registers = here.registers();
    registers.pc = endless;
    here.set_registers(registers);
    here.clear_hook(address_of("kz_joint_loop"));
    return h8s::HookAction::go_on;
  });
  run(9 * ms);
  EXPECT_EQ(mcu->pins().p4 & KZ_P4_ENABLE, 0);
  EXPECT_EQ(chip().reset_cause(), h8s::ResetCause::watchdog);
  run(100 * ms);
  const auto found = mcu->global("kz_startup_found", h8_layout::kStartupSize);
  const u8 cause =
      h8_layout::decode_startup(std::span<const u8, h8_layout::kStartupSize>(found)).reset_cause;
  EXPECT_EQ(cause, KZ_RESET_WATCHDOG);
}

// Eighteen loops closed, targets and states at 100 Hz.
TEST_F(Firmware, WalkingLoadFitsTheTick) {
  WalkingLoad load(*mcu);
  const auto walks = load.start();
  ASSERT_TRUE(walks) << walks.error().message;
  std::vector<int> busy;
  int missed = 0;
  mcu->on_tick([&](const TickRecord& tick) {
    busy.push_back(tick.input.busy_8states * 8);
    missed += tick.input.missed;
  });
  // The joints' loop alone, interrupts included, from its first instruction to its return.
  std::vector<States> loops;
  std::optional<u32> back;
  chip().set_hook(address_of("kz_joint_loop"), [&](h8s::Chip& here) {
    loops.push_back(-here.now());
    if (!back) {
      back = here.peek32(here.registers().er[7]).value() & 0xffffff;
      here.set_hook(*back, [&](h8s::Chip& returned) {
        loops.back() += returned.now();
        return h8s::HookAction::go_on;
      });
    }
    return h8s::HookAction::go_on;
  });
  const auto is_hand = [](int joint) { return joint == 5 || joint == 9; };  // soft on purpose
  double largest_error = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto ran = load.millisecond();
    ASSERT_TRUE(ran) << ran.error().message;
    for (int j = 0; j < KZ_JOINTS; ++j)
      if (!is_hand(j)) largest_error = std::max(largest_error, load.error(j));
  }
  EXPECT_LT(largest_error, 0.15) << "the loops do not follow";
  EXPECT_GT(load.bytes_from_board(), 300 * 53);  // a state reply has 53 bytes
  ASSERT_GT(busy.size(), 2900u);
  std::sort(busy.begin(), busy.end());
  const int median = busy[busy.size() / 2], worst = busy.back();
  std::printf("tick: median %d states (%.1f %%), worst %d (%.1f %%)\n", median, 100.0 * median / ms,
              worst, 100.0 * worst / ms);
  std::sort(loops.begin(), loops.end());
  ASSERT_GT(loops.size(), 2900u);
  std::printf("of it the joints' loop: median %d states\n",
              static_cast<int>(loops[loops.size() / 2]));
  EXPECT_EQ(missed, 0);
  EXPECT_LT(worst, ms * 75 / 100);
  // The inertial inputs cost 60 states of each tick. Tick times are bimodal: up to 8,200 states, and from
  // 8,400 on if bytes come. On which side of the gap the median lies depends on where in a tick the host
  // sends, and so on the size of the image, whose CRC delays the start.
  EXPECT_LT(median, ms * 47 / 100);
  for (const h8s::Misuse& misuse : chip().misuse()) ADD_FAILURE() << misuse.text;
}

TEST_F(Firmware, TheStackStaysInsideTheBoundOfTheBuild) {
  std::map<std::string, u32> sizes;
  std::ifstream file(KAZ_FIRMWARE_SIZES);
  for (std::string name; file >> name;) file >> sizes[name];
  ASSERT_GT(sizes["stack"], 0u);

  run(100 * ms);
  enable(all_joints);
  for (int i = 0; i < 100; ++i) {
    walk(i);
    send(KZ_TYPE_state, {});
    run(10 * ms);
  }
  // RAM was filled with 0xa5 at power-on: the lowest byte that changed is the deepest the stack
  // was.
  constexpr u32 ram = 0xFFE080, top = 0xFFF000;
  u32 lowest = ram + sizes["data"];
  while (lowest < top && chip().peek(lowest) == 0xA5) ++lowest;
  std::printf("stack: %u bytes used of at most %u\n", top - lowest, sizes["stack"]);
  EXPECT_GT(top - lowest, 100u);
  EXPECT_LE(top - lowest, sizes["stack"]);
}

}  // namespace
}  // namespace kaz::sim
