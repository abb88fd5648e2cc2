// Frames that the flash writer has to refuse, and what it does with them: the running program, the
// protected blocks and the rest of the flash stay as they are.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "shared/flash/protocol.h"
#include "tools/fuzz/flash_writer/writer_board.h"

namespace kaz::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr auto kMs = WriterBoard::kMillisecond;
constexpr std::uint32_t kFlash = 0x20000;

// A board, and what its writer and flash were like at first.
struct Flasher {
  explicit Flasher(WriterStart start) : board(start) {}

  int status(std::uint8_t type, const Bytes& payload) {
    answer = board.request(type, payload);
    EXPECT_EQ(board.failure(), "");
    return answer ? answer->status() : -1;
  }
  int write(std::uint32_t at, const Bytes& data) {
    Bytes payload;
    put_number(payload, at, 4);
    payload.insert(payload.end(), data.begin(), data.end());
    return status(KZ_WRITER_WRITE, payload);
  }
  // The line that the last answer names.
  int line() const { return answer->payload[2] << 8 | answer->payload[3]; }
  bool alive() { return status(KZ_WRITER_INFO, {}) == KZ_WRITER_OK; }
  Bytes program() const { return board.memory(kWriterRam, writer_program().size()); }
  Bytes flash() const { return board.memory(0, kFlash); }

  WriterBoard board;
  std::optional<WriterAnswer> answer;
};

Bytes part(std::uint32_t from, std::uint32_t to) {
  return {writer_program().begin() + (from - kWriterRam),
          writer_program().begin() + (to - kWriterRam)};
}

TEST(WriterFrames, ALoadersWriterRefusesEveryWriteToRam) {
  for (const std::uint32_t at :
       {kWriterRam, kWriterRam + 0x200, writer_second_stage() - 32, writer_second_stage(),
        writer_program_end() - 32, writer_program_end(), 0xffef00u, 0xff0000u, 0xffff80u}) {
    for (const std::size_t size : {std::size_t{32}, std::size_t{512}}) {
      Flasher to(WriterStart::loader);
      // TRAPA #0: nothing goes on where it stands.
      Bytes hostile(size);
      for (std::size_t k = 0; k < size; ++k) hostile[k] = k % 2 ? 0x00 : 0x57;
      EXPECT_EQ(to.write(at, hostile), KZ_WRITER_PROTECTED) << std::hex << at;
      EXPECT_EQ(to.program(), writer_program()) << std::hex << at;
      EXPECT_TRUE(to.alive()) << std::hex << at;
    }
  }
  Flasher to(WriterStart::loader);
  EXPECT_EQ(
      to.write(writer_second_stage(), part(writer_second_stage(), writer_second_stage() + 32)),
      KZ_WRITER_PROTECTED)
      << "of the very bytes that stand there";
}

TEST(WriterFrames, AfterBootModeTheSecondStageAloneAndInOrder) {
  const std::uint32_t first = writer_second_stage(), end = writer_program_end();
  Flasher to(WriterStart::boot);
  const Bytes before = to.program();
  const Bytes line(32, 0x57);
  EXPECT_EQ(to.write(kWriterRam, line), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.write(first - 32, Bytes(64, 0x57)), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.write(0xff0000, line), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.write(end, line), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.write(end - 32, Bytes(64, 0x57)), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.write(first + 32, part(first + 32, first + 64)), KZ_WRITER_ARGUMENTS) << "a gap";
  EXPECT_EQ(to.status(KZ_WRITER_ERASE, {4}), KZ_WRITER_UNKNOWN) << "not there yet";
  EXPECT_EQ(to.program(), before);

  EXPECT_EQ(to.write(first, part(first, first + 64)), KZ_WRITER_OK);
  EXPECT_EQ(to.write(first, part(first, first + 64)), KZ_WRITER_OK) << "its reply was lost";
  EXPECT_EQ(to.write(first, line), KZ_WRITER_PROTECTED) << "other bytes";
  EXPECT_EQ(to.write(first + 32, part(first + 32, first + 128)), KZ_WRITER_OK) << "overlapping";
  for (std::uint32_t at = first + 128; at < end;) {
    const std::uint32_t size = std::min(end - at, 512u);
    EXPECT_EQ(to.write(at, part(at, at + size)), KZ_WRITER_OK);
    at += size;
  }
  EXPECT_EQ(to.program(), writer_program());

  for (std::uint32_t at = kWriterRam; at < end + 64; at += 32)
    EXPECT_EQ(to.write(at, line), KZ_WRITER_PROTECTED) << std::hex << at;
  EXPECT_EQ(to.write(end - 256, part(end - 256, end)), KZ_WRITER_OK) << "its reply was lost";
  EXPECT_EQ(to.program(), writer_program());
  EXPECT_EQ(to.status(KZ_WRITER_ERASE, {4}), KZ_WRITER_OK);
}

