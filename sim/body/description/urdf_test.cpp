// Robots of others: elements that are used, noted and refused, frames, quaternions, meshes, limits.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <set>

#include "sim/body/description/convex_hull.h"
#include "sim/body/description/files_testing.h"
#include "sim/body/description/mesh_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_schema.h"

namespace kaz::sim {
namespace {

const char* const kInertial =
    "<inertial><mass value='1'/><inertia ixx='2e-3' iyy='2e-3' izz='2e-3' ixy='0' ixz='0' "
    "iyz='0'/></inertial>";

// Two links and a joint, with additions.
struct TwoLinks {
  std::string trunk = kInertial, arm = kInertial, arm_attributes, joint, type = "revolute",
              limit = "<limit lower='-0.5' upper='0.1' effort='1' velocity='5'/>", robot;
  std::string text() const {
    return "<robot name='r'>\n<link name='trunk'>" + trunk + "</link>\n<link name='arm'" +
           arm_attributes + ">" + arm + "</link>\n<joint name='j' type='" + type +
           "'><parent link='trunk'/><child link='arm'/>" + joint + limit + "</joint>\n" + robot +
           "</robot>\n";
  }
};

class UrdfFile : public testing::Test {
 protected:
  Result<RobotModel> load(const TwoLinks& robot, const ReadOptions& options = {}) {
    return load_robot(folder_.write("robot.urdf", robot.text()), options);
  }
  const test::Folder folder_;
};

TEST_F(UrdfFile, ReportsAllErrorsTogetherInOrderOfLines) {
  TwoLinks robot;
  robot.trunk += "<visual><geometry><box size='1 2'/></geometry></visual>";
  robot.arm_attributes = " tint='red'";
  robot.joint = "<origin xyz='0 0 0.1' ryp='0 0 1.2'/><axis xyz='0 0 0'/>";
  robot.robot = "<lnk name='x'/>\n";
  const auto read = load(robot);
  ASSERT_FALSE(read);
  const std::string all = full_text(read.error());
  EXPECT_EQ(read.error().fault, Fault::usage);
  EXPECT_EQ(read.error().details.size(), 4u) << all;
  std::size_t at = 0;
  for (const char* part :
       {":2: attribute `size` of <box> must be 3 numbers",
        ":3: attribute `tint` of <link> is unknown",
        ":4: attribute `ryp` of <origin> is unknown; <origin> accepts xyz rpy quat_xyzw",
        ":4: axis of joint `j` is zero", ":5: unknown element <lnk> in <robot>"}) {
    const auto found = all.find(part);
    ASSERT_NE(found, std::string::npos) << part << "\n" << all;
    EXPECT_GE(found, at) << all;
    at = found;
  }
}

TEST_F(UrdfFile, NotesWhatPhysicsDoesNotNeed) {
  TwoLinks robot;
  robot.trunk += "<origin xyz='1 2 3'/>";
  robot.joint = "<safety_controller k_velocity='1'/>";
  robot.robot =
      "<transmission name='a'><type>x</type></transmission><transmission name='b'/>"
      "<mujoco><compiler/></mujoco><drake:proximity/>\n";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(summary(read->notes),
            "<origin>, <safety_controller>, <transmission> (2), <mujoco>, <drake:proximity>");
  const auto strict = load(robot, {.strict = true});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().details.size(), 5u);
  EXPECT_NE(strict.error().message.find(":2: <origin> is not used, which --strict"),
            std::string::npos)
      << strict.error().message;
}

TEST_F(UrdfFile, RefusesWhatChangesPhysics) {
  for (const auto& [part, message] : std::vector<std::pair<std::string, std::string>>{
           {"<dynamics damping='0.1' spring_stiffness='3'/>",
            "joint `j` has a spring, which is not supported"},
           {"<dynamics damping='-1'/>", "damping of joint `j` is negative"}}) {
    TwoLinks robot;
    robot.joint = part;
    const auto read = load(robot);
    ASSERT_FALSE(read) << part;
    EXPECT_NE(read.error().message.find(message), std::string::npos) << read.error().message;
  }
  TwoLinks robot;
  robot.arm +=
      "<collision><geometry><box size='1 1 1'/><sphere radius='0.2'/></geometry></collision>";
  const auto two = load(robot);
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().message.find("<geometry> has more than one shape; use one <collision>"),
            std::string::npos)
      << two.error().message;
  robot = {};
  robot.robot = "<xacro:include filename='x'/>";
  const auto xacro = load(robot);
  ASSERT_FALSE(xacro);
  EXPECT_NE(xacro.error().message.find("xacro FILE > robot.urdf"), std::string::npos);
}

