// Intel HEX, ELF and raw images: valid files, damaged files, and the locations in error messages.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>

#include "shared/image/image.h"

namespace kaz::h8s {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Checksums by hand: two's complement of the sum of all bytes.
TEST(IntelHex, ReadsEveryRecordType) {
  const auto image = parse_intel_hex(
      ":0400000000001000EC\r\n"  // 4 bytes at 0
      ":020000021000EC\n"        // segment 1000: + 0x10000
      ":02FFFF00AABB9B\n"        // its last byte, then its first: offsets wrap
      ":02000004000EEC\n"        // linear 000E: + 0xE0000
      ":01000100CC32\n"          // 1 byte at 0xE0001
      ":04000005000123458E\n"    // entry 0x012345
      ":00000001FF\n",
      "t.hex");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  ASSERT_EQ(image->segments.size(), 4u);
  EXPECT_EQ(image->segments[0].bytes, (Bytes{0, 0, 0x10, 0}));
  EXPECT_EQ(image->segments[1].run_address, 0x1ffffu);
  EXPECT_EQ(image->segments[1].bytes, Bytes{0xaa});
  EXPECT_EQ(image->segments[2].run_address, 0x10000u);
  EXPECT_EQ(image->segments[2].bytes, Bytes{0xbb});
  EXPECT_EQ(image->segments[3].load_address, 0xe0001u);
  EXPECT_EQ(image->entry, 0x012345u);
  // Start address as segment and offset: 0x1000 * 16 + 0x234.
  const auto other = parse_intel_hex(":0100000055AA\n:0400000310000234B3\n:00000001FF\n", "t.hex");
  ASSERT_TRUE(other.has_value()) << other.error().message;
  EXPECT_EQ(other->entry, 0x10234u);
}

TEST(IntelHex, ErrorsNameLineAndFault) {
  struct Case {
    const char* text;
    const char* message;
  };
  const Case cases[] = {
      {":0100000055AB\n", "t.hex:1: wrong checksum"},
      {":0100000055AA\n:0200000055AA\n", "t.hex:2: length byte is 2, but the line has 1"},
      {":01000000G5AA\n", "t.hex:1: column 10"},
      {":0100000055A\n", "odd number"},
      {":000000\n", "too short"},
      {"S9\n", "colon"},
      {":00000006FA\n", "unknown record type 6"},
      {":0100000400FB\n", "record type 4 has 1 bytes of data, 2 expected"},
      {":00000001FF\n:00000001FF\n", "t.hex:2: record after the end"},
      {":0100000055AA\n", "no end record"},
      {":00000001FF\n", "no data records"},
      {"", "no data records"},
  };
  for (const Case& c : cases) {
    const auto image = parse_intel_hex(c.text, "t.hex");
    ASSERT_FALSE(image.has_value()) << c.text;
    EXPECT_NE(image.error().message.find(c.message), std::string::npos) << image.error().message;
  }
}

TEST(IntelHex, LinesMayEndWithCrAlone) {
  const auto image = parse_intel_hex(":0100000055AA\r:00000001FF\r", "t.hex");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->segments[0].bytes, Bytes{0x55});
  const auto bad = parse_intel_hex(":0100000055AA\r:00000001FE\r", "t.hex");
  ASSERT_FALSE(bad.has_value());
  EXPECT_EQ(bad.error().message, "t.hex:2: wrong checksum");
}

TEST(IntelHex, RepeatedBytesMustBeEqual) {
  const std::string first = ":0400000000001000EC\n", end = ":00000001FF\n";
  const auto equal = parse_intel_hex(first + ":020001000010ED\n" + end, "t.hex");
  ASSERT_TRUE(equal.has_value()) << equal.error().message;
  ASSERT_EQ(equal->segments.size(), 1u);
  EXPECT_EQ(equal->segments[0].bytes, (Bytes{0, 0, 0x10, 0}));
  const auto other = parse_intel_hex(first + ":020001000011EC\n" + end, "t.hex");
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().message,
            "t.hex:2: address 000002 gets the value 11, but an earlier record has set it to 10; "
            "remove one of these records");
  // Segment 1000: offset ffff wraps to offset 0, which the record before has set.
  const auto wrapped =
      parse_intel_hex(":020000021000EC\n:01000000CC33\n:02FFFF00AABB9B\n" + end, "t.hex");
  ASSERT_FALSE(wrapped.has_value());
  EXPECT_NE(wrapped.error().message.find("t.hex:3: address 010000 gets the value bb"),
            std::string::npos)
      << wrapped.error().message;
}

