// Register tables against the corpus, which was transcribed from the published tables apart from them.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_bus/registers.h"

#include <gtest/gtest.h>

#include <set>

#include "shared/servo_bus/corpus_testing.h"

namespace kaz::servo_bus {
namespace {

class Table : public testing::TestWithParam<std::string> {
 protected:
  const Model& model() const { return *find_model(GetParam()); }
};

TEST_P(Table, IsThatOfTheCorpus) {
  const auto rows = test::corpus_of(GetParam());
  int in_table = 0;
  for (const Register& reg : model().registers) in_table += reg.count;
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(in_table));
  for (const test::CorpusRow& row : rows) {
    SCOPED_TRACE(row.what);
    const Register* found = model().at(row.address);
    ASSERT_NE(found, nullptr);
    const Register& reg = *found;
    const int index = (row.address - reg.address) / reg.size;
    EXPECT_EQ(reg.address + index * reg.size, row.address);
    EXPECT_EQ(reg.size, row.size);
    EXPECT_EQ(reg.writable, row.writable);
    EXPECT_EQ(reg.eeprom, row.eeprom);
    EXPECT_EQ(reg.sign_bit, row.sign_bit);
    EXPECT_EQ(model().initial(reg, index), row.factory.value_or(model().initial(reg, index)));
    if (!row.writable) continue;
    EXPECT_EQ(reg.min, row.min);
    // Besides its three states, Feetech's takes 128 as a command.
    EXPECT_EQ(row.what == "torque switch" ? 2 : reg.max, row.max);
  }
}

TEST_P(Table, RegistersDoNotOverlapAndHoldTheirRange) {
  std::set<int> taken;
  std::set<std::string_view> names;
  for (const Register& reg : model().registers) {
    SCOPED_TRACE(reg.name);
    EXPECT_TRUE(names.insert(reg.name).second);
    for (int k = reg.address; k < reg.end(); ++k) EXPECT_TRUE(taken.insert(k).second);
    for (const int value : {reg.min, reg.max, reg.initial}) {
      const auto bytes = encode(model(), reg, value);
      EXPECT_EQ(bytes.size(), reg.size);
      EXPECT_EQ(decode(model(), reg, bytes), value);
    }
    EXPECT_FALSE(reg.source.empty());
    EXPECT_EQ(model().find(reg.name), &reg);
    EXPECT_EQ(model().at(reg.address), &reg);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Table,
                         testing::Values("sts3215", "scs0009", "xl330-m288", "xl330-m077",
                                         "xl430-w250", "xm430-w350"));

// Examples of the public sources: byte order and signs.
TEST(Values, ByteOrderAndSigns) {
  const Model &sts = *find_model("sts3215"), &scs = *find_model("scs0009");
  using Bytes = std::vector<std::uint8_t>;
  EXPECT_EQ(encode(sts, *sts.find("model"), 777), (Bytes{0x09, 0x03}));
  EXPECT_EQ(encode(scs, *scs.find("model"), 1284), (Bytes{0x05, 0x04}));
  // 1023 in the wrong order reads 65283.
  EXPECT_EQ(encode(scs, *scs.find("goal_position"), 1023), (Bytes{0x03, 0xFF}));
  // A load of 1042 is -18; an offset of -5 has bit 11.
  EXPECT_EQ(decode(sts, *sts.find("present_load"), Bytes{0x12, 0x04}), -18);
  EXPECT_EQ(encode(sts, *sts.find("position_offset"), -5), (Bytes{0x05, 0x08}));
  EXPECT_EQ(encode(sts, *sts.find("goal_speed"), -1000), (Bytes{0xE8, 0x83}));
  // 2114 does not fit below bit 11.
  EXPECT_EQ(
      decode(sts, *sts.find("position_offset"), encode(sts, *sts.find("position_offset"), 2114)),
      2047);
}

TEST(Values, TwosComplement) {
  const Model& xl330 = *find_model("xl330-m288");
  using Bytes = std::vector<std::uint8_t>;
  EXPECT_EQ(encode(xl330, *xl330.find("goal_current"), -2), (Bytes{0xFE, 0xFF}));
  EXPECT_EQ(encode(xl330, *xl330.find("homing_offset"), -1024), (Bytes{0x00, 0xFC, 0xFF, 0xFF}));
  EXPECT_EQ(decode(xl330, *xl330.find("present_position"), Bytes{0xFF, 0xFF, 0xFF, 0xFF}), -1);
  EXPECT_EQ(decode(xl330, *xl330.find("bus_watchdog"), Bytes{0xFF}), -1);
  EXPECT_EQ(encode(xl330, *xl330.find("present_input_voltage"), 50), (Bytes{0x32, 0x00}));
}

TEST(Values, OnlyThoseThatAreListed) {
  const Register& mode = *find_model("xl430-w250")->find("operating_mode");
  for (int value = -1; value < 20; ++value)
    EXPECT_EQ(mode.allows(value), value == 1 || value == 3 || value == 4 || value == 16) << value;
}

TEST(Models, AreFoundByName) {
  EXPECT_EQ(models().size(), 6u);
  EXPECT_EQ(find_model("sts3215")->number, 777);
  EXPECT_EQ(find_model("xl330-m077")->number, 1190);
  EXPECT_EQ(find_model("sts9999"), nullptr);
}

}  // namespace
}  // namespace kaz::servo_bus
