// Our MJCF reader against libmujoco: mass, center of mass, joints, limits, poses of bodies and sites.
// SPDX-License-Identifier: Apache-2.0
// The URDF that we write is compared with urdfdom and our own reader.
//
// KAZ_ROBOT_FILES=FOLDER: in addition, all MJCF files below this folder that Kaz accepts.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <urdf_parser/urdf_parser.h>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/posture_testing.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_writer.h"

namespace kaz::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kExact = 1e-9;  // m, kg, rad

// A walker: classes, degrees, Euler angles, `ref`, a hinge beside its body's origin, masses from shapes.
const char* const kWalker = R"(<mujoco model="walker">
<compiler angle="degree" eulerseq="zyx"/>
<default><joint damping="0.3" limited="true" range="-40 70"/><geom density="500"/>
<default class="arm"><joint axis="0 1 0.2" frictionloss="0.02"/><geom type="capsule" size="0.01"/></default>
</default>
<worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="trunk" pos="0.1 0.2 0.5" euler="10 20 30"><freejoint/>
 <geom type="box" size="0.05 0.04 0.1" euler="0 0 45"/>
 <body name="hat" pos="0 0 0.2" axisangle="0 1 1 30"><geom type="ellipsoid" size="0.02 0.03 0.04"
  contype="0" conaffinity="0"/><site name="tip" pos="0 0 0.1" euler="5 6 7"/></body>
 <body name="left" pos="0 0.05 0" childclass="arm" xyaxes="1 0.1 0 0 1 0.3">
  <joint name="shoulder" pos="0.01 0.02 -0.03"/><geom fromto="0 0 0 0.1 0.05 -0.1"/>
  <body name="hand" pos="0 0 -0.1" zaxis="1 2 3"><joint name="elbow" ref="25" axis="1 0 0"/>
   <inertial pos="0.01 0 0" mass="0.07" fullinertia="2e-4 3e-4 4e-4 1e-5 2e-5 3e-5"/>
   <body name="finger" pos="0.02 0 0"><joint name="follower" range="-80 80" ref="5"/>
    <geom fromto="0 0 0 0 0 0.03"/></body>
    <body name="tip_a" pos="0 0 0.03"><joint name="slide_a" type="slide" axis="1 0 0.2" range="-0.02 0.06"
     ref="0.01" pos="0.1 0 0"/><geom type="sphere" size="0.01"/></body>
    <body name="tip_b" pos="0 0 0.04"><joint name="slide_b" type="slide" axis="-1 0 0" range="-0.1 0.1"/>
     <geom type="sphere" size="0.01"/></body>
  </body>
 </body>
</body></worldbody>
<equality><joint joint1="follower" joint2="elbow" polycoef="0.1 -0.5 0 0 0"/>
<joint joint1="slide_b" joint2="slide_a" polycoef="0.002 0.8 0 0 0"/></equality>
<actuator><motor joint="shoulder" gear="3" ctrllimited="true" ctrlrange="-1 0.5"/>
<position joint="elbow" kp="4" forcelimited="true" forcerange="-2 1.5"/></actuator>
</mujoco>)";

// An arm that is fixed to the world, with a pedestal.
const char* const kArm = R"(<mujoco model="arm">
<worldbody><body name="pedestal" pos="0 0 0.1"><geom type="cylinder" size="0.1 0.1" mass="2"/></body>
<body name="base" pos="0 0 0.2" quat="1 0 0 1"><geom type="sphere" size="0.03" mass="0.3"/>
 <body name="upper" pos="0 0 0.1"><joint name="a" axis="0 1 0"/>
  <geom type="box" size="0.01 0.02 0.1" friction="0.4"/>
  <geom size="0.02" mass="0" friction="0.9"/><geom size="0.01" mass="0" condim="1"/>
  <body name="lower" pos="0 0 0.2"><joint name="b" axis="1 1 0" pos="0 0 0.01" range="-1 2"/>
   <geom type="capsule" size="0.01 0.05" pos="0 0 0.05"/></body></body></body>
</worldbody></mujoco>)";

std::vector<std::string> mjcf_files() {
  std::vector<std::string> found{"walker", "arm"};
  const char* named = std::getenv("KAZ_ROBOT_FILES");
  if (named == nullptr) return found;
  for (const auto& entry : fs::recursive_directory_iterator(named)) {
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    if (entry.path().extension() == ".xml" && text.str().find("<mujoco") != std::string::npos)
      found.push_back(entry.path().string());
  }
  return found;
}

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;

