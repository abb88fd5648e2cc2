// Validates a URDF before the parser reads it, which reports no line numbers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/urdf_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

// Allowed elements of a robot file, by parent. Those with an empty entry are leaves, or their children are
// not checked.
const std::map<std::string, std::set<std::string>> kChildren{
    {"robot", {"link", "joint", "material", "transmission", "gazebo"}},
    {"link", {"inertial", "visual", "collision"}},
    {"inertial", {"origin", "mass", "inertia"}},
    {"visual", {"origin", "geometry", "material"}},
    {"collision", {"origin", "geometry"}},
    {"geometry", {"box", "cylinder", "sphere", "mesh"}},
    {"material", {"color"}},
    {"joint", {"parent", "child", "origin", "axis", "limit"}},
};

// All others stand once where they stand.
const std::set<std::string> kRepeated{"link",      "joint",  "material", "transmission",
                                      "collision", "gazebo", "visual"};

struct VectorAttribute {
  const char* element;
  const char* attribute;
  std::size_t count;
  bool needed;
};
constexpr VectorAttribute kVectors[] = {
    {"origin", "xyz", 3, false}, {"origin", "rpy", 3, false}, {"axis", "xyz", 3, true},
    {"box", "size", 3, true},    {"color", "rgba", 4, true},  {"mesh", "scale", 3, false},
};
struct NumberAttribute {
  const char* element;
  const char* attribute;
};
constexpr NumberAttribute kNumbers[] = {
    {"cylinder", "radius"}, {"cylinder", "length"}, {"sphere", "radius"}, {"mass", "value"},
    {"inertia", "ixx"},     {"inertia", "iyy"},     {"inertia", "izz"},   {"inertia", "ixy"},
    {"inertia", "ixz"},     {"inertia", "iyz"},     {"limit", "lower"},   {"limit", "upper"},
    {"limit", "effort"},    {"limit", "velocity"},
};

// Bounds against wrong units, such as millimetres for metres.
constexpr double kLargest = 10;    // m
constexpr double kHeaviest = 100;  // kg
constexpr double kLightest = 1e-9;
constexpr double kLargestTurn = 100;      // rad
constexpr double kLargestMoment = 10000;  // kg m^2: the heaviest at the largest distance
// Maximum depth: the tree is traversed recursively here, in the parser and in the dynamics.
constexpr std::size_t kMaxLinks = 500;

class Check {
 public:
  explicit Check(const XmlFile& file) : file_(file) {}

  Result<void> run() {
    if (auto ok = elements(file_.root()); !ok) return ok;
    if (auto ok = collect(); !ok) return ok;
    for (const Element* joint : joints_) {
      if (auto ok = check_joint(*joint); !ok) return ok;
    }
    if (auto ok = check_tree(); !ok) return ok;
    for (const auto& [name, link] : links_) {
      if (auto ok = check_link(name, *link); !ok) return ok;
    }
    if (auto ok = surfaces(); !ok) return ok;
    return check_table();
  }

  UrdfFacts facts() const {
    UrdfFacts facts;
    for (const Element* joint : joints_) {
      if (is_revolute(*joint)) facts.revolute.emplace_back(joint->Attribute("name"));
    }
    facts.friction = friction_;
    facts.text = file_.text();
    return facts;
  }

 private:
  Result<void> elements(const Element& parent) {
    const std::string name = parent.Name();
    KAZ_TRY(file_.check_name(parent));
    if (auto ok = numbers(parent); !ok) return ok;
    if (auto ok = sizes(parent); !ok) return ok;
    const auto allowed = kChildren.find(name);
    if (allowed == kChildren.end()) return {};
    for (const Element* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (name == "joint" && std::string(e->Name()) == "mimic") return mimic(*e);
      if (!allowed->second.count(e->Name())) {
        return file_.error(*e, std::string("unknown element <") + e->Name() + "> in <" + name +
                                   ">; docs/reference/robot.md lists the supported elements");
      }
      if (const Element* again = e->NextSiblingElement(e->Name());
          again != nullptr && !kRepeated.count(e->Name())) {
        return file_.error(
            *again, std::string("<") + e->Name() + "> occurs twice in <" + name + ">; remove one");
      }
      if (auto ok = elements(*e); !ok) return ok;
    }
    return {};
  }

