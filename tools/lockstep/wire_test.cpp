// The claim: at 115,200 baud all 18 targets out and 18 positions back at 100 Hz, with at most 60 %
// of the wire in either direction. With the firmware emulated and with its code on the PC.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/wire_load_testing.h"

#include <gtest/gtest.h>

#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {
namespace {

class Wire : public ::testing::TestWithParam<sim::McuKind> {
 protected:
  void SetUp() override {
    std::unique_ptr<sim::Mcu> mcu = sim::make_native();
    if (GetParam() == sim::McuKind::h8) {
      auto chip = sim::H8Mcu::load(KAZ_FIRMWARE_IMAGE);
      ASSERT_TRUE(chip) << chip.error().message;
      mcu = std::move(*chip);
    }
    sim::SimulationOptions options;
    options.make_renderer = sim::make_test_renderer;
    auto assembled = sim::Simulation::assemble(
        options, std::move(mcu), std::make_unique<sim::TestWorld>(), sim::small_camera());
    ASSERT_TRUE(assembled) << assembled.error().message;
    simulation_ = std::move(*assembled);
    clock_.emplace(*simulation_);
    link_.emplace(*simulation_);
    auto robot = host::Robot::connect(*link_, *clock_);
    ASSERT_TRUE(robot) << robot.error().message;
    robot_.emplace(std::move(*robot));
  }

  std::unique_ptr<sim::Simulation> simulation_;
  std::optional<LockstepClock> clock_;
  std::optional<LockstepLink> link_;
  std::optional<host::Robot> robot_;
};

TEST_P(Wire, AllJointsAt100Hz) {
  const auto load = run_wire_load(*robot_, link_->byte_time(), 100, std::chrono::seconds(3));
  ASSERT_TRUE(load) << load.error().message;
  EXPECT_GT(load->rate_hz, 99);
  EXPECT_LE(load->share_out, 0.60);
  EXPECT_LE(load->share_in, 0.60);
  EXPECT_GT(load->share_out, 0.50) << "60 bytes a cycle";
  EXPECT_GT(load->share_in, 0.55) << "68 bytes a cycle";
  EXPECT_EQ(load->late, 0u);
  EXPECT_EQ(load->retries, 0u);
  EXPECT_LT(load->oldest_s, 0.016);
  EXPECT_FALSE(robot_->take_resumption());
  RecordProperty("share_out_percent", std::to_string(load->share_out * 100));
  RecordProperty("share_in_percent", std::to_string(load->share_in * 100));
}

TEST_P(Wire, AsOftenAsTheWireAllows) {
  const auto load = run_wire_load(*robot_, link_->byte_time(), 0, std::chrono::seconds(2));
  ASSERT_TRUE(load) << load.error().message;
  EXPECT_GT(load->rate_hz, 110);
  EXPECT_LE(load->share_in, 1);
  EXPECT_EQ(load->retries, 0u);
}

INSTANTIATE_TEST_SUITE_P(Engines, Wire, ::testing::ValuesIn(sim::kMcuKinds),
                         [](const auto& mcu) { return to_string(mcu.param); });

}  // namespace
}  // namespace kaz::lockstep
