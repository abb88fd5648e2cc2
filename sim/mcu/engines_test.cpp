// The firmware image in the emulator, compared with the native engine.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "shared/flash/image.h"
#include "shared/servo/fields.h"
#include "sim/mcu/compare_testing.h"
#include "sim/mcu/compare_wire.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

std::unique_ptr<Mcu> started(Result<std::unique_ptr<Mcu>> mcu) {
  EXPECT_TRUE(mcu) << mcu.error().message;
  (*mcu)->set_analog(quiet_board);
  EXPECT_TRUE((*mcu)->run_until(100 * kMs));
  return std::move(*mcu);
}

std::unique_ptr<Mcu> h8() {
  return started(make_h8(KAZ_FIRMWARE_IMAGE));
}
std::unique_ptr<Mcu> native() {
  return started(make_native());
}

// Motor pins after the same requests, without multiplexer selects.
PinLevels after_requests(Mcu& mcu) {
  send(mcu, enable_frame(1, 0x3ffff));
  EXPECT_TRUE(mcu.run_until(mcu.now() + 10 * kMs));
  for (int j = 0; j < KZ_JOINTS; ++j) {
    send(mcu, target_frame(static_cast<std::uint8_t>(2 + j), j, 100 * (j % 3)));
    EXPECT_TRUE(mcu.run_until(mcu.now() + 10 * kMs));
  }
  EXPECT_TRUE(mcu.run_until(mcu.now() + 80 * kMs));
  PinLevels pins = mcu.pins();
  pins.p4 &= static_cast<std::uint8_t>(~KZ_P4_MUX_MASK);
  return pins;
}

TEST(Engines, PinsAgree) {
  const PinLevels from_h8 = after_requests(*h8()), from_native = after_requests(*native());
  EXPECT_EQ(from_h8.pw, from_native.pw);
  EXPECT_EQ(from_h8.tmo, from_native.tmo);
  EXPECT_EQ(from_h8.p3, from_native.p3);
  EXPECT_EQ(from_h8.p4, from_native.p4);
  EXPECT_EQ(from_h8.p5, from_native.p5);
  EXPECT_EQ(from_h8.p6, from_native.p6);
  EXPECT_TRUE(from_h8.p4 & KZ_P4_ENABLE);
  EXPECT_NE(from_h8.pw, (std::array<std::uint16_t, 16>{})) << "nothing was driven";
}

TEST(Engines, BytesTakeTheSameTime) {
  for (const auto& mcu : {h8(), native()}) {
    send(*mcu, frame_of(KZ_TYPE_state, 7, {}));
    ASSERT_TRUE(mcu->run_until(mcu->now() + 20 * kMs));
    const auto bytes = mcu->take_transmitted();
    ASSERT_EQ(bytes.size(), 53u) << mcu->name();
    for (std::size_t i = 1; i < bytes.size(); ++i)
      EXPECT_EQ(bytes[i].at - bytes[i - 1].at, KZ_STATES_PER_BYTE) << mcu->name() << ' ' << i;
    ASSERT_EQ(bodies_of(bytes).size(), 1u);
  }
}

// Runs until `states` after a tick became due, and at least 20 ms. Ticks count from the end of the start,
// most of which the chip spends on the CRC of its application: a time since power-on is at another place in
// the tick with each image. The place shows on the line: the first byte of a reply from an idle board begins
// 445 states after a tick (native_test.cpp, BytesLeaveBackToBack).
void run_into_tick(Mcu& mcu, States states) {
  mcu.take_transmitted();
  send(mcu, frame_of(KZ_TYPE_state, 99, {}));
  ASSERT_TRUE(mcu.run_until(mcu.now() + 20 * kMs));
  const auto bytes = mcu.take_transmitted();
  ASSERT_FALSE(bytes.empty()) << mcu.name();
  const States tick = bytes.front().at - KZ_STATES_PER_BYTE - 445;
  ASSERT_TRUE(mcu.run_until(tick + 20 * kMs + states));
}

