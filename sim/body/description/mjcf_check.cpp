// Checks an MJCF robot: elements, attributes, numbers, names, mesh files.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_check.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/mjcf_elements.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;
namespace fs = std::filesystem;

constexpr std::size_t kMaxMjcfNotes = 10000;

// Attributes that contain from `least` to `most` numbers.
struct NumberCount {
  std::string_view attributes;
  std::size_t least, most;
};
constexpr NumberCount kMjcfCounts[] = {
    {"pos axis euler zaxis diaginertia scale", 3, 3},
    {"quat axisangle rgba", 4, 4},
    {"xyaxes fromto fullinertia", 6, 6},
    {"range actuatorfrcrange forcerange ctrlrange inertiagrouprange", 2, 2},
    {"mass density ref damping frictionloss condim contype conaffinity group boundmass "
     "boundinertia "
     "settotalmass",
     1, 1},
    {"size friction", 1, 3},
    {"polycoef", 1, 5},
    {"gear", 1, 6},
    {"gainprm biasprm", 1, 10},
};
constexpr double kLargestMjcfNumber = 1e12;  // a lock by damping has 1e11

// Returns the numbers of an attribute, or nullopt if one of them is invalid.
std::optional<std::vector<double>> mjcf_values(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  std::size_t count = 0;
  while (words >> word) ++count;
  return parse_numbers(text, count);
}

class MjcfCheck {
 public:
  MjcfCheck(Mjcf& mjcf, const ReadOptions& options)
      : mjcf_(mjcf), options_(options), objections_(mjcf.source.path()) {}

  Result<void> run() {
    walk(mjcf_.source.root(), "");
    if (options_.body) meshes();
    if (options_.strict) {
      for (const FileNote& note : mjcf_.notes)
        objections_.add(note.path, note.line,
                        note.what + " is not used, which --strict does not permit; remove it");
    }
    return objections_.result();
  }

 private:
  void object(const Element& e, const std::string& text) {
    MjcfSource::object(objections_, e, text);
  }
  void note(const Element& e, const std::string& what) {
    if (mjcf_.notes.size() < kMaxMjcfNotes) mjcf_.notes.push_back(mjcf_.source.note(e, what));
  }

