// Validates a URDF: elements and attributes, numbers, the tree of links.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/urdf_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/rigid_link.h"
#include "sim/body/description/urdf_joints.h"
#include "sim/body/description/urdf_schema.h"
#include "sim/body/description/urdf_surfaces.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

// Bounds against wrong units, such as millimetres for metres.
constexpr double kLargest = 10;           // m
constexpr double kHeaviest = 500;         // kg
constexpr double kLargestTurn = 100;      // rad, and m of a prismatic joint
constexpr double kLargestMoment = 10000;  // kg m^2: the heaviest at the largest distance
// Maximum depth: the tree is traversed recursively.
constexpr std::size_t kMaxLinks = 500;
constexpr std::size_t kMaxNotes = 10000;

std::string format(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string tag(const Element& e) {
  return std::string("<") + e.Name() + ">";
}

class Check {
 public:
  Check(Urdf& urdf, const ReadOptions& options)
      : urdf_(urdf), options_(options), objections_(urdf.file.path()) {}

  Result<void> run() {
    walk(root(), "");
    collect();
    if (urdf_.links.size() > kMaxLinks) return objections_.result();
    for (const Element* joint : urdf_.joints) check_joint(*joint);
    // Errors that would only follow from a wrong joint are left out.
    if (joints_sound_) {
      check_tree();
      const auto object_at = [this](const Element& at, const std::string& text) {
        object(at, text);
      };
      resolve_mimics(urdf_, object_at);
      check_joint_names(urdf_, object_at);
    }
    read_surfaces(
        urdf_, options_.body, [this](const Element& at, const std::string& text) { object(at, text); },
        [this](const Element& at, const std::string& what) { note(at, what); });
    if (options_.strict) {
      for (const FileNote& note : urdf_.notes)
        object(note.line, note.what + " is not used, which --strict does not permit; remove it");
    }
    return objections_.result();
  }

 private:
  const Element& root() const { return urdf_.file.root(); }
  void object(int line, const std::string& text) { objections_.add(line, text); }
  void object(const Element& at, const std::string& text) { object(at.GetLineNum(), text); }
  void note(const Element& at, const std::string& what) {
    if (urdf_.notes.size() < kMaxNotes) urdf_.notes.push_back({at.GetLineNum(), what});
  }
  // An element with a wrong number or a missing attribute: later checks leave it out.
  void spoil(const Element& at, const std::string& text) {
    object(at, text);
    spoiled_.insert(&at);
  }
  bool sound(const Element* e) const { return e != nullptr && !spoiled_.contains(e); }

  // Elements and attributes of `e` and below. `parent`: name of the element that contains `e`.
  void walk(const Element& e, const std::string& parent) {
    const std::string name = e.Name();
    attributes(e, *urdf_element(parent, name));
    if (const auto wrong = name_error(e)) object(e, *wrong);
    numbers(e);
    if (name == "gazebo") return;
    for (const Element* child = e.FirstChildElement(); child; child = child->NextSiblingElement()) {
      if (!options_.body && skipped(name, child->Name())) continue;
      if (const UrdfElement* known = takes(e, *child)) {
        if (known->use == Use::used) walk(*child, name);
      }
    }
  }

  // Parts of links and joints that are not needed for their names and limits.
  static bool skipped(const std::string& parent, const std::string& child) {
    if (parent == "link" || parent == "material") return true;
    return parent == "joint" && child != "parent" && child != "child" && child != "limit" &&
           child != "mimic";
  }

  // Returns the entry of a child that may stand there, else adds an objection and returns null.
  const UrdfElement* takes(const Element& e, const Element& child) {
    const std::string parent = e.Name(), name = child.Name();
    const UrdfElement* known = urdf_element(parent, name);
    if (name.starts_with("xacro:")) {
      object(child, tag(child) + " is not expanded; expand the file: xacro FILE > robot.urdf");
      return nullptr;
    }
    if (known == nullptr && name.find(':') != name.npos) {
      note(child, tag(child));
      return nullptr;
    }
    if (known == nullptr) {
      object(child, "unknown element " + tag(child) + " in " + tag(e) +
                        "; docs/reference/robot.md lists the supported elements");
      return nullptr;
    }
    if (known->use == Use::noted) note(child, tag(child));
    if (known->use == Use::refused) {
      object(child, tag(child) + " is not supported: " + std::string(known->remedy));
      return nullptr;
    }
    if (!known->repeated && child.PreviousSiblingElement(child.Name()) != nullptr) {
      object(child, tag(child) + " occurs twice in " + tag(e) + "; remove one");
      return nullptr;
    }
    if (parent == "geometry" && child.PreviousSiblingElement() != nullptr) {
      object(child, "<geometry> has more than one shape; use one <" +
                        std::string(e.Parent()->ToElement()->Name()) + "> for each shape");
      return nullptr;
    }
    return known;
  }

  void attributes(const Element& e, const UrdfElement& known) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
      const std::string name = a->Name();
      if (has_word(known.attributes, name) || name == "xmlns") continue;
      const std::string what = "attribute `" + name + "` of " + tag(e);
      if (has_word(known.noted, name))
        note(e, what);
      else if (name.find(':') == name.npos)
        spoil(e, what + " is unknown; " + tag(e) + " accepts " +
                     (known.attributes.empty() ? "no attributes" : std::string(known.attributes)));
    }
    if (e.Attribute("rpy") != nullptr && e.Attribute("quat_xyzw") != nullptr)
      spoil(e, "<origin> has both rpy and quat_xyzw; remove one");
  }

  void numbers(const Element& e) {
    const std::string name = e.Name();
    for (const UrdfNumbers& n : kUrdfNumbers) {
      if (name != n.element) continue;
      const char* text = e.Attribute(n.attribute);
      if (text == nullptr && !n.needed) continue;
      if (text != nullptr && parse_numbers(text, n.count)) continue;
      const std::string attribute = std::string("attribute `") + n.attribute + "` of " + tag(e);
      if (name == "color") {
        note(e, attribute);
        continue;
      }
      if (text == nullptr)
        spoil(e, tag(e) + " lacks the attribute `" + n.attribute + "`");
      else if (n.count == 1)
        spoil(e, attribute + " is \"" + text + "\", expected a number");
      else
        spoil(e, attribute + " must be " + std::to_string(n.count) + " numbers");
    }
    if (sound(&e)) sizes(e);
    if (name == "mesh") mesh(e);
  }

  // After numbers(): all of them are valid.
  void sizes(const Element& e) {
    const std::string name = e.Name();
    std::vector<double> lengths;
    if (name == "box") lengths = numbers_of(e, "size", 3);
    if (name == "cylinder" || name == "sphere" || name == "capsule")
      lengths.push_back(e.DoubleAttribute("radius"));
    if (name == "cylinder" || name == "capsule") lengths.push_back(e.DoubleAttribute("length"));
    const bool is_empty = std::ranges::all_of(lengths, [](double length) { return length == 0; });
    if (!lengths.empty() && (is_empty || is_drawn_only(e)) && std::ranges::min(lengths) == 0) {
      urdf_.shapeless.insert(&e);
      return note(e, tag(e) + " without a size");
    }
    for (const double length : lengths) {
      if (length > 0 && length <= kLargest) continue;
      return spoil(e, tag(e) + " has a size of " + format(length) +
                          " m; sizes are above 0 and at most 10 m");
    }
    if (name == "origin") origin(e);
    if (name == "inertia") inertia(e);
    if (name == "mass") {
      const double value = number_of(e, "value", 0);
      if (value < 0) spoil(e, "a mass of " + format(value) + " kg; masses are not negative");
      if (value > kHeaviest) spoil(e, "a mass of " + format(value) + " kg; the maximum is 500 kg");
    }
  }

  static bool is_drawn_only(const Element& shape) {
    return std::string_view(shape.Parent()->Parent()->ToElement()->Name()) == "visual";
  }

  void origin(const Element& e) {
    for (const double place : numbers_of(e, "xyz", 3)) {
      if (std::abs(place) > kLargest)
        return spoil(e, "<origin> lies " + format(place) + " m away; the maximum is 10 m");
    }
    for (const double angle : numbers_of(e, "rpy", 3)) {
      if (std::abs(angle) > kLargestTurn)
        return spoil(
            e, "<origin> is turned by " + format(angle) + " rad; angles are from -100 to 100 rad");
    }
    if (const auto q = numbers_of(e, "quat_xyzw", 4);
        !q.empty() &&
        std::abs(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) - 1) > 0.01)
      spoil(e, "quat_xyzw of <origin> is not a unit quaternion; divide it by its norm");
  }

  // A frame without mass may have zero inertia. The whole of each moving part is checked later.
  void inertia(const Element& e) {
    for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
      if (const double value = number_of(e, moment, 0); std::abs(value) > kLargestMoment)
        return spoil(e, std::string("<inertia> has ") + moment + " of " + format(value) +
                            " kg m2; moments are from -10000 to 10000 kg m2");
    }
    const Eigen::Matrix3d tensor = tensor_of(e);
    const char* name = e.Parent()->Parent()->ToElement()->Attribute("name");
    const std::string link = name == nullptr ? "" : name;
    if (tensor.isZero(0) || physical(1, tensor)) return;
    if (!physical(1, tensor, kLargestExcess))
      return spoil(e, "the inertia of link `" + link +
                          "` is impossible: its principal moments must be above 0, and none of "
                          "them may exceed the sum of the other two");
    note(e, "rule of the principal moments in link `" + link + "` (one exceeds the sum of the others)");
  }

  // Reads each file once: robots repeat meshes.
  std::optional<std::string> error_of_mesh(const std::string& path) {
    const auto known = mesh_errors_.find(path);
    if (known != mesh_errors_.end()) return known->second;
    return mesh_errors_[path] = mesh_error(path);
  }

  void mesh(const Element& e) {
    const char* name = e.Attribute("filename");
    if (name == nullptr) return spoil(e, "<mesh> lacks the attribute `filename`");
    const auto path = mesh_path(urdf_.file.path(), name);
    const std::string what = std::string("mesh `") + name + "`";
    if (options_.skip_missing_meshes && !(path && mesh_exists(*path))) {
      urdf_.shapeless.insert(&e);
      return note(e, what);
    }
    const auto error = path ? error_of_mesh(*path) : path.error().message;
    if (!error) return;
    if (!is_drawn_only(e) || !(path && mesh_exists(*path))) return spoil(e, what + " " + *error);
    urdf_.shapeless.insert(&e);
    note(e, what + " (it " + *error + ")");
  }

  void collect() {
    std::set<std::string> names;
    for (auto* e = root().FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind != "link" && kind != "joint") continue;
      const char* name = e->Attribute("name");
      if (name == nullptr) {
        object(*e, tag(*e) + " lacks the attribute `name`");
        continue;
      }
      const bool fresh =
          kind == "joint" ? names.insert(name).second : urdf_.links.emplace(name, e).second;
      if (!fresh)
        object(*e, kind + " `" + name + "` is already defined above; rename it");
      else if (kind == "joint")
        urdf_.joints.push_back(e);
    }
    if (urdf_.links.empty()) object(root(), "<robot> has no <link>");
    if (urdf_.links.size() > kMaxLinks)
      object(root(), "<robot> has more than " + std::to_string(kMaxLinks) + " links");
  }

  // The link that <parent> or <child> names; empty after an objection.
  std::string end_of(const Element& joint, const char* which) {
    const Element* e = joint.FirstChildElement(which);
    const std::string name = joint.Attribute("name");
    if (e == nullptr) {
      object(joint, "joint `" + name + "` lacks <" + which + ">");
      return "";
    }
    const char* link = e->Attribute("link");
    if (link == nullptr) {
      object(*e, tag(*e) + " lacks the attribute `link`");
      return "";
    }
    if (urdf_.links.contains(link)) return link;
    object(*e, std::string(which) + " link `" + link + "` of joint `" + name +
                   "` does not exist; check the spelling");
    return "";
  }

  void check_joint(const Element& joint) {
    const std::string name = joint.Attribute("name");
    const char* type = joint.Attribute("type");
    if (type == nullptr) {
      joints_sound_ = false;
      return object(joint, "<joint> lacks the attribute `type`");
    }
    if (!urdf_.moves(joint) && std::string(type) != "fixed" && std::string(type) != "floating") {
      joints_sound_ = false;
      object(joint, "joint `" + name + "` has type \"" + type +
                        "\"; the supported types are revolute, continuous, prismatic, fixed and floating");
    }
    const std::string parent = end_of(joint, "parent"), child = end_of(joint, "child");
    const bool fresh = !child.empty() && urdf_.joint_to.emplace(child, &joint).second;
    if (!child.empty() && !fresh)
      object(joint, "link `" + child + "` is already the child of joint `" +
                        urdf_.joint_to.at(child)->Attribute("name") + "`");
    if (std::string(type) == "floating") floating_ = &joint;
    joints_sound_ = joints_sound_ && fresh && !parent.empty();
    if (fresh && !parent.empty()) parent_of_[child] = parent;
    if (urdf_.moves(joint)) check_moving(joint, name, type);
  }

  void check_moving(const Element& joint, const std::string& name, const std::string& type) {
    const Element* limit = joint.FirstChildElement("limit");
    const bool slides = type == "prismatic";
    if (type != "continuous" && limit == nullptr)
      object(joint, "joint `" + name + "` lacks <limit>; give limits" +
                        (slides ? "" : ", or the type continuous"));
    if (type != "continuous" && sound(limit)) {
      const double lower = number_of(*limit, "lower", 0), upper = number_of(*limit, "upper", 0);
      if (lower > upper)
        object(*limit, "lower limit of joint `" + name + "` is above the upper one; swap them");
      if (lower == upper) note(*limit, "range of joint `" + name + "` (its limits are equal)");
    }
    for (const char* side : {"lower", "upper"}) {
      const double value = sound(limit) ? std::abs(number_of(*limit, side, 0)) : 0;
      if (value >= kStatedUnlimited)
        note(*limit, std::string(side) + " limit of joint `" + name + "` (1000 and more: no limit)");
      else if (value > kLargestTurn)
        object(*limit, std::string(side) + " limit of joint `" + name + "` is " +
                           limit->Attribute(side) +
                           (slides ? " m; limits are from -100 to 100 m"
                                   : " rad; limits are from -100 to 100 rad"));
    }
    for (const char* least : {"effort", "velocity"}) {
      if (sound(limit) && number_of(*limit, least, 0) < 0)
        object(*limit, std::string(least) + " limit of joint `" + name + "` is negative");
    }
    const Element* dynamics = joint.FirstChildElement("dynamics");
    for (const char* loss : {"damping", "friction"}) {
      if (sound(dynamics) && number_of(*dynamics, loss, 0) < 0)
        object(*dynamics, std::string(loss) + " of joint `" + name + "` is negative");
    }
    if (sound(dynamics) && number_of(*dynamics, "spring_stiffness", 0) != 0)
      object(*dynamics, "joint `" + name +
                            "` has a spring, which is not supported; remove `spring_stiffness`");
    const Element* axis = joint.FirstChildElement("axis");
    if (axis == nullptr || !sound(axis) || !options_.body) return;
    const auto xyz = numbers_of(*axis, "xyz", 3);
    if (xyz[0] == 0 && xyz[1] == 0 && xyz[2] == 0)
      object(*axis, "axis of joint `" + name + "` is zero");
  }

  void check_tree() {
    for (const auto& [name, link] : urdf_.links) {
      if (parent_of_.contains(name) || urdf_.joint_to.contains(name)) continue;
      if (!urdf_.root.empty()) {
        object(*link, "links `" + urdf_.root + "` and `" + name +
                          "` are both without a parent joint; a robot has one root");
        continue;
      }
      urdf_.root = name;
    }
    if (floating_ != nullptr) free_root(*floating_);
    for (const auto& [name, link] : urdf_.links) {
      std::string at = name;
      for (std::size_t steps = 0; parent_of_.contains(at); ++steps) {
        if (steps > urdf_.links.size()) return loop(at);
        at = parent_of_.at(at);
      }
    }
  }

  // A floating joint from an empty root frees its child, which becomes the root.
  void free_root(const Element& joint) {
    const std::string parent = joint.FirstChildElement("parent")->Attribute("link");
    const auto is_child = [&](const auto& one) { return one.second == parent; };
    if (parent != urdf_.root || std::ranges::count_if(parent_of_, is_child) != 1 ||
        urdf_.links.at(parent)->FirstChildElement() != nullptr)
      return object(joint, std::string("joint `") + joint.Attribute("name") +
                               "` is floating, which is supported only as the one joint of an empty "
                               "root link; use a fixed joint");
    urdf_.root = joint.FirstChildElement("child")->Attribute("link");
    note(joint, "floating joint (the robot is free)");
  }

  // `at` is on a loop. The error names the loop's first joint in the file.
  void loop(std::string at) {
    const Element* first = urdf_.joint_to.at(at);
    for (std::size_t i = 0; i <= urdf_.links.size(); ++i, at = parent_of_.at(at)) {
      if (urdf_.joint_to.at(at)->GetLineNum() < first->GetLineNum()) first = urdf_.joint_to.at(at);
    }
    object(*first, std::string("joint `") + first->Attribute("name") +
                       "` closes a loop; links must form a tree");
  }

  Urdf& urdf_;
  const ReadOptions& options_;
  Objections objections_;
  std::set<const Element*> spoiled_;
  std::map<std::string, std::optional<std::string>> mesh_errors_;  // by path
  std::map<std::string, std::string> parent_of_;
  const Element* floating_ = nullptr;
  bool joints_sound_ = true;
};

}  // namespace

bool Urdf::moves(const Element& joint) const {
  const std::string type = joint.Attribute("type") == nullptr ? "" : joint.Attribute("type");
  return type == "revolute" || type == "continuous" || type == "prismatic";
}

bool Urdf::has_motor(const Element& joint) const {
  return moves(joint) && !mimics.contains(joint.Attribute("name"));
}

Eigen::Matrix3d tensor_of(const Element& inertia) {
  const auto of = [&](const char* moment) { return number_of(inertia, moment, 0); };
  Eigen::Matrix3d tensor;
  tensor << of("ixx"), of("ixy"), of("ixz"),  //
      of("ixy"), of("iyy"), of("iyz"),        //
      of("ixz"), of("iyz"), of("izz");
  return tensor;
}

Result<Urdf> check_urdf(XmlFile file, const ReadOptions& options) {
  Urdf urdf{std::move(file), {}, {}, {}, {}, {}, {}, {}, {}, {}};
  KAZ_TRY(Check(urdf, options).run());
  return urdf;
}

}  // namespace kaz::sim
