// Worlds of others: models that Gazebo has in its own folder, and its floor's friction.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/files_testing.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

const char* const kOldWorld =
    "<sdf version='1.5'><world name='w'><include><uri>model://sun</uri></include><include>"
    "<uri>model://ground_plane</uri><pose>0 0 0.5 0 0 0</pose></include></world></sdf>";

TEST(FieldWorld, GazebosFloorAndSunAreKnown) {
  const test::Folder folder;
  const auto world = load_world(folder.write("old.world", kOldWorld));
  ASSERT_TRUE(world) << full_text(world.error());
  ASSERT_EQ(world->bodies.size(), 1u);
  const RigidLink& floor = world->bodies[0].rigid;
  ASSERT_EQ(floor.collisions.size(), 1u);
  EXPECT_EQ(floor.collisions[0].shape.kind, Shape::Kind::plane);
  EXPECT_EQ(floor.collisions[0].surface.mu, 100);
  EXPECT_EQ(world->bodies[0].pose.translation().z(), 0.5);
  EXPECT_NE(summary(world->notes).find("model `model://sun` (a light)"), std::string::npos)
      << summary(world->notes);
}

TEST(FieldWorld, ModelsOfTheWorldsFolderReplaceThem) {
  const test::Folder folder;
  folder.write("ground_plane", "<sdf version='1.6'><model name='own'><static>true</static></model></sdf>");
  const auto world = load_world(folder.write("old.world", kOldWorld));
  ASSERT_TRUE(world) << full_text(world.error());
  EXPECT_TRUE(world->bodies.empty() || world->bodies[0].rigid.collisions.empty());
}

}  // namespace
}  // namespace kaz::sim