  Result<void> numbers(const Element& e) {
    const std::string name = e.Name();
    for (const VectorAttribute& v : kVectors) {
      if (name != v.element) continue;
      const char* text = e.Attribute(v.attribute);
      if (text == nullptr && !v.needed) continue;
      if (text == nullptr || !parse_numbers(text, v.count)) {
        return file_.error(e, std::string("attribute `") + v.attribute + "` of <" + name +
                                  "> must be " + std::to_string(v.count) + " numbers");
      }
    }
    for (const NumberAttribute& n : kNumbers) {
      if (name != n.element) continue;
      KAZ_TRY(file_.number(e, n.attribute));
    }
    return {};
  }

  // After numbers(): all of them are there.
  Result<void> sizes(const Element& e) {
    const std::string name = e.Name();
    std::vector<double> lengths;
    if (name == "box") lengths = *parse_numbers(e.Attribute("size"), 3);
    if (name == "cylinder" || name == "sphere") lengths.push_back(e.DoubleAttribute("radius"));
    if (name == "cylinder") lengths.push_back(e.DoubleAttribute("length"));
    for (const double length : lengths) {
      if (length > 0 && length <= kLargest) continue;
      return file_.error(e, "<" + name + "> has a size of " + format(length) +
                                " m; sizes are above 0 and at most 10 m");
    }
    if (name == "origin" && e.Attribute("xyz") != nullptr) {
      const std::vector<double> places = *parse_numbers(e.Attribute("xyz"), 3);
      for (const double place : places) {
        if (std::abs(place) > kLargest)
          return file_.error(e, "<origin> lies " + format(place) + " m away; the maximum is 10 m");
      }
    }
    if (name == "origin" && e.Attribute("rpy") != nullptr) {
      const std::vector<double> angles = *parse_numbers(e.Attribute("rpy"), 3);
      for (const double angle : angles) {
        if (std::abs(angle) > kLargestTurn)
          return file_.error(e, "<origin> is turned by " + format(angle) +
                                    " rad; angles are from -100 to 100 rad");
      }
    }
    if (name == "inertia") {
      for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
        if (std::abs(e.DoubleAttribute(moment)) > kLargestMoment)
          return file_.error(e, std::string("<inertia> has ") + moment + " of " +
                                    format(e.DoubleAttribute(moment)) +
                                    " kg m2; moments are from -10000 to 10000 kg m2");
      }
    }
    if (const double value = name == "mass" ? e.DoubleAttribute("value") : 0;
        value > 0 && value < kLightest)
      return file_.error(e, "a mass of " + format(value) + " kg; masses are from 1e-9 to 100 kg");
    if (name == "mass" && e.DoubleAttribute("value") > kHeaviest) {
      return file_.error(
          e, "a mass of " + format(e.DoubleAttribute("value")) + " kg; the maximum is 100 kg");
    }
    return name == "mesh" ? mesh(e) : Result<void>();
  }

  Result<void> mesh(const Element& e) {
    const auto name = KAZ_TRY(file_.attribute(e, "filename"));
    const auto path = mesh_path(file_.path(), name);
    const auto error = path ? mesh_error(*path) : path.error().message;
    if (error) return file_.error(e, "mesh `" + name + "` " + *error);
    return {};
  }

  static std::string format(double value) {
    std::string text(32, ' ');
    text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%g", value)));
    return text;
  }

  // Friction of a link: <gazebo reference="link"><mu1>, as Gazebo reads it; the same in all directions.
  Result<void> surfaces() {
    for (auto* e = file_.root().FirstChildElement("gazebo"); e;
         e = e->NextSiblingElement("gazebo")) {
      const Element *mu1 = e->FirstChildElement("mu1"), *mu2 = e->FirstChildElement("mu2");
      if (mu1 == nullptr && mu2 == nullptr) continue;
      const auto link = KAZ_TRY(file_.attribute(*e, "reference"));
      if (!links_.count(link))
        return file_.error(*e, "<gazebo> refers to link `" + link + "`, which does not exist");
      double mu = -1;
      for (const Element* element : {mu1, mu2}) {
        if (element == nullptr) continue;
        const auto value = parse_numbers(element->GetText() ? element->GetText() : "", 1);
        if (!value || value->front() < 0 || (mu >= 0 && value->front() != mu))
          return file_.error(
              *element, std::string("<") + element->Name() +
                            "> must contain one number not below 0; mu1 and mu2 must be equal");
        mu = value->front();
      }
      friction_[link] = mu;
    }
    return {};
  }

  Result<void> mimic(const Element& e) {
    const auto target = KAZ_TRY(file_.attribute(e, "joint"));
    for (auto* j = file_.root().FirstChildElement("joint"); j; j = j->NextSiblingElement("joint")) {
      const char* name = j->Attribute("name");
      if (name != nullptr && target == name) {
        return file_.error(
            e, "<mimic> is not supported: each joint has its own motor; remove <mimic>");
      }
    }
    return file_.error(e, "<mimic> refers to joint `" + target + "`, which does not exist");
  }

  Result<void> collect() {
    for (auto* e = file_.root().FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind != "link" && kind != "joint") continue;
      const auto name = KAZ_TRY(file_.attribute(*e, "name"));
      if (kind == "joint") {
        if (!joint_by_name_.emplace(name, e).second) {
          return file_.error(*e, "joint `" + name + "` is already defined above; rename it");
        }
        joints_.push_back(e);
      } else if (!links_.emplace(name, e).second) {
        return file_.error(*e, "link `" + name + "` is already defined above; rename it");
      }
    }
    if (links_.empty()) return file_.error(file_.root(), "<robot> has no <link>");
    if (links_.size() > kMaxLinks)
      return file_.error(file_.root(),
                         "<robot> has more than " + std::to_string(kMaxLinks) + " links");
    return {};
  }

  Result<std::string> end_of(const Element& joint, const char* which) {
    const Element* e = joint.FirstChildElement(which);
    const std::string name = joint.Attribute("name");
    if (e == nullptr) return file_.error(joint, "joint `" + name + "` lacks <" + which + ">");
    auto link = file_.attribute(*e, "link");
    if (link && !links_.count(*link)) {
      return file_.error(*e, std::string(which) + " link `" + *link + "` of joint `" + name +
                                 "` does not exist; check the spelling");
    }
    return link;
  }

  Result<void> check_joint(const Element& joint) {
    const std::string name = joint.Attribute("name");
    const auto type = KAZ_TRY(file_.attribute(joint, "type"));
    if (type != "revolute" && type != "fixed") {
      return file_.error(joint, "joint `" + name + "` has type \"" + type +
                                    "\"; only revolute and fixed joints are supported");
    }
    const auto parent = KAZ_TRY(end_of(joint, "parent"));
    const auto child = KAZ_TRY(end_of(joint, "child"));
    if (const auto [it, fresh] = joint_to_.emplace(child, &joint); !fresh) {
      return file_.error(joint, "link `" + child + "` is already the child of joint `" +
                                    it->second->Attribute("name") + "`");
    }
    parent_of_[child] = parent;
    if (type == "fixed") return {};

    const Element* limit = joint.FirstChildElement("limit");
    if (limit == nullptr) return file_.error(joint, "joint `" + name + "` lacks <limit>");
    if (!(limit->DoubleAttribute("lower") < limit->DoubleAttribute("upper"))) {
      return file_.error(*limit, "lower limit of joint `" + name + "` is not below the upper one");
    }
    // The mechanical stop is one degree beyond the limit, and must be within half a turn.
    constexpr double kLargestLimit = 3.1;
    for (const char* side : {"lower", "upper"}) {
      if (std::abs(limit->DoubleAttribute(side)) > kLargestLimit)
        return file_.error(*limit, std::string(side) + " limit of joint `" + name + "` is " +
                                       limit->Attribute(side) +
                                       " rad: its stop, 1 degree farther, must be within half a "
                                       "turn; give -3.1 to 3.1 rad");
    }
    if (const Element* axis = joint.FirstChildElement("axis")) {
      const auto xyz = parse_numbers(axis->Attribute("xyz"), 3);
      if ((*xyz)[0] == 0 && (*xyz)[1] == 0 && (*xyz)[2] == 0) {
        return file_.error(*axis, "axis of joint `" + name + "` is zero");
      }
    }
    return {};
  }

  Result<void> check_tree() {
    std::string root;
    for (const auto& [name, link] : links_) {
      if (parent_of_.count(name)) continue;
      if (!root.empty()) {
        return file_.error(*link, "links `" + root + "` and `" + name +
                                      "` are both without a parent joint; a robot has one root");
      }
      root = name;
    }
    for (const auto& [name, link] : links_) {
      std::string at = name;
      for (std::size_t steps = 0; parent_of_.count(at); ++steps) {
        if (steps > links_.size()) {
          // `at` is on the loop. The error names the loop's first joint in the file.
          const Element* first = joint_to_.at(at);
          for (std::size_t i = 0; i < steps; ++i, at = parent_of_.at(at)) {
            if (joint_to_.at(at)->GetLineNum() < first->GetLineNum()) first = joint_to_.at(at);
          }
          return file_.error(*first, std::string("joint `") + first->Attribute("name") +
                                         "` closes a loop; links must form a tree");
        }
        at = parent_of_.at(at);
      }
    }
    return {};
  }

  Result<void> check_link(const std::string& name, const Element& link) {
    const auto joint = joint_to_.find(name);
    const bool welded =
        joint != joint_to_.end() && std::string(joint->second->Attribute("type")) == "fixed";
    const Element* inertial = link.FirstChildElement("inertial");
    if (inertial == nullptr) {
      const bool anchored = joint == joint_to_.end() && name == kFixedRoot;
      if (welded || anchored) return {};
      return file_.error(link, "link `" + name + "` moves but has no <inertial>");
    }
    const Element* mass = inertial->FirstChildElement("mass");
    const Element* inertia = inertial->FirstChildElement("inertia");
    if (mass == nullptr || inertia == nullptr) {
      return file_.error(*inertial, "<inertial> of link `" + name + "` needs <mass> and <inertia>");
    }
    const auto of = [&](const char* a) { return inertia->DoubleAttribute(a); };
    if (!(mass->DoubleAttribute("value") > 0)) {
      return file_.error(*mass, "mass of link `" + name + "` is not above zero");
    }
    Eigen::Matrix3d tensor;
    tensor << of("ixx"), of("ixy"), of("ixz"),  //
        of("ixy"), of("iyy"), of("iyz"),        //
        of("ixz"), of("iyz"), of("izz");
    if (!physical(mass->DoubleAttribute("value"), tensor)) {
      return file_.error(*inertia, "the inertia of link `" + name +
                                       "` is impossible: its principal moments must be above 0, "
                                       "and none of them may exceed the sum of the other two");
    }
    return {};
  }

  // A robot with any joint of Kaz's table is a Kaz: it must have all of them and no others.
  Result<void> check_table() {
    const std::set<std::string> table(joint_names().begin(), joint_names().end());
    const auto of_kaz = [&](const Element* joint) {
      return is_revolute(*joint) && table.count(joint->Attribute("name")) > 0;
    };
    const auto shared = std::find_if(joints_.begin(), joints_.end(), of_kaz);
    if (shared == joints_.end()) return some_joint();
    for (const std::string& name : joint_names()) {
      const auto joint = joint_by_name_.find(name);
      if (joint == joint_by_name_.end()) {
        return file_.error(file_.root(), missing_joint(name, (*shared)->Attribute("name")));
      }
      if (std::string(joint->second->Attribute("type")) != "revolute") {
        return file_.error(*joint->second, "joint `" + name + "` has a motor and must be revolute");
      }
    }
    for (const Element* joint : joints_) {
      const std::string name = joint->Attribute("name");
      if (is_revolute(*joint) && !table.count(name)) {
        return file_.error(*joint,
                           "joint `" + name +
                               "` is not a joint of the servo board (shared/board/joints.def): "
                               "correct the joint's name, or make the joint fixed");
      }
    }
    return {};
  }

  // Whoever describes another robot does not look for a joint of Kaz: what made it one is named, too.
  static std::string missing_joint(const std::string& name, const std::string& shared) {
    return "robot has no joint `" + name + "`, but has the joint `" + shared +
           "` of Kaz; a Kaz has all joints of shared/board/joints.def: add the missing joint, or "
           "rename `" +
           shared + "` if the robot is not a Kaz";
  }

  Result<void> some_joint() {
    if (std::any_of(joints_.begin(), joints_.end(),
                    [](const Element* j) { return is_revolute(*j); }))
      return {};
    return file_.error(file_.root(), "robot has no revolute joint; a robot needs at least one");
  }

  static bool is_revolute(const Element& joint) {
    return std::string(joint.Attribute("type")) == "revolute";
  }

  const XmlFile& file_;
  std::map<std::string, const Element*> links_, joint_by_name_, joint_to_;
  std::vector<const Element*> joints_;  // in the order of the file
  std::map<std::string, std::string> parent_of_;
  std::map<std::string, double> friction_;
};

}  // namespace

Result<UrdfFacts> check_urdf(const std::string& path) {
  const Result<XmlFile> file = XmlFile::load(path, "robot");
  if (!file) return tl::unexpected(file.error());
  Check check(*file);
  KAZ_TRY(check.run());
  return check.facts();
}

}  // namespace kaz::sim