// Inputs of each tick: bytes received, and room in the transmit ring, of which the channel holds two. Ticks
// count from the first that is recorded; how long the boards take to start is compared by CompareWire.
TEST(Engines, RingsAgree) {
  // A tick reads its ring 650 states after it became due. Requests begin so that this is midway between the
  // ends of their 4th and 5th byte, so both boards divide each request between the same two ticks.
  constexpr States request_at = kMs + 650 - KZ_STATES_PER_BYTE / 2 - 4 * KZ_STATES_PER_BYTE;
  std::vector<std::vector<std::array<int, 3>>> seen;
  for (const auto& mcu : {h8(), native()}) {
    ASSERT_NO_FATAL_FAILURE(run_into_tick(*mcu, request_at));
    auto& ticks = seen.emplace_back();
    std::optional<std::uint32_t> first;
    mcu->on_tick([&ticks, &first](const TickRecord& record) {
      first = first.value_or(record.input.tick);
      ticks.push_back({static_cast<int>(record.input.tick - *first), record.input.rx_count,
                       record.input.tx_room});
    });
    const States begin = mcu->now();
    for (std::uint8_t number = 0; number < 5; ++number) {
      send(*mcu, frame_of(KZ_TYPE_calibration, number, {}));
      ASSERT_TRUE(mcu->run_until(begin + (number + 1) * 12 * kMs));
    }
    mcu->on_tick(nullptr);
    ASSERT_GE(ticks.size(), 60u) << mcu->name();
    EXPECT_EQ(ticks[0][1], 4) << mcu->name() << ": a request does not begin where it should";
    EXPECT_EQ(ticks[1][1], 5) << mcu->name();
  }
  EXPECT_EQ(seen[0], seen[1]);
  int min_room = KZ_TX_BUFFER;
  for (const auto& tick : seen[0]) min_room = std::min(min_room, tick[2]);
  EXPECT_LT(min_room, KZ_TX_BUFFER - 12);
}

TEST(Engines, SampleEveryInputWithItsSelect) {
  for (const auto& mcu : {h8(), native()}) {
    mcu->set_analog([](int channel, const PinLevels& levels, States) {
      return ((channel < KZ_MUXES ? channel * 8 + (levels.p4 & 7) : 900 + channel) + 0.5) /
             KZ_POT_CODES;
    });
    kz_tick_input last{};
    mcu->on_tick([&last](const TickRecord& record) { last = record.input; });
    ASSERT_TRUE(mcu->run_until(mcu->now() + 5 * kMs));
    for (unsigned i = 0; i < KZ_ANALOG; ++i) {
      const unsigned code = i == KZ_ANALOG_YAW_RATE        ? 903
                            : i == KZ_ANALOG_FORWARD_FORCE ? 904
                            : i == KZ_ANALOG_LEFT_FORCE    ? 905
                                                           : i;
      EXPECT_EQ(last.analog[i], code) << mcu->name();
    }
    mcu->on_tick(nullptr);
  }
}