void put16(Bytes& b, unsigned v) {
  b.push_back(static_cast<std::uint8_t>(v >> 8));
  b.push_back(static_cast<std::uint8_t>(v));
}
void put32(Bytes& b, std::uint32_t v) {
  put16(b, v >> 16);
  put16(b, v & 0xffff);
}
void put_words(Bytes& b, std::initializer_list<std::uint32_t> words) {
  for (const std::uint32_t w : words) put32(b, w);
}

// Header 0, one program header 52, contents of .text 84 and .data 88, symbols 92, names 140, section
// headers 160. .data runs at 0xffe080 and is loaded behind .text.
Bytes small_elf() {
  Bytes b = {0x7f, 'E', 'L', 'F', 1, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  put16(b, 2), put16(b, 46), put32(b, 1), put32(b, 0x402), put32(b, 52), put32(b, 160);
  put32(b, 0x00820000), put16(b, 52), put16(b, 32), put16(b, 1), put16(b, 40), put16(b, 5);
  put16(b, 4);
  put_words(b, {1, 84, 0x400, 0x400, 8, 8, 7, 2});
  put32(b, 0x00005470), put32(b, 0x11223344);
  put_words(b, {0, 0, 0, 0});
  put_words(b, {1, 0x402, 2}), b.push_back(0x12), b.push_back(0), put16(b, 1);  // _main, function
  put_words(b, {7, 0xffe080, 4}), b.push_back(0x11), b.push_back(0), put16(b, 2);  // data
  const char names[20] = "\0_main\0_x\0.t\0.d\0.s";
  b.insert(b.end(), names, names + 20);
  put_words(b, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  put_words(b, {10, 1, 6, 0x400, 84, 4, 0, 0, 2, 0});
  put_words(b, {13, 1, 3, 0xffe080, 88, 4, 0, 0, 2, 0});
  put_words(b, {16, 2, 0, 0, 92, 48, 4, 0, 4, 16});
  put_words(b, {16, 3, 0, 0, 140, 20, 0, 0, 1, 0});
  return b;
}

TEST(Elf, SectionsEntryAndSymbols) {
  const auto image = parse_elf(small_elf(), "t.elf");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->entry, 0x402u);
  EXPECT_FALSE(image->normal_mode);
  ASSERT_EQ(image->segments.size(), 2u);
  EXPECT_EQ(image->segments[0].name, ".t");
  EXPECT_EQ(image->segments[0].run_address, 0x400u);
  EXPECT_EQ(image->segments[0].bytes, (Bytes{0, 0, 0x54, 0x70}));
  EXPECT_EQ(image->segments[1].run_address, 0xffe080u);
  EXPECT_EQ(image->segments[1].load_address, 0x404u);
  EXPECT_EQ(image->symbols.address_of("main"), 0x402u);
  EXPECT_EQ(image->symbols.address_of("x"), 0xffe080u);
  EXPECT_EQ(image->symbols.at(0x402)->size, 2u);
  EXPECT_EQ(image->symbols.at(0xffe080)->size, 0u) << "of data";
}

TEST(Elf, SegmentsWhereThereAreNoSections) {
  Bytes b = small_elf();
  b[48] = b[49] = 0;
  const auto image = parse_elf(b, "t.elf");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  ASSERT_EQ(image->segments.size(), 1u);
  EXPECT_EQ(image->segments[0].run_address, 0x400u);
  EXPECT_EQ(image->segments[0].bytes.size(), 8u);
}

// The sizes of the program header are at 52 + 16 (p_filesz) and 52 + 20 (p_memsz).
TEST(Elf, SegmentsMustFitTheMemory) {
  const auto message = [](std::uint32_t address, std::uint32_t memory_size, bool sections) {
    Bytes b = small_elf(), fields;
    put_words(fields, {address, address, 8, memory_size});
    std::copy(fields.begin(), fields.end(), b.begin() + 52 + 8);
    if (!sections) b[48] = b[49] = 0;
    const auto image = parse_elf(b, "t.elf");
    return image ? "" : image.error().message;
  };
  for (const bool sections : {true, false}) {
    EXPECT_EQ(message(0x400, 8, sections), "");
    EXPECT_EQ(message(0x400, 7, sections),
              "t.elf: at offset 0x34: the segment at address 0x400 has p_memsz 0x7: must be at "
              "least its p_filesz 0x8; link the program again");
    EXPECT_EQ(message(0x400, 0x1000000 - 0x400, sections), "");
    for (const std::uint32_t size : {0x1000000u - 0x3ff, 0x7fffffffu, 0xffffffffu})
      EXPECT_NE(message(0x400, size, sections).find("must end at or below 0xffffff"),
                std::string::npos);
    EXPECT_EQ(message(0xfffffff8, 8, sections),
              "t.elf: at offset 0x34: the segment at address 0xfffffff8 has p_memsz 0x8: must end "
              "at or below 0xffffff, the last address of the chip; check the linker script");
  }
}

TEST(Elf, ErrorsSayWhatIsExpected) {
  struct Case {
    std::size_t at;
    std::uint8_t value;
    const char* message;
  };
  for (const Case& c : {Case{4, 2, "32-bit"},
                        {5, 1, "big-endian"},
                        {19, 3, "46"},
                        {17, 1, "not been linked"},
                        {35, 0xff, "outside the file"},
                        {160 + 40 + 18, 0xff, "contents of .t lie outside"}}) {
    Bytes b = small_elf();
    b[c.at] = c.value;
    const auto image = parse_elf(b, "t.elf");
    ASSERT_FALSE(image.has_value()) << c.message;
    EXPECT_NE(image.error().message.find(c.message), std::string::npos) << image.error().message;
    EXPECT_NE(image.error().message.find("t.elf: at offset"), std::string::npos);
  }
}

TEST(Elf, DamageIsReportedNotFollowed) {
  const Bytes good = small_elf();
  for (std::size_t cut = 0; cut < good.size(); ++cut)
    EXPECT_FALSE(parse_elf(std::span(good).first(cut), "t.elf").has_value()) << cut;
  std::mt19937 random(1);
  for (int round = 0; round < 20'000; ++round) {
    Bytes bad = good;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    const auto image = parse_elf(bad, "t.elf");
    if (image) image->symbols.describe(0x402);
  }
}

class Loading : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }
  const std::string& file(const Bytes& bytes) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    return path_;
  }
  std::string path_ = ::testing::TempDir() + "kaz_formats_test_image";
};

TEST_F(Loading, ReportsTheFormatByTheContents) {
  EXPECT_EQ(load_image(file(small_elf()))->entry, 0x402u);
  const std::string hex = ":0100000055AA\n:00000001FF\n";
  EXPECT_EQ(load_image(file({hex.begin(), hex.end()}))->segments.size(), 1u);
  const auto neither = load_image(file({1, 2, 3}));
  ASSERT_FALSE(neither.has_value());
  EXPECT_NE(neither.error().message.find("--format raw"), std::string::npos);
}

TEST_F(Loading, RawNeedsAnAddressAndHasItAsEntry) {
  const auto none = load_image(file({1, 2, 3}), {Format::raw, std::nullopt});
  ASSERT_FALSE(none.has_value());
  EXPECT_NE(none.error().message.find("--at"), std::string::npos);
  const auto image = load_image(path_, {Format::raw, 0x400});
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->entry, 0x400u);
  EXPECT_EQ(image->segments[0].bytes, (Bytes{1, 2, 3}));
  EXPECT_FALSE(load_image(path_, {Format::raw, 0xfffffe}).has_value());
}

}  // namespace
}  // namespace kaz::h8s