TEST(WriterFrames, AWriteStaysWithinTheFlash) {
  for (const WriterStart start : {WriterStart::loader, WriterStart::boot_complete}) {
    Flasher to(start);
    const Bytes before = to.flash();
    EXPECT_EQ(to.write(kFlash - 64, Bytes(96, 0)), KZ_WRITER_ARGUMENTS);
    for (const std::uint32_t at : {kFlash, 0x00fe0000u, 0x01002000u, 0x80002000u, 0xff00e080u,
                                   0x01ffe080u, 0xffffe080u, 0xffffffe0u})
      EXPECT_EQ(to.write(at, Bytes(512, 0)), KZ_WRITER_ARGUMENTS) << std::hex << at;
    for (const std::uint32_t at : {0x2001u, 0x2002u, 0x2010u, 0xffe081u})
      EXPECT_EQ(to.write(at, Bytes(32, 0)), KZ_WRITER_ARGUMENTS) << std::hex << at;
    for (const std::size_t size : {1u, 31u, 33u, 511u})
      EXPECT_EQ(to.write(0x2000, Bytes(size, 0)), KZ_WRITER_ARGUMENTS) << size;
    EXPECT_TRUE(to.alive());
    EXPECT_EQ(to.flash(), before);
    EXPECT_EQ(to.program(), writer_program());
    EXPECT_TRUE(to.board.chip().misuse().empty());
  }
}

TEST(WriterFrames, AWriteIntoAProtectedBlockEndsAtItsBound) {
  Flasher to(WriterStart::loader);
  for (const std::uint32_t at : {0x0u, 0x3e0u, 0xc000u, 0xdfe0u})
    EXPECT_EQ(to.write(at, Bytes(32, 0)), KZ_WRITER_PROTECTED) << std::hex << at;
  EXPECT_EQ(to.write(0xbfe0, Bytes(64, 0)), KZ_WRITER_PROTECTED);
  EXPECT_EQ(to.line(), 0xc000);
  EXPECT_EQ(to.board.memory(0xbfe0, 32), Bytes(32, 0));
  for (const std::uint8_t block : {0, 6})
    EXPECT_EQ(to.status(KZ_WRITER_ERASE, {block}), KZ_WRITER_PROTECTED);
  Flasher fresh(WriterStart::loader);
  EXPECT_EQ(to.board.memory(0xc000, 0x2000), fresh.board.memory(0xc000, 0x2000));
  EXPECT_EQ(to.board.memory(0, 0x400), fresh.board.memory(0, 0x400));
  for (const int block : {0, 6})
    EXPECT_EQ(
        to.board.chip().flash_statistics().blocks[static_cast<std::size_t>(block)].program_pulses,
        0);
}

TEST(WriterFrames, TheLineThatCannotBeWrittenIsNamed) {
  Flasher to(WriterStart::loader);
  // Of these the third is programmed already (writer_board.cpp).
  EXPECT_EQ(to.write(0x1ffa0, Bytes(96, 0xf0)), KZ_WRITER_NOT_BLANK);
  EXPECT_EQ(to.line(), 0xffe0);
  EXPECT_EQ(to.write(0x18000, Bytes(64, 0xf0)), KZ_WRITER_OK);
}

