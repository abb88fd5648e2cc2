// Hosts of a virtual bus whose adapter holds bytes for 16 ms, or returns the bytes that the host sends.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "hil/bus/bus_suite.h"
#include "host/bus/bus_driver.h"
#include "host/bus/bus_scan.h"
#include "sim/bus/bus_testing.h"
#include "tests/integration/servo_conformance/bus_link_testing.h"

namespace kaz::test {
namespace {

using namespace std::chrono_literals;
using servo_bus::Protocol;

struct Adapter {
  const char* name;
  Time latency;
  bool echo;
};

class Adapters : public testing::TestWithParam<std::tuple<Adapter, const char*>> {
 protected:
  const Adapter& adapter() const { return std::get<0>(GetParam()); }
  std::string model() const { return std::get<1>(GetParam()); }
  Protocol protocol() const { return servo_bus::find_model(model())->protocol; }
  void SetUp() override {
    bus_ = sim::test::bus_of({1, 4}, model());
    bus_->set_adapter_latency(adapter().latency);
    bus_->set_adapter_echo(adapter().echo);
    bus_->advance(3ms);
    link_ = std::make_unique<BusLink>(*bus_);
  }
  std::unique_ptr<sim::VirtualBus> bus_;
  std::unique_ptr<BusLink> link_;
};

TEST_P(Adapters, AreScanned) {
  for (const int last : {20, 4}) {
    host::ScanOptions options;
    options.first_id = last == 4 ? 4 : 0;
    options.last_id = last;
    const auto found = host::scan_bus(*link_, *link_, protocol(), 1'000'000, options);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->size(), last == 4 ? 1u : 2u);
    for (const host::ScannedServo& servo : *found) {
      EXPECT_EQ(servo.lost + servo.damaged, 0) << servo.id;
      ASSERT_TRUE(servo.model) << servo.id;
      EXPECT_EQ(servo.model->name, model());
    }
    EXPECT_EQ(found->back().id, 4);
  }
}

TEST_P(Adapters, AreDriven) {
  const auto driver = host::BusDriver::make(protocol(), *link_, *link_);
  const servo_bus::BusServo one = bus_->mount(0), two = bus_->mount(1);
  const std::vector<const servo_bus::BusServo*> servos{&one, &two};
  for (const auto* servo : servos) {
    const auto greeting = driver->greet(*servo);
    ASSERT_TRUE(greeting) << greeting.error().message;
    ASSERT_TRUE(*greeting);
    EXPECT_EQ((*greeting)->model, servo->model->number);
    EXPECT_TRUE((*greeting)->refused.empty());
    const auto held = driver->hold(*servo, servo->zero);
    ASSERT_TRUE(held);
    EXPECT_TRUE(*held);
  }
  const std::array goals{host::BusDriver::Goal{&one, 2200, 2000},
                         host::BusDriver::Goal{&two, 1900, 2000}};
  ASSERT_TRUE(driver->move(goals));
  ASSERT_TRUE(link_->sleep_until(link_->now() + 1s));
  const auto states = driver->read_all(servos);
  ASSERT_TRUE(states);
  for (const std::size_t i : {0u, 1u}) {
    ASSERT_TRUE((*states)[i]) << i;
    EXPECT_NEAR((*states)[i]->steps, goals[i].steps, 3);
  }
  const auto torque = driver->release(servos, 1s);
  ASSERT_TRUE(torque);
  for (const auto one_torque : *torque) EXPECT_EQ(one_torque, host::BusDriver::Torque::off);
  EXPECT_EQ(driver->counts().missing + driver->counts().damaged, 0u);
}

TEST_P(Adapters, DoNotFailTheSuite) {
  hil::BusRunOptions options;
  options.family =
      protocol() == Protocol::feetech ? hil::ServoFamily::feetech : hil::ServoFamily::dynamixel;
  options.filter = "^(packet|instructions)";
  const auto report = hil::run_bus_suite(*link_, *link_, options);
  ASSERT_TRUE(report) << report.error().message;
  for (const auto& one : report->results)
    EXPECT_NE(one.verdict, hil::Verdict::failed) << one.of->id << ": " << one.message;
}

INSTANTIATE_TEST_SUITE_P(All, Adapters,
                         testing::Combine(testing::Values(Adapter{"slow", 16ms, false},
                                                          Adapter{"echo", Time{}, true},
                                                          Adapter{"both", 16ms, true}),
                                          testing::Values("sts3215", "xl330-m288")),
                         [](const auto& test) {
                           std::string name = std::string(std::get<0>(test.param).name) + "_" +
                                              std::get<1>(test.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace kaz::test
