// Validates a world file and the files that it includes, and prepares them for libsdformat.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"

namespace kaz::sim {

// Name of the element that marks the place of an <include>: <kaz:include file="INDEX"/> in a <model>. World
// files cannot contain this element.
inline constexpr const char* kIncludePlace = "kaz:include";

// Deepest nesting of models, and of files that include each other.
inline constexpr int kMaxSdfDepth = 8;

// Text of an included file with one <model> in <sdf>.
struct IncludedText {
  std::string path;
  std::string text;
};

// A valid world. The texts contain only elements of sdf_schema(), each on its line of the file. Unused
// elements are left out, paths of meshes are absolute, and empty poses are zero.
struct CheckedSdf {
  std::string text;
  std::vector<IncludedText> models;
  std::vector<FileNote> notes;
  // Direction to the lamp of the first directional light, in the world frame, at least 3 degrees above the
  // floor. Used without <kaz:light>.
  std::optional<Eigen::Vector3d> to_lamp;
  int nesting = 0;        // depth of nested models; 0: none
  bool is_plain = true;   // no joints, frames, meshes or masks
  bool is_recent = true;  // all files have SDF 1.7 or newer
};

// Checks elements, attributes, numbers, names and masses against the SDF subset in docs/reference/worlds.md
// (sdf_elements.h). All errors of a file are reported together, with their lines.
Result<CheckedSdf> check_sdf(const std::string& path, const ReadOptions& options);

// Returns the minor number of a supported SDF version ("1.9": 9), or nullopt.
std::optional<int> sdf_minor_version(std::string_view version);

}  // namespace kaz::sim
