// The register corpus of DYNAMIXEL on the wire: default, range, access and persistence of every register.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo_bus/corpus_testing.h"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using servo_bus::Register;
using servo_bus::test::CorpusRow;

constexpr int kRange = 4, kLength = 5, kLimit = 6, kAccess = 7;

class DynamixelCorpus : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    rows_ = servo_bus::test::corpus_of(GetParam());
    fresh();
  }
  void TearDown() override { RecordProperty("cases", cases_); }
  void fresh() {
    bus_ = bus_of({1}, GetParam());
    host_.emplace(*bus_);
    bus_->advance(std::chrono::milliseconds(3));
  }
  // As the corpus describes the register: the table that the servo is made of is not looked at.
  static Register of(const CorpusRow& row) {
    Register reg;
    reg.address = row.address;
    reg.size = row.size;
    reg.sign_bit = row.sign_bit;
    return reg;
  }
  const servo_bus::Model& model() const { return *servo_bus::find_model(GetParam()); }
  std::optional<int> read(const CorpusRow& row) {
    ++cases_;
    const auto bytes = host_->read(1, row.address, row.size);
    if (!bytes || bytes->size() != row.size) return std::nullopt;
    return servo_bus::decode(model(), of(row), *bytes);
  }
  // Error of the answer, without the alert that a low limit of temperature brings.
  int write(const CorpusRow& row, int value) {
    ++cases_;
    const int error = host_->write(1, row.address, servo_bus::encode(model(), of(row), value));
    return error < 0 ? error : error & ~dynamixel::kAlert;
  }
  // These change how, or whether, the servo is heard; dynamixel_servo_test.cpp has them.
  static bool of_the_line(const CorpusRow& row) {
    return row.what == "ID" || row.what == "Baud Rate" || row.what == "Status Return Level";
  }
  static bool is_indirect(const CorpusRow& row) { return row.what.starts_with("Indirect"); }
  // Values between are not all allowed.
  static bool is_choice(const CorpusRow& row) {
    return row.what == "Operating Mode" || row.what == "Protocol Type";
  }
  // Limited by another register, which has the corpus's range from the factory, or less.
  int limit_of(const CorpusRow& row) const {
    static const std::map<std::string, std::string> kLimits{
        {"Goal PWM", "PWM Limit"},
        {"Goal Current", "Current Limit"},
        {"Goal Velocity", "Velocity Limit"},
        {"Goal Position", "Max Position Limit"}};
    const auto found = kLimits.find(row.what);
    if (found == kLimits.end()) return -1;
    return *std::ranges::find(rows_, found->second, &CorpusRow::what)->factory;
  }
  // What could be set while the torque is off, and is not what it is from the factory.
  int other(const CorpusRow& row) const {
    if (row.what == "Operating Mode") return 16;
    if (row.what == "Protocol Type") return row.max;
    if (const int limit = limit_of(row); limit >= 0) return limit / 2;
    return row.factory == row.max ? row.min : row.max;
  }
  std::vector<CorpusRow> rows_;
  int cases_ = 0;
  std::unique_ptr<VirtualBus> bus_;
  std::optional<DynamixelHost> host_;
};

TEST_P(DynamixelCorpus, FactoryValues) {
  for (const CorpusRow& row : rows_) {
    // The bus of these tests is at 1 Mbaud.
    const auto value = row.what == "Baud Rate"
                           ? VirtualServo::make(model(), 1)->registers().get("baud_rate")
                           : read(row);
    ASSERT_TRUE(value) << row.what;
    if (row.factory) {
      EXPECT_EQ(*value, *row.factory) << row.what;
    }
  }
  EXPECT_GE(cases_, 100);
}

TEST_P(DynamixelCorpus, RangesAreKept) {
  for (const CorpusRow& row : rows_) {
    if (!row.writable || of_the_line(row) || limit_of(row) >= 0) continue;
    fresh();
    // Last of them the least: an indirect address that points at itself again.
    std::vector<int> values{row.max, row.min};
    if (!is_choice(row)) values.push_back((row.max + row.min) / 2);
    if (row.what == "Operating Mode" && model().find("current_limit") == nullptr)
      values = {row.max, 1};
    for (const int value : values) {
      EXPECT_EQ(write(row, value), 0) << row.what << " " << value;
      EXPECT_EQ(read(row), value) << row.what;
    }
    const auto before = read(row);
    const std::int64_t top =
        (std::int64_t{1} << (row.sign_bit != 0 ? row.sign_bit : 8 * row.size)) - 1;
    if (row.max < top) {
      EXPECT_EQ(write(row, row.max + 1), kRange) << row.what << ", above";
    }
    if (row.sign_bit != 0 ? row.min > -top - 1 : row.min > 0) {
      EXPECT_EQ(write(row, row.min - 1), kRange) << row.what << ", below";
    }
    EXPECT_EQ(read(row), before) << row.what;
  }
  EXPECT_GE(cases_, 500);
}

