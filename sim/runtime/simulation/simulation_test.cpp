// Board and world on one clock.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "shared/base/files.hpp"
#include "sim/body/description/robot_model.h"
#include "sim/mcu/host_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

void run_ms(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(simulation.step());
}

TEST(Simulation, StepIsOneMillisecondOfEverything) {
  auto simulation = test_simulation();
  run_ms(*simulation, 5);
  EXPECT_EQ(simulation->time(), std::chrono::milliseconds(5));
  EXPECT_EQ(simulation->board().now(), 5 * KZ_STATES_PER_TICK);
  EXPECT_NEAR(simulation->world().time_s(), 0.005, 1e-12);
}

TEST(Simulation, TargetMovesTheJointThroughMotorAndPotentiometer) {
  SimulationOptions options;
  options.sensors = SensorSet::ideal;
  auto simulation = test_simulation(options);
  run_ms(*simulation, 50);
  simulation->write(enable_frame(1, 1));
  run_ms(*simulation, 20);
  EXPECT_TRUE(simulation->board().drivers_enabled());
  EXPECT_NEAR(simulation->world().joints()[0].angle, 0.0, 0.01);
  simulation->write(target_frame(2, 0, 3000));  // 0.3 rad
  for (int i = 0; i < 10; ++i) {
    run_ms(*simulation, 50);
    simulation->write(frame_of(KZ_TYPE_heartbeat, static_cast<std::uint8_t>(3 + i), {0, 0}));
  }
  // 190 degrees are 1024 codes: the loop cannot see less than 3.2 mrad.
  EXPECT_NEAR(simulation->world().joints()[0].angle, 0.3, 0.01);
  EXPECT_NEAR(dynamic_cast<const TestWorld&>(simulation->world()).supply_volts(), 10 - 0.15, 1e-9);
}

TEST(Simulation, AnswersArriveWhenTheWireHasCarriedThem) {
  auto simulation = test_simulation();
  run_ms(*simulation, 50);
  const States sent = simulation->now();
  simulation->write(frame_of(KZ_TYPE_state, 9, {}));
  std::vector<SerialByte> answer;
  std::array<std::uint8_t, 64> buffer{};
  States first = 0;
  while (answer.size() < 53 && simulation->now() < sent + 50 * KZ_STATES_PER_TICK) {
    run_ms(*simulation, 1);
    const std::size_t count = simulation->read(buffer);
    if (count > 0 && first == 0) first = simulation->now();
    EXPECT_LE(count, 12u);  // 11.52 a millisecond
    for (std::size_t i = 0; i < count; ++i) answer.push_back({buffer[i], 0, false});
  }
  ASSERT_EQ(answer.size(), 53u);
  ASSERT_EQ(bodies_of(answer).size(), 1u);
  EXPECT_EQ(bodies_of(answer)[0][1], KZ_TYPE_state_reply);
  // The request takes 9 bytes of 87 us; the tick after that computes, the next one sends.
  EXPECT_GE(first - sent, 2 * KZ_STATES_PER_TICK);
  EXPECT_LE(first - sent, 5 * KZ_STATES_PER_TICK);
}

TEST(Simulation, DrawsForNobodyUntilEyesAreOpened) {
  std::atomic<int> made = 0;
  SimulationOptions options;
  auto counting = [&made]() -> Result<std::unique_ptr<Renderer>> {
    ++made;
    return make_test_renderer();
  };
  options.make_renderer = counting;
  auto simulation =
      Simulation::assemble(options, make_native(), std::make_unique<TestWorld>(), small_camera());
  ASSERT_TRUE(simulation);
  run_ms(**simulation, 100);
  EXPECT_EQ(made, 0);
  EXPECT_FALSE((*simulation)->next_pair());
  (*simulation)->open_eyes();
  run_ms(**simulation, 100);
  EXPECT_EQ(made, 1);
  EXPECT_TRUE((*simulation)->next_pair());
}

TEST(Simulation, OutsideViewShowsTheWorldAsItStands) {
  auto simulation = test_simulation();
  View view;
  view.camera.width = 16;
  view.camera.height = 8;
  view.world_from_optical.translation() = Eigen::Vector3d(0.1, 0.05, 0);
  const auto picture = simulation->picture(view, simulation->world().pose());
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->rgb.size(), 16u * 8 * 3);
  EXPECT_EQ(picture->rgb[0], 100);
  EXPECT_EQ(picture->rgb[1], 50);
}

class BrokenMcu final : public Mcu {
 public:
  std::string name() const override { return "broken"; }
  States now() const override { return now_; }
  Result<void> run_until(States until) override {
    if (until > 3 * KZ_STATES_PER_TICK) return fail(Fault::failed, "undefined instruction");
    now_ = until;
    return {};
  }
  void reset() override {}
  void power_cycle() override {}
  std::array<std::uint8_t, kMemorySize> memory() const override { return {}; }
  void set_memory(std::span<const std::uint8_t, kMemorySize>) override {}
  const PinLevels& pins() const override { return pins_; }
  void on_pins(std::function<void(States, const PinLevels&)>) override {}
  void set_analog(AnalogSource) override {}
  void receive(const SerialByte&) override {}
  std::vector<SerialByte> take_transmitted() override { return {}; }
  void on_tick(std::function<void(const TickRecord&)>) override {}

 private:
  States now_ = 0;
  PinLevels pins_;
};

TEST(Simulation, ErrorOfTheChipComesOutOfEveryFurtherStep) {
  auto simulation = Simulation::assemble({}, std::make_unique<BrokenMcu>(),
                                         std::make_unique<TestWorld>(), small_camera());
  ASSERT_TRUE(simulation);
  run_ms(**simulation, 3);
  for (int i = 0; i < 3; ++i) {
    const auto stepped = (*simulation)->step();
    ASSERT_FALSE(stepped);
    EXPECT_EQ(stepped.error().message, "undefined instruction");
  }
  EXPECT_EQ((*simulation)->time(), std::chrono::milliseconds(3));
}

TEST(Simulation, DoesNotReadTheFileOfARobotThatTheOptionsContain) {
  const std::string folder = make_temporary_folder("kaz-robot-").value();
  std::filesystem::copy("sim/robots/arm", folder, std::filesystem::copy_options::recursive);
  SimulationOptions options;
  options.world_path = "sim/worlds/empty.sdf";
  options.robot_path = folder + "/arm.urdf";
  options.robot_model = std::make_shared<const RobotModel>(load_robot(options.robot_path).value());
  std::ofstream(options.robot_path) << "no robot";
  const auto simulation = Simulation::create(options);
  ASSERT_TRUE(simulation) << simulation.error().message;
  EXPECT_TRUE(
      std::ranges::equal((*simulation)->world().joint_order(), options.robot_model->joint_order()));
  options.robot_model = nullptr;
  EXPECT_FALSE(Simulation::create(options));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace kaz::sim
