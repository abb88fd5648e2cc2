// Our SDF reader against libsdformat on the original files: pose, mass, center of mass and inertia of links.
// SPDX-License-Identifier: Apache-2.0
//
// KAZ_WORLD_FILES=FOLDER: all SDF files below this folder as well. Files that Kaz refuses are left out; the
// error must name the file.
#include <cstdlib>
#include <map>

#include <sdf/sdf.hh>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kWorldAgrees = 1e-9;

struct JudgedLink {
  ignition::math::Pose3d pose;  // in the world
  ignition::math::Inertiald inertial;
};

// All links below `model`, by "model::model/link".
void collect(const sdf::Model& model, const std::string& outer,
             const ignition::math::Pose3d& outer_pose, std::map<std::string, JudgedLink>& links) {
  ignition::math::Pose3d in_outer;
  for (const auto& error : model.SemanticPose().Resolve(in_outer, outer.empty() ? "" : "__model__"))
    ADD_FAILURE() << error.Message();
  const ignition::math::Pose3d pose = outer_pose * in_outer;
  const std::string name = outer.empty() ? model.Name() : outer + "::" + model.Name();
  for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
    const sdf::Link& link = *model.LinkByIndex(i);
    ignition::math::Pose3d in_model;
    for (const auto& error : link.SemanticPose().Resolve(in_model, "__model__"))
      ADD_FAILURE() << error.Message();
    links[name + "/" + link.Name()] = {pose * in_model, link.Inertial()};
  }
  for (std::uint64_t i = 0; i < model.ModelCount(); ++i)
    collect(*model.ModelByIndex(i), name, pose, links);
}

Eigen::Isometry3d isometry(const ignition::math::Pose3d& p) {
  Eigen::Isometry3d out(Eigen::Translation3d(p.Pos().X(), p.Pos().Y(), p.Pos().Z()));
  out.linear() = Eigen::Quaterniond(p.Rot().W(), p.Rot().X(), p.Rot().Y(), p.Rot().Z())
                     .normalized()
                     .toRotationMatrix();
  return out;
}

void compare_link(const WorldBody& body, const JudgedLink& its) {
  const Eigen::Isometry3d in_link = isometry(its.inertial.Pose());
  const auto& m = its.inertial.MassMatrix();
  Eigen::Matrix3d tensor;
  tensor << m.Ixx(), m.Ixy(), m.Ixz(), m.Ixy(), m.Iyy(), m.Iyz(), m.Ixz(), m.Iyz(), m.Izz();
  tensor = in_link.linear() * tensor * in_link.linear().transpose();
  const std::string& name = body.rigid.name;
  EXPECT_LT((body.pose.matrix() - isometry(its.pose).matrix()).cwiseAbs().maxCoeff(), kWorldAgrees)
      << name;
  EXPECT_NEAR(body.rigid.mass, m.Mass(), kWorldAgrees) << name;
  EXPECT_LT((body.rigid.com - in_link.translation()).norm(), kWorldAgrees) << name;
  EXPECT_LT((body.rigid.inertia - tensor).cwiseAbs().maxCoeff(),
            kWorldAgrees * (1 + tensor.cwiseAbs().maxCoeff()))
      << name;
}

// Bodies of links that fixed joints merge have another mass and are left out.
void judge_world(const std::string& path, const WorldModel& world) {
  sdf::ParserConfig config;
  const std::string folder = fs::path(path).parent_path();
  config.SetFindCallback([&](const std::string& uri) {
    const std::string model = "model://";
    return folder + "/" + (uri.starts_with(model) ? uri.substr(model.size()) : uri);
  });
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Root root;
  for (const sdf::Error& error : root.Load(path, config)) ADD_FAILURE() << error.Message();
  ASSERT_GT(root.WorldCount(), 0u);
  std::map<std::string, JudgedLink> links;
  const sdf::World& its = *root.WorldByIndex(0);
  for (std::uint64_t i = 0; i < its.ModelCount(); ++i)
    collect(*its.ModelByIndex(i), "", ignition::math::Pose3d::Zero, links);
  EXPECT_LE(world.bodies.size(), links.size());
  const bool is_merged = world.bodies.size() < links.size();
  for (const WorldBody& body : world.bodies) {
    const auto found = links.find(body.rigid.name);
    ASSERT_NE(found, links.end()) << body.rigid.name;
    if (!is_merged) compare_link(body, found->second);
  }
}

const std::string kTiltedMass =
    "<inertial><pose>0.1 0.2 0.3 0.4 0.5 0.6</pose><mass>2</mass><inertia><ixx>0.3</ixx><ixy>0.01"
    "</ixy><ixz>0.02</ixz><iyy>0.2</iyy><iyz>0.03</iyz><izz>0.25</izz></inertia></inertial>";

std::string tilted(const std::string& name, const std::string& pose) {
  return "<link name='" + name + "'>" + pose + kTiltedMass + "</link>";
}

struct JudgedCase {
  const char* name;
  const char* version;
  std::string models;
};

const std::string kTurn = "0.1 -0.2 0.3 0.4 -0.5 0.6</pose>";

