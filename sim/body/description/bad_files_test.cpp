// Broken robot and world files: one sentence with file and line, and no crash.
// SPDX-License-Identifier: Apache-2.0
#include <ostream>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

// A valid world with one of each element.
const char* const kValidWorld = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf">
  <world name="valid">
    <kaz:robot pose="0 0 0 0 0 0"/>
    <gravity>0 0 -9.81</gravity>
    <model name="floor">
      <static>true</static>
      <link name="slab">
        <visual name="wood">
          <geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
          <material><diffuse>0.7 0.6 0.4 1</diffuse></material>
          <kaz:texture name="wood"/>
        </visual>
      </link>
    </model>
    <model name="ball">
      <pose>0.3 0.5 0.02 0 0 0</pose>
      <link name="ball">
        <inertial>
          <mass>0.015</mass>
          <inertia>
            <ixx>2.4e-6</ixx><iyy>2.4e-6</iyy><izz>2.4e-6</izz>
          </inertia>
        </inertial>
        <collision name="skin">
          <geometry><sphere><radius>0.02</radius></sphere></geometry>
          <surface>
            <friction><ode><mu>1.0</mu></ode></friction>
            <bounce><restitution_coefficient>0.7</restitution_coefficient></bounce>
            <kaz:rolling_resistance metres="0.0002"/>
          </surface>
        </collision>
      </link>
      <kaz:kick time="7.0" velocity="0.34 -0.2 0"/>
    </model>
    <model name="pen">
      <static>true</static>
    </model>
  </world>
</sdf>
)";

