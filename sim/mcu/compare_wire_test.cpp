// Conversations on the wire with both boards, and boards that are not equal.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/compare_wire.h"

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

WireOptions options(std::int64_t conversations) {
  WireOptions options;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.conversations = conversations;
  return options;
}

// The native board with a fault at its line or pins.
class Altered : public Mcu {
 public:
  explicit Altered(const NativeOptions& options) : board_(make_native(options)) {}
  std::string name() const override { return board_->name(); }
  States now() const override { return board_->now(); }
  Result<void> run_until(States until) override { return board_->run_until(until); }
  void reset() override { board_->reset(); }
  void power_cycle() override { board_->power_cycle(); }
  std::array<std::uint8_t, kMemorySize> memory() const override { return board_->memory(); }
  void set_memory(std::span<const std::uint8_t, kMemorySize> bytes) override {
    board_->set_memory(bytes);
  }
  const PinLevels& pins() const override {
    pins_ = board_->pins();
    alter(pins_);
    return pins_;
  }
  void on_pins(std::function<void(States, const PinLevels&)> listener) override {
    board_->on_pins(std::move(listener));
  }
  void set_analog(AnalogSource source) override { board_->set_analog(std::move(source)); }
  void receive(const SerialByte& byte) override { board_->receive(byte); }
  std::vector<SerialByte> take_transmitted() override {
    auto bytes = board_->take_transmitted();
    for (SerialByte& byte : bytes) alter(byte);
    return bytes;
  }
  void on_tick(std::function<void(const TickRecord&)> listener) override {
    board_->on_tick(std::move(listener));
  }
  void on_watchdog_reset(std::function<void(States)> listener) override {
    board_->on_watchdog_reset(std::move(listener));
  }

 protected:
  virtual void alter(SerialByte& byte) { (void)byte; }
  virtual void alter(PinLevels& pins) const { (void)pins; }

 private:
  std::unique_ptr<Mcu> board_;
  mutable PinLevels pins_;
};

class Late : public Altered {
  using Altered::Altered;
  void alter(SerialByte& byte) override { byte.at += 2 * KZ_STATES_PER_TICK; }
};

class OneBitWrong : public Altered {
  using Altered::Altered;
  void alter(SerialByte& byte) override {
    if (++count_ == 500) byte.value ^= 0x10;
  }
  int count_ = 0;
};

class PinStuck : public Altered {
  using Altered::Altered;
  void alter(PinLevels& pins) const override {
    pins.p4 = static_cast<std::uint8_t>(pins.p4 & ~KZ_P4_ENABLE);
  }
};

template <class Board>
WireReport compared_with() {
  WireOptions altered = options(2);
  altered.make_other = [](const NativeOptions& o) { return std::make_unique<Board>(o); };
  const auto report = compare_wire(altered);
  EXPECT_TRUE(report) << report.error().message;
  return report ? *report : WireReport{};
}

// The long form is `kaz mcu compare --wire --conversations 10000`.
TEST(CompareWire, FindsNoDifference) {
  const auto report = compare_wire(options(60));
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->equal()) << report->text();
  EXPECT_EQ(report->conversations, 60);
  EXPECT_GE(report->fewest_requests, 20);
  EXPECT_LE(report->largest_lag, KZ_STATES_PER_TICK);
  // The conversations have covered something.
  EXPECT_GT(report->replies, 3000);
  EXPECT_GT(report->resets, 10);
  EXPECT_GT(report->pins_compared, 55000);
  EXPECT_GT(report->by_type.size(), 20u) << report->text();
}

// Each of them differed once: a masked frame that ended just before a reset, a store in flash
// right behind the bytes that had waited for the board's start, and a store that was repeated
// without a pause.
TEST(CompareWire, ConversationsThatDifferedOnce) {
  for (const std::int64_t number : {1742, 2130, 2557, 2804, 3105, 3240, 3627, 7195}) {
    WireOptions one = options(1);
    one.first = number;
    const auto report = compare_wire(one);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(report->equal()) << report->text();
  }
}

TEST(CompareWire, MoreThanAFewThatEndEarlyAreADifference) {
  WireReport report;
  report.conversations = 60;
  report.ended_early = 1;
  EXPECT_TRUE(report.equal());
  report.ended_early = 2;
  EXPECT_FALSE(report.equal());
  EXPECT_NE(report.text().find("more than the 1 allowed"), std::string::npos) << report.text();
}

TEST(CompareWire, ConversationIsTheSameAlone) {
  const auto many = compare_wire(options(4));
  WireOptions last = options(1);
  last.first = 3;
  WireOptions others = options(3);
  const auto alone = compare_wire(last), before = compare_wire(others);
  ASSERT_TRUE(many && alone && before);
  EXPECT_EQ(many->replies, alone->replies + before->replies);
  EXPECT_EQ(many->bytes, alone->bytes + before->bytes);
  EXPECT_EQ(many->requests, alone->requests + before->requests);
}

TEST(CompareWire, RepliesThatAreTwoTicksLateAreFound) {
  const WireReport report = compared_with<Late>();
  ASSERT_FALSE(report.equal());
  EXPECT_NE(report.text().find("states apart"), std::string::npos) << report.text();
}

TEST(CompareWire, OneBitOfOneByteIsFound) {
  const WireReport report = compared_with<OneBitWrong>();
  ASSERT_FALSE(report.equal());
  ASSERT_FALSE(report.differences.empty());
  EXPECT_NE(report.differences[0].h8, report.differences[0].native);
  EXPECT_NE(report.text().find("--first"), std::string::npos) << report.text();
}

TEST(CompareWire, PinIsFound) {
  const WireReport report = compared_with<PinStuck>();
  ASSERT_FALSE(report.equal());
  EXPECT_NE(report.text().find("pins"), std::string::npos) << report.text();
}

TEST(CompareWire, OtherStartIsFound) {
  WireOptions altered = options(1);
  altered.make_other = [](NativeOptions o) {
    o.start_states += 5 * KZ_STATES_PER_TICK;
    return make_native(o);
  };
  const auto report = compare_wire(altered);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->equal());
}

}  // namespace
}  // namespace kaz::sim
