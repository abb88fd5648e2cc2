// Worlds of others: elements that are used, noted and refused, includes, joints, meshes, masks, lights.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>

#include "sim/body/contact/contacts.h"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

namespace fs = std::filesystem;

const std::string kMass =
    "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>"
    "</inertial>";

std::string link_text(const std::string& name, const std::string& parts = "") {
  return "<link name='" + name + "'>" + kMass + parts + "</link>";
}

std::string ball_text(const std::string& parts) {
  return "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry>" + parts +
         "</collision>";
}

// A file of SDF 1.9 with one model.
std::string model_file(const std::string& name, const std::string& parts) {
  return "<sdf version='1.9'>\n<model name='" + name + "'>\n" + parts + "\n</model></sdf>\n";
}

class SdfFile : public testing::Test {
 protected:
  // `models` begin on line 8.
  Result<WorldModel> load(const std::string& models, const ReadOptions& options = {}) {
    return load_world(write("world.sdf", test::world_text("0 0 -9.8", models)), options);
  }
  std::string write(const std::string& name, const std::string& text) {
    const fs::path path = fs::path(folder_.write("x", "")).parent_path() / name;
    fs::create_directories(path.parent_path());
    return folder_.write(name, text);
  }
  void expect_error(const std::string& models, const std::string& part) {
    const auto world = load(models);
    ASSERT_FALSE(world) << models;
    EXPECT_EQ(world.error().fault, Fault::usage);
    EXPECT_NE(full_text(world.error()).find(part), std::string::npos) << full_text(world.error());
  }
  const test::Folder folder_;
};

TEST_F(SdfFile, ReportsAllErrorsTogetherInOrderOfLines) {
  const auto world = load(
      "<model name='a'>\n<link name='l' tint='red'><inertial><mass>x</mass></inertial></link>\n"
      "<joint name='j' type='screw'><parent>world</parent><child>l</child></joint>\n"
      "<lnk/></model>\n<population name='p'/>");
  ASSERT_FALSE(world);
  const std::string all = full_text(world.error());
  EXPECT_EQ(world.error().details.size(), 4u) << all;
  std::size_t at = 0;
  for (const char* part :
       {":9: attribute `tint` of <link> is unknown; <link> accepts name",
        ":9: <mass> must contain 1 number", ":10: joint `j` has type \"screw\"; the supported",
        ":11: unknown element <lnk> in <model>",
        ":12: <population> is not supported: give each model as a <model>"}) {
    const auto found = all.find(part);
    ASSERT_NE(found, std::string::npos) << part << "\n" << all;
    EXPECT_GE(found, at) << all;
    at = found;
  }
}

TEST_F(SdfFile, NotesAreErrorsWithStrict) {
  const std::string text =
      "<plugin name='p' filename='f'/><gz:spin/>\n<model name='m'><link "
      "name='l'><sensor name='s' type='imu'/></link></model>";
  const auto world = load(text);
  ASSERT_TRUE(world) << full_text(world.error());
  EXPECT_EQ(summary(world->notes),
            "<plugin>, <gz:spin>, <sensor>, link `l` has no <inertial>: 1 kg by SDF's default");
  EXPECT_EQ(world->bodies.at(1).rigid.mass, 1);
  EXPECT_TRUE(world->bodies[1].rigid.inertia.isIdentity());
  const auto strict = load(text, {.strict = true});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().details.size(), 3u);
  EXPECT_NE(strict.error().message.find(":8: <plugin> is not used, which --strict"),
            std::string::npos)
      << strict.error().message;
  EXPECT_NE(
      full_text(strict.error()).find("by SDF's default, which --strict does not permit; give"),
      std::string::npos);
}

