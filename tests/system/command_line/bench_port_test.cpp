// Link and tick measured over a real pty, in real time: the simulator is another process.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <csignal>

#include <gtest/gtest.h>

#include "hil/bench/link_bench.h"
#include "hil/bench/tick_bench.h"
#include "host/link/tty_link.h"
#include "host/link/wall_clock.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

class BenchPort : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(sim_.wait_for_output("ready", seconds(30))) << sim_.wait(seconds(0)).err;
    auto link = host::TtyLink::open(folder_ / "board");
    ASSERT_TRUE(link) << link.error().message;
    link_ = std::move(*link);
  }

  // What depends on how busy this machine is: said, not judged.
  void say() const {
    for (const hil::Measurement& one : report_.measurements) {
      std::printf("%-26s %10.3f %s %s\n", one.of->name.c_str(), one.value, one.of->unit.c_str(),
                  one.message.c_str());
    }
  }
  double value(const std::string& name) const {
    for (const hil::Measurement& one : report_.measurements) {
      if (one.of->name == name) return one.value;
    }
    return std::nan("");
  }

  const TemporaryFolder folder_;
  Process sim_{kaz({"sim", "--world", "empty", "--mcu", "native", "--serial", folder_ / "board"})};
  host::WallClock clock_;
  std::unique_ptr<host::TtyLink> link_;
  const hil::Limits limits_;
  hil::BenchReport report_;
  hil::BenchJudge judge_{report_, limits_};
};

TEST_F(BenchPort, Link) {
  hil::LinkBenchOptions options;
  options.round_trips = 200;
  options.cycle_time = options.stream_time = seconds(2);
  const auto measured = hil::bench_link(*link_, clock_, options, judge_);
  ASSERT_TRUE(measured) << measured.error().message;
  say();
  EXPECT_EQ(report_.measurements.size(), 6u);
  EXPECT_GT(value("link.round_trip_median"), 5.5) << "what the wire takes, and the board";
  EXPECT_LT(value("link.round_trip_median"), 40);
  EXPECT_GT(value("link.cycle_rate"), 10);
  EXPECT_EQ(value("link.error_rate"), 0) << "a pty damages nothing";
  EXPECT_EQ(value("link.telemetry_loss"), 0);
}

TEST_F(BenchPort, Tick) {
  hil::TickBenchOptions options;
  options.quiet_time = seconds(4);
  options.load_time = seconds(1);
  const auto measured = hil::bench_tick(*link_, clock_, options, judge_);
  ASSERT_TRUE(measured) << measured.error().message;
  say();
  EXPECT_EQ(report_.measurements.size(), 5u);
  EXPECT_EQ(value("tick.missed"), 0);
  // A simulator that is kept from running for 0.1 s makes 30 ms of jitter and 4 % of clock error.
  EXPECT_LT(value("tick.jitter"), 100);
  EXPECT_LT(std::abs(value("tick.clock_error")), 100000);
}

TEST_F(BenchPort, APortThatGoesIsASentence) {
  hil::LinkBenchOptions options;
  options.progress = [&](double share, const std::string&) {
    if (share > 0.05) sim_.signal(SIGKILL);
  };
  const auto measured = hil::bench_link(*link_, clock_, options, judge_);
  ASSERT_FALSE(measured);
  EXPECT_EQ(measured.error().fault, Fault::environment);
  EXPECT_NE(measured.error().message.find(folder_ / "board"), std::string::npos)
      << measured.error().message;
}

}  // namespace
}  // namespace kaz::test
