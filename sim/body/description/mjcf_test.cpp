// Robots in MJCF: elements that are used, noted and refused, includes, meshes, couplings, actuators.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <tuple>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/body/description/convex_hull.h"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/mesh_file.h"
#include "sim/body/description/mjcf_elements.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_writer.h"

namespace kaz::sim {
namespace {

const char* const kMass = "<inertial pos='0 0 0' mass='1' diaginertia='2e-3 2e-3 2e-3'/>";

// A floating trunk with an arm, one element in each line, with additions.
struct TwoBodies {
  std::string trunk = kMass, arm = kMass, joint = "name='j' axis='0 0 1'", root = "<freejoint/>",
              after;
  std::string text() const {
    return "<mujoco model='r'>\n<worldbody>\n<body name='trunk'>" + root + trunk +
           "\n<body name='arm' pos='0 0 0.1'>" + arm + "\n<joint " + joint +
           "/>\n</body></body></worldbody>\n" + after + "</mujoco>\n";
  }
};

class MjcfFile : public testing::Test {
 protected:
  Result<RobotModel> load(const TwoBodies& robot, const ReadOptions& options = {}) {
    return load_robot(folder_.write("robot.xml", robot.text()), options);
  }
  // The errors of a file that must not be accepted.
  std::string errors(const TwoBodies& robot, const ReadOptions& options = {}) {
    const auto read = load(robot, options);
    return read ? "accepted" : full_text(read.error());
  }
  const test::Folder folder_;
};

#define EXPECT_PART(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(MjcfFile, ReportsAllErrorsTogetherWithTheirLines) {
  TwoBodies robot;
  robot.trunk += "<geom size='0.1' tint='1'/>";
  robot.arm += "<geom size='a b'/><flexcomp/><wheel/>";
  robot.joint += " stiffness='3'";
  robot.after = "<option density='1.2'/>";
  const std::string all = errors(robot);
  for (const char* part :
       {":3: attribute `tint` of <geom> is unknown; remove it",
        ":4: attribute `size` of <geom> is \"a b\", expected 1 to 3 numbers",
        ":4: <flexcomp> in <body> is not supported: Kaz has rigid bodies only",
        ":4: unknown element <wheel> in <body>",
        ":5: attribute `stiffness` of <joint> is not supported: Kaz has no springs in joints",
        ":7: attribute `density` of <option> is not supported: Kaz has no fluid"})
    EXPECT_PART(all, part);
}

TEST_F(MjcfFile, NotesWhatPhysicsDoesNotNeed) {
  TwoBodies robot;
  robot.joint += " armature='0.1' stiffness='0'";
  robot.after =
      "<option timestep='0.001'><flag eulerdamp='disable'/></option><actuator>"
      "<position joint='j' kp='3' kv='1' inheritrange='1'/></actuator><sensor><gyro/></sensor>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(summary(read->notes),
            "attribute `armature` of <joint>, attribute `timestep` of <option>, <flag>, attribute "
            "`kp` of <position>, attribute `kv` of <position>, attribute `inheritrange` of "
            "<position>, <sensor>");
  const std::string strict = errors(robot, {.strict = true});
  EXPECT_PART(strict, ":5: attribute `armature` of <joint> is not used, which --strict does not");
}

TEST_F(MjcfFile, RefusesClosedLoopsAndNamesTheCouplingThatCanReplaceThem) {
  TwoBodies robot;
  robot.arm += "<body name='rod'><joint name='passive'/>" + std::string(kMass) + "</body>";
  robot.after = "<equality>\n<connect body1='rod' body2='trunk' anchor='0 0 0'/></equality>";
  EXPECT_PART(errors(robot),
              ":8: <connect> of `rod` and `trunk` in <equality> is not supported: open the loop");
  robot.after += "<equality>\n<joint joint1='passive' joint2='j'/></equality>";
  EXPECT_PART(errors(robot),
              "the coupling of `passive` to `j` in line 9 can replace it: remove <connect>");
  robot.after =
      "<equality><weld body1='rod' body2='trunk' active='false'/></equality><tendon>"
      "<spatial name='t'><site site='a'/></spatial></tendon>";
  EXPECT_PART(errors(robot), "spatial `t` in <tendon> is not supported: state how the joints turn");
}

