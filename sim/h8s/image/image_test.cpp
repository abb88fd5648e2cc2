// Image loaders: valid files, damaged files, and the locations in error messages.
// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

// Checksums by hand: one's complement of the sum of length, address and data.
TEST(SRecord, ReadsAllAddressWidths) {
  // S1 03 bytes+...: 07 + 00+00 + 00+00+10+00 = 0x17 -> E8.
  const auto image = parse_srecord(
      "S0030000FC\nS107000000001000E8\r\nS205010000AA4F\nS30600020000BB3C\nS5030003F9\nS804001000EB"
      "\n",
      "t.srec");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  ASSERT_EQ(image->segments.size(), 3u);
  EXPECT_EQ(image->segments[0].bytes, (std::vector<std::uint8_t>{0x00, 0x00, 0x10, 0x00}));
  EXPECT_EQ(image->segments[1].load_address, 0x010000u);
  EXPECT_EQ(image->segments[2].load_address, 0x00020000u);
  EXPECT_EQ(image->entry, 0x001000u);
}

TEST(SRecord, ErrorsNameLineAndFault) {
  struct Case {
    const char* text;
    const char* message;
  };
  const Case cases[] = {
      {"S107000000001000E9\nS9030000FC\n", "t.srec:1: wrong checksum"},
      {"S0030000FC\nS108000000001000E8\n", "t.srec:2: length byte"},
      {"S10700000000100xE8\n", "t.srec:1: column 15"},
      {"S4030000FC\n", "unknown record type S4"},
      {"hello\n", "t.srec:1: not an S-record"},
      {"S107000000001000E8\n", "no end record"},
      {"S9030000FC\n", "no data records"},
      {"S107000000001000E8\nS5030002FA\n", "record count is 2, but the file has 1"},
      {"S107000000001000E8\nS9030000FC\nS9030000FC\n", "t.srec:3: record after the end"},
      {"S101FE\n", "too short"},
      {"S1\n", "not an S-record"},
      {"", "no data records"},
  };
  for (const Case& c : cases) {
    const auto image = parse_srecord(c.text, "t.srec");
    ASSERT_FALSE(image.has_value()) << c.text;
    EXPECT_NE(image.error().message.find(c.message), std::string::npos) << image.error().message;
  }
}

TEST(SRecord, LinesEndWithLfOrCrLfOrCr) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string first = "S0030000FC" + end + "S107000000001000E8" + end;
    for (const std::string& last : {"S9030000FC" + end, std::string("S9030000FC")}) {
      const auto image = parse_srecord(first + end + last, "t.srec");
      ASSERT_TRUE(image.has_value()) << image.error().message;
      ASSERT_EQ(image->segments.size(), 1u);
      EXPECT_EQ(image->segments[0].bytes, (std::vector<std::uint8_t>{0, 0, 0x10, 0}));
    }
    const auto bad = parse_srecord(first + end + "S9030000FD" + end, "t.srec");
    ASSERT_FALSE(bad.has_value());
    EXPECT_EQ(bad.error().message, "t.srec:4: wrong checksum");
    const auto cut = parse_srecord(first + "S90300", "t.srec");
    ASSERT_FALSE(cut.has_value());
    EXPECT_EQ(cut.error().message,
              "t.srec:3: length byte is 3, but the line has 1 bytes; the file ends within this "
              "line: it seems cut off");
  }
}

TEST(SRecord, RepeatedBytesMustBeEqual) {
  const std::string first = "S107000000001000E8\n", end = "S9030000FC\n";
  // Repeats addresses 1 and 2; repeats address 3 and adds 4.
  const auto equal = parse_srecord(first + "S10500010010E9\nS105000300AA4D\n" + end, "t.srec");
  ASSERT_TRUE(equal.has_value()) << equal.error().message;
  ASSERT_EQ(equal->segments.size(), 1u);
  EXPECT_EQ(equal->segments[0].bytes, (std::vector<std::uint8_t>{0, 0, 0x10, 0, 0xaa}));
  const auto other = parse_srecord(first + "S10500010011E8\n" + end, "t.srec");
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().message,
            "t.srec:2: address 000002 gets the value 11, but an earlier record has set it to 10; "
            "remove one of these records");
}

TEST(SRecord, BytesBelowAnEarlierRecordMustAgreeWithIt) {
  const std::string first = "S1050010AABB85\n", end = "S9030000FC\n";
  const auto equal = parse_srecord(first + "S107000E0102AABB82\n" + end, "t.srec");
  ASSERT_TRUE(equal.has_value()) << equal.error().message;
  ASSERT_EQ(equal->segments.size(), 2u);
  EXPECT_EQ(equal->segments[1].load_address, 0xeu);
  EXPECT_EQ(equal->segments[1].bytes, (std::vector<std::uint8_t>{1, 2}));
  const auto other = parse_srecord(first + "S107000E0102AABC81\n" + end, "t.srec");
  ASSERT_FALSE(other.has_value());
  EXPECT_NE(other.error().message.find("t.srec:2: address 000011 gets the value bc"),
            std::string::npos)
      << other.error().message;
  const auto beyond = parse_srecord("S307FFFFFFFFAABB97\n" + end, "t.srec");
  ASSERT_FALSE(beyond.has_value());
  EXPECT_NE(beyond.error().message.find("end beyond ffffffff"), std::string::npos);
  EXPECT_TRUE(parse_srecord("S306FFFFFFFFAA53\n" + end, "t.srec").has_value());
}

