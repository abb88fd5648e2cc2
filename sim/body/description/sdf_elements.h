// Elements and attributes of SDF 1.0 to 1.11 in worlds, and what Kaz does with each of them.
// SPDX-License-Identifier: Apache-2.0
//
// A test compares the list with the specification that comes with libsdformat.
#pragma once

#include <string>
#include <string_view>

#include "sim/body/description/reading.h"

namespace kaz::sim {

struct SdfElement {
  // Context of the parent (sdf_context()).
  std::string_view parent, name;
  Use use = Use::used;
  bool repeated = false;             // may occur several times in one parent
  std::string_view attributes = {};  // used, separated by spaces
  std::string_view noted = {};       // not used
  std::string_view remedy = {};      // for refused elements
  // Refused elements: the value without an effect, which is accepted. Used elements: kOnlyChecked if
  // libsdformat does not get the element.
  std::string_view harmless = {};
};

inline constexpr std::string_view kOnlyChecked = "*";
inline constexpr std::string_view kPoseAttributes = "relative_to rotation_format degrees frame";

inline constexpr SdfElement kSdfElements[] = {
    {"", "sdf", Use::used, false, "version"},
    {"sdf", "world", Use::used, false, "name"},
    {"sdf", "model", Use::refused, true, "", "", "include the model in a world: <include><uri>"},
    {"sdf", "actor", Use::noted, true},
    {"sdf", "light", Use::noted, true},

    {"world", "gravity"},
    {"world", "model", Use::used, true, "name canonical_link placement_frame"},
    {"world", "include", Use::used, true, "merge"},
    {"world", "frame", Use::used, true, "name attached_to"},
    // The direction of the first directional light is used.
    {"world", "light", Use::noted, true},
    {"world", "kaz:robot", Use::used, false, "pose first_step"},
    {"world", "kaz:light", Use::used, false, "to_lamp lamp shade"},
    {"world", "wind", Use::used, false, "", "", "", kOnlyChecked},
    {"world", "joint", Use::refused, true, "", "", "move the joint into one of its models"},
    {"world", "population", Use::refused, true, "", "", "give each model as a <model>"},
    {"world", "state", Use::refused, true, "", "", "give the poses in the models"},
    {"world", "actor", Use::noted, true},
    {"world", "atmosphere", Use::noted},
    {"world", "audio", Use::noted},
    {"world", "gui", Use::noted},
    {"world", "magnetic_field", Use::noted},
    {"world", "particle_emitter", Use::noted, true},
    {"world", "physics", Use::noted, true},
    {"world", "plugin", Use::noted, true},
    {"world", "road", Use::noted, true},
    {"world", "scene", Use::noted},
    {"world", "spherical_coordinates", Use::noted},
    {"kaz:robot", "kaz:push", Use::used, true, "time link impulse"},
    {"wind", "linear_velocity", Use::refused, false, "", "", "remove the wind", "0 0 0"},
    {"frame", "pose", Use::used, false, kPoseAttributes},

    {"include", "uri"},
    {"include", "name"},
    {"include", "static"},
    {"include", "pose", Use::used, false, kPoseAttributes},
    {"include", "placement_frame"},
    {"include", "plugin", Use::noted, true},

    {"model", "static"},
    {"model", "pose", Use::used, false, kPoseAttributes},
    {"model", "link", Use::used, true, "name"},
    {"model", "joint", Use::used, true, "name type"},
    {"model", "frame", Use::used, true, "name attached_to"},
    {"model", "model", Use::used, true, "name canonical_link placement_frame"},
    {"model", "include", Use::used, true, "merge"},
    {"model", "kaz:kick", Use::used, true, "time velocity"},
    {"model", "gripper", Use::refused, true, "", "", "remove it; contacts hold the objects"},
    {"model", "allow_auto_disable", Use::noted},
    {"model", "enable_wind", Use::noted},
    {"model", "plugin", Use::noted, true},
    {"model", "self_collide", Use::noted},

    {"link", "pose", Use::used, false, kPoseAttributes},
    {"link", "inertial", Use::used, false, "auto"},
    {"link", "collision", Use::used, true, "name"},
    {"link", "visual", Use::used, true, "name"},
    {"link", "gravity", Use::refused, false, "", "", "remove it, or make the model static", "true"},
    {"link", "kinematic", Use::refused, false, "", "", "make the model static", "false"},
    {"link", "velocity_decay", Use::used, false, "", "", "", kOnlyChecked},
    {"link", "audio_sink", Use::noted, true},
    {"link", "audio_source", Use::noted, true},
    {"link", "battery", Use::noted, true},
    {"link", "enable_wind", Use::noted},
    {"link", "light", Use::noted, true},
    {"link", "must_be_base_link", Use::noted},
    {"link", "particle_emitter", Use::noted, true},
    {"link", "projector", Use::noted, true},
    {"link", "self_collide", Use::noted},
    {"link", "sensor", Use::noted, true},
    {"velocity_decay", "linear", Use::refused, false, "", "", "remove it", "0"},
    {"velocity_decay", "angular", Use::refused, false, "", "", "remove it", "0"},

    {"inertial", "mass"},
    {"inertial", "pose", Use::used, false, "rotation_format degrees frame relative_to"},
    {"inertial", "inertia"},
    {"inertial", "density", Use::noted},
    {"inertial", "auto_inertia_params", Use::noted},
    {"inertial", "fluid_added_mass", Use::refused, false, "", "", "remove it; Kaz has no fluids"},
    {"inertia", "ixx"},
    {"inertia", "ixy"},
    {"inertia", "ixz"},
    {"inertia", "iyy"},
    {"inertia", "iyz"},
    {"inertia", "izz"},

    {"visual", "pose", Use::used, false, kPoseAttributes},
    {"visual", "geometry"},
    {"visual", "material"},
    {"visual", "kaz:texture", Use::used, false, "name"},
    {"visual", "cast_shadows", Use::noted},
    {"visual", "laser_retro", Use::noted},
    {"visual", "meta", Use::noted},
    {"visual", "plugin", Use::noted, true},
    {"visual", "transparency", Use::noted},
    {"visual", "visibility_flags", Use::noted},
    {"material", "ambient", Use::used, false, "", "", "", kOnlyChecked},
    {"material", "diffuse"},
    {"material", "specular", Use::used, false, "", "", "", kOnlyChecked},
    {"material", "double_sided", Use::noted},
    {"material", "emissive", Use::noted},
    {"material", "lighting", Use::noted},
    {"material", "pbr", Use::noted},
    {"material", "render_order", Use::noted},
    {"material", "script", Use::noted},
    {"material", "shader", Use::noted},
    {"material", "shininess", Use::noted},

    {"collision", "pose", Use::used, false, kPoseAttributes},
    {"collision", "geometry"},
    {"collision", "surface"},
    {"collision", "auto_inertia_params", Use::noted},
    {"collision", "density", Use::noted},
    {"collision", "laser_retro", Use::noted},
    {"collision", "max_contacts", Use::noted},

    // Shapes that are refused here are noted in visuals: the visual is left out.
    {"geometry", "box"},
    {"geometry", "capsule"},
    {"geometry", "cylinder"},
    {"geometry", "mesh", Use::used, false, "", "optimization"},
    {"geometry", "plane"},
    {"geometry", "sphere"},
    {"geometry", "empty", Use::noted},
    {"geometry", "cone", Use::refused, false, "", "", "use a mesh or a cylinder"},
    {"geometry", "ellipsoid", Use::refused, false, "", "", "use a mesh, a sphere or a capsule"},
    {"geometry", "heightmap", Use::refused, false, "", "", "use boxes, or meshes of convex parts"},
    {"geometry", "image", Use::refused, false, "", "", "use boxes, or meshes of convex parts"},
    {"geometry", "polyline", Use::refused, true, "", "", "use boxes, or meshes of convex parts"},
    {"box", "size"},
    {"capsule", "radius"},
    {"capsule", "length"},
    {"cylinder", "radius"},
    {"cylinder", "length"},
    {"plane", "normal"},
    {"plane", "size"},
    {"sphere", "radius"},
    {"mesh", "uri"},
    {"mesh", "scale"},
    {"mesh", "submesh", Use::refused, false, "", "", "put the part into a mesh file of its own"},
    {"mesh", "convex_decomposition", Use::noted},

    {"surface", "friction"},
    {"surface", "bounce"},
    {"surface", "contact"},
    {"surface", "kaz:rolling_resistance", Use::used, false, "metres"},
    {"surface", "soft_contact", Use::noted},
    {"friction", "ode"},
    {"friction", "torsional", Use::used, false, "", "", "", kOnlyChecked},
    {"friction", "bullet", Use::noted},
    {"friction/ode", "mu"},
    {"friction/ode", "mu2", Use::used, false, "", "", "", kOnlyChecked},
    {"friction/ode", "fdir1", Use::noted, false, "", "expressed_in"},
    {"friction/ode", "slip1", Use::refused, false, "", "", "remove it", "0"},
    {"friction/ode", "slip2", Use::refused, false, "", "", "remove it", "0"},
    {"torsional", "coefficient", Use::noted},
    {"torsional", "use_patch_radius", Use::noted},
    {"torsional", "patch_radius", Use::refused, false, "", "",
     "remove it, or use kaz:rolling_resistance", "0"},
    {"torsional", "surface_radius", Use::refused, false, "", "",
     "remove it, or use kaz:rolling_resistance", "0"},
    {"torsional", "ode", Use::noted},
    {"bounce", "restitution_coefficient"},
    {"bounce", "threshold"},
    {"contact", "ode"},
    {"contact", "collide_bitmask", Use::used},
    {"contact", "collide_without_contact", Use::refused, false, "", "",
     "remove the collision, or the element", "false"},
    {"contact", "bullet", Use::noted},
    {"contact", "category_bitmask", Use::noted},
    {"contact", "collide_without_contact_bitmask", Use::noted},
    {"contact", "elastic_modulus", Use::noted},
    {"contact", "poissons_ratio", Use::noted},
    {"contact/ode", "soft_cfm"},
    {"contact/ode", "kd", Use::noted},
    {"contact/ode", "kp", Use::noted},
    {"contact/ode", "max_vel", Use::noted},
    {"contact/ode", "min_depth", Use::noted},
    {"contact/ode", "soft_erp", Use::noted},

    {"joint", "parent"},
    {"joint", "child"},
    {"joint", "pose", Use::used, false, kPoseAttributes},
    {"joint", "axis"},
    {"joint", "axis2", Use::refused, false, "", "", "use two joints with a link between them"},
    {"joint", "gearbox_ratio", Use::noted},
    {"joint", "gearbox_reference_body", Use::noted},
    {"joint", "physics", Use::noted},
    {"joint", "screw_thread_pitch", Use::noted},
    {"joint", "sensor", Use::noted, true},
    {"joint", "thread_pitch", Use::noted},
    {"axis", "xyz", Use::used, false, "expressed_in"},
    {"axis", "use_parent_model_frame"},  // until SDF 1.6
    {"axis", "dynamics"},
    {"axis", "limit"},
    {"axis", "mimic", Use::refused, false, "", "", "make the joint fixed"},
    {"dynamics", "damping"},
    {"dynamics", "friction"},
    {"dynamics", "spring_reference", Use::noted},
    {"dynamics", "spring_stiffness", Use::refused, false, "", "", "remove the spring", "0"},
    {"limit", "lower"},
    {"limit", "upper"},
    {"limit", "dissipation", Use::noted},
    {"limit", "effort", Use::noted},
    {"limit", "stiffness", Use::noted},
    {"limit", "velocity", Use::noted},
};

// Returns the entry of the element `name` in `parent`, or null.
constexpr const SdfElement* sdf_element(std::string_view parent, std::string_view name) {
  for (const SdfElement& element : kSdfElements) {
    if (element.name == name && element.parent == parent) return &element;
  }
  return nullptr;
}

// Returns the name of an element, or "parent/name" where the name has several meanings.
inline std::string sdf_context(const std::string& parent, const std::string& name) {
  return name == "ode" || parent == "dynamics" ? parent + "/" + name : name;
}

// Returns whether an element may have child elements.
constexpr bool has_elements(std::string_view context) {
  for (const SdfElement& element : kSdfElements) {
    if (element.parent == context) return true;
  }
  return false;
}

}  // namespace kaz::sim
