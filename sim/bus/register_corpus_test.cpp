// The register corpus on the wire: default, range, access and persistence of every register of both models.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo_bus/corpus_testing.h"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using servo_bus::Register;
using servo_bus::test::CorpusRow;

class Corpus : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    for (const CorpusRow& row : servo_bus::test::corpus_of(GetParam())) rows_.push_back(row);
    fresh();
  }
  void TearDown() override { RecordProperty("cases", cases_); }
  void fresh() {
    bus_ = bus_of({1}, GetParam());
    host_ = std::make_unique<BusHost>(*bus_);
    bus_->advance(std::chrono::milliseconds(3));
  }
  // As the corpus describes the register: the table that the servo is made of is not looked at.
  Register of(const CorpusRow& row) const {
    Register reg;
    reg.address = row.address;
    reg.size = row.size;
    reg.sign_bit = row.sign_bit;
    return reg;
  }
  std::optional<int> read(const CorpusRow& row, int id = 1) {
    ++cases_;
    const auto bytes = host_->read(id, row.address, row.size);
    if (!bytes) return std::nullopt;
    return servo_bus::decode(*servo_bus::find_model(GetParam()), of(row), *bytes);
  }
  bool write(const CorpusRow& row, int value, int id = 1) {
    Bytes parameters{static_cast<std::uint8_t>(row.address)};
    for (const auto b : servo_bus::encode(*servo_bus::find_model(GetParam()), of(row), value))
      parameters.push_back(b);
    return host_
               ->send(
                   feetech::request(static_cast<std::uint8_t>(id), Instruction::write, parameters))
               .size() == 1;
  }
  // These change how, or whether, the servo is heard; tests of their own have them.
  bool of_the_line(const CorpusRow& row) const {
    return row.what == "ID" || row.what == "baud rate" || row.what.starts_with("response");
  }
  int lock_address() const { return GetParam() == "sts3215" ? 55 : 48; }
  void unlock() {
    host_->send(
        feetech::request(1, Instruction::write, {static_cast<std::uint8_t>(lock_address()), 0}));
  }
  void power_cycle() {
    bus_->set_power(false);
    bus_->advance(bus_->time() + std::chrono::milliseconds(10));
    bus_->set_power(true);
  }
  int other(const CorpusRow& row) const { return row.factory == row.max ? row.min : row.max; }

  std::vector<CorpusRow> rows_;
  int cases_ = 0;
  std::unique_ptr<VirtualBus> bus_;
  std::unique_ptr<BusHost> host_;
};

TEST_P(Corpus, FactoryValues) {
  for (const CorpusRow& row : rows_) {
    const auto value = read(row);
    ASSERT_TRUE(value) << row.what;
    if (row.factory) {
      EXPECT_EQ(*value, *row.factory) << row.what;
    }
  }
}

TEST_P(Corpus, RangesAreKept) {
  for (const CorpusRow& row : rows_) {
    if (!row.writable || of_the_line(row)) continue;
    fresh();
    const int top = (1 << (row.sign_bit != 0 ? row.sign_bit : 8 * row.size)) - 1;
    for (const int value : {row.max, row.min, (row.max + row.min) / 2}) {
      EXPECT_TRUE(write(row, value)) << row.what;
      EXPECT_EQ(read(row), value) << row.what;
    }
    // torque switch 128 is a command, and all above 2 is undefined.
    if (row.max < top && row.what != "torque switch") {
      EXPECT_TRUE(write(row, row.max + 1)) << row.what;
      EXPECT_EQ(read(row), row.max) << row.what << ", above its range";
    }
    if (row.sign_bit != 0 && row.min > -top) {
      EXPECT_TRUE(write(row, row.min - 1)) << row.what;
      EXPECT_EQ(read(row), row.min) << row.what << ", below its range";
    }
    if (row.sign_bit == 0 && row.min > 0) {
      EXPECT_TRUE(write(row, row.min - 1)) << row.what;
      EXPECT_EQ(read(row), row.min) << row.what << ", below its range";
    }
  }
}

TEST_P(Corpus, ReadOnlyRegistersStay) {
  for (const CorpusRow& row : rows_) {
    if (row.writable) continue;
    const auto before = read(row);
    EXPECT_TRUE(write(row, 1)) << row.what;
    EXPECT_TRUE(write(row, 0)) << row.what;
    EXPECT_EQ(read(row), before) << row.what;
  }
}

TEST_P(Corpus, WithoutPowerEepromStaysIfUnlocked) {
  for (const bool unlocked : {false, true}) {
    for (const CorpusRow& row : rows_) {
      if (!row.writable || of_the_line(row) || row.what == "lock") continue;
      fresh();
      if (unlocked) unlock();
      EXPECT_TRUE(write(row, other(row))) << row.what;
      EXPECT_EQ(read(row), other(row)) << row.what;
      power_cycle();
      EXPECT_EQ(read(row), unlocked && row.eeprom ? other(row) : *row.factory) << row.what;
    }
  }
}

TEST_P(Corpus, IdIsKeptAndTakesEffect) {
  const CorpusRow& id = *std::ranges::find(rows_, "ID", &CorpusRow::what);
  for (const int value : {0, 100, 253}) {
    fresh();
    unlock();
    EXPECT_TRUE(write(id, value));
    EXPECT_EQ(read(id, value), value);
    power_cycle();
    EXPECT_EQ(read(id, value), value);
  }
}

TEST_P(Corpus, RatesTakeEffect) {
  const CorpusRow& rate = *std::ranges::find(rows_, "baud rate", &CorpusRow::what);
  const long bauds[] = {1000000, 500000, 250000, 128000, 115200, 76800, 57600, 38400};
  for (int code = 0; code < 8; ++code) {
    fresh();
    EXPECT_TRUE(write(rate, code));
    bus_->set_host_baud(bauds[code]);
    EXPECT_EQ(
        host_->send(feetech::request(1, Instruction::ping), std::chrono::milliseconds(10)).size(),
        1u)
        << code;
    ++cases_;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Corpus, testing::Values("sts3215", "scs0009"));

}  // namespace
}  // namespace kaz::sim