// Each element of the schema is used, noted or refused as its entry says.
TEST_F(UrdfFile, TreatsEachElementAsTheSchemaSays) {
  for (const UrdfElement& element : kUrdfElements) {
    if (element.use == Use::used) continue;
    TwoLinks robot;
    const std::string added = "<" + std::string(element.name) + "/>";
    if (element.parent == "robot") robot.robot = added;
    if (element.parent == "link") robot.arm += added;
    if (element.parent == "joint") robot.joint = added;
    if (element.parent == "collision")
      robot.arm += "<collision>" + added + "<geometry><sphere radius='1'/></geometry></collision>";
    if (element.parent == "contact") robot.arm += "<contact>" + added + "</contact>";
    if (element.parent == "material") robot.robot = "<material name='m'>" + added + "</material>";
    const auto read = load(robot);
    EXPECT_EQ(read.has_value(), element.use == Use::noted) << added << " in " << element.parent;
    if (read) {
      EXPECT_EQ(summary(read->notes), "<" + std::string(element.name) + ">");
    }
    EXPECT_EQ(element.use == Use::refused, !element.remedy.empty()) << added;
  }
}

TEST(UrdfSchema, IsListedOnThePageOfTheRobot) {
  const std::string page = test::read_text("docs/reference/robot.md");
  for (const char* row : {"| not used,", "| refused,"}) {
    const auto at = page.find(row);
    ASSERT_NE(at, std::string::npos);
    const std::string line = page.substr(at, page.find('\n', at) - at);
    const Use use = row == std::string("| not used,") ? Use::noted : Use::refused;
    for (const UrdfElement& element : kUrdfElements) {
      if (element.use != use) continue;
      EXPECT_NE(line.find("`" + std::string(element.name) + "`"), std::string::npos)
          << element.name << " in " << element.parent;
    }
  }
}

TEST_F(UrdfFile, FramesNeedNoMass) {
  TwoLinks robot;
  robot.robot =
      "<link name='tool'><inertial><mass value='1e-9'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' "
      "iyz='0' izz='0'/></inertial></link><joint name='t' type='fixed'><parent link='arm'/><child "
      "link='tool'/></joint><link name='base_link'/><joint name='b' type='fixed'><parent "
      "link='base_link'/><child link='trunk'/></joint>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->links.size(), 2u);
  EXPECT_EQ(read->links[0].rigid.name, "base_link");
  EXPECT_NEAR(read->mass(), 2, 1e-8);
  EXPECT_EQ(read->frames.size(), 4u);
  EXPECT_FALSE(read->fixed_base);
}

TEST_F(UrdfFile, PartsThatMoveNeedAMass) {
  TwoLinks robot;
  robot.trunk = robot.arm = "";
  const auto read = load(robot);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find(
                ":2: link `trunk` moves but has no mass; give an <inertial>, or name the link "
                "`world`"),
            std::string::npos)
      << read.error().message;
  ASSERT_EQ(read.error().details.size(), 1u);
  EXPECT_NE(read.error().details[0].find(":3: link `arm` moves but has no mass"),
            std::string::npos);
  // A servo bus needs names and limits only.
  const auto joints = load(robot, {.body = false});
  ASSERT_TRUE(joints) << full_text(joints.error());
  EXPECT_EQ(joints->joint_order(), std::vector<std::string>{"j"});
  EXPECT_EQ(joints->joints[0].upper, 0.1);
}

