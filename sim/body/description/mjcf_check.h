// Checks the elements of an MJCF robot against the list in mjcf_elements.h.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/description/mjcf_source.h"
#include "sim/body/description/reading.h"

namespace kaz::sim {

struct MjcfMesh {
  std::string path;                                 // absolute; empty: missing and skipped
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  // factor for each axis
};

// A valid MJCF file, except for errors that only libmujoco finds.
struct Mjcf {
  MjcfSource source;
  std::map<std::string, MjcfMesh> meshes;  // by the name of the <mesh>
  std::vector<FileNote> notes;
};

// Returns whether a refused attribute has no effect with this value: zeros, the identity quaternion, `false`,
// `none` or `legacy`.
bool mjcf_neutral(const std::string& value);

// Returns whether the element is a <body> that a program moves: a handle of the viewer, no part of a robot.
bool mjcf_is_mocap(const tinyxml2::XMLElement& e);

// Returns the name of a <mesh>: its `name`, or the stem of its `file`.
std::string mjcf_mesh_name(const tinyxml2::XMLElement& mesh);

// Returns the name of the mesh of a <geom>, or null if its shape is not a mesh.
const char* mjcf_mesh_of(const MjcfSource& source, const tinyxml2::XMLElement& geom);

// Checks the file with its includes. Errors: unknown and refused elements and attributes, invalid
// numbers and names, missing meshes. All of them are reported together.
Result<Mjcf> check_mjcf(const XmlFile& file, const ReadOptions& options);

}  // namespace kaz::sim
