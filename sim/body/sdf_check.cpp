// Finds elements of a world file that this simulator does not take, so that none is ignored in
// silence. SPDX-License-Identifier: Apache-2.0
#include "sim/body/sdf_check.h"

#include <map>
#include <set>

#include "sim/body/xml_file.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

// By parent; `ode` stands twice in SDF, so its parent's name is part of the key.
const std::map<std::string, std::set<std::string>> kChildren{
    {"sdf", {"world"}},
    {"world", {"gravity", "model", "kaz:robot"}},
    {"model", {"static", "pose", "link", "kaz:kick"}},
    {"link", {"pose", "inertial", "visual", "collision"}},
    {"inertial", {"mass", "pose", "inertia"}},
    {"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}},
    {"visual", {"pose", "geometry", "material", "kaz:texture"}},
    {"collision", {"pose", "geometry", "surface"}},
    {"geometry", {"box", "capsule", "cylinder", "plane", "sphere"}},
    {"box", {"size"}},
    {"capsule", {"radius", "length"}},
    {"cylinder", {"radius", "length"}},
    {"plane", {"normal", "size"}},
    {"sphere", {"radius"}},
    {"material", {"ambient", "diffuse", "specular"}},
    {"surface", {"friction", "bounce", "contact", "kaz:rolling_resistance"}},
    {"friction", {"ode"}},
    {"friction/ode", {"mu"}},
    {"bounce", {"restitution_coefficient", "threshold"}},
    {"contact", {"ode"}},
    {"contact/ode", {"soft_cfm"}},
};

Result<void> check(const XmlFile& file, const Element& parent, const std::string& key) {
  const auto allowed = kChildren.find(key);
  for (const Element* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string name = e->Name();
    if (allowed == kChildren.end() || !allowed->second.count(name)) {
      std::string known;
      if (allowed != kChildren.end()) {
        for (const std::string& k : allowed->second) {
          if (!known.empty()) known += ", ";
          known += k;
        }
      }
      return file.error(*e, "unknown element <" + name + "> in <" + parent.Name() +
                                ">, which takes " + (known.empty() ? "none" : known));
    }
    if (e->Attribute("relative_to") != nullptr) {
      return file.error(*e, "`relative_to` is not taken; give the pose in the parent's frame");
    }
    if (auto ok = check(file, *e, name == "ode" ? key + "/ode" : name); !ok) return ok;
  }
  return {};
}

// SDF gives a link without <inertial> a mass of 1 kg: no ball is meant to weigh that.
Result<void> check_inertials(const XmlFile& file) {
  const Element* world = file.root().FirstChildElement("world");
  if (world == nullptr) return file.error(file.root(), "<sdf> has no <world>");
  for (auto* model = world->FirstChildElement("model"); model;
       model = model->NextSiblingElement("model")) {
    const Element* fixed = model->FirstChildElement("static");
    if (fixed != nullptr && fixed->BoolText(false)) continue;
    for (auto* link = model->FirstChildElement("link"); link;
         link = link->NextSiblingElement("link")) {
      const Element* inertial = link->FirstChildElement("inertial");
      if (inertial == nullptr) {
        return file.error(*link,
                          "a link that can move lacks <inertial>; add it, or make the model "
                          "<static>true</static>");
      }
      if (!inertial->FirstChildElement("mass") || !inertial->FirstChildElement("inertia")) {
        return file.error(*inertial, "<inertial> needs <mass> and <inertia>");
      }
    }
  }
  return {};
}

}  // namespace

Result<void> check_sdf(const std::string& path) {
  const Result<XmlFile> file = XmlFile::load(path, "sdf");
  if (!file) return tl::unexpected(file.error());
  if (auto ok = check(*file, file->root(), "sdf"); !ok) return ok;
  return check_inertials(*file);
}

}  // namespace kaz::sim