TEST_F(SdfFile, EmptyPosesAreZero) {
  const auto world =
      load("<model name='m'><pose/><frame name='f'><pose>1 2 3 0 0 0</pose></frame>" +
           link_text("l", "<pose relative_to='f'></pose>") + "</model>");
  ASSERT_TRUE(world) << full_text(world.error());
  EXPECT_EQ(world->bodies.at(1).pose.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST_F(SdfFile, PosesInDegreesAndByQuaternions) {
  const auto turned = [&](const std::string& pose) {
    const auto world = load("<model name='m'>" + pose + link_text("l") + "</model>");
    if (!world) return Eigen::Vector3d(Eigen::Vector3d::Zero());
    return Eigen::Vector3d(world->bodies.at(1).pose.linear().col(0));
  };
  EXPECT_TRUE(
      turned("<pose degrees='true'>0 0 0 0 0 90</pose>").isApprox(Eigen::Vector3d(0, 1, 0)));
  EXPECT_TRUE(turned("<pose rotation_format='quat_xyzw'>0 0 0 0 0 1 0</pose>")
                  .isApprox(Eigen::Vector3d(-1, 0, 0)));
  expect_error("<model name='m'><pose rotation_format='quat_xyzw'>0 0 0 0 0 2 0</pose></model>",
               "does not have the length 1");
  expect_error("<model name='m'><pose frame='x'>0 0 0 0 0 0</pose></model>",
               "attribute `frame` of <pose> exists until SDF 1.6; use `relative_to`");
  expect_error("<model name='m'><pose relative_to='nothing'>0 0 0 0 0 0</pose>" + link_text("l") +
                   "</model>",
               "nothing");
}

TEST_F(SdfFile, RefusesWhatChangesPhysics) {
  const auto in_ball = [](const std::string& parts) {
    return "<model name='m'>" + link_text("l", ball_text(parts)) + "</model>";
  };
  expect_error(
      in_ball("<surface><friction><ode><mu>1</mu><mu2>0.5</mu2></ode></friction></surface>"),
      "<mu2> of 0.5 differs from <mu>");
  EXPECT_TRUE(load(
      in_ball("<surface><friction><ode><mu>0.5</mu><mu2>0.5</mu2></ode></friction></surface>")));
  expect_error("<model name='m'><link name='l'><inertial auto='true'/></link></model>",
               "attribute `auto` of <inertial> is not supported; give <mass> and <inertia>");
  expect_error("<model name='m'>" +
                   link_text("l",
                             "<collision name='c'><geometry><heightmap><uri>h.png</uri>"
                             "</heightmap></geometry></collision>") +
                   "</model>",
               "<heightmap> is not supported: use boxes");
  const auto drawn =
      load("<model name='m'>" +
           link_text("l",
                     "<visual name='v'><geometry><heightmap/></geometry></visual><collision "
                     "name='c'><geometry><empty/></geometry></collision>") +
           "</model>");
  ASSERT_TRUE(drawn) << full_text(drawn.error());
  EXPECT_EQ(summary(drawn->notes), "<visual> with <heightmap>, <collision> with <empty>");
  EXPECT_TRUE(drawn->bodies.at(1).rigid.visuals.empty());
  EXPECT_TRUE(drawn->bodies[1].rigid.collisions.empty());
}

TEST_F(SdfFile, IncludesModelsOfTheSearchPath) {
  write("models/cart/model.config",
        "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.9'>cart.sdf</sdf></model>");
  write("models/cart/cart.sdf",
        model_file("cart", "<pose>9 9 9 0 0 0</pose>" + link_text("l", "<sensor name='s'/>") +
                               "<frame name='grip'><pose>0 0 0.5 0 0 0</pose></frame>"));
  const auto world = load(
      "<include><uri>model://cart</uri></include>\n<include><uri>models/cart/cart.sdf</uri><name>"
      "second</name><static>true</static><pose>1 2 3 0 0 0</pose><placement_frame>grip"
      "</placement_frame></include>");
  ASSERT_TRUE(world) << full_text(world.error());
  ASSERT_EQ(world->bodies.size(), 3u);
  EXPECT_EQ(world->bodies[1].model, "cart");
  EXPECT_EQ(world->bodies[1].pose.translation(), Eigen::Vector3d(9, 9, 9));
  EXPECT_FALSE(world->bodies[1].fixed);
  EXPECT_EQ(world->bodies[2].rigid.name, "second/l");
  EXPECT_TRUE(world->bodies[2].pose.translation().isApprox(Eigen::Vector3d(1, 2, 2.5)));
  EXPECT_TRUE(world->bodies[2].fixed);
  ASSERT_EQ(world->notes.size(), 2u);
  EXPECT_EQ(world->notes[1].line, 9) << "the line of the include";

  const std::string elsewhere =
      fs::path(write("far/boat/boat.sdf", "")).parent_path().parent_path();
  write("far/boat/boat.sdf", model_file("boat", link_text("l")));
  write("worlds/w.sdf", test::world_text("0 0 -9",
                                         "<include><uri>model://boat/boat.sdf</uri>"
                                         "</include>"));
  const std::string path = write("worlds/x", "").substr(0, elsewhere.size() - 3) + "worlds/w.sdf";
  EXPECT_FALSE(load_world(path));
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH"}) {
    setenv(variable, ("/nowhere:" + elsewhere).c_str(), 1);
    const auto found = load_world(path);
    unsetenv(variable);
    EXPECT_TRUE(found) << variable << full_text(found.error());
  }
}

TEST_F(SdfFile, IncludedFilesAreCheckedAsTheWorldIs) {
  write("bad.sdf",
        model_file("bad", "<link name='l'>\n<inertial><mass>x</mass></inertial></link>"));
  const auto world = load(
      "<include><uri>bad.sdf</uri></include>\n<include><uri>bad.sdf</uri>"
      "<name>twice</name></include><lnk/>");
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("bad.sdf:4: <mass> must contain 1 number"),
            std::string::npos)
      << world.error().message;
  ASSERT_EQ(world.error().details.size(), 1u) << full_text(world.error());
  EXPECT_NE(world.error().details[0].find("world.sdf:9: unknown element <lnk>"), std::string::npos);
}