// What an earlier frame left behind the payload is no argument.
TEST(WriterFrames, ShortAndLongPayloadsAreRefused) {
  const Bytes five = {0x05, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
  const std::array<std::pair<std::uint8_t, std::size_t>, 4> wanted = {
      {{KZ_WRITER_RATE, 1}, {KZ_WRITER_ERASE, 1}, {KZ_WRITER_SUM, 8}, {KZ_WRITER_READ, 6}}};
  for (const auto& [type, length] : wanted) {
    for (std::size_t k = 0; k < 12; ++k) {
      if (k == length) continue;
      Flasher to(WriterStart::loader);
      const Bytes before = to.flash();
      // Both of the writer's frames hold it.
      for (int n = 0; n < 2; ++n) to.status(KZ_WRITER_INFO, five);
      EXPECT_EQ(to.status(type, Bytes(five.begin(), five.begin() + static_cast<long>(k))),
                KZ_WRITER_ARGUMENTS)
          << "type " << int{type} << ", " << k << " bytes";
      EXPECT_EQ(to.flash(), before) << "type " << int{type} << ", " << k << " bytes";
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    Flasher to(WriterStart::boot_complete);
    const Bytes before = to.flash();
    EXPECT_EQ(to.status(KZ_WRITER_WRITE, Bytes(k, 0)), KZ_WRITER_ARGUMENTS) << k;
    EXPECT_TRUE(to.alive());
    EXPECT_EQ(to.flash(), before);
    EXPECT_EQ(to.program(), writer_program());
  }
}

TEST(WriterFrames, RatesThatItCannotKeepAreRefused) {
  for (const std::uint8_t brr : {0, 3, 120, 255}) {
    Flasher to(WriterStart::loader);
    EXPECT_EQ(to.status(KZ_WRITER_RATE, {brr}), KZ_WRITER_ARGUMENTS) << int{brr};
    EXPECT_EQ(to.board.chip().peek(0xffffd9), KZ_WRITER_BRR_MIN);
    EXPECT_TRUE(to.alive());
  }
  for (const std::uint8_t brr : {KZ_WRITER_BRR_MIN, 9, 59, KZ_WRITER_BRR_MAX}) {
    Flasher to(WriterStart::boot);
    EXPECT_EQ(to.status(KZ_WRITER_RATE, {brr}), KZ_WRITER_OK) << int{brr};
    to.board.run(kMs);
    EXPECT_EQ(to.board.chip().peek(0xffffd9), brr);
    EXPECT_TRUE(to.alive());
  }
}

// On a shared line a writer hears replies, its own among them: answered, they would go on for ever.
TEST(WriterFrames, RepliesAreNotAnswered) {
  Flasher to(WriterStart::loader);
  EXPECT_TRUE(to.alive());
  for (const int type :
       {KZ_WRITER_REPLY | KZ_WRITER_WRITE, KZ_WRITER_REPLY | KZ_WRITER_INFO, 0xff}) {
    to.board.send(writer_frame(static_cast<std::uint8_t>(type), 7, Bytes{0, 0}));
    to.board.run(60 * kMs);
    EXPECT_FALSE(to.board.take_answer()) << type;
  }
  EXPECT_TRUE(to.alive());
}

TEST(WriterFrames, AReportOfDamageHasNumberZero) {
  Flasher to(WriterStart::loader);
  EXPECT_TRUE(to.alive());
  EXPECT_TRUE(to.alive());
  Bytes frame = writer_frame(KZ_WRITER_INFO, 77, {});
  frame.back() ^= 1;
  to.board.send(frame);
  to.board.run(60 * kMs);
  const auto report = to.board.take_answer();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->type, KZ_WRITER_REPLY);
  EXPECT_EQ(report->status(), KZ_WRITER_DAMAGED);
  EXPECT_EQ(report->number, 0);
  EXPECT_FALSE(to.board.take_answer());
}

}  // namespace
}  // namespace kaz::fuzz