// A copy of a robot's folder that libmujoco 2.2.2 can read. The copy lacks the attributes that libmujoco
// reports as unknown, and has a tetrahedron in place of each missing mesh.
class JudgeFolder {
 public:
  explicit JudgeFolder(const fs::path& robot) : robot_(robot) {
    fs::create_directories(folder_);
    for (const auto& entry : fs::directory_iterator(robot.parent_path())) {
      const fs::path copy = folder_ / entry.path().filename();
      if (entry.path().extension() == ".xml")
        fs::copy_file(entry.path(), copy);
      else
        fs::create_symlink(fs::absolute(entry.path()), copy);
    }
  }
  ~JudgeFolder() { fs::remove_all(folder_); }
  JudgeFolder(const JudgeFolder&) = delete;
  JudgeFolder& operator=(const JudgeFolder&) = delete;

  Model load() {
    edit(R"(<mujoco(| [^>]*[^/])>)", "$&<compiler autolimits=\"true\"/>");
    char error[1000] = "";
    for (int i = 0; i < 100; ++i) {
      mjModel* model = mj_loadXML((folder_ / robot_.filename()).c_str(), nullptr, error, 1000);
      if (model != nullptr) return {model, mj_deleteModel};
      std::cmatch part;
      if (std::regex_search(error, part, std::regex("unrecognized attribute: '(\\w+)'")))
        edit("\\s" + part[1].str() + "=\"[^\"]*\"", "");
      else if (std::regex_search(error, part, std::regex("open\\w* (?:STL )?file '([^']+)'")))
        write_tetrahedron(part[1].str());
      else
        break;
    }
    ADD_FAILURE() << error;
    return {nullptr, mj_deleteModel};
  }

 private:
  void edit(const std::string& pattern, const std::string& with) const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() != ".xml") continue;
      const std::string text = test::read_text(entry.path().string());
      std::ofstream(entry.path()) << std::regex_replace(text, std::regex(pattern), with);
    }
  }
  static void write_tetrahedron(const std::string& path) {
    const std::array<float, 36> corners{0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0,
                                        0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::string bytes(80, '\0');
    bytes += std::string("\4\0\0\0", 4);
    for (std::size_t i = 0; i < 4; ++i)
      bytes += std::string(12, '\0') +
               std::string(reinterpret_cast<const char*>(&corners[9 * i]), 36) +
               std::string(2, '\0');
    std::ofstream(path) << bytes;
  }

  fs::path robot_;
  fs::path folder_ = fs::path(testing::TempDir()) / ("kaz_mjcf_judge_" + std::to_string(getpid()));
};

class JudgedMjcf : public testing::TestWithParam<std::string> {
 protected:
  std::string path() const {
    if (GetParam() == "walker") return folder_.write("walker.xml", kWalker);
    if (GetParam() == "arm") return folder_.write("arm.xml", kArm);
    return GetParam();
  }
  const test::Folder folder_;
};

// Angles within the limits, different for each posture, with the couplings.
std::vector<double> angles_of(const RobotModel& robot, int number) {
  std::vector<double> angles;
  for (const RobotJoint& joint : robot.joints) {
    const double low = std::max(joint.lower, -3.0), high = std::min(joint.upper, 3.0);
    const double share =
        std::fmod(0.37 + 0.618 * static_cast<double>(angles.size() + 1) * number, 1.0);
    angles.push_back(number == 0 ? 0 : low + share * (high - low));
    if (joint.follows)
      angles.back() = joint.follows->offset +
                      joint.follows->ratio * angles[static_cast<std::size_t>(joint.follows->joint)];
  }
  return angles;
}

Eigen::Isometry3d pose_of_numbers(const mjtNum* position, const mjtNum* rotation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(position);
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation);
  return pose;
}

void compare_joints(const RobotModel& robot, const mjModel& model, const mjData& data) {
  int joints = 0;
  for (int j = 0; j < model.njnt; ++j)
    joints += model.jnt_type[j] == mjJNT_HINGE || model.jnt_type[j] == mjJNT_SLIDE;
  EXPECT_EQ(static_cast<int>(robot.joints.size()), joints);
  int last = -1;
  for (const RobotJoint& joint : robot.joints) {
    const int j = mj_name2id(&model, mjOBJ_JOINT, joint.name.c_str());
    ASSERT_GE(j, 0) << joint.name;
    if (!joint.follows) {
      EXPECT_GT(j, last) << "order of " << joint.name;
    }
    last = j;
    const double unit = test::unit_of(joint);
    EXPECT_EQ(std::isfinite(joint.lower), model.jnt_limited[j] != 0) << joint.name;
    if (model.jnt_limited[j]) {
      EXPECT_NEAR(joint.lower * unit, model.jnt_range[2 * j], kExact) << joint.name;
      EXPECT_NEAR(joint.upper * unit, model.jnt_range[2 * j + 1], kExact) << joint.name;
    }
    EXPECT_NEAR(joint.damping / (unit * unit), model.dof_damping[model.jnt_dofadr[j]], kExact);
    EXPECT_NEAR(joint.friction / unit, model.dof_frictionloss[model.jnt_dofadr[j]], kExact);
    const Eigen::Map<const Eigen::Vector3d> axis(data.xaxis + 3 * j);
    EXPECT_LT((joint.axis - axis).cwiseAbs().maxCoeff(), kExact) << joint.name;
  }
}