TEST_F(SdfFile, ErrorsOfTheParserNameTheIncludedFile) {
  write("odd.sdf", model_file("odd", link_text("__odd__")));
  expect_error("<include><uri>odd.sdf</uri></include>", "__odd__");
  const auto world = load("<include><uri>odd.sdf</uri></include>");
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().message.find("world.sdf:"), world.error().message.find("world.sdf: "))
      << "no line of another file: " << world.error().message;
}

TEST_F(SdfFile, RefusesIncludesThatItCannotFollow) {
  expect_error(
      "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun</uri></include>",
      ":8: model `https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun` is on a server, "
      "which Kaz does not contact: download the model, and add the folder");
  expect_error("<include><uri>model://nothing</uri></include>",
               "model `model://nothing` was not found: add the folder that contains it to "
               "GZ_SIM_RESOURCE_PATH");
  write("a.sdf", model_file("a", "<include><uri>b.sdf</uri></include>" + link_text("l")));
  write("b.sdf", model_file("b", "<include><uri>a.sdf</uri></include>" + link_text("l")));
  expect_error("<include><uri>a.sdf</uri></include>", "model `a.sdf` includes itself");
  expect_error("<include><uri>world.sdf</uri></include>", "model `world.sdf` includes itself");
  write("robot.sdf", "<robot/>");
  expect_error("<include><uri>robot.sdf</uri></include>",
               "world.sdf:8: model `robot.sdf` is not valid: ");
  write("world_too.sdf", "<sdf version='1.9'><world name='w'/></sdf>");
  expect_error(
      "<include><uri>world_too.sdf</uri></include>",
      "world_too.sdf:1: <world> is not supported in an included file; it needs one <model>");
  expect_error("<include merge='true'><uri>a.sdf</uri></include>",
               "attribute `merge` of <include> is not supported");
}

// A world file that somebody sends must not make the program read files elsewhere.
TEST_F(SdfFile, IncludesOnlyFilesInItsFolders) {
  const std::string secret = write("secret/m.sdf", model_file("m", link_text("l")));
  const fs::path root = fs::path(secret).parent_path().parent_path();
  write("inner/x", "");
  fs::create_symlink(secret, root / "inner/link.sdf");
  for (const std::string& uri : {std::string("../secret/m.sdf"), secret, "file://" + secret,
                                 std::string("link.sdf"), std::string("model://../secret/m.sdf")}) {
    const auto world = load_world(write(
        "inner/w.sdf", test::world_text("0 0 -9", "<include><uri>" + uri + "</uri></include>")));
    ASSERT_FALSE(world) << uri;
    EXPECT_NE(world.error().message.find("outside of the world's folder"), std::string::npos)
        << world.error().message;
  }
}

