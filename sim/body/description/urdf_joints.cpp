// Checks of a URDF's joints together: <mimic>, and the names of Kaz's joints.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/urdf_joints.h"

#include <cmath>
#include <optional>

#include "sim/body/description/joint_names.h"

namespace kaz::sim {
namespace {

using JointsByName = std::map<std::string, const tinyxml2::XMLElement*>;

const tinyxml2::XMLElement* mimic_of(const tinyxml2::XMLElement& joint) {
  return joint.FirstChildElement("mimic");
}

bool ratio_in_range(double ratio) {
  return std::abs(ratio) >= kSmallestRatio && std::abs(ratio) <= kLargestRatio;
}

// The error of one <mimic>, without the rest of its chain.
std::optional<std::string> mimic_error(const Urdf& urdf, const JointsByName& joints,
                                       const tinyxml2::XMLElement& joint) {
  const std::string name = joint.Attribute("name");
  const tinyxml2::XMLElement& mimic = *mimic_of(joint);
  if (joint.Attribute("type", "fixed") != nullptr)
    return "joint `" + name + "` is fixed but has <mimic>; remove <mimic>";
  const char* leader = mimic.Attribute("joint");
  if (leader == nullptr) return "<mimic> lacks the attribute `joint`";
  const auto found = joints.find(leader);
  if (found == joints.end())
    return "joint `" + name + "` follows joint `" + leader +
           "`, which does not exist; check the spelling";
  if (!urdf.moves(*found->second))
    return "joint `" + name + "` follows joint `" + leader +
           "`, which does not move; name a joint that is not fixed";
  if (!ratio_in_range(number_of(mimic, "multiplier", 1)))
    return "multiplier of joint `" + name + "` is " + mimic.Attribute("multiplier") +
           "; its magnitude must be 0.001 to 1000";
  return std::nullopt;
}

}  // namespace

void resolve_mimics(Urdf& urdf, const UrdfRemark& object) {
  JointsByName joints, followers;
  for (const auto* joint : urdf.joints) joints.emplace(joint->Attribute("name"), joint);
  bool sound = true;
  for (const auto& [name, joint] : joints) {
    if (mimic_of(*joint) == nullptr) continue;
    followers.emplace(name, joint);
    const auto error = mimic_error(urdf, joints, *joint);
    if (error) object(*mimic_of(*joint), *error);
    sound = sound && !error;
  }
  if (!sound) return;  // a chain may lead to a wrong <mimic>
  for (const auto& [name, joint] : followers) {
    Mimic chain;
    std::size_t steps = 0;
    for (const auto* at = joint; mimic_of(*at) != nullptr && steps <= followers.size(); ++steps) {
      chain.offset += chain.ratio * number_of(*mimic_of(*at), "offset", 0);
      chain.ratio *= number_of(*mimic_of(*at), "multiplier", 1);
      chain.joint = mimic_of(*at)->Attribute("joint");
      at = joints.at(chain.joint);
    }
    if (steps > followers.size())
      object(*mimic_of(*joint), "joint `" + name +
                                    "` follows itself through <mimic>; one joint of the cycle "
                                    "needs a motor");
    else if (!ratio_in_range(chain.ratio))
      object(*mimic_of(*joint), "the product of the multipliers from joint `" + name +
                                    "` to joint `" + chain.joint +
                                    "` is out of range; its magnitude must be 0.001 to 1000");
    urdf.mimics[name] = chain;
  }
}

void check_joint_names(const Urdf& urdf, const UrdfRemark& object) {
  std::vector<const tinyxml2::XMLElement*> driven;
  std::vector<std::string> names;
  for (const auto* joint : urdf.joints) {
    if (!urdf.has_motor(*joint)) continue;
    driven.push_back(joint);
    names.emplace_back(joint->Attribute("name"));
  }
  // Followers alone form a cycle, which resolve_mimics() has reported.
  if (names.empty() && !urdf.mimics.empty()) return;
  for (const JointNameError& error : joint_name_errors(names))
    object(error.joint < 0 ? urdf.file.root() : *driven[static_cast<std::size_t>(error.joint)],
           error.text);
}

}  // namespace kaz::sim