TEST_F(MjcfFile, RefusesJointsWithSeveralDegreesOfFreedom) {
  for (const auto& [joint, message] : std::vector<std::pair<std::string, std::string>>{
           {"name='j' type='ball'", ":4: body `arm` has a ball joint, which is not supported"},
           {"axis='0 0 1'", ":4: <joint> has no name; Kaz's joints have names"},
           {"name='l'/><joint type='ball'", ":4: body `arm` has a ball joint"}}) {
    TwoBodies robot;
    robot.trunk += "<body name='b'><joint name='k'/>" + std::string(kMass) + "</body>";
    robot.joint = joint;
    EXPECT_PART(errors(robot), message);
  }
  TwoBodies robot;
  robot.arm = "<geom size='0.1' contype='0' conaffinity='0' mass='0'/>";
  EXPECT_PART(errors(robot), ":4: <body>: mass and inertia of moving bodies must be larger than");
  robot = {};
  robot.after = "<worldbody><body name='b'><freejoint/><body name='c'><joint name='k'/>" +
                std::string(kMass) + "</body>" + kMass + "</body></worldbody>";
  EXPECT_PART(errors(robot), "bodies `trunk` and `b` are two robots; a file has one");
}

TEST_F(MjcfFile, ErrorsOfLibmujocoNameTheLineOfTheFile) {
  TwoBodies robot;
  robot.joint += " range='1 -1'";
  EXPECT_PART(errors(robot), ":5: <joint>: range[0] should be smaller than range[1] in joint 'j'");
  robot = {};
  robot.after = "<actuator>\n<motor joint='none'/></actuator>";
  EXPECT_PART(errors(robot), ":8: <motor>: unknown transmission target 'none'");
  robot = {};
  robot.arm += "<geom size='0.1' type='pyramid'/>";
  EXPECT_PART(errors(robot), ":4: <geom>: invalid keyword: 'pyramid' (libmujoco)");
}

TEST_F(MjcfFile, IncludedFilesAreReadOnceAndErrorsNameThem) {
  TwoBodies robot;
  robot.after = "<include file='motors.xml'/>";
  folder_.write("motors.xml",
                "<mujocoinclude>\n<actuator><motor joint='j' gear='2' ctrlrange='-1 1'/></actuator>"
                "</mujocoinclude>");
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->joints[0].effort, 2);
  folder_.write("motors.xml",
                "<x>\n\n<wheel/><include file='robot.xml'/><include file='no.xml'/></x>");
  const std::string all = errors(robot);
  EXPECT_PART(all, "motors.xml:3: included file `robot.xml` is already part of this robot");
  EXPECT_PART(all, "included file `no.xml` cannot be used: ");
  folder_.write("motors.xml", "<x>\n\n<wheel/></x>");
  EXPECT_PART(errors(robot), "motors.xml:3: unknown element <wheel> in <mujoco>");
  robot.after = "<include file='../../../../../../../etc/passwd'/>";
  EXPECT_PART(errors(robot), "which is outside of the robot's folder");
}

TEST_F(MjcfFile, DeeplyNestedAndLargeFilesAreRefused) {
  TwoBodies robot;
  for (int i = 0; i < 70000; ++i) robot.after += "<size/>";
  EXPECT_PART(errors(robot), "more than 50000 elements or 100 levels");
  std::string open, close;
  for (int i = 0; i < 60; ++i) {
    open += "<body>";
    close += "</body>";
  }
  folder_.write("deep.xml", "<x>" + open + close + "</x>");
  robot.after = "<worldbody>" + open + "<include file='deep.xml'/>" + close + "</worldbody>";
  EXPECT_PART(errors(robot), "more than 50000 elements or 100 levels");
}

