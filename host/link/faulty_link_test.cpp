// A faulty line in front of a link that remembers.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/faulty_link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

class TestClock final : public Clock {
 public:
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }
  Time now_ = std::chrono::seconds(100);
};

// What is written comes back at once; waiting takes the clock's time.
class EchoLink final : public Link {
 public:
  explicit EchoLink(TestClock& clock) : clock_(clock) {}
  std::string name() const override { return "echo"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    if (bytes_.empty()) clock_.now_ = std::max(clock_.now_, deadline);
    const std::size_t count = std::min(bytes.size(), bytes_.size());
    std::copy_n(bytes_.begin(), count, bytes.begin());
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  std::vector<std::uint8_t> bytes_;

 private:
  TestClock& clock_;
};

struct Bench {
  TestClock clock;
  EchoLink echo{clock};
  FaultyLink link;
  explicit Bench(const std::string& schedule)
      : link(echo, clock, faults::Schedule::parse(schedule, "test").value(), 1) {}
  std::vector<std::uint8_t> exchange(const std::vector<std::uint8_t>& bytes, Time wait) {
    EXPECT_TRUE(link.write(bytes));
    std::vector<std::uint8_t> got;
    std::array<std::uint8_t, 7> some{};
    const Time until = clock.now() + wait;
    while (true) {
      const auto count = link.read(some, until);
      EXPECT_TRUE(count);
      got.insert(got.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*count));
      if (*count == 0) return got;
    }
  }
};

const std::vector<std::uint8_t> kSomeBytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

TEST(FaultyLink, WithoutFaultsItIsTheLink) {
  Bench bench("");
  EXPECT_EQ(bench.exchange(kSomeBytes, milliseconds(5)), kSomeBytes);
  EXPECT_EQ(bench.clock.now(), std::chrono::seconds(100) + milliseconds(5));
}

TEST(FaultyLink, DelayHoldsBytesBackInOrder) {
  Bench bench("for 1 ms link_delay 0.02 to board\nlink_delay 0.01 to host\n");
  EXPECT_TRUE(bench.exchange(kSomeBytes, milliseconds(25)).empty());
  EXPECT_EQ(bench.exchange({}, milliseconds(10)), kSomeBytes);
}

TEST(FaultyLink, ACableIsPulledAndPutBack) {
  Bench bench("at 10 ms for 10 ms link_cut\n");
  EXPECT_EQ(bench.exchange(kSomeBytes, milliseconds(12)), kSomeBytes);
  EXPECT_TRUE(bench.exchange(kSomeBytes, milliseconds(12)).empty());
  EXPECT_EQ(bench.exchange(kSomeBytes, milliseconds(12)), kSomeBytes);
}

TEST(FaultyLink, DamageComesFromTheSeed) {
  Bench one("link_flip 0.5\n"), two("link_flip 0.5\n");
  const auto damaged = one.exchange(kSomeBytes, milliseconds(1));
  EXPECT_EQ(damaged.size(), kSomeBytes.size());
  EXPECT_NE(damaged, kSomeBytes);
  EXPECT_EQ(damaged, two.exchange(kSomeBytes, milliseconds(1)));
}

TEST(FaultyLink, FaultsCanBeginLater) {
  Bench bench("");
  faults::Fault fault;
  fault.name = faults::Name::link_cut;
  fault.at = bench.link.age();
  bench.link.add(fault);
  EXPECT_TRUE(bench.exchange(kSomeBytes, milliseconds(1)).empty());
}

}  // namespace
}  // namespace kaz::host
