// For tests: paths of robot and world files, temporary folders, and worlds from SDF text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shared/board/board.h"
#include "sim/body/world/world.h"

namespace kaz::sim::test {

inline const std::string kRobot = "shared/robot/kaz/kaz.urdf";
inline const std::string kEmpty = "sim/worlds/empty.sdf";
inline const std::string kBall = "sim/worlds/ball.sdf";

inline std::string read_text(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// URDF files in the tree. KAZ_ROBOT_FILES=FOLDER: all URDF files below this folder instead.
inline std::vector<std::string> robot_files() {
  const char* named = std::getenv("KAZ_ROBOT_FILES");
  std::vector<std::string> folders{"shared/robot", "sim/robots"}, found;
  if (named != nullptr) folders = {named};
  for (const std::string& folder : folders) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().extension() == ".urdf") found.push_back(entry.path().string());
    }
  }
  std::ranges::sort(found);
  return found;
}

// Name of the test of one of robot_files().
inline std::string robot_test_name(const testing::TestParamInfo<std::string>& test) {
  std::string name =
      std::filesystem::path(test.param).stem().string() + "_" + std::to_string(test.index);
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

// Temporary folder of the current test case. The destructor removes the folder.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(info->test_suite_name()) + "." + info->name();
    std::replace(name.begin(), name.end(), '/', '_');
    path_ =
        std::filesystem::path(testing::TempDir()) / ("kaz_body_" + std::to_string(getpid()) + name);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  // Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = path_ / name;
    std::ofstream(path) << text;
    return path;
  }

 private:
  std::filesystem::path path_;
};

// Returns the SDF text of a world with a floor (mu 0.5) and the given models. The robot starts at y = -3 m,
// away from the models. `gravity` is "x y z" in m/s^2.
inline std::string world_text(const std::string& gravity, const std::string& models) {
  return R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="test">
<kaz:robot pose="0 -3 0 0 0 0"/>
<gravity>)" +
         gravity + R"(</gravity>
<model name="floor"><static>true</static><link name="l"><collision name="c">
<geometry><plane><normal>0 0 1</normal><size>9 9</size></plane></geometry>
<surface><friction><ode><mu>0.5</mu></ode></friction></surface></collision></link></model>
)" + models +
         "</world></sdf>\n";
}

// Loads a world with the robot Kaz. On an error, the test fails and the result is null.
inline std::unique_ptr<World> load_or_fail(const std::string& world, const WorldOptions& options) {
  auto loaded = World::load(world, kRobot, options);
  if (!loaded) {
    ADD_FAILURE() << loaded.error().message;
    return nullptr;
  }
  return std::move(*loaded);
}

using Drives = std::array<MotorDrive, KZ_JOINTS>;

// Steps the world for `seconds` with constant drives and a 10 V supply.
inline void run(World& world, double seconds, const Drives& drives = {}) {
  const double end = world.time_s() + seconds - world.step_s() / 2;
  while (world.time_s() < end) world.step(drives, 10.0);
}

}  // namespace kaz::sim::test
