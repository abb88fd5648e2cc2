// Register tables against the corpus, which was transcribed from the published tables apart from them.
// SPDX-License-Identifier: Apache-2.0
#include "shared/feetech/registers.h"

#include <gtest/gtest.h>

#include <set>

#include "shared/feetech/corpus_testing.h"

namespace kaz::feetech {
namespace {

class Table : public testing::TestWithParam<std::string> {
 protected:
  const Model& model() const { return *find_model(GetParam()); }
};

TEST_P(Table, IsThatOfTheCorpus) {
  const auto rows = test::corpus_of(GetParam());
  ASSERT_EQ(rows.size(), model().registers.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const test::CorpusRow& row = rows[i];
    const Register& reg = model().registers[i];
    SCOPED_TRACE(row.what);
    EXPECT_EQ(reg.address, row.address);
    EXPECT_EQ(reg.size, row.size);
    EXPECT_EQ(reg.writable, row.writable);
    EXPECT_EQ(reg.eeprom, row.eeprom);
    EXPECT_EQ(reg.sign_bit, row.sign_bit);
    EXPECT_EQ(reg.initial, row.factory.value_or(reg.initial));
    if (!row.writable) continue;
    EXPECT_EQ(reg.min, row.min);
    // Besides its three states, torque_enable takes 128 as a command.
    EXPECT_EQ(reg.name == "torque_enable" ? 2 : reg.max, row.max);
  }
}

TEST_P(Table, RegistersDoNotOverlapAndHoldTheirRange) {
  std::set<int> taken;
  std::set<std::string_view> names;
  for (const Register& reg : model().registers) {
    SCOPED_TRACE(reg.name);
    EXPECT_TRUE(names.insert(reg.name).second);
    for (int k = 0; k < reg.size; ++k) EXPECT_TRUE(taken.insert(reg.address + k).second);
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

INSTANTIATE_TEST_SUITE_P(Models, Table, testing::Values("sts3215", "scs0009"));

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

TEST(Models, AreFoundByName) {
  EXPECT_EQ(models().size(), 2u);
  EXPECT_EQ(find_model("sts3215")->number, 777);
  EXPECT_EQ(find_model("sts9999"), nullptr);
}

}  // namespace
}  // namespace kaz::feetech