TEST_F(MjcfFile, CouplingsLeadFromTheJointWithAnActuator) {
  TwoBodies robot;
  robot.arm += "<body name='rod'><joint name='passive' ref='0.2'/>" + std::string(kMass) +
               "<body name='end'><joint name='last'/>" + kMass + "</body></body>";
  robot.after =
      "<compiler angle='radian'/><equality><joint joint1='j' joint2='passive' "
      "polycoef='0.1 -2 0 0 0'/>"
      "<joint joint1='last' joint2='passive' polycoef='0 3 0 0 0'/></equality>"
      "<actuator><motor joint='j'/></actuator>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->joint_order(), std::vector<std::string>{"j"});
  ASSERT_EQ(read->joints.size(), 3u);
  // j = 0.1 - 2 (passive - 0.2), thus passive = 0.25 - j / 2; last = 3 (passive - 0.2).
  const RobotJoint &passive = read->joints[1], &last = read->joints[2];
  EXPECT_EQ(passive.name, "passive");
  EXPECT_NEAR(passive.follows->ratio, -0.5, 1e-12);
  EXPECT_NEAR(passive.follows->offset, 0.25, 1e-12);
  EXPECT_NEAR(last.follows->ratio, -1.5, 1e-12);
  EXPECT_NEAR(last.follows->offset, 0.15, 1e-12);
  for (const RobotLink& link : read->links)
    if (link.joint >= 0) {
      EXPECT_EQ(link.rigid.name,
                read->links[static_cast<std::size_t>(
                                read->joints[static_cast<std::size_t>(link.joint)].child)]
                    .rigid.name);
    }
  robot.after = "<equality><joint joint1='passive' joint2='j' polycoef='0 1 2 0 0'/></equality>";
  EXPECT_PART(errors(robot), "the coupling of joint `passive` is not linear");
  robot.after =
      "<equality><joint joint1='passive' joint2='j'/><joint joint1='j' joint2='passive'/>"
      "</equality>";
  EXPECT_PART(errors(robot), "follows itself; remove one of the couplings");
}

TEST_F(MjcfFile, EffortsAreTheActuatorsForces) {
  TwoBodies robot;
  robot.arm += "<body name='rod'><joint name='k'/>" + std::string(kMass) + "</body>";
  robot.joint += " actuatorfrcrange='-4 4'";
  robot.after =
      "<default><default class='m'><position forcerange='-3 2.5'/></default></default><actuator>"
      "<position class='m' joint='j' gear='2'/></actuator>";
  auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->joints[0].effort, 4) << "2 x 3 Nm, but 4 Nm at the joint";
  EXPECT_EQ(read->joints[1].effort, HUGE_VAL);
  EXPECT_EQ(read->joints[1].velocity, HUGE_VAL);
  EXPECT_PART(summary(read->notes), "passive motion of joint `k` (it gets a motor)");
}

TEST_F(MjcfFile, ImpossibleValuesAreRefused) {
  for (const auto& [joint, arm, message] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"range='-180 18000'", "", ":5: a limit of joint `j` is beyond 100 rad; check `angle`"},
           {"damping='-1'", "", ":5: `damping` or `frictionloss` of joint `j` is negative"},
           {"", "<geom size='0.1' friction='-1'/>", ":4: <geom> has a negative `friction`"},
           {"", "<geom size='11'/>", ":4: <geom> is larger than 10 m; give its size in m"},
           {"", "<body pos='11 0 0'/>", ":4: body `body_3` is more than 10 m away"},
           {"", "<body><inertial pos='0 0 0' mass='501' diaginertia='1 1 1'/></body>",
            ":4: body `body_3` has a mass above 500 kg"},
           {"pos='0 0 1'", "<body name='arm_at_j'/>", ":4: the name `arm_at_j` is used twice"}}) {
    TwoBodies robot;
    robot.joint += " " + joint;
    robot.arm += arm;
    EXPECT_PART(errors(robot), message);
  }
}

TEST_F(MjcfFile, ThingsOfTheWorldAreNoted) {
  TwoBodies robot;
  robot.after =
      "<worldbody><geom name='floor' type='plane' size='1 1 1'/><body name='box'><freejoint/>"
      "<geom size='0.1'/></body></worldbody>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->links.size(), 2u);
  EXPECT_EQ(summary(read->notes),
            "body `box` of the world (use --world), geom `floor` of the "
            "world (use --world)");
  robot.root = "";
  const auto fixed = load(robot);
  ASSERT_TRUE(fixed) << full_text(fixed.error());
  EXPECT_TRUE(fixed->fixed_base);
  EXPECT_EQ(fixed->links[0].rigid.name, "world");
  EXPECT_EQ(fixed->links[0].rigid.mass, 1) << "the trunk is fixed to the world";
}

