// Compiles a checked MJCF file by libmujoco.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "sim/body/description/libmujoco.h"
#include "sim/body/description/mjcf_check.h"

namespace kaz::sim {

// A model, and the elements of the file by the names in the model.
struct CompiledMjcf {
  std::shared_ptr<const mjModel_> model;
  // A body without a name gets the name body_N.
  std::map<std::string, const tinyxml2::XMLElement*> bodies, joints;
  // All <geom> get new names. A mesh is a sphere in the model, which has the pose of the <geom>. Reason:
  // libmujoco moves the frame of a mesh to the mesh's center of mass.
  std::map<std::string, const tinyxml2::XMLElement*> geoms;
};

// Compiles the file without the parts that Kaz does not use (mjcf_elements.h). Unless the file states
// `autolimits`, it is true, as in MuJoCo 3. Meshes are compiled only for bodies without an <inertial>. With
// ReadOptions::body == false, such bodies have other masses. The error is libmujoco's, with the file's line.
Result<CompiledMjcf> compile_mjcf(const Mjcf& mjcf, const ReadOptions& options);

}  // namespace kaz::sim
