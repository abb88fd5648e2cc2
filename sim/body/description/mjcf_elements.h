// Elements and attributes of MJCF, and what Kaz does with each of them.
// SPDX-License-Identifier: Apache-2.0
//
// The list contains MuJoCo 2.2.2, which compiles the file, and the names that MuJoCo 3 added. Only
// `compiled` attributes are given to libmujoco. Therefore a file with newer names compiles. A test compares
// the list with libmujoco's schema.
#pragma once

#include <span>
#include <string_view>

#include "sim/body/description/reading.h"
#include "sim/body/description/urdf_schema.h"

namespace kaz::sim {

// Names are separated by spaces. An element that is noted or refused stands for all elements in it.
struct MjcfElement {
  std::string_view parent, name;
  Use use = Use::used;
  std::string_view compiled = {};  // used, by libmujoco
  std::string_view own = {};       // used, by Kaz itself
  std::string_view noted = {};     // not used
  std::string_view refused = {};   // refused, unless the value is neutral (mjcf_neutral())
  std::string_view remedy = {};    // for refused elements
};

namespace mjcf {
inline constexpr std::string_view kExpand =
    "expand it with MuJoCo's program `compile ROBOT.xml EXPANDED.xml`";
inline constexpr std::string_view kOpen =
    "open the loop, and state how the passive joint turns: <equality><joint joint1=\"PASSIVE\" "
    "joint2=\"DRIVEN\" polycoef=\"0 RATIO 0 0 0\"/>";
inline constexpr std::string_view kServo = "use <motor>, <position>, <velocity> or <general>";
inline constexpr std::string_view kTendon =
    "state how the joints turn together: <equality><joint joint1=\"PASSIVE\" joint2=\"DRIVEN\" "
    "polycoef=\"0 RATIO 0 0 0\"/>";
}  // namespace mjcf

// Position and orientation; range of an actuator; targets of an actuator that are not joints.
#define KZ_POSE "pos quat axisangle xyaxes zaxis euler"
#define KZ_RANGES \
  "name class ctrllimited forcelimited ctrlrange forcerange gear joint jointinparent tendon"
#define KZ_SERVO                                                                                   \
  "group actlimited actrange lengthrange cranklength user inheritrange kp kv dampratio timeconst " \
  "delay nsample interp damping armature"
#define KZ_TARGETS "slidersite cranksite site refsite body"

// A tendon only distributes the force of its actuator: it neither pulls nor ends by itself.
#define KZ_TENDON                                                                            \
  "group width material rgba margin solreflimit solimplimit solreffriction solimpfriction " \
  "springlength armature actuatorfrcrange actuatorfrclimited user"
#define KZ_TENDON_LIMITS "stiffness damping frictionloss limited range"

inline constexpr MjcfElement kMjcfElements[] = {
    {"", "mujoco", Use::used, "model"},
    {"mujoco", "compiler", Use::used,
     "autolimits boundmass boundinertia settotalmass balanceinertia coordinate angle eulerseq "
     "inertiafromgeom inertiagrouprange exactmeshinertia",
     "meshdir assetdir strippath",
     "fitaabb texturedir discardvisual convexhull usethread fusestatic alignfree saveinertial"},
    {"mujoco", "option", Use::used, "", "",
     "timestep apirate impratio tolerance ls_tolerance noslip_tolerance ccd_tolerance "
     "mpr_tolerance "
     "sleep_tolerance gravity magnetic o_margin o_solref o_solimp o_friction integrator collision "
     "cone jacobian solver iterations ls_iterations noslip_iterations mpr_iterations "
     "ccd_iterations sdf_iterations sdf_initpoints actuatorgroupdisable",
     "wind density viscosity"},
    {"mujoco", "size", Use::noted},
    {"mujoco", "visual", Use::noted},
    {"mujoco", "statistic", Use::noted},
    {"mujoco", "default", Use::used, "class"},
    {"mujoco", "custom", Use::noted},
    {"mujoco", "extension", Use::refused, "", "", "", "",
     "Kaz has no plug-ins of MuJoCo; remove it"},
    {"mujoco", "asset"},
    {"mujoco", "worldbody", Use::used, "", "", KZ_POSE " name"},
    {"mujoco", "contact", Use::noted},
    {"mujoco", "deformable", Use::refused, "", "", "", "", "Kaz has rigid bodies only; remove it"},
    {"mujoco", "equality"},
    {"mujoco", "tendon"},
    {"mujoco", "actuator"},
    {"mujoco", "sensor", Use::noted},
    {"mujoco", "keyframe", Use::noted},
    {"compiler", "lengthrange", Use::noted},
    {"option", "flag", Use::noted},

    {"default", "default", Use::used, "class"},
    {"default", "pair", Use::noted},
    {"default", "equality", Use::used, "active", "", "solref solimp"},
    {"default", "tendon", Use::used, "", "", KZ_TENDON, KZ_TENDON_LIMITS},
    {"default", "damper", Use::noted},
    {"default", "cylinder", Use::noted},
    {"default", "muscle", Use::noted},
    {"default", "adhesion", Use::noted},

    {"asset", "mesh", Use::used, "name class scale", "file",
     "smoothnormal content_type maxhullvert material octree",
     "vertex normal texcoord face refpos refquat inertia builtin params"},
    {"asset", "material", Use::used, "name class rgba", "",
     "texture texrepeat texuniform emission specular shininess reflectance metallic roughness"},
    {"asset", "texture", Use::noted},
    {"asset", "hfield", Use::noted},
    {"asset", "skin", Use::noted},
    {"asset", "model", Use::refused, "", "", "", "", mjcf::kExpand},
    {"mesh", "plugin", Use::refused, "", "", "", "", "give a file instead"},
    {"material", "layer", Use::noted},

    {"body", "body", Use::used, "name childclass " KZ_POSE, "", "user sleep gravcomp", "mocap"},
    {"body", "inertial", Use::used, "mass diaginertia fullinertia " KZ_POSE},
    {"body", "joint", Use::used, "name class type pos axis limited range ref damping frictionloss",
     "actuatorfrcrange actuatorfrclimited",
     "group solreflimit solimplimit solreffriction solimpfriction margin springref armature user "
     "actuatorgravcomp",
     "stiffness springdamper"},
    {"body", "freejoint", Use::used, "name", "", "group align"},
    {"body", "geom", Use::used,
     "name class type contype conaffinity condim group size material friction mass density "
     "shellinertia fromto mesh fitscale rgba " KZ_POSE,
     "", "priority solmix solref solimp margin gap fluidshape fluidcoef user", "hfield"},
    {"body", "site", Use::used, "name class type size fromto " KZ_POSE, "",
     "group material rgba user"},
    {"body", "camera", Use::noted},
    {"body", "light", Use::noted},
    {"body", "composite", Use::refused, "", "", "", "", "Kaz has rigid bodies only; remove it"},
    {"body", "flexcomp", Use::refused, "", "", "", "", "Kaz has rigid bodies only; remove it"},
    {"body", "frame", Use::refused, "", "", "", "", mjcf::kExpand},
    {"body", "replicate", Use::refused, "", "", "", "", mjcf::kExpand},
    {"body", "attach", Use::refused, "", "", "", "", mjcf::kExpand},
    {"body", "plugin", Use::refused, "", "", "", "", "Kaz has no plug-ins of MuJoCo; remove it"},
    {"geom", "plugin", Use::refused, "", "", "", "", "Kaz has no plug-ins of MuJoCo; remove it"},

    {"equality", "joint", Use::used, "name class joint1 joint2 polycoef active", "",
     "solref solimp"},
    {"equality", "connect", Use::refused, "", "", "", "", mjcf::kOpen},
    {"equality", "weld", Use::refused, "", "", "", "", mjcf::kOpen},
    {"equality", "distance", Use::refused, "", "", "", "", mjcf::kOpen},
    {"equality", "tendon", Use::refused, "", "", "", "", mjcf::kTendon},
    {"equality", "flex", Use::refused, "", "", "", "", "Kaz has rigid bodies only; remove it"},
    {"equality", "flexvert", Use::refused, "", "", "", "", "Kaz has rigid bodies only; remove it"},
    {"equality", "flexstrain", Use::refused, "", "", "", "",
     "Kaz has rigid bodies only; remove it"},
    {"tendon", "spatial", Use::refused, "", "", "", "", mjcf::kTendon},
    {"tendon", "fixed", Use::used, "name class", "", KZ_TENDON, KZ_TENDON_LIMITS},
    {"fixed", "joint", Use::used, "joint coef"},

    {"actuator", "general", Use::used, KZ_RANGES " gaintype biastype gainprm biasprm", "",
     KZ_SERVO " dyntype dynprm actdim actearly", KZ_TARGETS},
    {"actuator", "motor", Use::used, KZ_RANGES, "", KZ_SERVO, KZ_TARGETS},
    {"actuator", "position", Use::used, KZ_RANGES, "", KZ_SERVO, KZ_TARGETS},
    {"actuator", "velocity", Use::used, KZ_RANGES, "", KZ_SERVO, KZ_TARGETS},
    {"actuator", "intvelocity", Use::used, KZ_RANGES, "", KZ_SERVO, KZ_TARGETS},
    {"actuator", "damper", Use::refused, "", "", "", "", mjcf::kServo},
    {"actuator", "cylinder", Use::refused, "", "", "", "", mjcf::kServo},
    {"actuator", "muscle", Use::refused, "", "", "", "", mjcf::kServo},
    {"actuator", "adhesion", Use::refused, "", "", "", "", mjcf::kServo},
    {"actuator", "plugin", Use::refused, "", "", "", "", mjcf::kServo},
};
#undef KZ_POSE
#undef KZ_RANGES
#undef KZ_SERVO
#undef KZ_TARGETS
#undef KZ_TENDON
#undef KZ_TENDON_LIMITS

// Remedies for refused attributes.
struct MjcfRemedy {
  std::string_view attributes, remedy;
};
inline constexpr MjcfRemedy kMjcfRemedies[] = {
    {"stiffness springdamper", "Kaz has no springs in joints; remove it"},
    {"damping frictionloss limited range", "Kaz's tendons do not act by themselves; remove it"},
    {"wind density viscosity", "Kaz has no fluid; remove it"},
    {"hfield", "Kaz has no height fields; use a mesh or a box"},
    {"vertex normal texcoord face builtin params", "write the mesh to an OBJ or STL file"},
    {"refpos refquat", "change the vertices of the mesh, or the pose of the <geom>"},
    {"inertia", "give the body an <inertial>"},
    {"slidersite cranksite site refsite body", "Kaz's motors act on joints; give `joint`"},
};

// Returns the entry of the element `name` in `parent`, or null. The elements in a <worldbody> are those in a
// <body>. The elements in a <default> are those in a <body>, an <asset> or an <actuator>.
constexpr const MjcfElement* mjcf_element(std::string_view parent, std::string_view name) {
  if (parent == "worldbody") parent = "body";
  for (const MjcfElement& element : kMjcfElements) {
    if (element.parent == parent && element.name == name) return &element;
  }
  if (parent != "default") return nullptr;
  for (const std::string_view other : {"body", "asset", "actuator"}) {
    if (const MjcfElement* element = mjcf_element(other, name)) return element;
  }
  return nullptr;
}

constexpr std::string_view mjcf_remedy(std::string_view attribute) {
  for (const MjcfRemedy& one : kMjcfRemedies) {
    if (has_word(one.attributes, attribute)) return one.remedy;
  }
  return "remove it";
}

}  // namespace kaz::sim