  void walk(const Element& e, std::string_view parent) {
    const MjcfElement& known = *mjcf_element(parent, e.Name());
    if (const auto wrong = name_error(e)) object(e, *wrong);
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next())
      attribute(e, known, a->Name(), a->Value());
    if (std::string_view(e.Name()) == "geom" && e.Attribute("mesh") != nullptr &&
        parent == "default")
      object(e, "<geom> of a class has a `mesh`, which is not supported; give it in each <geom>");
    for (const Element* child = e.FirstChildElement(); child; child = child->NextSiblingElement()) {
      if (takes(e, *child)) walk(*child, e.Name());
    }
  }

  // Returns whether the child is used. Adds an objection or a note if it is not.
  bool takes(const Element& e, const Element& child) {
    const MjcfElement* known = mjcf_element(e.Name(), child.Name());
    if (known == nullptr) {
      object(child, "unknown element " + mjcf_tag(child) + " in " + mjcf_tag(e) +
                        "; docs/reference/robot.md lists the supported elements");
      return false;
    }
    const char* active = child.Attribute("active");
    const bool inactive = active != nullptr && std::string_view(active) == "false";
    if (mjcf_is_mocap(child) || holds_mocap(child)) {
      note(child, mjcf_name(child) + " (mocap)");
      return false;
    }
    if (known->use == Use::refused && !inactive) {
      object(child, mjcf_name(child) + ends_of(child) + " in " + mjcf_tag(e) +
                        " is not supported: " + std::string(known->remedy) + coupling_for(child));
      return false;
    }
    if (known->use != Use::used) note(child, mjcf_tag(child));
    return known->use == Use::used;
  }

  void attribute(const Element& e, const MjcfElement& known, const std::string& name,
                 const std::string& value) {
    const std::string what = "attribute `" + name + "` of " + mjcf_tag(e);
    if (has_word(known.compiled, name) || has_word(known.own, name)) {
      numbers(e, name, value);
    } else if (has_word(known.refused, name)) {
      if (!mjcf_neutral(value))
        object(e, what + " is not supported: " + std::string(mjcf_remedy(name)));
    } else if (has_word(known.noted, name)) {
      note(e, what);
    } else {
      object(e, what + " is unknown; remove it");
    }
  }

  void numbers(const Element& e, const std::string& name, const std::string& value) {
    const auto* count = std::ranges::find_if(
        kMjcfCounts, [&](const NumberCount& one) { return has_word(one.attributes, name); });
    if (count == std::end(kMjcfCounts)) return;
    const auto values = mjcf_values(value);
    const std::string what = "attribute `" + name + "` of " + mjcf_tag(e) + " ";
    if (!values || values->size() < count->least || values->size() > count->most) {
      const std::string most = std::to_string(count->most);
      return object(
          e,
          what + "is \"" + value + "\", expected " +
              (count->least == count->most ? most : std::to_string(count->least) + " to " + most) +
              (count->most == 1 ? " number" : " numbers"));
    }
    for (const double number : *values) {
      if (std::abs(number) > kLargestMjcfNumber)
        return object(e, what + "contains a number beyond 1e12; give it in SI units");
    }
  }

  // Returns whether the element is a constraint that pulls the robot to a mocap body.
  bool holds_mocap(const Element& e) const {
    for (const char* end : {"body1", "body2"}) {
      const char* name = e.Attribute(end);
      const auto* world = mjcf_.source.root().FirstChildElement("worldbody");
      for (; world != nullptr && name != nullptr; world = world->NextSiblingElement("worldbody")) {
        for (auto* body = world->FirstChildElement("body"); body != nullptr;
             body = body->NextSiblingElement("body"))
          if (mjcf_is_mocap(*body) && body->Attribute("name", name) != nullptr) return true;
      }
    }
    return false;
  }

  // " of `ONE` and `OTHER`", the bodies or geoms that a constraint ties together; empty for other elements.
  static std::string ends_of(const Element& e) {
    std::string text;
    for (const char* end : {"body1", "geom1", "joint1", "body2", "geom2", "joint2"}) {
      if (const char* name = e.Attribute(end))
        text += std::string(text.empty() ? " of `" : " and `") + name + "`";
    }
    return text;
  }

  // Returns a sentence about a coupling of the file that can replace a closed loop, or an empty text.
  std::string coupling_for(const Element& loop) const {
    std::vector<std::string> joints;
    for (const char* end : {"body1", "body2"}) {
      if (const char* body = loop.Attribute(end)) joints_above(mjcf_.source.root(), body, joints);
    }
    for (const Element* section = mjcf_.source.root().FirstChildElement("equality"); section;
         section = section->NextSiblingElement("equality")) {
      for (const Element* e = section->FirstChildElement("joint"); e;
           e = e->NextSiblingElement("joint")) {
        const char *one = e->Attribute("joint1"), *two = e->Attribute("joint2");
        if (one != nullptr && two != nullptr && std::ranges::count(joints, one) > 0 &&
            std::ranges::count(joints, two) > 0)
          return std::string("; the coupling of `") + one + "` to `" + two + "` in line " +
                 std::to_string(MjcfSource::origin(*e).line) + " can replace it: remove " +
                 mjcf_tag(loop);
      }
    }
    return {};
  }

  // Adds the joints of the body and of those that contain it. Returns whether the body is in `e`.
  static bool joints_above(const Element& e, std::string_view body,
                           std::vector<std::string>& joints) {
    const char* name = e.Attribute("name");
    const bool is_body = std::string_view(e.Name()) == "body";
    bool found = is_body && name != nullptr && name == body;
    for (const Element* child = e.FirstChildElement(); child && !found;
         child = child->NextSiblingElement())
      found = joints_above(*child, body, joints);
    if (!found || !is_body) return found;
    for (const Element* joint = e.FirstChildElement("joint"); joint;
         joint = joint->NextSiblingElement("joint"))
      if (joint->Attribute("name") != nullptr) joints.emplace_back(joint->Attribute("name"));
    return true;
  }

  void meshes() {
    for (const Element* asset = mjcf_.source.root().FirstChildElement("asset"); asset;
         asset = asset->NextSiblingElement("asset")) {
      for (const Element* e = asset->FirstChildElement("mesh"); e;
           e = e->NextSiblingElement("mesh"))
        mesh(*e);
    }
  }

  // MuJoCo's rules: an absolute path, or one that is relative to `meshdir`.
  std::string path_in_files(const std::string& file) const {
    const MjcfSource& source = mjcf_.source;
    const char* strip = source.setting("compiler", "strippath");
    const char* folder = source.setting("compiler", "meshdir");
    if (folder == nullptr) folder = source.setting("compiler", "assetdir");
    const fs::path name = strip != nullptr && std::string_view(strip) == "true"
                              ? fs::path(file).filename()
                              : fs::path(file);
    return (fs::path(folder == nullptr ? "" : folder) / name).string();
  }

  void mesh(const Element& e) {
    const char* file = e.Attribute("file");
    if (file == nullptr) return object(e, "<mesh> lacks the attribute `file`");
    MjcfMesh out;
    const char* scale = mjcf_.source.value(e, "scale");
    if (const auto values = parse_numbers(scale == nullptr ? "" : scale, 3))
      out.scale = {(*values)[0], (*values)[1], (*values)[2]};
    const auto path = mesh_path(mjcf_.source.path(), path_in_files(file));
    const std::string what = std::string("mesh `") + file + "`";
    if (options_.skip_missing_meshes && !(path && mesh_exists(*path))) {
      note(e, what);
    } else {
      const auto error = path ? mesh_error(*path) : path.error().message;
      if (error) return object(e, what + " " + *error);
      if (out.scale.prod() == 0) return object(e, what + " has a scale of 0; remove `scale`");
      out.path = *path;
    }
    if (!mjcf_.meshes.emplace(mjcf_mesh_name(e), out).second)
      object(e, "mesh `" + mjcf_mesh_name(e) + "` is already defined above; rename it");
  }

  Mjcf& mjcf_;
  const ReadOptions& options_;
  Objections objections_;
};

}  // namespace