TEST_F(UrdfFile, RotationByAQuaternionAndOverSeveralLines) {
  TwoLinks robot;
  robot.joint = "<origin xyz='0\n 0\t0.1' quat_xyzw='0 0 0.7071067811865476 0.7071067811865476'/>";
  const auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  const Eigen::Isometry3d& at = read->links[1].at_zero;
  EXPECT_TRUE((at * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 1, 0.1), 1e-12));
  robot.joint = "<origin rpy='0 0 1' quat_xyzw='0 0 0 1'/>";
  EXPECT_FALSE(load(robot));
  robot.joint = "<origin quat_xyzw='0 0 0 2'/>";
  EXPECT_FALSE(load(robot));
}

TEST_F(UrdfFile, LimitsOfTheFile) {
  TwoLinks robot;
  robot.type = "continuous";
  robot.limit = "<limit effort='3' velocity='0'/><dynamics damping='0.2' friction='0.1'/>";
  auto read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  RobotJoint joint = read->joints[0];
  EXPECT_EQ(joint.lower, -HUGE_VAL);
  EXPECT_EQ(joint.upper, HUGE_VAL);
  EXPECT_EQ(joint.effort, 3);
  EXPECT_EQ(joint.velocity, HUGE_VAL) << "0 means that nobody has stated it";
  EXPECT_EQ(joint.damping, 0.2);
  EXPECT_EQ(joint.friction, 0.1);
  robot = {};
  robot.limit = "<limit lower='-6' upper='6' effort='1' velocity='1'/>";
  read = load(robot);
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->joints[0].upper, 6);
  robot.limit = "";
  EXPECT_FALSE(load(robot));
}

// A tetrahedron whose corners are 0, x, y and z, of 1, 2 and 3 cm.
constexpr const char* kObj =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_F(UrdfFile, MeshesCollideByTheirHull) {
  folder_.write("part.obj", kObj);
  TwoLinks robot;
  robot.arm +=
      "<collision><origin xyz='0 0 1'/><geometry><mesh filename='package:///part.obj' "
      "scale='0.01 0.01 0.01'/></geometry></collision>";
  const auto hull = load(robot);
  ASSERT_TRUE(hull) << full_text(hull.error());
  const CollisionShape& shape = hull->links[1].rigid.collisions.at(0);
  ASSERT_EQ(shape.shape.kind, Shape::Kind::hull);
  EXPECT_EQ(shape.shape.hull->size(), 4u);
  EXPECT_EQ(shape.shape.hull->planes.size(), 16u);
  const Eigen::AlignedBox3d box = extent(shape.shape, shape.in_link);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d(0, 0, 1)));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(0.01, 0.02, 1.03)));
  const auto is_inside = [&](const Eigen::Vector3d& in_link) {
    return inside(shape.shape, shape.in_link.inverse() * in_link, 0);
  };
  EXPECT_TRUE(is_inside({0.001, 0.001, 1.001}));
  EXPECT_FALSE(is_inside({0.009, 0.019, 1.029}));
  EXPECT_TRUE(box.contains(shape.in_link.translation())) << "bounding spheres are about the origin";
  for (const MeshCollision wanted : {MeshCollision::box, MeshCollision::capsule}) {
    const auto read = load(robot, {.mesh_collision = wanted});
    ASSERT_TRUE(read) << full_text(read.error());
    const CollisionShape& around = read->links[1].rigid.collisions.at(0);
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(0, 0, 1), {0.01, 0, 1}, {0, 0.02, 1}, {0, 0, 1.03}})
      EXPECT_TRUE(inside(around.shape, around.in_link.inverse() * corner, -1e-9))
          << to_string(wanted) << " " << corner.transpose();
  }
}

