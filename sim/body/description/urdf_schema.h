// Elements and attributes of URDF, and what Kaz does with each of them.
// SPDX-License-Identifier: Apache-2.0
//
// The list contains URDF 1.2 (ROS 2) and the usual extensions of Gazebo, MuJoCo, PyBullet and ros2_control.
// A test compares docs/reference/robot.md with it.
#pragma once

#include <span>
#include <string_view>

#include "sim/body/description/reading.h"

namespace kaz::sim {

struct UrdfElement {
  std::string_view parent, name;
  Use use = Use::used;
  bool repeated = false;             // may occur several times in one parent
  std::string_view attributes = {};  // used, separated by spaces
  std::string_view noted = {};       // not used
  std::string_view remedy = {};      // for refused elements
};

inline constexpr UrdfElement kUrdfElements[] = {
    {"", "robot", Use::used, false, "name", "version author"},
    {"robot", "link", Use::used, true, "name", "type concave"},
    {"robot", "joint", Use::used, true, "name type", ""},
    {"robot", "material", Use::used, true, "name", ""},
    {"robot", "transmission", Use::noted, true},
    {"robot", "gazebo", Use::used, true, "reference", ""},
    {"robot", "mujoco", Use::noted, true},
    {"robot", "ros2_control", Use::noted, true},
    {"robot", "sensor", Use::noted, true},
    {"robot", "group", Use::noted, true},
    {"robot", "model", Use::noted, true},
    {"robot", "frame", Use::noted, true},
    {"robot", "collision_filter_group", Use::noted, true},
    {"robot", "isaac_sim_config", Use::noted, true},
    {"robot", "loop_joint", Use::refused, true, "", "", "open the loop, as links must form a tree"},

    {"link", "inertial", Use::used, false, "", "name"},
    {"link", "visual", Use::used, true, "name", "group"},
    {"link", "collision", Use::used, true, "name", "group verbose concave"},
    {"link", "origin", Use::noted, true},
    {"link", "mass", Use::noted, true},
    {"link", "material", Use::noted, true},
    {"link", "sensor", Use::noted, true},
    {"link", "self_collision_checking", Use::noted, true},
    {"link", "contact", Use::used, false},
    {"link", "audio_source", Use::noted, true},

    {"inertial", "origin", Use::used, false, "xyz rpy quat_xyzw", ""},
    {"inertial", "mass", Use::used, false, "value", ""},
    {"inertial", "inertia", Use::used, false, "ixx ixy ixz iyy iyz izz", "iyx izx izy"},

    {"contact", "lateral_friction", Use::used, false, "value", ""},
    {"contact", "rolling_friction", Use::noted, true},
    {"contact", "spinning_friction", Use::noted, true},
    {"contact", "contact_cfm", Use::noted, true},
    {"contact", "contact_erp", Use::noted, true},
    {"contact", "stiffness", Use::noted, true},
    {"contact", "damping", Use::noted, true},
    {"contact", "friction_anchor", Use::noted, true},
    {"contact", "restitution", Use::refused, true, "", "", "Kaz's robots do not bounce; remove it"},
    {"contact", "inertia_scaling", Use::used, false, "value", ""},

    {"visual", "origin", Use::used, false, "xyz rpy quat_xyzw", ""},
    {"visual", "geometry", Use::used, false, "", "name"},
    {"visual", "material", Use::used, false, "name", ""},
    {"collision", "origin", Use::used, false, "xyz rpy quat_xyzw", ""},
    {"collision", "geometry", Use::used, false, "", "name"},
    {"collision", "material", Use::noted, true},
    {"collision", "verbose", Use::noted, true},
    {"collision", "contact_coefficients", Use::refused, true, "", "",
     "give the friction as <gazebo reference=\"LINK\"><mu1>"},

    {"geometry", "box", Use::used, false, "size", ""},
    {"geometry", "cylinder", Use::used, false, "radius length", ""},
    {"geometry", "sphere", Use::used, false, "radius", ""},
    {"geometry", "capsule", Use::used, false, "radius length", ""},
    {"geometry", "mesh", Use::used, false, "filename scale", ""},

    {"material", "color", Use::used, false, "rgba", ""},
    {"material", "texture", Use::noted, true},

    {"joint", "parent", Use::used, false, "link", ""},
    {"joint", "child", Use::used, false, "link", ""},
    {"joint", "origin", Use::used, false, "xyz rpy quat_xyzw", ""},
    {"joint", "axis", Use::used, false, "xyz", "rpy"},
    {"joint", "limit", Use::used, false, "lower upper effort velocity",
     "acceleration deceleration jerk k_velocity k_position safety_length_min safety_length_max"},
    {"joint", "dynamics", Use::used, false, "damping friction",
     "spring_reference spring_stiffness armature"},
    {"joint", "mimic", Use::used, false, "joint multiplier offset", ""},
    {"joint", "safety_controller", Use::noted, true},
    {"joint", "calibration", Use::noted, true},
    {"joint", "joint_properties", Use::noted, true},
    {"joint", "hardwareInterface", Use::noted, true},
    {"joint", "actuator", Use::noted, true},
};

// Attributes that contain `count` numbers.
struct UrdfNumbers {
  const char* element;
  const char* attribute;
  std::size_t count;
  bool needed;
};
inline constexpr UrdfNumbers kUrdfNumbers[] = {
    {"origin", "xyz", 3, false},        {"origin", "rpy", 3, false},
    {"origin", "quat_xyzw", 4, false},  {"axis", "xyz", 3, true},
    {"box", "size", 3, true},           {"color", "rgba", 4, true},
    {"mesh", "scale", 3, false},        {"cylinder", "radius", 1, true},
    {"cylinder", "length", 1, true},    {"capsule", "radius", 1, true},
    {"capsule", "length", 1, true},     {"sphere", "radius", 1, true},
    {"mass", "value", 1, true},         {"inertia", "ixx", 1, true},
    {"inertia", "iyy", 1, true},        {"inertia", "izz", 1, true},
    {"inertia", "ixy", 1, false},       {"inertia", "ixz", 1, false},
    {"inertia", "iyz", 1, false},       {"limit", "lower", 1, false},
    {"limit", "upper", 1, false},       {"limit", "effort", 1, false},
    {"limit", "velocity", 1, false},    {"dynamics", "damping", 1, false},
    {"dynamics", "friction", 1, false}, {"mimic", "multiplier", 1, false},
    {"mimic", "offset", 1, false},
};

// Returns the entry of the element `name` in `parent`, or null.
constexpr const UrdfElement* urdf_element(std::string_view parent, std::string_view name) {
  for (const UrdfElement& element : kUrdfElements) {
    if (element.parent == parent && element.name == name) return &element;
  }
  return nullptr;
}

}  // namespace kaz::sim