TEST(Engines, MotorsAreOffFromPowerOnUntilEnabled) {
  auto mcu = make_h8(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(mcu);
  (*mcu)->set_analog(quiet_board);
  bool enabled = false;
  (*mcu)->on_pins([&enabled](States, const PinLevels& pins) {
    enabled = enabled || (pins.p4 & KZ_P4_ENABLE) != 0;
  });
  ASSERT_TRUE((*mcu)->run_until(500 * kMs));
  EXPECT_FALSE(enabled);
}

TEST(Engines, PowerCycleStartsAnewAtTheSameTime) {
  auto mcu = h8();
  send(*mcu, enable_frame(1, 1));
  ASSERT_TRUE(mcu->run_until(mcu->now() + 10 * kMs));
  ASSERT_TRUE(mcu->pins().p4 & KZ_P4_ENABLE);
  const States before = mcu->now();
  mcu->power_cycle();
  EXPECT_EQ(mcu->now(), before);
  EXPECT_FALSE(mcu->pins().p4 & KZ_P4_ENABLE);
  ASSERT_TRUE(mcu->run_until(before + 100 * kMs));
  send(*mcu, frame_of(KZ_TYPE_state, 1, {}));
  ASSERT_TRUE(mcu->run_until(mcu->now() + 20 * kMs));
  const auto bytes = mcu->take_transmitted();
  ASSERT_FALSE(bytes.empty());
  EXPECT_GT(bytes.front().at, before);
}

// Four times 50,000 ticks; the long run is `kaz mcu compare --ticks 10000000`.
class CompareSeeds : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CompareSeeds, FindNoDifference) {
  CompareOptions options = firmware_comparison(50000);
  options.seed = GetParam();
  std::int64_t progress = 0;
  options.progress = [&progress](std::int64_t done, std::int64_t) { progress = done; };
  const CompareReport report = compare_or_fail(options);
  EXPECT_TRUE(report.equal()) << report.text();
  EXPECT_EQ(report.ticks, 50000);
  EXPECT_EQ(progress, 50000);
  // The comparison covered something: see the phases of RandomHost.
  EXPECT_GT(report.frames_sent_to_board, 1000);
  EXPECT_GT(report.bytes_received, 20000);
  EXPECT_GT(report.bytes_sent, 10000);
  EXPECT_GT(report.pins_compared, 45000);
  EXPECT_GT(report.coverage.replies.size(), 12u) << report.text();
  EXPECT_GT(report.coverage.refusals.size(), 6u) << report.text();
  EXPECT_GT(report.coverage.shutdowns.size(), 2u) << report.text();
  // It used the engine that every verb uses, and translated.
  EXPECT_EQ(report.engine, h8s::translator_available() ? "translator" : "interpreter");
  if (h8s::translator_available()) {
    EXPECT_GT(report.translated_instructions, report.instructions / 2) << report.text();
  }
}

INSTANTIATE_TEST_SUITE_P(Traffic, CompareSeeds, testing::Values(1, 2, 3, 4));

// The emulator's engines are equivalent: the same traffic gives equal results state by state.
TEST(Compare, TheEmulatorsEnginesSeeTheSame) {
  std::optional<CompareReport> first;
  for (const auto engine : {h8s::Engine::interpreter, h8s::Engine::translator}) {
    CompareOptions options = firmware_comparison(20000);
    options.engine = engine;
    const CompareReport report = compare_or_fail(options);
    EXPECT_TRUE(report.equal()) << report.text();
    if (!first) {
      first = report;
      EXPECT_EQ(report.engine, "interpreter");
      EXPECT_EQ(report.translated_instructions, 0);
      continue;
    }
    EXPECT_EQ(report.instructions, first->instructions);
    EXPECT_EQ(report.bytes_sent, first->bytes_sent);
    EXPECT_EQ(report.worst_busy_8states, first->worst_busy_8states);
    EXPECT_EQ(report.chip_s, first->chip_s);
  }
}

TEST(Compare, IsRepeatable) {
  const CompareOptions options = firmware_comparison(2000);
  const CompareReport first = compare_or_fail(options), second = compare_or_fail(options);
  EXPECT_GT(first.bytes_received, 0);
  EXPECT_EQ(first.bytes_received, second.bytes_received);
  EXPECT_EQ(first.bytes_sent, second.bytes_sent);
  EXPECT_EQ(first.worst_busy_8states, second.worst_busy_8states);
}

// The application's bytes in flash; the CRC of its header is put right when they are written back.
std::vector<std::uint8_t> application(H8Mcu& h8) {
  std::vector<std::uint8_t> bytes(
      h8.chip().peek32(KZ_APPLICATION_HEADER + offsetof(kz_image_header, length)).value_or(0));
  EXPECT_TRUE(h8.chip().peek(KZ_APPLICATION, bytes));
  return bytes;
}