TEST_F(MjcfFile, ShapesOfGeoms) {
  TwoBodies robot;
  robot.arm +=
      "<geom type='capsule' size='0.01 0.05' friction='0.7' rgba='1 0 0 1'/>"
      "<geom type='box' size='1 2 3' contype='0' conaffinity='0' condim='1' material='green'/>"
      "<geom size='0.1' group='3' condim='1'/>";
  robot.after = "<asset><material name='green' rgba='0 1 0 1'/></asset>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  const RigidLink& arm = read->links[1].rigid;
  ASSERT_EQ(arm.collisions.size(), 2u);
  EXPECT_EQ(arm.collisions[0].shape.size, Eigen::Vector3d(0.01, 0.1, 0));
  EXPECT_EQ(arm.collisions[0].surface.mu, 0.7);
  EXPECT_EQ(arm.collisions[1].surface.mu, 0) << "condim 1";
  ASSERT_EQ(arm.visuals.size(), 2u);
  EXPECT_EQ(arm.visuals[0].color.r, 1);
  EXPECT_EQ(arm.visuals[1].color.g, 1);
  EXPECT_EQ(arm.visuals[1].shape.size, Eigen::Vector3d(2, 4, 6));
  robot.arm += "<geom type='ellipsoid' size='0.1 0.2 0.3'/>";
  EXPECT_PART(errors(robot), ":4: <geom> is a plane or an ellipsoid, which is not supported");
}

// A tetrahedron whose corners are 0, x, y and z, of 1, 2 and 3 cm. libmujoco moves it to its center of mass.
TEST_F(MjcfFile, MeshesKeepTheirFrame) {
  folder_.write("part.obj",
                "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  TwoBodies robot;
  robot.after =
      "<compiler angle='radian' exactmeshinertia='true'/><default><default class='c'>"
      "<mesh scale='0.01 0.01 0.01'/></default></default><asset><mesh class='c' "
      "file='part.obj'/></asset>";
  for (const char* mass : {"", kMass}) {
    robot.arm = std::string(mass) + "<geom type='mesh' mesh='part' pos='0 0 1' euler='0 0 0.5'/>";
    const auto read = load(robot);
    ASSERT_TRUE(read) << full_text(read.error());
    const RigidLink& arm = read->links[1].rigid;
    const Eigen::Isometry3d expected =
        Eigen::Translation3d(0, 0, 1) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(arm.visuals.at(0).in_frame.isApprox(expected, 1e-12));
    EXPECT_EQ(arm.visuals[0].shape.size, Eigen::Vector3d(0.01, 0.01, 0.01));
    const CollisionShape& shape = arm.collisions.at(0);
    ASSERT_EQ(shape.shape.kind, Shape::Kind::hull);
    const HullMesh& mesh = shape.shape.hull->mesh;
    EXPECT_TRUE((shape.in_link * mesh.origin).isApprox(expected.translation(), 1e-12));
    if (*mass == '\0') {
      EXPECT_NEAR(arm.mass, 1000 * 1e-6, 1e-9) << "1 cm3";
      EXPECT_TRUE(arm.com.isApprox(expected * Eigen::Vector3d(0.0025, 0.005, 0.0075), 1e-6));
    }
  }
}

TEST_F(MjcfFile, MissingMeshesAreNamedAndCanBeSkippedIfTheyGiveNoMass) {
  TwoBodies robot;
  robot.arm += "<geom type='mesh' mesh='part'/>";
  robot.after = "<compiler meshdir='meshes'/><asset><mesh file='part.stl'/></asset>";
  EXPECT_PART(errors(robot), ":7: mesh `part.stl` cannot be read");
  const auto read = load(robot, {.skip_missing_meshes = true});
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(summary(read->notes), "mesh `part.stl`");
  EXPECT_EQ(read->links[1].rigid.visuals.size(), 0u);
  robot.arm = "<geom type='mesh' mesh='part'/>";
  EXPECT_PART(errors(robot, {.skip_missing_meshes = true}),
              ":4: mesh `part` is missing, but gives the body its mass; give the body an");
  // Names and limits do not depend on masses.
  EXPECT_TRUE(load(robot, {.body = false, .skip_missing_meshes = true}));
}

TEST_F(MjcfFile, RangesLimitJointsAsInMujoco3) {
  TwoBodies robot;
  robot.joint += " range='-45 90'";
  auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_NEAR(read->joints[0].upper, std::acos(0), 1e-12);
  robot.joint += " limited='false'";
  read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->joints[0].upper, HUGE_VAL);
}

TEST_F(MjcfFile, OnlyMjcfIsRewrittenAsUrdf) {
  const auto kaz = robot_urdf(test::kRobot);
  ASSERT_TRUE(kaz);
  EXPECT_EQ(*kaz, test::read_text(test::kRobot));
  const auto written = robot_urdf(folder_.write("robot.xml", TwoBodies().text()));
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_PART(*written, "<robot name=\"r\">");
  EXPECT_FALSE(robot_urdf("none.xml"));
}