TEST_F(SdfFile, BoundsModelsOfNestedIncludes) {
  std::string many;
  for (int i = 0; i < 70; ++i)
    many += "<include><uri>leaf.sdf</uri><name>n" + std::to_string(i) + "</name></include>\n";
  write("leaf.sdf", model_file("leaf", link_text("l")));
  std::string more = many;
  for (std::size_t at = 0; (at = more.find("leaf.sdf", at)) != more.npos;)
    more.replace(at, 8, "tree.sdf");
  write("tree.sdf", model_file("tree", many));
  expect_error(more, "<world> has more than 4000 models");
}

TEST_F(SdfFile, FixedJointsMergeLinks) {
  const auto world = load(
      "<model name='m'><pose>0 0 1 0 0 0</pose>" + link_text("a") +
      link_text("b", "<pose>1 0 0 0 0 0</pose>" + ball_text("")) + link_text("c") + link_text("d") +
      "<joint name='ab' type='fixed'><parent>a</parent><child>b</child>"
      "</joint><joint name='w' type='fixed'><parent>world</parent><child>d</child></joint>"
      "<joint name='dc' type='fixed'><parent>d</parent><child>c</child></joint></model>");
  ASSERT_TRUE(world) << full_text(world.error());
  ASSERT_EQ(world->bodies.size(), 4u) << "floor, a with b, c, d";
  const WorldBody& whole = world->bodies[1];
  EXPECT_EQ(whole.rigid.name, "m/a");
  EXPECT_FALSE(whole.fixed);
  EXPECT_EQ(whole.rigid.mass, 4);
  EXPECT_TRUE(whole.rigid.com.isApprox(Eigen::Vector3d(0.5, 0, 0)));
  EXPECT_NEAR(whole.rigid.inertia(2, 2), 0.2 + 2 * 2 * 0.25, 1e-12);
  ASSERT_EQ(whole.rigid.collisions.size(), 1u);
  EXPECT_TRUE(whole.rigid.collisions[0].in_link.translation().isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_TRUE(world->bodies[2].fixed && world->bodies[3].fixed);
  EXPECT_TRUE(world->joints.empty());
}

TEST_F(SdfFile, OtherJointsConnectBodies) {
  const std::string axis =
      "<axis><xyz>0 1 0</xyz><limit><lower>-0.5</lower><upper>1e16</upper></"
      "limit><dynamics><damping>0.2</damping><friction>0.1</friction>"
      "</dynamics></axis>";
  const auto joint = [&axis](const std::string& name, const std::string& type,
                             const std::string& parent, const std::string& child,
                             const std::string& parts = "") {
    return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" +
           child + "</child>" + parts + (type == "ball" || type == "fixed" ? "" : axis) +
           "</joint>";
  };
  const auto world = load(
      "<model name='m'><pose>0 0 1 0 0 1.5707963267948966</pose>" + link_text("a") +
      link_text("b", "<pose>1 0 0 0 0 0</pose>") + link_text("c") + link_text("d") +
      joint("hinge", "revolute", "a", "b", "<pose>0 0 0.25 0 0 0</pose>") +
      joint("slide", "prismatic", "c", "d") + joint("ball", "ball", "a", "c") +
      joint("free", "continuous", "a", "c") + joint("held", "fixed", "world", "d") + "</model>");
  ASSERT_TRUE(world) << full_text(world.error());
  ASSERT_EQ(world->joints.size(), 4u);
  const WorldJoint& hinge = world->joints[0];
  EXPECT_EQ(hinge.name, "m/hinge");
  EXPECT_EQ(hinge.kind, WorldJoint::Kind::revolute);
  EXPECT_EQ(hinge.parent, 1);
  EXPECT_EQ(hinge.child, 2);
  EXPECT_TRUE(hinge.anchor.isApprox(Eigen::Vector3d(0, 1, 1.25), 1e-12)) << hinge.anchor;
  EXPECT_TRUE(hinge.axis.isApprox(Eigen::Vector3d(-1, 0, 0), 1e-12)) << hinge.axis;
  EXPECT_EQ(hinge.lower, -0.5);
  EXPECT_EQ(hinge.upper, HUGE_VAL);
  EXPECT_EQ(hinge.damping, 0.2);
  EXPECT_EQ(hinge.friction, 0.1);
  const WorldJoint& slide = world->joints[1];
  EXPECT_EQ(slide.kind, WorldJoint::Kind::prismatic);
  EXPECT_EQ(slide.parent, 4) << "the child moves, the parent is fixed";
  EXPECT_TRUE(world->bodies[4].fixed);
  EXPECT_EQ(slide.child, 3);
  EXPECT_TRUE(slide.axis.isApprox(Eigen::Vector3d(1, 0, 0), 1e-12)) << slide.axis;
  EXPECT_EQ(world->joints[2].kind, WorldJoint::Kind::ball);
  EXPECT_EQ(world->joints[3].lower, -HUGE_VAL);
}

TEST_F(SdfFile, LinksOfJointedModelsDoNotCollideWithEachOther) {
  const std::string collide = "<self_collide>true</self_collide>";
  const auto model = [&](const std::string& parts, const std::string& in_link) {
    return "<model name='m'>" + link_text("a", in_link) + parts + "</model>";
  };
  const std::string joint =
      "<joint name='j' type='ball'><parent>world</parent><child>a</child>"
      "</joint>";
  EXPECT_TRUE(load(model(collide, "")));
  const std::string refused = "<self_collide> of true is not supported in a model with joints";
  expect_error(model(joint + collide, ""), refused);
  expect_error(model(joint, collide), refused);
  EXPECT_TRUE(load(model(joint + "<self_collide>false</self_collide>", "")));
}

TEST_F(SdfFile, RefusesLimitsInTheWrongOrder) {
  for (const char* limits :
       {"<lower>1</lower><upper>-1</upper>", "<lower>1e16</lower><upper>1e16</upper>",
        "<lower>-inf</lower><upper>-inf</upper>"})
    expect_error("<model name='m'>" + link_text("a") +
                     "<joint name='j' type='revolute'><parent>world</parent><child>a</child><axis>"
                     "<limit>" +
                     limits + "</limit></axis></joint></model>",
                 "lower limit of joint `j` is above the upper limit");
}

TEST_F(SdfFile, NestedModelsHaveTheNamesOfTheirParents) {
  const auto world = load(
      "<model name='a'><static>true</static><pose>1 0 0 0 0 0</pose><model "
      "name='b'><pose>0 1 0 0 0 0</pose>" +
      link_text("l") + "</model></model>");
  ASSERT_TRUE(world) << full_text(world.error());
  EXPECT_EQ(world->bodies.at(1).model, "a::b");
  EXPECT_EQ(world->bodies[1].rigid.name, "a::b/l");
  EXPECT_TRUE(world->bodies[1].fixed) << "as the model around it";
  EXPECT_EQ(world->bodies[1].pose.translation(), Eigen::Vector3d(1, 1, 0));
}

// A tetrahedron whose corners are 0, x, y and z, of 1, 2 and 3 cm.
constexpr const char* kSdfObj =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_F(SdfFile, MeshesCollideByTheirHullAndAreDrawn) {
  const std::string path = write("models/part/meshes/part.obj", kSdfObj);
  const std::string mesh =
      "<geometry><mesh><uri>model://part/meshes/part.obj</uri><scale>0.01 0.01 "
      "0.01</scale></mesh></geometry>";
  const std::string text = "<model name='m'>" +
                           link_text("l", "<collision name='c'>" + mesh +
                                              "</collision><visual "
                                              "name='v'>" +
                                              mesh + "</visual>") +
                           "</model>";
  const auto world = load(text);
  ASSERT_TRUE(world) << full_text(world.error());
  const RigidLink& link = world->bodies.at(1).rigid;
  ASSERT_EQ(link.collisions.at(0).shape.kind, Shape::Kind::hull);
  const auto box = extent(link.collisions[0].shape, link.collisions[0].in_link);
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(0.01, 0.02, 0.03)));
  EXPECT_EQ(link.visuals.at(0).shape.kind, Shape::Kind::mesh);
  EXPECT_EQ(link.visuals[0].shape.mesh_path, fs::canonical(path).string());
  const auto as_box = load(text, {.mesh_collision = MeshCollision::box});
  ASSERT_TRUE(as_box);
  EXPECT_EQ(as_box->bodies.at(1).rigid.collisions[0].shape.kind, Shape::Kind::box);
  fs::remove(path);
  expect_error(text, "mesh `model://part/meshes/part.obj` was not found");
  const auto skipped = load(text, {.skip_missing_meshes = true});
  ASSERT_TRUE(skipped) << full_text(skipped.error());
  EXPECT_EQ(skipped->notes.size(), 2u);
  EXPECT_TRUE(skipped->bodies.at(1).rigid.visuals.empty());
}