TEST(Load, RefusesWhatDoesNotFitTheFlash) {
  Chip chip;
  Image image;
  image.segments.push_back({0x1ffff, 0x1ffff, "tail", {1, 2}});
  const auto ok = chip.load(image);
  ASSERT_FALSE(ok.has_value());
  EXPECT_NE(ok.error().message.find("tail"), std::string::npos);
  EXPECT_FALSE(load_image("/nonexistent/image").has_value());
}

void put16(std::vector<std::uint8_t>& b, unsigned v) {
  b.push_back(static_cast<std::uint8_t>(v >> 8));
  b.push_back(static_cast<std::uint8_t>(v));
}
void put32(std::vector<std::uint8_t>& b, std::uint32_t v) {
  put16(b, v >> 16);
  put16(b, v & 0xffff);
}
void put_name(std::vector<std::uint8_t>& b, std::string name) {
  name.resize(8, '\0');
  b.insert(b.end(), name.begin(), name.end());
}

// One .text of four bytes at 0x400 with a function `_main` that begins in line 10 of m.c and has a
// second line at 0x402. Offsets: header 0, optional 20, section 48, contents 88, lines 92, symbols
// 108.
std::vector<std::uint8_t> small_coff() {
  std::vector<std::uint8_t> b;
  put16(b, 0x8302), put16(b, 1), put32(b, 0), put32(b, 108), put32(b, 6), put16(b, 28), put16(b, 2);
  for (int k = 0; k < 4; ++k) put32(b, 0);
  put32(b, 0x400), put32(b, 0), put32(b, 0);
  put_name(b, ".text"), put32(b, 0x400), put32(b, 0x400), put32(b, 4), put32(b, 88), put32(b, 0);
  put32(b, 92), put16(b, 0), put16(b, 2), put32(b, 0x20);
  put32(b, 0x00005470);
  put32(b, 2), put32(b, 0), put32(b, 0x402), put32(b, 2);  // line entries
  put_name(b, ".file"), put32(b, 0), put16(b, 0xfffe), put16(b, 0), b.push_back(103),
      b.push_back(1);
  put_name(b, "m.c"), put32(b, 0), put32(b, 0), put16(b, 0);
  put_name(b, "_main"), put32(b, 0x400), put16(b, 1), put16(b, 0x24), b.push_back(2),
      b.push_back(1);
  put32(b, 0), put32(b, 4), put32(b, 0), put32(b, 0), put16(b, 0);  // of four bytes
  put_name(b, ".bf"), put32(b, 0x400), put16(b, 1), put16(b, 0), b.push_back(101), b.push_back(1);
  put32(b, 0), put16(b, 10), put32(b, 0), put32(b, 0), put32(b, 0);
  put32(b, 4);  // empty string table
  return b;
}

TEST(Coff, SymbolsAndLines) {
  const auto image = parse_coff(small_coff(), "t.coff");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_EQ(image->entry, 0x400u);
  ASSERT_EQ(image->segments.size(), 1u);
  EXPECT_EQ(image->symbols.address_of("main"), 0x400u);
  EXPECT_EQ(image->symbols.address_of("_main"), 0x400u);
  EXPECT_FALSE(image->symbols.address_of("other").has_value());
  EXPECT_EQ(image->symbols.describe(0x400), "_main (m.c:10)");
  EXPECT_EQ(image->symbols.describe(0x402), "_main+0x2 (m.c:11)");
  EXPECT_EQ(image->symbols.describe(0x100), "0x000100");
  ASSERT_NE(image->symbols.at(0x400), nullptr);
  EXPECT_EQ(image->symbols.at(0x400)->size, 4u);
}

TEST(Coff, DamageIsReportedNotFollowed) {
  const std::vector<std::uint8_t> good = small_coff();
  for (std::size_t cut = 0; cut < good.size(); ++cut) {
    const std::vector<std::uint8_t> part(good.begin(),
                                         good.begin() + static_cast<std::ptrdiff_t>(cut));
    const auto image = parse_coff(part, "t.coff");
    if (cut < 108 + 6 * 18) {
      ASSERT_FALSE(image.has_value()) << cut;
      EXPECT_NE(image.error().message.find("offset"), std::string::npos);
    }
  }
  std::mt19937 random(1);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> bad = good;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    const auto image = parse_coff(bad, "t.coff");
    if (image) image->symbols.describe(0x402);
  }
  std::vector<std::uint8_t> elf = good;
  elf[0] = 0x7f;
  EXPECT_NE(parse_coff(elf, "t.coff").error().message.find("magic"), std::string::npos);
}

}  // namespace
}  // namespace kaz::h8s::testing