bool mjcf_neutral(const std::string& value) {
  if (value == "false" || value == "none" || value == "legacy") return true;
  const auto numbers = mjcf_values(value);
  if (!numbers) return false;
  if (*numbers == std::vector<double>{1, 0, 0, 0}) return true;
  return std::ranges::all_of(*numbers, [](double number) { return number == 0; });
}

bool mjcf_is_mocap(const Element& e) {
  return std::string_view(e.Name()) == "body" && e.Attribute("mocap", "true") != nullptr;
}

std::string mjcf_mesh_name(const Element& mesh) {
  if (const char* name = mesh.Attribute("name")) return name;
  const char* file = mesh.Attribute("file");
  return fs::path(file == nullptr ? "" : file).stem().string();
}

const char* mjcf_mesh_of(const MjcfSource& source, const Element& geom) {
  const char* type = source.value(geom, "type");
  return type != nullptr && std::string_view(type) == "mesh" ? source.value(geom, "mesh") : nullptr;
}

Result<Mjcf> check_mjcf(const XmlFile& file, const ReadOptions& options) {
  auto source = KAZ_TRY(MjcfSource::load(file));
  Mjcf mjcf{std::move(source), {}, {}};
  KAZ_TRY(MjcfCheck(mjcf, options).run());
  return mjcf;
}

}  // namespace kaz::sim
