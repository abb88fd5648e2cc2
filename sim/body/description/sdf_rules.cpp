// Rules for models, inertias, joints, friction and lights of SDF.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_rules.h"

#include <algorithm>
#include <string>

#include <Eigen/Geometry>

#include "sim/body/description/rigid_link.h"
#include "sim/body/description/sdf_values.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using SdfNode = tinyxml2::XMLElement;

// Required children. Without the sizes, SDF has defaults, such as a sphere of 1 m.
struct NeededChild {
  const char* parent;
  const char* child;
  bool has_default = false;
};
constexpr NeededChild kNeededChildren[] = {
    {"box", "size", true},        {"capsule", "length", true},
    {"capsule", "radius", true},  {"cylinder", "length", true},
    {"cylinder", "radius", true}, {"plane", "size", true},
    {"sphere", "radius", true},   {"mesh", "uri"},
    {"include", "uri"},           {"joint", "parent"},
    {"joint", "child"},
};
constexpr const char* kNamed[] = {"world",     "model", "link", "visual",
                                  "collision", "frame", "joint"};
constexpr double kLargestLimit = 1e16;  // rad or m; larger limits are infinite
constexpr const char* kJointTypes[] = {"ball", "continuous", "fixed", "prismatic", "revolute"};

std::string name_of(const SdfNode& e) {
  const char* name = e.Attribute("name");
  return name == nullptr ? "" : name;
}

bool is_listed(const auto& list, const std::string& name) {
  return std::ranges::find(list, name) != std::end(list);
}

// Tensor with SDF's defaults, or nullopt if a moment is no number.
std::optional<Eigen::Matrix3d> tensor_in(const SdfNode& inertia, const SdfReport& report) {
  bool sound = true;
  const auto of = [&](const char* moment, double otherwise) {
    const SdfNode* e = inertia.FirstChildElement(moment);
    sound = sound && (e == nullptr || report.sound(*e));
    return e ? e->DoubleText() : otherwise;
  };
  Eigen::Matrix3d tensor;
  tensor << of("ixx", 1), of("ixy", 0), of("ixz", 0),  //
      of("ixy", 0), of("iyy", 1), of("iyz", 0),        //
      of("ixz", 0), of("iyz", 0), of("izz", 1);
  return sound ? std::optional(tensor) : std::nullopt;
}

void check_inertial(const SdfNode& link, SdfReport& report) {
  const SdfNode* inertial = link.FirstChildElement("inertial");
  if (inertial == nullptr)
    return report.note_default(
        link, "link `" + name_of(link) + "` has no <inertial>: 1 kg by SDF's default");
  const char* automatic = inertial->Attribute("auto");
  if (automatic != nullptr && !same_value(automatic, "false"))
    return report.object(
        *inertial, "attribute `auto` of <inertial> is not supported; give <mass> and <inertia>");
  if (!report.sound(*inertial)) return;
  const SdfNode* mass = inertial->FirstChildElement("mass");
  const SdfNode* inertia = inertial->FirstChildElement("inertia");
  if (inertia != nullptr && mass == nullptr)
    return report.object(*inertial, "<inertial> lacks <mass>");
  if (inertia == nullptr)
    report.note_default(*inertial,
                        "<inertial> of link `" + name_of(link) + "` has no " +
                            (mass == nullptr ? "<mass>: 1 kg and 1 kg m2" : "<inertia>: 1 kg m2") +
                            " by SDF's default");
  if (mass == nullptr) return;
  const auto tensor = inertia == nullptr ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                         : tensor_in(*inertia, report);
  if (!tensor || !report.sound(*mass)) return;
  const double kilograms = mass->DoubleText();
  if (kilograms > 0 && kilograms < kMinSdfMass)
    return report.object(*mass, std::string("a mass of ") + mass->GetText() +
                                    " kg; a movable body must have 1e-9 to 10000 kg");
  if (!physical(kilograms, *tensor))
    report.object(inertia == nullptr ? *mass : *inertia,
                  "impossible mass or inertia: mass and principal moments must be above 0, and no "
                  "principal moment may exceed the sum of the other two");
}

// Kaz ignores contacts between links that joints connect, as SDF does by default.
void check_self_collide(const SdfNode& e, SdfReport& report) {
  if (truth_of(e, "self_collide").value_or(false))
    report.object(*e.FirstChildElement("self_collide"),
                  "<self_collide> of true is not supported in a model with joints, whose links do "
                  "not collide with each other; remove it");
}

}  // namespace

void check_needs(const SdfNode& e, SdfReport& report) {
  const std::string name = e.Name(), tag = "<" + name + ">";
  if (is_listed(kNamed, name) && e.Attribute("name") == nullptr)
    report.spoil(e, tag + " lacks the attribute `name`");
  for (const NeededChild& needed : kNeededChildren) {
    if (name != needed.parent || e.FirstChildElement(needed.child) != nullptr) continue;
    const std::string child = std::string("<") + needed.child + ">";
    if (needed.has_default)
      report.note_default(e, tag + " has no " + child + ": SDF's default");
    else
      report.spoil(e, tag + " lacks " + child);
  }
}

