// The part of SDF that is read is that of the library.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_schema.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <sdf/sdf.hh>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

std::string text_of(const sdf::ParamPtr& param) {
  if (!param) return "none";
  std::string text = param->GetKey() + " " + param->GetTypeName() + " `" +
                     param->GetDefaultAsString() + "` " + (param->GetRequired() ? "1" : "0");
  for (const auto& bound : {param->GetMinValueAsString(), param->GetMaxValueAsString()})
    text += " " + bound.value_or("free");
  return text;
}

// `outer`: the library's specification of the element around `its`, to which nested models refer.
void compare(const sdf::ElementPtr& ours, sdf::ElementPtr its, const std::string& path,
             const sdf::ElementPtr& outer = nullptr) {
  if (!its->ReferenceSDF().empty() && outer) its = outer;
  EXPECT_EQ(ours->GetRequired(), its->GetRequired()) << path;
  EXPECT_EQ(text_of(ours->GetValue()), text_of(its->GetValue())) << path;
  ASSERT_EQ(ours->GetAttributeCount(), its->GetAttributeCount()) << path;
  for (unsigned i = 0; i < ours->GetAttributeCount(); ++i)
    EXPECT_EQ(text_of(ours->GetAttribute(i)), text_of(its->GetAttribute(i))) << path;
  for (unsigned i = 0; i < ours->GetElementDescriptionCount(); ++i) {
    const sdf::ElementPtr child = ours->GetElementDescription(i);
    const std::string name = path + "/" + child->GetName();
    ASSERT_TRUE(its->HasElementDescription(child->GetName())) << name;
    compare(child, its->GetElementDescription(child->GetName()), name, its);
  }
}

TEST(SdfSchema, IsAPartOfTheLibrarys) {
  const auto ours = std::make_shared<sdf::SDF>(), its = std::make_shared<sdf::SDF>();
  ASSERT_TRUE(sdf::initString(sdf_schema(false, 2), ours));
  ASSERT_TRUE(sdf::init(its));
  ASSERT_TRUE(ours->Root()->HasElementDescription("world"));
  compare(ours->Root(), its->Root(), "sdf");
}

TEST(SdfSchema, HasAllThatPassesTheCheck) {
  const test::Folder folder;
  std::string shapes;
  for (const char* shape :
       {"<box><size>1 2 3</size></box>", "<capsule><radius>1</radius><length>2</length></capsule>",
        "<cylinder><radius>1</radius><length>2</length></cylinder>",
        "<sphere><radius>1</radius></sphere>"}) {
    const std::string name = std::to_string(shapes.size());
    const std::string pose = "<pose>0.1 0.2 0.3 0.4 0.5 0.6</pose>";
    shapes += "<collision name='c" + name + "'>" + pose + "<geometry>" + shape +
              "</geometry><surface><friction><ode><mu>0.4</mu></ode></friction><bounce>"
              "<restitution_coefficient>0.3</restitution_coefficient><threshold>0.2</threshold>"
              "</bounce><contact><ode><soft_cfm>0.001</soft_cfm></ode></contact>"
              "<kaz:rolling_resistance metres='0.002'/></surface></collision><visual name='v" +
              name + "'>" + pose + "<geometry>" + shape +
              "</geometry><material><ambient>1 1 1 1</ambient><diffuse>0.1 0.2 0.3 1</diffuse>"
              "<specular>0 0 0 1</specular></material><kaz:texture name='wood'/></visual>";
  }
  const std::string text = test::world_text(
      "0 0 -5",
      "<kaz:light to_lamp='0 0 1' lamp='0.5' shade='0.25'/><model name='m'>"
      "<static>false</static><pose>1 2 3 0 0 0</pose><link name='l'><pose>0 0 1 0 0 0</pose>"
      "<inertial><mass>2</mass><pose>0.1 0 0 0 0 0</pose><inertia><ixx>1</ixx><ixy>0</ixy>"
      "<ixz>0</ixz><iyy>1</iyy><iyz>0</iyz><izz>1</izz></inertia></inertial>" +
          shapes + "</link><kaz:kick time='1' velocity='0 1 0'/></model>");
  const auto world = load_world(folder.write("w.sdf", text));
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_EQ(world->gravity, Eigen::Vector3d(0, 0, -5));
  ASSERT_EQ(world->bodies.size(), 2u);  // the floor is the first
  const WorldBody& body = world->bodies[1];
  EXPECT_EQ(body.pose.translation(), Eigen::Vector3d(1, 2, 4));
  EXPECT_EQ(body.rigid.com, Eigen::Vector3d(0.1, 0, 0));
  EXPECT_EQ(body.kicks.size(), 1u);
  ASSERT_EQ(body.rigid.collisions.size(), 4u);
  ASSERT_EQ(body.rigid.visuals.size(), 4u);
  for (const CollisionShape& shape : body.rigid.collisions) {
    EXPECT_EQ(shape.surface.mu, 0.4);
    EXPECT_EQ(shape.surface.softness, 0.001);
    EXPECT_EQ(shape.surface.restitution, 0.3);
    EXPECT_EQ(shape.surface.bounce_threshold, 0.2);
    EXPECT_EQ(shape.surface.rolling_resistance, 0.002);
  }
  EXPECT_EQ(body.rigid.visuals[0].texture, "wood");
  EXPECT_EQ(body.rigid.visuals[0].color.b, 0.3f);
}

// The library returns no error for it.
TEST(SdfSchema, MissingVersionIsNamed) {
  const test::Folder folder;
  std::string text = test::world_text("0 0 -9.81", "");
  const std::string version = " version=\"1.9\"";
  text.erase(text.find(version), version.size());
  const auto world = load_world(folder.write("w.sdf", text));
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("version=\"1.9\""), std::string::npos)
      << world.error().message;
}

}  // namespace
}  // namespace kaz::sim
