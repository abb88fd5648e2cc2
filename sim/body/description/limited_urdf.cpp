// Writes a URDF with other joint limits.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/limited_urdf.h"

#include <string_view>

#include <tinyxml2.h>

#include "sim/body/description/urdf_writer.h"

namespace kaz::sim {
namespace {

tinyxml2::XMLElement* joint_named(tinyxml2::XMLElement& robot, std::string_view name) {
  for (tinyxml2::XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const char* const given = joint->Attribute("name");
    if (given != nullptr && given == name) return joint;
  }
  return nullptr;
}

void set_limits(tinyxml2::XMLElement& joint, const JointRange& range) {
  tinyxml2::XMLElement* limit = joint.FirstChildElement("limit");
  if (range.lower >= range.upper) {
    joint.SetAttribute("type", "fixed");
    for (const char* moving : {"axis", "limit", "dynamics", "mimic", "safety_controller"})
      while (tinyxml2::XMLElement* child = joint.FirstChildElement(moving))
        joint.DeleteChild(child);
    return;
  }
  if (joint.Attribute("type", "prismatic") == nullptr) joint.SetAttribute("type", "revolute");
  if (limit == nullptr) limit = joint.InsertNewChildElement("limit");
  limit->SetAttribute("lower", range.lower);
  limit->SetAttribute("upper", range.upper);
}

}  // namespace

Result<std::string> urdf_with_limits(const std::string& path,
                                     const std::vector<JointRange>& ranges) {
  tinyxml2::XMLDocument copy;
  const std::string urdf = KAZ_TRY(robot_urdf(path));
  if (copy.Parse(urdf.c_str(), urdf.size()) != tinyxml2::XML_SUCCESS || !copy.RootElement())
    return fail(Fault::usage, path + ": is not well-formed XML");
  for (const JointRange& range : ranges) {
    tinyxml2::XMLElement* const joint = joint_named(*copy.RootElement(), range.joint);
    if (joint == nullptr)
      return fail(Fault::usage, path + ": has no joint `" + range.joint + "` to give limits to");
    set_limits(*joint, range);
  }
  tinyxml2::XMLPrinter text;
  copy.Print(&text);
  return std::string(text.CStr());
}

}  // namespace kaz::sim
