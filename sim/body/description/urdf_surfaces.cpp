// Reads the friction of a URDF's links.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/urdf_surfaces.h"

#include <algorithm>
#include <optional>

namespace kaz::sim {
namespace {

using SurfaceElement = tinyxml2::XMLElement;

// Coefficients from here on hold at any slope that a robot meets. Gazebo's floor has 100 and 50.
constexpr double kNeverSlips = 10;

void read_gazebo(Urdf& urdf, const char* link, const SurfaceElement& gazebo, const UrdfRemark& object) {
  std::optional<double> mu;
  for (const char* name : {"mu1", "mu2"}) {
    const SurfaceElement* e = gazebo.FirstChildElement(name);
    if (e == nullptr) continue;
    const auto value = coefficient_in(*e);
    const double least = value && mu ? std::min(*value, *mu) : kNeverSlips;
    if (!value || (mu && *mu != *value && least < kNeverSlips))
      return object(*e, std::string("<") + name +
                            "> must contain one number not below 0; mu1 and mu2 must be equal");
    mu = mu ? std::min(*mu, *value) : *value;
  }
  if (mu) urdf.friction[link] = *mu;
}

}  // namespace

void read_surfaces(Urdf& urdf, bool body, const UrdfRemark& object, const UrdfRemark& note) {
  for (const auto& [name, link] : urdf.links) {
    const SurfaceElement* contact = link->FirstChildElement("contact");
    if (contact == nullptr || !body) continue;
    for (const char* kind : {"lateral_friction", "inertia_scaling"}) {
      const SurfaceElement* e = contact->FirstChildElement(kind);
      const auto value = e == nullptr ? std::nullopt : coefficient_in(*e);
      if (value)
        (kind == std::string("lateral_friction") ? urdf.friction : urdf.inertia_scales)[name] = *value;
      else if (e != nullptr)
        object(*e, std::string("<") + kind + "> must have a `value` not below 0");
    }
  }
  const SurfaceElement& root = urdf.file.root();
  for (auto* e = root.FirstChildElement("gazebo"); e; e = e->NextSiblingElement("gazebo")) {
    const SurfaceElement *mu1 = e->FirstChildElement("mu1"), *mu2 = e->FirstChildElement("mu2");
    for (auto* child = e->FirstChildElement(); child; child = child->NextSiblingElement())
      if (child != mu1 && child != mu2) note(*child, std::string("<gazebo><") + child->Name() + ">");
    if ((mu1 == nullptr && mu2 == nullptr) || !body) continue;
    const char* link = e->Attribute("reference");
    if (link == nullptr || !urdf.links.contains(link))
      object(*e, "<gazebo> refers to link `" + std::string(link == nullptr ? "" : link) +
                     "`, which does not exist");
    else
      read_gazebo(urdf, link, *e, object);
  }
}

}  // namespace kaz::sim
