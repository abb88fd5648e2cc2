// Finds the files of models and meshes to which a world refers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Gazebo's model of a floor, which most worlds include from Gazebo's own folder. It is used if no folder
// contains it.
inline constexpr const char* kFloorModel = "model://ground_plane";
inline constexpr const char* kFloorText = R"(<sdf version="1.6"><model name="ground_plane">
<static>true</static><link name="link">
<collision name="collision"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
<surface><friction><ode><mu>100</mu><mu2>50</mu2></ode></friction></surface></collision>
<visual name="visual"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
<material><diffuse>0.8 0.8 0.8 1</diffuse></material></visual></link></model></sdf>)";
// Gazebo's model of a light. It is left out if no folder contains it.
inline constexpr const char* kSunModel = "model://sun";

// Search path of one world: the folder of the world, its subfolder `models`, and the folders of the
// environment variables GZ_SIM_RESOURCE_PATH, GAZEBO_MODEL_PATH and SDF_PATH (FOLDER[:FOLDER...]).
//
// Worlds are untrusted and must not make the program read, draw or serve arbitrary files. Therefore each file
// must be in one of these folders, with symbolic links resolved.
class ModelPath {
 public:
  explicit ModelPath(const std::string& world_path);

  // Returns the absolute path of a file or folder. `uri` is model://NAME/PATH, file://PATH, or a relative
  // path. A relative path starts at the folder of `file`, which contains the URI. An error message is a
  // sentence fragment that the caller completes. The function never accesses the network.
  Result<std::string> find(const std::string& file, const std::string& uri) const;

  // Returns the SDF file of a model: `path` itself, or for a folder the file of the newest supported version
  // in its model.config. Errors as in find().
  Result<std::string> model_file(const std::string& path) const;

 private:
  Result<std::string> permitted(const std::filesystem::path& path) const;
  std::vector<std::filesystem::path> folders_;  // absolute, without symbolic links
};

}  // namespace kaz::sim
