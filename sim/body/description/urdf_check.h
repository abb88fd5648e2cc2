// Validates a URDF. All errors of the file are reported together, with their lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {

// If the root link has this name, the root link is fixed in the world, at the robot's start pose.
inline constexpr const char* kFixedRoot = "world";
// Limits of this size mean that the joint has none, rad or m. Exporters write 1e16.
inline constexpr double kStatedUnlimited = 1000;
// Largest ratio of a principal moment of inertia to the sum of the two others. For rigid bodies it is at most
// 1, but CAD programs and estimates violate this. The dynamics need only positive moments.
inline constexpr double kLargestExcess = 1.5;

// A joint that follows another joint: angle = ratio * (angle of `joint`) + offset (rad).
struct Mimic {
  std::string joint;
  double ratio = 1, offset = 0;
};

// A valid URDF. The pointers refer to elements of `file`.
struct Urdf {
  XmlFile file;
  std::map<std::string, const tinyxml2::XMLElement*> links;  // by name
  std::vector<const tinyxml2::XMLElement*> joints;           // in the order of the file
  std::map<std::string, const tinyxml2::XMLElement*>
      joint_to;                            // joint by the name of its child link
  std::string root;                        // name of the root link
  std::map<std::string, double> friction;  // coefficient mu of each link that states one
  std::set<const tinyxml2::XMLElement*> shapeless;  // parts of <geometry> that are left out
  std::map<std::string, double> inertia_scales;  // PyBullet's factor of each link that states one
  std::vector<FileNote> notes;
  std::map<std::string, Mimic>
      mimics;  // by name of the follower; Mimic::joint does not follow a joint

  bool moves(const tinyxml2::XMLElement& joint) const;  // revolute, continuous or prismatic
  // Returns whether the joint moves and does not follow another joint.
  bool has_motor(const tinyxml2::XMLElement& joint) const;
};

// The inertia tensor of an element <inertia>; missing moments are 0.
Eigen::Matrix3d tensor_of(const tinyxml2::XMLElement& inertia);

// Checks a file with the root <robot> against the URDF subset in docs/reference/robot.md (urdf_schema.h).
// With ReadOptions::body == false, only names and limits are checked.
Result<Urdf> check_urdf(XmlFile file, const ReadOptions& options);

}  // namespace kaz::sim