TEST_F(SdfFile, FirstDirectionalLightIsTheLamp) {
  const std::string sun =
      "<light type='directional' name='sun'><direction>-0.5 0.1 -0.9</direction>"
      "</light>";
  const auto world = load(sun +
                          "<light type='directional' name='moon'/><light type='point' "
                          "name='bulb'/>");
  ASSERT_TRUE(world) << full_text(world.error());
  EXPECT_EQ(world->light.to_key, Eigen::Vector3d(0.5, -0.1, 0.9));
  EXPECT_EQ(summary(world->notes), "<light> (2)");
  const auto own = load(sun + "<kaz:light to_lamp='0 0 1' lamp='1' shade='1'/>");
  ASSERT_TRUE(own) << full_text(own.error());
  EXPECT_EQ(own->light.to_key, Eigen::Vector3d(0, 0, 1));
}

// Steps a ball with the given mask, 5 mm in a fixed plane with the mask 2.
std::size_t contacts_with_mask(const WorldModel& world) {
  const RobotModel robot;
  ContactModel model(robot);
  model.add_object(world.bodies.at(1).rigid, -1, world.bodies[1].pose);
  model.add_object(world.bodies.at(2).rigid, 0, world.bodies[2].pose);
  Contacts& contacts = Contacts::of_this_thread();
  contacts.begin(model);
  contacts.place(0, Eigen::Matrix3d::Identity(), world.bodies[2].pose.translation(), true);
  contacts.update();
  return contacts.touches().size();
}