void compare_poses(const RobotModel& robot, const mjModel& model, const mjData& data,
                   const std::vector<double>& angles) {
  const auto poses = test::link_poses(robot, angles);
  double mass = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), own = Eigen::Vector3d::Zero();
  std::size_t known = 0;
  for (const auto& [name, frame] : robot.frames) {
    const int body = mj_name2id(&model, mjOBJ_BODY, name.c_str()),
              site = mj_name2id(&model, mjOBJ_SITE, name.c_str());
    if (body < 0 && site < 0) continue;
    ++known;
    const Eigen::Isometry3d theirs =
        body >= 0 ? pose_of_numbers(data.xpos + 3 * body, data.xmat + 9 * body)
                  : pose_of_numbers(data.site_xpos + 3 * site, data.site_xmat + 9 * site);
    const Eigen::Isometry3d ours = poses[static_cast<std::size_t>(frame.link)] * frame.in_link;
    EXPECT_LT((ours.matrix() - theirs.matrix()).cwiseAbs().maxCoeff(), kExact) << name;
  }
  std::size_t links = known;  // the links between several joints of one body have no body
  for (int body = 1; body < model.nbody; ++body)
    links += static_cast<std::size_t>(std::max(0, model.body_jntnum[body] - 1));
  EXPECT_GE(links, robot.joints.size());
  for (int body = 1; body < model.nbody; ++body) {
    int named = body;  // a body without a name belongs to the one that carries it
    while (mj_id2name(&model, mjOBJ_BODY, named) == nullptr) named = model.body_parentid[named];
    if (model.body_mocapid[body] >= 0) continue;
    if (!robot.frames.contains(mj_id2name(&model, mjOBJ_BODY, named))) continue;
    mass += model.body_mass[body];
    sum += model.body_mass[body] * Eigen::Map<const Eigen::Vector3d>(data.xipos + 3 * body);
  }
  for (std::size_t i = 0; i < poses.size(); ++i)
    own += robot.links[i].rigid.mass * (poses[i] * robot.links[i].rigid.com);
  EXPECT_NEAR(robot.mass(), mass, kExact);
  EXPECT_LT((own - sum).norm(), kExact * mass);
}

TEST_P(JudgedMjcf, AgreesWithLibmujoco) {
  const std::string file = path();
  const auto robot = load_robot(file, {.skip_missing_meshes = true});
  if (!robot && GetParam() == file) GTEST_SKIP() << "refused: " << full_text(robot.error());
  ASSERT_TRUE(robot) << full_text(robot.error());
  JudgeFolder judge(file);
  const Model model = judge.load();
  ASSERT_TRUE(model);
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(model.get()), mj_deleteData);
  for (int number = 0; number < 3; ++number) {
    const std::vector<double> angles = angles_of(*robot, number);
    for (int j = 0; j < model->njnt; ++j) {
      mjtNum* q = data->qpos + model->jnt_qposadr[j];
      if (model->jnt_type[j] == mjJNT_FREE)
        for (int k = 0; k < 7; ++k) q[k] = k == 3;
    }
    for (std::size_t i = 0; i < angles.size(); ++i)
      data->qpos[model->jnt_qposadr[mj_name2id(model.get(), mjOBJ_JOINT,
                                               robot->joints[i].name.c_str())]] =
          test::unit_of(robot->joints[i]) * angles[i];
    mj_kinematics(model.get(), data.get());
    if (number == 0) compare_joints(*robot, *model, *data);
    compare_poses(*robot, *model, *data, angles);
  }
}

// Links and frames of one name in both models, at the posture of the angles.
void compare_frames(const RobotModel& one, const RobotModel& other,
                    const std::vector<double>& angles) {
  const auto poses = test::link_poses(one, angles), others = test::link_poses(other, angles);
  for (const auto& [name, frame] : one.frames) {
    const RobotFrame& twin = other.frames.at(name);
    const Eigen::Isometry3d a = poses[static_cast<std::size_t>(frame.link)] * frame.in_link,
                            b = others[static_cast<std::size_t>(twin.link)] * twin.in_link;
    EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), kExact) << name;
  }
}