void replace_application(H8Mcu& h8, std::vector<std::uint8_t> bytes) {
  const std::size_t crc_at =
      KZ_APPLICATION_HEADER - KZ_APPLICATION + offsetof(kz_image_header, crc);
  u16 crc = 0xFFFF;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (i != crc_at && i != crc_at + 1) crc = kz_crc16(crc, bytes[i]);
  bytes[crc_at] = static_cast<std::uint8_t>(crc >> 8);
  bytes[crc_at + 1] = static_cast<std::uint8_t>(crc);
  ASSERT_TRUE(h8.chip().poke(KZ_APPLICATION, bytes));
}

// An image of other sources as the header names them.
void plant_other_header(H8Mcu& h8) {
  auto bytes = application(h8);
  bytes[KZ_APPLICATION_HEADER - KZ_APPLICATION + offsetof(kz_image_header, build_id)] ^= 1;
  replace_application(h8, bytes);
}

TEST(Compare, RefusesAnImageOfOtherSourcesBeforeTheFirstTick) {
  char other[9], own[9];
  std::snprintf(own, sizeof own, "%08x", static_cast<unsigned>(kz_build_id));
  std::snprintf(other, sizeof other, "%08x", static_cast<unsigned>(kz_build_id ^ 0x01000000));
  CompareOptions options = firmware_comparison(1);
  options.prepare_h8 = plant_other_header;
  WireOptions wire;
  wire.image_path = KAZ_FIRMWARE_IMAGE;
  wire.conversations = 1;
  wire.prepare_h8 = plant_other_header;
  const auto ticks = compare_engines(options);
  const auto conversations = compare_wire(wire);
  for (const Error* error :
       {ticks ? nullptr : &ticks.error(), conversations ? nullptr : &conversations.error()}) {
    ASSERT_NE(error, nullptr) << "it was compared";
    EXPECT_EQ(error->fault, Fault::usage);
    for (const std::string& part :
         {std::string(KAZ_FIRMWARE_IMAGE), std::string("from other sources"),
          std::string("build ") + other, std::string("this program ") + own})
      EXPECT_NE(error->message.find(part), std::string::npos) << error->message;
  }
}

TEST(Compare, ADifferenceInAFrameIsNamedByMessageAndField) {
  CompareOptions options = firmware_comparison(2000);
  // The build id that the code puts into its reply, not the header's.
  options.prepare_h8 = [](H8Mcu& h8) {
    auto bytes = application(h8);
    std::array<std::uint8_t, 4> id{};
    for (int i = 0; i < 4; ++i) id[i] = static_cast<std::uint8_t>(kz_build_id >> (24 - 8 * i));
    const auto code = bytes.begin() + (KZ_APPLICATION_CODE - KZ_APPLICATION);
    const auto found = std::search(code, bytes.end(), id.begin(), id.end());
    ASSERT_NE(found, bytes.end());
    found[3] ^= 1;
    replace_application(h8, bytes);
  };
  const CompareReport report = compare_or_fail(options);
  ASSERT_FALSE(report.equal());
  EXPECT_EQ(report.differences.front().field, "identify_reply.build_id") << report.text();
  EXPECT_EQ(report.differences.front().native, std::int64_t{kz_build_id}) << report.text();
  EXPECT_EQ(report.text().find("sender.body"), std::string::npos) << report.text();
}

TEST(Compare, NeedsSymbols) {
  const auto alone =
      std::filesystem::temp_directory_path() / ("kaz-alone-" + std::to_string(::getpid()) + ".mot");
  std::filesystem::copy_file(KAZ_FIRMWARE_IMAGE, alone,
                             std::filesystem::copy_options::overwrite_existing);
  CompareOptions options;
  options.image_path = alone.string();
  const auto report = compare_engines(options);
  std::filesystem::remove(alone);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::usage);
  EXPECT_NE(report.error().message.find(".coff"), std::string::npos);
}

TEST(Compare, SaysWhatIsWrongWithAFile) {
  CompareOptions options;
  options.image_path = "/nonexistent/kaz.mot";
  const auto report = compare_engines(options);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::usage);
  EXPECT_NE(report.error().message.find("/nonexistent/kaz.mot"), std::string::npos);
}

}  // namespace
}  // namespace kaz::sim