void check_no_text(const SdfNode& e, SdfReport& report) {
  for (const tinyxml2::XMLNode* node = e.FirstChild(); node != nullptr;
       node = node->NextSibling()) {
    if (node->ToText() != nullptr)
      report.object(
          e, node->GetLineNum(),
          std::string("text in <") + e.Name() + ">, which accepts only elements; remove the text");
  }
}

void check_model(const SdfNode& model, bool fixed, SdfReport& report) {
  const SdfNode* kick = model.FirstChildElement("kaz:kick");
  if (fixed && kick != nullptr)
    report.object(*kick, "model `" + name_of(model) + "` is static, so <kaz:kick> cannot move it");
  if (fixed) return;
  const bool has_joints = model.FirstChildElement("joint") != nullptr;
  if (has_joints) check_self_collide(model, report);
  for (const SdfNode* link = model.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    check_inertial(*link, report);
    if (has_joints) check_self_collide(*link, report);
    for (const SdfNode* c = link->FirstChildElement("collision"); c != nullptr;
         c = c->NextSiblingElement("collision")) {
      const SdfNode* geometry = c->FirstChildElement("geometry");
      if (geometry != nullptr && geometry->FirstChildElement("plane") != nullptr)
        report.object(*geometry, "a plane collides only as part of a static model");
    }
  }
}

void check_friction(const SdfNode& ode, SdfReport& report) {
  const SdfNode *mu = ode.FirstChildElement("mu"), *mu2 = ode.FirstChildElement("mu2");
  if (mu2 == nullptr || !report.sound(*mu2) || (mu != nullptr && !report.sound(*mu))) return;
  // Gazebo's floor has 100 and 50: nothing slips on it in any direction.
  constexpr double kNeverSlips = 10;
  const double first = mu == nullptr ? 1 : mu->DoubleText(), second = mu2->DoubleText();
  if (first == second || std::min(first, second) >= kNeverSlips) return;
  report.object(*mu2, "<mu2> of " + trimmed_text(*mu2) +
                          " differs from <mu>; Kaz has one friction coefficient for all "
                          "directions: make them equal");
}

void check_joint(const SdfNode& joint, SdfReport& report) {
  const char* type = joint.Attribute("type");
  if (type == nullptr || !is_listed(kJointTypes, type))
    report.object(joint, "joint `" + name_of(joint) + "` has type \"" + (type ? type : "") +
                             "\"; the supported types are ball, continuous, fixed, prismatic and "
                             "revolute");
  const SdfNode* axis = joint.FirstChildElement("axis");
  const SdfNode* limit = axis == nullptr ? nullptr : axis->FirstChildElement("limit");
  const SdfNode* lower = limit == nullptr ? nullptr : limit->FirstChildElement("lower");
  const SdfNode* upper = limit == nullptr ? nullptr : limit->FirstChildElement("upper");
  if (lower == nullptr || upper == nullptr) return;
  const auto low = joint_limit(trimmed_text(*lower)), high = joint_limit(trimmed_text(*upper));
  if (!low || !high) return;
  if (*low > *high || *low > kLargestLimit || *high < -kLargestLimit)
    report.object(*lower, "lower limit of joint `" + name_of(joint) +
                              "` is above the upper limit; exchange them");
}

std::optional<Eigen::Vector3d> direction_to_lamp(const SdfNode& light) {
  const SdfNode *direction = light.FirstChildElement("direction"),
                *pose = light.FirstChildElement("pose");
  if (!light.Attribute("type", "directional")) return std::nullopt;
  const auto along = parse_numbers(direction == nullptr ? "0 0 -1" : trimmed_text(*direction), 3);
  const auto turn = parse_numbers(pose == nullptr ? "0 0 0 0 0 0" : trimmed_text(*pose), 6);
  const char* frame = pose == nullptr ? nullptr : pose->Attribute("relative_to");
  if (!along || !turn || (frame != nullptr && *frame != '\0')) return std::nullopt;
  const auto about = [&](std::size_t i, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd((*turn)[i], axis);
  };
  const Eigen::Vector3d to = about(5, Eigen::Vector3d::UnitZ()) *
                             (about(4, Eigen::Vector3d::UnitY()) *
                              (about(3, Eigen::Vector3d::UnitX()) *
                               Eigen::Vector3d(-(*along)[0], -(*along)[1], -(*along)[2])));
  if (!to.allFinite() || !(to.z() > 0.05 * to.norm())) return std::nullopt;
  return to;
}

}  // namespace kaz::sim