void compare_links(const RigidLink& link, const RigidLink& twin) {
  EXPECT_NEAR(link.mass, twin.mass, kExact) << link.name;
  EXPECT_LT((link.com - twin.com).norm(), kExact) << link.name;
  EXPECT_LT((link.inertia - twin.inertia).norm(), kExact) << link.name;
  ASSERT_EQ(link.visuals.size(), twin.visuals.size()) << link.name;
  for (std::size_t i = 0; i < link.visuals.size(); ++i) {
    const Visual &a = link.visuals[i], &b = twin.visuals[i];
    EXPECT_EQ(a.shape.mesh_path, b.shape.mesh_path) << a.name;
    EXPECT_EQ(a.shape.size, b.shape.size) << a.name;
    EXPECT_EQ(a.color.g, b.color.g) << a.name;
    EXPECT_LT((a.in_frame.matrix() - b.in_frame.matrix()).norm(), kExact) << a.name;
  }
  ASSERT_EQ(link.collisions.size(), twin.collisions.size()) << link.name;
  // Shapes with another friction come last.
  double sum = 0;
  for (const CollisionShape& a : link.collisions) {
    double nearest = HUGE_VAL;
    for (const CollisionShape& b : twin.collisions)
      if (a.shape.kind == b.shape.kind && a.surface.mu == b.surface.mu &&
          a.shape.size == b.shape.size)
        nearest = std::min(nearest, (a.in_link.matrix() - b.in_link.matrix()).norm());
    sum += nearest;
  }
  EXPECT_LT(sum, kExact) << link.name;
}

TEST_P(JudgedMjcf, IsTheSameRobotAsUrdf) {
  const std::string file = path();
  const auto robot = load_robot(file, {.skip_missing_meshes = true});
  if (!robot && GetParam() == file) GTEST_SKIP() << "refused: " << full_text(robot.error());
  ASSERT_TRUE(robot) << full_text(robot.error());
  const std::string folder = fs::canonical(file).parent_path().string();
  const std::string urdf = urdf_of(*robot, folder);
  const auto judge = urdf::parseURDF(urdf);
  ASSERT_TRUE(judge) << urdf;
  EXPECT_EQ(judge->getRoot()->name, robot->links[0].rigid.name);
  for (const RobotJoint& joint : robot->joints) {
    const auto other = judge->getJoint(joint.name);
    ASSERT_TRUE(other) << joint.name;
    EXPECT_EQ(other->mimic != nullptr, joint.follows.has_value());
    if (joint.follows) {
      const RobotJoint& leader = robot->joints[static_cast<std::size_t>(joint.follows->joint)];
      EXPECT_NEAR(other->mimic->multiplier * test::unit_of(leader) / test::unit_of(joint),
                  joint.follows->ratio, kExact);
      EXPECT_NEAR(other->mimic->offset / test::unit_of(joint), joint.follows->offset, kExact);
    }
  }
  setenv("KAZ_MESH_PATH", folder.c_str(), 1);
  const auto read = load_robot(folder_.write(
      "robot.urdf",
      std::regex_replace(urdf, std::regex("filename=\"(?!/)"), "filename=\"" + folder + "/")));
  unsetenv("KAZ_MESH_PATH");
  ASSERT_TRUE(read) << full_text(read.error());
  EXPECT_EQ(read->fixed_base, robot->fixed_base);
  ASSERT_EQ(read->joints.size(), robot->joints.size());
  for (std::size_t i = 0; i < read->joints.size(); ++i) {
    const RobotJoint &a = robot->joints[i], &b = read->joints[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.follows.has_value(), b.follows.has_value()) << a.name;
    for (const double RobotJoint::* value :
         {&RobotJoint::lower, &RobotJoint::upper, &RobotJoint::effort, &RobotJoint::damping,
          &RobotJoint::friction, &RobotJoint::pinion_m})
      EXPECT_TRUE(a.*value == b.*value || std::abs(a.*value - b.*value) < kExact) << a.name;
    EXPECT_LT((a.axis - b.axis).norm(), kExact) << a.name;
  }
  for (int number = 0; number < 3; ++number)
    compare_frames(*robot, *read, angles_of(*robot, number));
  for (const RobotLink& link : robot->links)
    compare_links(
        link.rigid,
        read->links[static_cast<std::size_t>(read->frames.at(link.rigid.name).link)].rigid);
}

INSTANTIATE_TEST_SUITE_P(Files, JudgedMjcf, testing::ValuesIn(mjcf_files()), [](const auto& test) {
  std::string name = fs::path(test.param).stem().string() + "_" + std::to_string(test.index);
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

}  // namespace
}  // namespace kaz::sim