TEST_F(MjcfFile, OtherRootElementsAreRefused) {
  const auto read = load_robot(folder_.write("robot.xml", "<default/>"));
  ASSERT_FALSE(read);
  EXPECT_PART(read.error().message,
              ":1: root element is <default>, expected <robot> (URDF) or "
              "<mujoco> (MJCF)");
}

TEST(MjcfElements, AreListedOnThePageOfTheRobot) {
  const std::string page = test::read_text("docs/reference/robot.md");
  const auto table = page.find("| MJCF |");
  ASSERT_NE(table, std::string::npos);
  for (const MjcfElement& element : kMjcfElements) {
    if (element.use == Use::used || element.parent == "default") continue;
    const auto at = page.find(element.use == Use::noted ? "| not used |" : "| refused |", table);
    ASSERT_NE(at, std::string::npos);
    const std::string row = page.substr(at, page.find('\n', at) - at);
    EXPECT_NE(row.find("`" + std::string(element.name) + "`"), std::string::npos) << element.name;
  }
}

// One element of libmujoco's schema: the names of its attributes and the elements in it.
struct SchemaLine {
  int depth = 0;
  std::string name;
  std::vector<std::string> attributes;
};

// The text of mj_printSchema(): three spaces for each level, then `name (type)`, and attributes in column 28.
std::vector<SchemaLine> schema_of_libmujoco() {
  std::vector<char> buffer(200000);
  mj_printSchema(nullptr, buffer.data(), static_cast<int>(buffer.size()), 0, 0);
  std::istringstream text(buffer.data());
  std::vector<SchemaLine> lines;
  for (std::string line; std::getline(text, line);) {
    const auto first = line.find_first_not_of(' ');
    if (first == line.npos) continue;
    if (first < 24) {
      SchemaLine& one = lines.emplace_back();
      one.depth = static_cast<int>(first / 3);
      one.name = line.substr(first, line.find(" (", first) - first);
    }
    std::istringstream words(line.substr(std::min<std::size_t>(line.size(), 27)));
    for (std::string word; words >> word;) lines.back().attributes.push_back(word);
  }
  return lines;
}

TEST(MjcfElements, ContainLibmujocosSchema) {
  std::vector<std::string> path;
  std::size_t compared = 0;
  for (const SchemaLine& line : schema_of_libmujoco()) {
    path.resize(static_cast<std::size_t>(line.depth));
    const std::string name = line.name == "(world)body" ? "body" : line.name;
    const std::string parent = path.empty() ? "" : path.back();
    const MjcfElement* known =
        mjcf_element(parent == "mujoco" && name == "body" ? "body" : parent, name);
    // An element that is not used as a whole has no entries below.
    const bool below = known == nullptr && !path.empty() && path.back().empty();
    path.push_back(below || (known != nullptr && known->use != Use::used) ? "" : name);
    if (below) continue;
    ASSERT_NE(known, nullptr) << "<" << name << "> in <" << parent << ">";
    if (known->use != Use::used) continue;
    for (const std::string& attribute : line.attributes) {
      ++compared;
      const int classes = has_word(known->compiled, attribute) + has_word(known->own, attribute) +
                          has_word(known->noted, attribute) + has_word(known->refused, attribute);
      EXPECT_EQ(classes, 1) << attribute << " of <" << name << ">";
    }
  }
  EXPECT_GT(compared, 250u);
}

// libmujoco 2.2.2 must know each attribute that it gets.
TEST(MjcfElements, LibmujocoKnowsWhatItCompiles) {
  const std::vector<SchemaLine> schema = schema_of_libmujoco();
  for (const MjcfElement& element : kMjcfElements) {
    EXPECT_EQ(element.use == Use::refused, !element.remedy.empty()) << element.name;
    std::istringstream words{std::string(element.compiled)};
    for (std::string word; words >> word;) {
      bool known = false;
      for (const SchemaLine& line : schema)
        known = known || ((line.name == element.name ||
                           (element.name == "body" && line.name == "(world)body")) &&
                          std::ranges::count(line.attributes, word) > 0);
      EXPECT_TRUE(known) << word << " of <" << element.name << ">";
    }
  }
}

}  // namespace
}  // namespace kaz::sim
