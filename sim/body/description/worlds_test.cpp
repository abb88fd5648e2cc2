// The worlds that come with Kaz: ours takes them, and so does SDFormat's own checker.
// SPDX-License-Identifier: Apache-2.0
#include <sdf/sdf.hh>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

std::vector<std::string> worlds() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator("sim/worlds")) {
    if (entry.path().extension() == ".sdf") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

class OurWorld : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Files, OurWorld, testing::ValuesIn(worlds()), [](const auto& test) {
  return std::filesystem::path(test.param).stem().string();
});

TEST_P(OurWorld, IsTaken) {
  const auto world = load_world(GetParam());
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_FALSE(world->bodies.empty());
}

// What the format's command-line checker looks at.
TEST_P(OurWorld, PassesTheChecksOfTheFormat) {
  sdf::Root root;
  const sdf::Errors errors = root.Load(GetParam());
  for (const sdf::Error& error : errors) ADD_FAILURE() << error.Message();
  EXPECT_TRUE(sdf::checkCanonicalLinkNames(&root));
  EXPECT_TRUE(sdf::checkFrameAttachedToNames(&root));
  EXPECT_TRUE(sdf::checkFrameAttachedToGraph(&root));
  EXPECT_TRUE(sdf::checkPoseRelativeToGraph(&root));
  sdf::Errors of_joints;
  sdf::checkJointParentChildNames(&root, of_joints);
  EXPECT_TRUE(of_joints.empty());
  EXPECT_TRUE(sdf::recursiveSameTypeUniqueNames(root.Element()));
  EXPECT_TRUE(sdf::recursiveSiblingUniqueNames(root.Element()));
  EXPECT_TRUE(sdf::recursiveSiblingNoDoubleColonInNames(root.Element()));
}

TEST(Props, ComeToRestAndStay) {
  const auto world = test::load_or_fail("sim/worlds/props.sdf", {});
  ASSERT_TRUE(world);
  const char* const objects[] = {"block_1", "block_4", "block_7", "block_8", "can_1", "can_2"};
  test::run(*world, 0.5);
  std::vector<Eigen::Vector3d> before;
  for (const char* object : objects) before.push_back(world->object_position(object).value());
  test::run(*world, 0.4);  // the ball is flicked after that
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(world->object_position(objects[i]).value(), before[i]) << objects[i];
  }
}

}  // namespace
}  // namespace kaz::sim