TEST_F(SdfFile, BitmasksDecideWhichShapesCollide) {
  const auto mask = [](const std::string& value) {
    return "<surface><contact><collide_bitmask>" + value + "</collide_bitmask></contact></surface>";
  };
  for (const std::string& fixed_shape :
       {std::string("<plane><normal>0 0 1</normal><size>1 1</size></plane>"),
        std::string("<box><size>1 1 0.01</size></box>")}) {
    for (const auto& [value, touches] : {std::pair{"0x01", 0u}, {"0x03", 1u}, {"2", 1u}}) {
      const auto world = load(
          "<model name='fixed'><static>true</static><link name='l'><collision name='c'>"
          "<geometry>" +
          fixed_shape + "</geometry>" + mask("0x2") +
          "</collision></link></model><model name='m'><pose>0 0 0.095 0 0 0</pose>" +
          link_text("l", ball_text(mask(value))) + "</model>");
      ASSERT_TRUE(world) << full_text(world.error());
      EXPECT_EQ(contacts_with_mask(*world), touches) << value << fixed_shape;
    }
  }
  expect_error("<model name='m'>" + link_text("l", ball_text(mask("0x10000"))) + "</model>",
               "<collide_bitmask> must be a number from 0 to 65535");
}

TEST_F(SdfFile, OfOldAndNewVersions) {
  const auto with_version = [&](const std::string& version, const std::string& models) {
    std::string text = test::world_text("0 0 -9.8", models);
    text.replace(text.find("1.9\" xmlns"), 3, version);
    return load_world(write("world.sdf", text));
  };
  for (const std::string version : {"1.4", "1.5", "1.6", "1.7", "1.8", "1.9", "1.10", "1.11"}) {
    const auto world = with_version(
        version, "<model name='m'><pose>1 0 0 0 0 0</pose>" + link_text("l") + "</model>");
    ASSERT_TRUE(world) << version << full_text(world.error());
    EXPECT_EQ(world->bodies.at(1).pose.translation(), Eigen::Vector3d(1, 0, 0)) << version;
  }
  const auto framed =
      with_version("1.6", "<model name='m'><link name='a'><pose>1 0 0 0 0 0</pose>" + kMass +
                              "</link><link name='b'><pose frame='a'>0 1 0 "
                              "0 0 0</pose>" +
                              kMass + "</link></model>");
  ASSERT_TRUE(framed) << full_text(framed.error());
  EXPECT_EQ(framed->bodies.at(2).pose.translation(), Eigen::Vector3d(1, 1, 0));
  EXPECT_FALSE(with_version("1.12", ""));
}

}  // namespace
}  // namespace kaz::sim