struct Case {
  const char* name;
  const char* find;  // in the valid file, once or first
  const char* replace;
  int lines_down;       // the error is that many lines below the change
  const char* message;  // part of the sentence
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

// The text changed, and the line on which the change begins.
std::pair<std::string, int> changed(std::string text, const Case& c) {
  const std::size_t at = text.find(c.find);
  if (at == std::string::npos) {
    ADD_FAILURE() << "the valid file has no " << c.find;
    return {text, 0};
  }
  text.replace(at, std::string(c.find).size(), c.replace);
  return {text, 1 + static_cast<int>(std::count(
                        text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'))};
}

void expect_error(const Error& error, const std::string& path, int line, const Case& c) {
  EXPECT_EQ(error.fault, Fault::usage);
  EXPECT_EQ(error.message.find(path + ":" + std::to_string(line) + ": "), 0u) << error.message;
  EXPECT_NE(error.message.find(c.message), std::string::npos) << error.message;
  EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
}

class BadRobot : public testing::TestWithParam<Case> {};

TEST_P(BadRobot, IsNamedWithFileAndLine) {
  const test::Folder folder;
  const auto [text, line] = changed(test::read_text(test::kRobot), GetParam());
  const std::string path = folder.write("robot.urdf", text);
  const auto robot = load_robot(path);
  ASSERT_FALSE(robot);
  expect_error(robot.error(), path, line + GetParam().lines_down, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadRobot,
    testing::Values(
        Case{"xml", "<mass value=\"0.060\"/>", "<mass value=0.060/>", 0, "well-formed"},
        Case{"other_root", "<robot name=\"kaz\">", "<model name=\"kaz\"/><!--", 0, ""},
        Case{"typing_error", "<visual name=\"pelvis\">", "<visuel/><visual name=\"pelvis\">", 0,
             "unknown element <visuel> in <link>"},
        Case{"negative_mass", "<mass value=\"0.550\"/>", "<mass value=\"-0.55\"/>", 0,
             "a mass of -0.55 kg; masses are not negative"},
        Case{"no_number", "<mass value=\"0.550\"/>", "<mass value=\"half\"/>", 0,
             "attribute `value` of <mass> is \"half\""},
        Case{"two_numbers", "size=\"0.05 0.084 0.02\"", "size=\"0.05 0.084\"", 0,
             "attribute `size` of <box> must be 3 numbers"},
        Case{"millimetres", "size=\"0.05 0.084 0.02\"", "size=\"50 84 20\"", 0,
             "<box> has a size of 50 m; sizes are above 0 and at most 10 m"},
        Case{"negative_size", "size=\"0.05 0.084 0.02\"", "size=\"0.05 -0.084 0.02\"", 0,
             "<box> has a size of -0.084 m"},
        Case{"inverted_cylinder", "<cylinder radius=\"0.009\" length=\"0.002\"/>",
             "<cylinder radius=\"-1\" length=\"0.002\"/>", 0, "<cylinder> has a size of -1 m"},
        Case{"far_away", "<origin xyz=\"-0.004 0 0.021\"/>", "<origin xyz=\"-4000 0 21\"/>", 0,
             "<origin> lies -4000 m away"},
        Case{"grams", "<mass value=\"0.550\"/>", "<mass value=\"550\"/>", 0,
             "a mass of 550 kg; the maximum is 500 kg"},
        Case{"turned_often", "<origin xyz=\"-0.004 0 0.021\"/>",
             "<origin xyz=\"0 0 0\" rpy=\"0 1e9 0\"/>", 0,
             "turned by 1e+09 rad; angles are from -100 to 100 rad"},
        Case{"as_inert_as_a_planet", "<inertia ixx=\"0.000872\"", "<inertia ixx=\"1e30\"", 0,
             "ixx of 1e+30 kg m2; moments are from -10000 to 10000 kg m2"},
        Case{"ampersand", "<robot name=\"kaz\">", "<robot name=\"kaz&amp;co\">", 0,
             "the name `kaz&co` of <robot> contains one of & < >"},
        Case{"quote", "<visual name=\"pelvis\">", "<visual name='pel\"vis'>", 0,
             "of <visual> contains one of"},
        Case{"newline", "<visual name=\"pelvis\">", "<visual name=\"pel&#10;vis\">", 0,
             "the name `pel vis` of <visual>"},
        Case{"escape", "<visual name=\"pelvis\">", "<visual name=\"pel&#x1b;[2Jvis\">", 0,
             "the name `pel\\x1b[2Jvis` of <visual>"},
        Case{"no_mesh", "<box size=\"0.05 0.084 0.02\"/>", "<mesh filename=\"pelvis.stl\"/>", 0,
             "mesh `pelvis.stl` cannot be read (No such file or directory); check the path, add a "
             "folder to KAZ_MESH_PATH, or give --skip-missing-meshes"},
        Case{"mesh_of_another_kind", "<box size=\"0.05 0.084 0.02\"/>",
             "<mesh filename=\"pelvis.blend\"/>", 0,
             "mesh `pelvis.blend` is not .obj, .stl or .dae"},
        Case{"mesh_that_is_none", "<box size=\"0.05 0.084 0.02\"/>",
             "<mesh filename=\"none.stl\"/>", 0, "mesh `none.stl` "},
        Case{"friction_of_nobody", "<gazebo reference=\"trunk\">", "<gazebo reference=\"belly\">",
             0, "<gazebo> refers to link `belly`, which does not exist"},
        Case{"negative_friction", "<mu1>0.4</mu1>", "<mu1>-0.4</mu1>", 0,
             "<mu1> must contain one number not below 0"},
        Case{"two_frictions", "<mu1>0.4</mu1>", "<mu1>0.4</mu1><mu2>0.5</mu2>", 0,
             "<mu2> must contain one number not below 0; mu1 and mu2 must be equal"},
        Case{"impossible_inertia", "<inertia ixx=\"0.000872\"", "<inertia ixx=\"0.1\"", 0,
             "the inertia of link `trunk` is impossible"},
        Case{"unknown_child", "<child link=\"neck_pan\"/>", "<child link=\"neck_pam\"/>", 0,
             "child link `neck_pam` of joint `neck_pan` does not exist"},
        Case{"loop", "<parent link=\"trunk\"/><child link=\"neck_pan\"/>",
             "<parent link=\"neck_tilt\"/><child link=\"neck_pan\"/>", -1, "closes a loop"},
        Case{"second_parent", "<child link=\"neck_tilt\"/>", "<child link=\"neck_pan\"/>", -1,
             "link `neck_pan` is already the child of joint `neck_pan`"},
        Case{"mimic", "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/><mimic joint=\"waist\"/>", 0,
             "joint `neck_pan` follows joint `waist`, which does not exist"},
        Case{"zero_axis", "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>", 0,
             "axis of joint `neck_pan` is zero"},
        Case{"swapped_limits", "<limit lower=\"-1.5707\" upper=\"1.5707\"",
             "<limit lower=\"1.5707\" upper=\"-1.5707\"", 0, "is above the upper one; swap them"},
        Case{"degrees", "<limit lower=\"-1.5707\" upper=\"1.5707\"",
             "<limit lower=\"-1.5707\" upper=\"180\"", 0,
             "is 180 rad; limits are from -100 to 100 rad"},
        Case{"planar", "<joint name=\"neck_pan\" type=\"revolute\">",
             "<joint name=\"neck_pan\" type=\"planar\">", 0, "type \"planar\""},
        Case{"not_wired", "<link name=\"left_eye\"/>\n  <joint name=\"left_eye\" type=\"fixed\">",
             "<link name=\"left_eye\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" "
             "izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
             "  <joint name=\"waist\" type=\"revolute\"><limit lower=\"0\" upper=\"1\" "
             "effort=\"1\" velocity=\"1\"/>",
             1, "joint `waist` is not a joint of the servo board"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(BadRobotFile, LacksAJointOfTheBoard) {
  const test::Folder folder;
  std::string text = test::read_text(test::kRobot);
  for (std::size_t at; (at = text.find("\"r_hand\"")) != std::string::npos;) {
    text.replace(at, 8, "\"r_claw\"");
  }
  const std::string path = folder.write("robot.urdf", text);
  const auto robot = load_robot(path);
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("robot has no joint `r_hand`"), std::string::npos)
      << robot.error().message;
}

// A robot file that somebody sends must not make the program read files elsewhere.
TEST(BadRobotFile, NamesAMeshOutsideOfItsPackage) {
  namespace fs = std::filesystem;
  const test::Folder folder;
  const fs::path root = fs::path(folder.write("root", "")).parent_path();
  const fs::path urdf = root / "package/urdf", secret = root / "elsewhere/secret.stl";
  fs::create_directories(urdf);
  fs::create_directories(secret.parent_path());
  const std::string mesh = "solid a\nfacet normal 0 0 1\nendfacet\nendsolid a\n";
  folder.write("elsewhere/secret.stl", mesh);
  folder.write("package/base.stl", mesh);
  fs::create_symlink(secret, urdf / "link.stl");
  fs::create_directory_symlink(secret.parent_path(), urdf / "folder");
  fs::create_symlink("../base.stl", urdf / "inner.stl");
  const auto load = [&](const std::string& name) {
    const std::string named = "<mesh filename=\"" + name + "\"/>";
    const Case with_mesh{"", "<box size=\"0.05 0.084 0.02\"/>", named.c_str(), 0, ""};
    return load_robot(folder.write("package/urdf/robot.urdf",
                                   changed(test::read_text(test::kRobot), with_mesh).first));
  };
  const std::vector<std::string> always{"link.stl", "folder/secret.stl", secret.string(),
                                        "../../elsewhere/secret.stl"};
  std::vector<std::string> outside = always;
  outside.insert(outside.end(), {"../base.stl", "inner.stl"});
  for (const std::string& name : outside) {
    const auto robot = load(name);
    ASSERT_FALSE(robot) << name;
    EXPECT_NE(robot.error().message.find("outside of the robot's folder"), std::string::npos)
        << robot.error().message;
  }
  // With a package.xml the folder above is the robot's package.
  folder.write("package/package.xml", "<package/>");
  EXPECT_TRUE(load("../base.stl"));
  EXPECT_TRUE(load("inner.stl"));
  for (const std::string& name : always) EXPECT_FALSE(load(name)) << name;
  // The user names another folder.
  setenv("KAZ_MESH_PATH", ("/nowhere:" + secret.parent_path().string()).c_str(), 1);
  const auto robot = load("folder/secret.stl");
  unsetenv("KAZ_MESH_PATH");
  ASSERT_TRUE(robot) << robot.error().message;
  std::vector<std::string> paths;
  for (const RobotLink& link : robot->links) {
    for (const Visual& visual : link.rigid.visuals) paths.push_back(visual.shape.mesh_path);
  }
  EXPECT_EQ(std::ranges::count(paths, fs::canonical(secret).string()), 1)
      << "what is read later is not the file that was checked";
}

TEST(BadRobotFile, DoesNotExist) {
  const auto robot = load_robot("no/such.urdf");
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().message,
            "no/such.urdf: cannot be read (No such file or directory); check the path");
}

class BadWorld : public testing::TestWithParam<Case> {};

TEST_P(BadWorld, IsNamedWithFileAndLine) {
  const test::Folder folder;
  const auto [text, line] = changed(kValidWorld, GetParam());
  const std::string path = folder.write("world.sdf", text);
  const auto world = load_world(path);
  ASSERT_FALSE(world);
  expect_error(world.error(), path, line + GetParam().lines_down, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadWorld,
    testing::Values(
        Case{"xml", "<mass>0.015</mass>", "<mass 0.015</mass>", 0, "well-formed"},
        Case{"typing_error", "<mass>0.015</mass>", "<mas>0.015</mas>", 0,
             "unknown element <mas> in <inertial>, which accepts inertia, mass, pose"},
        Case{"two_masses", "<mass>0.015</mass>", "<mass>0.015</mass><mass>1</mass>", 0,
             "<mass> occurs twice in <inertial>"},
        Case{"two_gravities", "<gravity>0 0 -9.81</gravity>",
             "<gravity>0 0 -9.81</gravity>\n<gravity>0 0 9.81</gravity>", 1,
             "<gravity> occurs twice in <world>"},
        Case{"text_between", "<mass>0.015</mass>", "<mass>0.015</mass>heavy", 0,
             "text in <inertial>, which accepts only elements"},
        Case{"version_as_a_power", "<sdf version=\"1.9\"", "<sdf version=\"1e0\"", 0,
             "SDF version \"1e0\" is not supported; the newest supported version is 1.11"},
        Case{"version_to_come", "<sdf version=\"1.9\"", "<sdf version=\"9.9\"", 0,
             "SDF version \"9.9\" is not supported; the newest supported version is 1.11"},
        Case{"not_taken", "<kaz:robot", "<population name=\"p\"/><kaz:robot", 0,
             "<population> is not supported: give each model as a <model>"},
        Case{"misspelled_attribute", "<kaz:robot pose=", "<kaz:robot yaw=\"1\" pose=", 0,
             "attribute `yaw` of <kaz:robot> is unknown; <kaz:robot> accepts pose first_step"},
        Case{"no_normal", "<normal>0 0 1</normal>", "<normal>0 0 0</normal>", 0,
             "<normal> is zero; give a direction"},
        Case{"no_number", "<mass>0.015</mass>", "<mass>light</mass>", 0,
             "<mass> must contain 1 number not below 0 and at most 10000, not \"light\""},
        Case{"five_numbers", "<pose>0.3 0.5 0.02 0 0 0</pose>", "<pose>0.3 0.5 0.02 0 0</pose>", 0,
             "<pose> must contain 6 numbers"},
        Case{"flat_ball", "<radius>0.02</radius>", "<radius>0</radius>", 0,
             "<radius> must contain 1 number above 0"},
        Case{"no_mass", "<mass>0.015</mass>", "", -1, "<inertial> lacks <mass>"},
        Case{"zero_mass", "<mass>0.015</mass>", "<mass>0</mass>", 1, "impossible mass or inertia"},
        Case{"as_large_as_a_town", "<radius>0.02</radius>", "<radius>20000</radius>", 0,
             "<radius> must contain 1 number above 0 and at most 1000"},
        Case{"impossible_inertia", "<ixx>2.4e-6</ixx>", "<ixx>2.4e-3</ixx>", -1,
             "impossible mass or inertia"},
        Case{"as_light_as_nothing", "<mass>0.015</mass>", "<mass>1e-200</mass>", 0,
             "a mass of 1e-200 kg; a movable body must have 1e-9 to 10000 kg"},
        Case{"beyond_the_horizon", "<pose>0.3 0.5 0.02 0 0 0</pose>",
             "<pose>0.3 1e9 0.02 0 0 0</pose>", 0,
             "<pose> must contain 6 numbers from -1000 to 1000 (m, rad)"},
        Case{"gravity_of_a_star", "<gravity>0 0 -9.81</gravity>", "<gravity>0 0 -9810</gravity>", 0,
             "<gravity> must contain 3 numbers from -50 to 50 m/s2, not \"0 0 -9810\""},
        Case{"moments_of_a_star", "<ixx>2.4e-6</ixx>", "<ixx>1e250</ixx>", 0,
             "<ixx> must contain 1 number from -1e+09 to 1e+09 kg m2"},
        Case{"kick_of_light", "velocity=\"0.34 -0.2 0\"", "velocity=\"3e8 0 0\"", 0,
             "attribute `velocity` with 3 numbers from -100 to 100 m/s"},
        Case{"kick_in_a_million_years", "time=\"7.0\"", "time=\"3e13\"", 0,
             "attribute `time` with 1 number not below 0 and at most 1e+06 s"},
        Case{"robot_on_the_moon", "<kaz:robot pose=\"0 0 0 0 0 0\"/>",
             "<kaz:robot pose=\"0 0 3.8e8 0 0 0\"/>", 0,
             "attribute `pose` with 6 numbers from -100 to 100 (m, rad)"},
        Case{"ampersand", "<model name=\"ball\">", "<model name=\"b&amp;ll\">", 0,
             "the name `b&ll` of <model> contains one of & < >"},
        Case{"tag_in_a_name", "<link name=\"slab\">", "<link name=\"a&lt;b\">", 0,
             "the name `a<b` of <link>"},
        Case{"newline", "<model name=\"ball\">", "<model name=\"ba&#10;ll\">", 0,
             "the name `ba ll` of <model>"},
        Case{"kick_without_time", "<kaz:kick time=\"7.0\"", "<kaz:kick tiem=\"7.0\"", 0,
             "attribute `tiem` of <kaz:kick> is unknown; <kaz:kick> accepts time velocity"},
        Case{"kick_of_two_numbers", "velocity=\"0.34 -0.2 0\"", "velocity=\"0.34 -0.2\"", 0,
             "<kaz:kick> needs the attribute `velocity` with 3 numbers"},
        Case{"robot_pose", "<kaz:robot pose=\"0 0 0 0 0 0\"/>", "<kaz:robot pose=\"0 0 0\"/>", 0,
             "<kaz:robot> needs the attribute `pose` with 6 numbers"},
        Case{"lamp_below", "<kaz:robot",
             "<kaz:light to_lamp=\"1 0 0\" lamp=\"1\" shade=\"1\"/><kaz:robot", 0,
             "<kaz:light> needs a lamp 3 degrees or more above"},
        Case{"lamp_dark", "<kaz:robot",
             "<kaz:light to_lamp=\"1 0 1\" lamp=\"-1\" shade=\"1\"/><kaz:robot", 0,
             "<kaz:light> needs the attribute `lamp` with 1 number not below 0"},
        Case{"texture", "<kaz:texture name=\"wood\"/>", "<kaz:texture name=\"oak\"/>", 0,
             "<kaz:texture> needs a `name` of checker, wood or carpet"},
        Case{"frozen_ball", "<kaz:kick time=\"7.0\"", "<static>true</static><kaz:kick time=\"7.0\"",
             0, "model `ball` is static, so <kaz:kick> cannot move it"},
        Case{"restitution", "<restitution_coefficient>0.7</restitution_coefficient>",
             "<restitution_coefficient>1.7</restitution_coefficient>", 0,
             "<restitution_coefficient> must contain 1 number from 0 to 1"},
        Case{"same_name_twice", "<model name=\"pen\">", "<model name=\"ball\">", 0,
             "model `ball` is already defined above"},
        Case{"no_shape", "<geometry><sphere><radius>0.02</radius></sphere></geometry>",
             "<geometry></geometry>", -1, "<collision> must contain one <geometry> with one shape"},
        Case{"no_truth", "<static>true</static>", "<static>maybe</static>", 0,
             "<static> must be true or false"}),
    [](const auto& test) { return std::string(test.param.name); });

// Known to the parser alone, which gives no line.
TEST(ValidWorldFile, IsTaken) {
  const test::Folder folder;
  const auto world = load_world(folder.write("world.sdf", kValidWorld));
  ASSERT_TRUE(world) << world.error().message;
  ASSERT_EQ(world->bodies.size(), 2u);
  const WorldBody& ball = world->bodies[1];
  EXPECT_EQ(ball.model, "ball");
  EXPECT_EQ(ball.rigid.mass, 0.015);
  ASSERT_EQ(ball.kicks.size(), 1u);
  EXPECT_EQ(ball.kicks[0].velocity, Eigen::Vector3d(0.34, -0.2, 0));
  ASSERT_EQ(ball.rigid.collisions.size(), 1u);
  EXPECT_EQ(ball.rigid.collisions[0].surface.restitution, 0.7);
  EXPECT_EQ(ball.rigid.collisions[0].surface.rolling_resistance, 0.0002);
  EXPECT_EQ(world->bodies[0].rigid.visuals[0].texture, "wood");
  EXPECT_EQ(world->light.to_key, Light{}.to_key) << "without <kaz:light>";
  const Case light{"", "<kaz:robot",
                   "<kaz:light to_lamp=\"0 2 3\" lamp=\"0.5\" shade=\"1.2\"/><kaz:robot", 0, ""};
  const auto lit = load_world(folder.write("lit.sdf", changed(kValidWorld, light).first));
  ASSERT_TRUE(lit) << lit.error().message;
  EXPECT_EQ(lit->light.to_key, Eigen::Vector3d(0, 2, 3));
  EXPECT_EQ(lit->light.key, 0.5);
  EXPECT_EQ(lit->light.shaded, 1.2);
}

TEST(BadWorldFile, NamesTheLinkToo) {
  const test::Folder folder;
  std::string text = kValidWorld;
  const auto mass = text.find("<mass>");
  ASSERT_NE(mass, std::string::npos);
  text.replace(mass, text.find("</mass>") - mass, "<mass>heavy");
  const auto world = load_world(folder.write("world.sdf", text));
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("(link `"), std::string::npos) << world.error().message;
  EXPECT_NE(world.error().message.find("` of model `"), std::string::npos);
}

TEST(BadWorldFile, HasAReservedName) {
  const test::Folder folder;
  std::string text = kValidWorld;
  text.replace(text.find("\"pen\""), 5, "\"__pen__\"");
  const std::string path = folder.write("world.sdf", text);
  const auto world = load_world(path);
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().message.find(path + ": "), 0u) << world.error().message;
  EXPECT_NE(world.error().message.find("[__pen__] is reserved"), std::string::npos);
}

TEST(Load, NamesUnknownDynamics) {
  WorldOptions options;
  options.dynamics = "fast";
  const auto world = World::load(test::kEmpty, test::kRobot, options);
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("unknown dynamics `fast` (--dynamics)"), std::string::npos);
}

TEST(Load, RefusesAStartInsideAModel) {
  const test::Folder folder;
  const auto with_box_at = [&](const std::string& place, const std::string& robot =
                                                             "<kaz:robot pose='0 0 0 0 0 0'/>") {
    const std::string path = folder.write(
        "box.sdf", "<sdf version='1.9' xmlns:kaz='urn:kaz:sdf'><world name='w'>" + robot +
                       "<model name='crate'><static>true</static><pose>" + place +
                       "</pose><link name='l'><collision name='c'><geometry><box><size>0.2 0.2 0.2"
                       "</size></box></geometry></collision></link></model></world></sdf>");
    return World::load(path, test::kRobot, WorldOptions{});
  };
  const auto inside = with_box_at("0.05 0 0.1 0 0 0.3");
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error().fault, Fault::usage);
  EXPECT_NE(inside.error().message.find("starts inside the model `crate`"), std::string::npos)
      << inside.error().message;
  EXPECT_TRUE(with_box_at("0.3 0 0.1 0 0 0.3"));
  EXPECT_TRUE(with_box_at("0 0 -0.1 0 0 0")) << "it stands on it";
  // A world of another program does not state the start.
  const auto elsewhere = with_box_at("0.05 0 0.1 0 0 0.3", "");
  ASSERT_TRUE(elsewhere) << elsewhere.error().message;
  const double distance = (*elsewhere)->link_pose("trunk").translation().head<2>().norm();
  EXPECT_GT(distance, 0.4);
  EXPECT_LT(distance, 1.6);
}

TEST(Load, NamesAnUnknownMotor) {
  WorldOptions options;
  options.motor = "s3003";
  const auto world = World::load(test::kEmpty, test::kRobot, options);
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("has no motor `s3003`"), std::string::npos);
}

TEST(Load, NamesAnUnknownObject) {
  const auto world = test::load_or_fail(test::kBall, {});
  ASSERT_TRUE(world);
  const auto cube = world->object_position("cube");
  ASSERT_FALSE(cube);
  EXPECT_EQ(cube.error().message, "the world has no object `cube`; movable objects: ball");
}

}  // namespace
}  // namespace kaz::sim