std::vector<JudgedCase> judged_cases() {
  return {
      {"relative_to", "1.9",
       "<frame name='f'><pose>" + kTurn + "</frame><model name='m'><pose relative_to='f'>" + kTurn +
           "<frame name='g' attached_to='b'><pose>" + kTurn + "</frame>" +
           tilted("a", "<pose relative_to='g'>" + kTurn) + tilted("b", "<pose>" + kTurn) +
           "</model><model name='n'><pose relative_to='m'>" + kTurn + tilted("a", "") + "</model>"},
      {"placement_frame", "1.8",
       "<model name='m' placement_frame='b'><pose>" + kTurn + tilted("a", "<pose>" + kTurn) +
           tilted("b", "<pose relative_to='a'>" + kTurn) + "</model>"},
      {"frame_of_1_6", "1.6",
       "<model name='m'><pose>" + kTurn + "<frame name='f'><pose>" + kTurn + "</frame>" +
           tilted("a", "<pose frame='f'>" + kTurn) + tilted("b", "<pose frame='a'>" + kTurn) +
           "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 "
           "1</xyz>"
           "<use_parent_model_frame>1</use_parent_model_frame><limit><lower>-1</lower><upper>1"
           "</upper></limit></axis></joint></model>"},
      {"frame_of_1_5", "1.5",
       "<model name='m'><pose>" + kTurn + tilted("a", "<pose>" + kTurn) +
           tilted("b", "<pose frame='a'>" + kTurn) + "</model>"},
      {"of_1_4", "1.4",
       "<model name='m'><pose>" + kTurn + tilted("a", "<pose>" + kTurn) + "</model>"},
      {"degrees", "1.9",
       "<model name='m'><pose degrees='true'>1 2 3 40 50 60</pose>" +
           tilted("a", "<pose rotation_format='quat_xyzw'>1 2 3 0.5 0.5 -0.5 0.5</pose>") +
           "</model>"},
      {"nested", "1.9",
       "<model name='m'><pose>" + kTurn + tilted("a", "<pose>" + kTurn) +
           "<model name='n' placement_frame='c'><pose relative_to='a'>" + kTurn +
           tilted("c", "<pose>" + kTurn) + "<model name='o'><pose>" + kTurn + tilted("d", "") +
           "</model></model>" + tilted("e", "<pose relative_to='n::o::d'>" + kTurn) + "</model>"},
      {"included", "1.9",
       "<include><uri>part</uri></include><include><uri>model://part</uri><name>second</name>"
       "<pose>" +
           kTurn + "<placement_frame>b</placement_frame></include><model name='m'><pose>" + kTurn +
           tilted("a", "") +
           "<include><uri>part</uri><name>third</name><pose "
           "relative_to='a'>" +
           kTurn + "</include></model>"},
      {"included_in_1_6", "1.6", "<include><uri>part</uri><pose>" + kTurn + "</include>"},
      {"without_masses", "1.7", "<model name='m'><link name='a'/></model>"},
  };
}

class JudgedText : public testing::TestWithParam<JudgedCase> {};

TEST_P(JudgedText, AgreesWithLibsdformat) {
  const test::Folder folder;
  const fs::path root = fs::path(folder.write("x", "")).parent_path();
  fs::create_directories(root / "part");
  folder.write("part/model.config",
               "<?xml version='1.0'?><model><name>part</name><version>1</version>"
               "<sdf version='1.6'>model.sdf</sdf></model>");
  folder.write("part/model.sdf",
               "<?xml version='1.0'?><sdf version='1.6'><model name='part'><pose>" + kTurn +
                   tilted("a", "<pose>" + kTurn) + tilted("b", "<pose frame='a'>" + kTurn) +
                   "</model></sdf>");
  const std::string path = folder.write(
      "world.sdf", std::string("<?xml version='1.0'?><sdf version='") + GetParam().version +
                       "'><world name='w'>" + GetParam().models + "</world></sdf>");
  const auto world = load_world(path);
  ASSERT_TRUE(world) << full_text(world.error());
  judge_world(path, *world);
}

INSTANTIATE_TEST_SUITE_P(Texts, JudgedText, testing::ValuesIn(judged_cases()),
                         [](const auto& test) { return std::string(test.param.name); });

std::vector<std::string> world_files() {
  std::vector<std::string> paths;
  const char* folder = std::getenv("KAZ_WORLD_FILES");
  for (const std::string& root : {std::string("sim/worlds"), std::string(folder ? folder : "")}) {
    if (root.empty()) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root))
      if (entry.path().extension() == ".sdf") paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

class JudgedWorld : public testing::TestWithParam<std::string> {};

TEST_P(JudgedWorld, AgreesWithLibsdformat) {
  const auto world = load_world(GetParam());
  if (world) return judge_world(GetParam(), *world);
  EXPECT_NE(world.error().message.find(GetParam()), std::string::npos) << world.error().message;
  EXPECT_FALSE(GetParam().starts_with("sim/worlds")) << world.error().message;
  std::printf("refused: %s\n", world.error().message.c_str());
}

INSTANTIATE_TEST_SUITE_P(Files, JudgedWorld, testing::ValuesIn(world_files()),
                         [](const auto& test) {
                           std::string name = fs::path(test.param).stem().string() + "_" +
                                              std::to_string(test.index);
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
                           return name;
                         });

}  // namespace
}  // namespace kaz::sim