TEST_P(DynamixelCorpus, GoalsAreLimitedByTheirRegisters) {
  for (const CorpusRow& row : rows_) {
    const int limit = limit_of(row);
    if (limit < 0) continue;
    fresh();
    const int lowest = row.what == "Goal Position" ? 0 : -limit;
    for (const int value : {limit, lowest, limit / 2}) {
      EXPECT_EQ(write(row, value), 0) << row.what;
      EXPECT_EQ(read(row), value) << row.what;
    }
    if (limit < row.max) {
      EXPECT_EQ(write(row, limit + 1), kLimit) << row.what;
    }
    if (lowest > row.min) {
      EXPECT_EQ(write(row, lowest - 1), kLimit) << row.what;
    }
    EXPECT_EQ(write(row, row.max + 1), kRange) << row.what;
    EXPECT_EQ(write(row, row.min - 1), kRange) << row.what;
    EXPECT_EQ(read(row), limit / 2) << row.what;
  }
}

TEST_P(DynamixelCorpus, ReadOnlyRegistersRefuseAndStay) {
  for (const CorpusRow& row : rows_) {
    if (row.writable || row.what == "Realtime Tick") continue;
    const auto before = read(row);
    EXPECT_EQ(write(row, 1), kAccess) << row.what;
    EXPECT_EQ(read(row), before) << row.what;
  }
}

TEST_P(DynamixelCorpus, PartsOfARegisterAreReadAndNotWritten) {
  for (const CorpusRow& row : rows_) {
    if (row.size == 1) continue;
    const auto whole = host_->read(1, row.address, row.size);
    const auto last = host_->read(1, row.address + row.size - 1, 1);
    ASSERT_TRUE(whole && last) << row.what;
    if (row.what != "Realtime Tick") {
      EXPECT_EQ(last->at(0), whole->back()) << row.what;
    }
    EXPECT_EQ(host_->write(1, row.address, Bytes(row.size - 1u, 0)),
              row.writable ? kLength : kAccess)
        << row.what;
  }
}

TEST_P(DynamixelCorpus, EepromIsReadOnlyWhileTheTorqueIsOn) {
  for (const CorpusRow& row : rows_) {
    if (!row.writable || of_the_line(row) || row.what == "Torque Enable") continue;
    fresh();
    ASSERT_TRUE(host_->set(1, "torque_enable", 1));
    EXPECT_EQ(write(row, other(row)), row.eeprom ? kAccess : 0) << row.what;
    if (row.eeprom) {
      EXPECT_EQ(read(row), *row.factory) << row.what;
    }
  }
}

TEST_P(DynamixelCorpus, WithoutPowerOnlyEepromStays) {
  for (const bool by_reboot : {false, true}) {
    for (const CorpusRow& row : rows_) {
      if (!row.writable || of_the_line(row)) continue;
      fresh();
      EXPECT_EQ(write(row, other(row)), 0) << row.what;
      EXPECT_EQ(read(row), other(row)) << row.what;
      if (by_reboot) {
        host_->send(dynamixel::request(1, dynamixel::Instruction::reboot));
        bus_->advance(bus_->time() + std::chrono::milliseconds(400));
      } else {
        bus_->set_power(false);
        bus_->advance(bus_->time() + std::chrono::milliseconds(10));
        bus_->set_power(true);
      }
      const auto after = read(row);
      if (row.eeprom) {
        EXPECT_EQ(after, other(row)) << row.what;
      } else if (row.factory) {
        EXPECT_EQ(after, *row.factory) << row.what;
      } else {
        EXPECT_NE(after, other(row)) << row.what;
      }
    }
  }
  EXPECT_GE(cases_, 500);
}

INSTANTIATE_TEST_SUITE_P(Models, DynamixelCorpus,
                         testing::Values("xl330-m288", "xl330-m077", "xl430-w250", "xm430-w350"));

}  // namespace
}  // namespace kaz::sim
