// The plan of a run, and results that are written only if the observer keeps them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "shared/base/files.hpp"
#include "sim/body/description/robot_model.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class Keeper final : public RunObserver {
 public:
  explicit Keeper(bool keeps) : keeps_(keeps) {}
  void ended(const Result<behavior::Outcome>&, double, double) override { ended_ = true; }
  bool is_worth_keeping() override {
    EXPECT_TRUE(ended_);
    return keeps_;
  }

 private:
  bool keeps_, ended_ = false;
};

TEST(Run, WritesResultsOfARunThatIsWorthKeeping) {
  for (const bool keeps : {true, false}) {
    SCOPED_TRACE(keeps);
    const std::string folder = make_temporary_folder("kaz-session-").value();
    RunOptions options;
    options.behavior = "stand";
    options.backend.mcu = sim::McuKind::native;
    options.out = folder + "/out";
    options.quiet = options.json = true;
    Keeper keeper(keeps);
    const auto ran = run(options, keeper);
    ASSERT_TRUE(ran) << ran.error().message;
    EXPECT_TRUE(*ran);
    EXPECT_EQ(fs::exists(folder + "/out/result.json"), keeps);
    EXPECT_EQ(fs::exists(folder + "/out/recording.mcap"), keeps);
    EXPECT_FALSE(fs::exists(folder + "/out/recording.mcap.part"));
    fs::remove_all(folder);
  }
}

// The simulation takes this robot instead of reading the file again.
TEST(RunPlan, ContainsTheRobotOfTheFile) {
  RunOptions options;
  options.behavior = "stand";
  options.quiet = true;
  EXPECT_EQ(RunPlan::make(options)->backend().robot_model, nullptr);
  options.backend.robot_file = "sim/robots/arm/arm.urdf";
  const auto plan = RunPlan::make(options);
  ASSERT_TRUE(plan) << plan.error().message;
  const auto robot = plan->backend().robot_model;
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->joint_order(), plan->backend().joints);
  EXPECT_GT(robot->mass(), 0);
}

TEST(RunPlan, WritesTheOptionsOfTheRobotInAFixedOrder) {
  RunOptions options;
  options.behavior = "stand";
  options.backend.memory = "ff";
  options.backend.suspended = true;
  const auto plan = RunPlan::make(options);
  ASSERT_TRUE(plan) << plan.error().message;
  const auto& facts = plan->backend().facts;
  const auto fact =
      std::ranges::find(facts, "backend", &std::pair<std::string, std::string>::first);
  ASSERT_NE(fact, facts.end());
  EXPECT_EQ(fact->second,
            R"({"world":"ball","robot_file":"","mcu":"h8","image":"","sensors":"nominal",)"
            R"("imu":false,"dynamics":"reduced","physics_step_ms":1.0,"eyes":"ideal",)"
            R"("eye_width":0,"renderer":"raster","supply_volts":10.0,"seed":1,"memory":"ff",)"
            R"("suspended":true})");
}

}  // namespace
}  // namespace kaz::tools