TEST_F(UrdfFile, MissingMeshesAreNamedAndCanBeSkipped) {
  TwoLinks robot;
  robot.arm += "<visual><geometry><mesh filename='none.stl'/></geometry></visual>";
  robot.trunk +=
      "<collision><geometry><mesh filename='package://other/none.dae'/></geometry>"
      "</collision>";
  const auto read = load(robot);
  ASSERT_FALSE(read);
  const std::string all = full_text(read.error());
  EXPECT_NE(all.find("mesh `none.stl` cannot be read"), std::string::npos) << all;
  EXPECT_NE(all.find("is in the package `other`, which was not found: add the package's folder to "
                     "KAZ_MESH_PATH"),
            std::string::npos)
      << all;
  const auto skipped = load(robot, {.skip_missing_meshes = true});
  ASSERT_TRUE(skipped) << full_text(skipped.error());
  EXPECT_EQ(skipped->links[0].rigid.collisions.size(), 0u);
  EXPECT_EQ(skipped->links[1].rigid.visuals.size(), 0u);
  EXPECT_EQ(skipped->notes.size(), 2u);
}

TEST_F(UrdfFile, PackagesAreFoundByTheirNames) {
  namespace fs = std::filesystem;
  const std::string root = fs::path(folder_.write("x", "")).parent_path().string();
  fs::create_directories(root + "/robot_description/meshes");
  fs::create_directories(root + "/robot_description/urdf");
  folder_.write("robot_description/meshes/part.obj", kObj);
  TwoLinks robot;
  robot.arm +=
      "<visual><geometry><mesh filename='package://robot_description/meshes/part.obj'/>"
      "</geometry></visual>";
  EXPECT_FALSE(load(robot));
  for (const std::string& named : {root, root + "/robot_description"}) {
    setenv("KAZ_MESH_PATH", named.c_str(), 1);
    const auto read = load(robot);
    unsetenv("KAZ_MESH_PATH");
    EXPECT_TRUE(read) << full_text(read.error());
  }
  folder_.write("robot_description/package.xml",
                "<package><name>robot_description</name></package>");
  EXPECT_TRUE(load_robot(folder_.write("robot_description/urdf/robot.urdf", robot.text())));
}

TEST_F(UrdfFile, OfAnotherRobotMayHaveSomeJointNamesOfKaz) {
  TwoLinks robot;
  std::string text = robot.text();
  text.replace(text.find("joint name='j'"), 14, "joint name='l_knee'");
  const auto read = load_robot(folder_.write("robot.urdf", text));
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_FALSE(read->is_kaz());
}

TEST(Collada, PlacesGeometriesByTheirNodes) {
  const test::Folder folder;
  std::string seed = test::read_text("tools/fuzz/inputs/seeds/mesh/tetrahedron.dae");
  const auto mesh = read_mesh(folder.write("t.dae", seed.substr(1)), {1, 1, 1});
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->corners.size(), 12u);
  // Millimeters. The corner (10, 0, 0) is moved by 5 along x, scaled, turned to y and moved by (1, 2, 3).
  EXPECT_TRUE(mesh->corners[2].isApprox(1e-3 * Eigen::Vector3d(1, 17, 3), 1e-12))
      << mesh->corners[2].transpose();
  double volume = 0;
  for (std::size_t i = 0; i < 12; i += 3)
    volume += mesh->corners[i].dot(mesh->corners[i + 1].cross(mesh->corners[i + 2])) / 6;
  EXPECT_NEAR(volume, 2e-6, 1e-12) << "10 x 20 x 30 mm3 / 6, and twice as high";
  const auto mirrored = read_mesh(folder.write("t.dae", seed.substr(1)), {1, -1, 1});
  ASSERT_TRUE(mirrored);
  EXPECT_TRUE(mirrored->normals[0].isApprox(mesh->normals[0], 1e-12)) << "still outward";
}

TEST(ConvexHull, OfAFineSphereHasFewVertices) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 5000; ++i) {
    const double z = 1 - (2 * i + 1) / 5000.0, r = std::sqrt(1 - z * z), a = 2.4 * i;
    points.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  EXPECT_LE(hull->size(), 700u);
  // Euler's formula for triangles: F = 2 V - 4.
  EXPECT_EQ(hull->planes.size() / 4, 2 * hull->size() - 4);
  for (std::size_t i = 0; i < hull->planes.size(); i += 4) EXPECT_GT(hull->planes[i + 3], 0.98);
  EXPECT_FALSE(
      convex_hull(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
}

}  // namespace
}  // namespace kaz::sim
