// Validates a world file before the parser reads it, so that errors have a line number.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/sdf_elements.h"
#include "sim/body/description/sdf_include.h"
#include "sim/body/description/sdf_rules.h"
#include "sim/body/description/sdf_values.h"
#include "sim/body/description/sdf_writer.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using SdfXml = tinyxml2::XMLElement;

constexpr int kNewestMinor = 11, kParserMinor = 9;

// The parser's time grows with the square of their number: 3000 models take 10 s and 0.8 GB.
constexpr std::size_t kMaxModels = 4000;

std::string sdf_tag(const SdfXml& e) {
  return std::string("<") + e.Name() + ">";
}

std::string used_children(const std::string& parent) {
  std::set<std::string_view> names;
  for (const SdfElement& one : kSdfElements) {
    if (one.parent == parent && one.use == Use::used) names.insert(one.name);
  }
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text.empty() ? "no elements" : text;
}

template <class List>
bool contains_name(const List& list, const std::string& name) {
  return std::ranges::find(list, name) != std::end(list);
}

struct IncludedModel {
  int index = -1;  // into CheckedSdf::models; -1: the file has no model
  std::string name;
  std::size_t models = 0;  // with nested models
};

// State of the check of a world and of all included files.
struct SdfScan {
  SdfScan(const ReadOptions& read_options, const std::string& world)
      : options(read_options), path(world) {}
  const ReadOptions& options;
  ModelPath path;
  CheckedSdf out;
  std::vector<Error> errors;  // one for each file
  std::map<std::pair<std::string, int>, IncludedModel> known;
  std::vector<std::string> open;  // files that include each other
  std::size_t models = 0;
};

class SdfFileCheck {
 public:
  // `include_line`: line of the world file that includes `file`, or 0 for the world file.
  SdfFileCheck(SdfScan& scan, const XmlFile& file, int include_line)
      : scan_(scan), file_(file), report_(file.path(), include_line, scan.out.notes) {}

  // Returns the text for libsdformat.
  std::string world() {
    if (begin()) {
      const SdfXml& root = file_.root();
      if (root.FirstChildElement("world") == nullptr && root.FirstChildElement("model") == nullptr)
        report_.object(root, "<sdf> must contain one <world>");
      children(root, "sdf", false);
      writer_.close("sdf");
    }
    if (scan_.options.strict) report_.object_to_notes();
    return end();
  }

  // Checks a file with a model. Returns its text, or nothing if the file has no model. `fixed`: the model is
  // in a static model. `is_static`: replaces the model's <static>.
  std::string model(bool fixed, std::optional<bool> is_static, std::string& name) {
    if (begin()) {
      const SdfXml& root = file_.root();
      const SdfXml* model = root.FirstChildElement("model");
      for (const SdfXml* e = root.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        if (e == model) continue;
        if (!contains_name(std::vector{"light", "actor"}, e->Name()))
          report_.object(
              *e, sdf_tag(*e) + " is not supported in an included file; it needs one <model>");
        else
          report_.note(*e, sdf_tag(*e));
      }
      if (model != nullptr) {
        const char* named = model->Attribute("name");
        name = named == nullptr ? "" : named;
        root_fixed_ = fixed || is_static.value_or(truth_of(*model, "static").value_or(false));
        root_model_ = model;
        walk(*model, *sdf_element("world", "model"), "world", fixed);
      }
      writer_.close("sdf");
      if (model == nullptr) return end(), "";
    }
    return end();
  }

 private:
  // The version. Returns false if nothing else can be checked.
  bool begin() {
    const SdfXml& root = file_.root();
    const char* version = root.Attribute("version");
    const auto minor = sdf_minor_version(version == nullptr ? "" : version);
    if (version == nullptr) report_.object(root, "<sdf> lacks version=\"1.9\"");
    if (version != nullptr && !minor)
      report_.object(root, std::string("SDF version \"") + version +
                               "\" is not supported; the newest supported version is 1.11");
    if (!minor) return false;
    minor_ = *minor;
    scan_.out.is_recent = scan_.out.is_recent && minor_ >= 7;
    const SdfElement& known = *sdf_element("", "sdf");
    attributes(root, known);
    writer_.open("sdf", root.GetLineNum());
    writer_.attribute("version", "1." + std::to_string(std::min(minor_, kParserMinor)));
    writer_.attribute("xmlns:kaz", "urn:kaz:sdf");
    check_no_text(root, report_);
    return true;
  }

  std::string end() {
    if (const auto result = report_.result(); !result) scan_.errors.push_back(result.error());
    return writer_.text();
  }

  // `fixed`: the element is in a static model.
  void walk(const SdfXml& e, const SdfElement& known, const std::string& parent, bool fixed) {
    const std::string name = e.Name();
    attributes(e, known);
    if (const auto wrong = name_error(e)) report_.spoil(e, *wrong);
    check_colons(e);
    check_needs(e, report_);
    if (const auto wrong = sdf_value_error(e, parent)) report_.spoil(e, *wrong);
    if ((name == "visual" || name == "collision") && !has_shape(e)) return;
    if (name == "model") {
      fixed = &e == root_model_ ? root_fixed_ : fixed || truth_of(e, "static").value_or(false);
      if (!enter_model(e, parent)) return;
    }
    scan_.out.is_plain = scan_.out.is_plain && is_plain(name, parent);
    const bool was_muted = writer_.is_muted();
    writer_.mute(was_muted || known.harmless == kOnlyChecked);
    write_tag(e, known);
    const std::string context = sdf_context(parent, name);
    if (has_elements(context)) {
      check_no_text(e, report_);
      children(e, context, fixed);
    } else {
      if (e.FirstChildElement() != nullptr)
        report_.object(*e.FirstChildElement(), "unknown element " +
                                                   sdf_tag(*e.FirstChildElement()) + " in " +
                                                   sdf_tag(e) + ", which accepts no elements");
      writer_.content(leaf_text(e, parent));
    }
    writer_.close(e.Name());
    writer_.mute(was_muted);
    if (name == "model") {
      --level_;
      check_model(e, fixed, report_);
    }
    if (name == "joint") check_joint(e, report_);
    if (name == "ode" && parent == "friction") check_friction(e, report_);
  }

  // Until SDF 1.7, links of nested models may have names such as `model::link`.
  void check_colons(const SdfXml& e) {
    const char* name = e.Attribute("name");
    if (name == nullptr || std::string(name).find("::") == std::string::npos) return;
    if (minor_ < 8 && !contains_name(std::vector{"world", "visual", "collision"}, e.Name())) return;
    report_.spoil(
        e, "the name `" + std::string(name) + "` of " + sdf_tag(e) + " contains `::`; rename it");
  }

  static bool is_plain(const std::string& name, const std::string& parent) {
    constexpr const char* kOthers[] = {"joint", "frame", "mesh", "collide_bitmask"};
    return !contains_name(kOthers, name) && !(name == "model" && parent == "model");
  }

  bool enter_model(const SdfXml& e, const std::string& parent) {
    if (parent == "model" && level_ >= kMaxSdfDepth) {
      report_.object(e, "models are nested more than " + std::to_string(kMaxSdfDepth) + " deep");
      return false;
    }
    if (!count_models(e, 1)) return false;
    scan_.out.nesting = std::max(scan_.out.nesting, level_++);
    return true;
  }

  bool count_models(const SdfXml& e, std::size_t count) {
    const bool was_within = scan_.models <= kMaxModels;
    scan_.models += count;
    const bool within = scan_.models <= kMaxModels;
    if (was_within && !within)
      report_.object(e, "<world> has more than " + std::to_string(kMaxModels) + " models");
    return within;
  }

  void children(const SdfXml& e, const std::string& context, bool fixed) {
    std::set<std::string> names;
    for (const SdfXml* child = e.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const SdfElement* known = takes(e, *child, context);
      if (known == nullptr) continue;
      const std::string name = child->Name();
      const char* own_name = child->Attribute("name");
      if (own_name != nullptr && !names.insert(name + " " + own_name).second)
        report_.object(*child, name + " `" + own_name + "` is already defined above; rename it");
      if (name == "include")
        include(*child, fixed, names);
      else
        walk(*child, *known, context, fixed);
    }
  }

  // Returns the entry of a child that is used. Else adds an objection or a note, and returns null.
  const SdfElement* takes(const SdfXml& e, const SdfXml& child, const std::string& context) {
    const std::string name = child.Name();
    const SdfElement* known = sdf_element(context, name);
    if (known == nullptr && name.find(':') != name.npos && !name.starts_with("kaz:")) {
      report_.note(child, sdf_tag(child));
      return nullptr;
    }
    if (known == nullptr) {
      report_.distrust(e);
      report_.object(child, "unknown element " + sdf_tag(child) + " in " + sdf_tag(e) +
                                ", which accepts " + used_children(context));
      return nullptr;
    }
    if (!known->repeated && child.PreviousSiblingElement(child.Name()) != nullptr) {
      report_.object(child, sdf_tag(child) + " occurs twice in " + sdf_tag(e) + "; remove one");
      return nullptr;
    }
    if (known->use == Use::noted && !(name == "light" && context == "world" && is_lamp(child)))
      report_.note(child, sdf_tag(child));
    if (known->use == Use::refused &&
        (known->harmless.empty() || !same_value(trimmed_text(child), known->harmless)))
      report_.object(child, sdf_tag(child) +
                                (known->harmless.empty() ? "" : " of " + trimmed_text(child)) +
                                " is not supported: " + std::string(known->remedy));
    return known->use == Use::used ? known : nullptr;
  }

  void attributes(const SdfXml& e, const SdfElement& known) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
      const std::string name = a->Name(), what = "attribute `" + name + "` of " + sdf_tag(e);
      if (name.starts_with("xmlns")) continue;
      if (name == "frame" && minor_ >= 7 && has_word(known.attributes, name))
        report_.spoil(e, what + " exists until SDF 1.6; use `relative_to`");
      else if (name == "merge" && !same_value(a->Value(), "false"))
        report_.spoil(e, what + " is not supported; remove it, so that the model is nested");
      else if (has_word(known.attributes, name))
        continue;
      else if (has_word(known.noted, name) ||
               (name.find(':') != name.npos && !name.starts_with("kaz:")))
        report_.note(e, what);
      else
        report_.spoil(
            e, what + " is unknown; " + sdf_tag(e) + " accepts " +
                   (known.attributes.empty() ? "no attributes" : std::string(known.attributes)));
    }
  }

  // Returns whether a visual or collision has a shape that is used. Else adds an objection or a note.
  bool has_shape(const SdfXml& e) {
    const SdfXml* geometry = e.FirstChildElement("geometry");
    const SdfXml* shape = geometry ? geometry->FirstChildElement() : nullptr;
    // Several polylines form one shape.
    const bool is_one = shape != nullptr && (shape->NextSiblingElement() == nullptr ||
                                             std::string(shape->Name()) == "polyline");
    if (!is_one || geometry->NextSiblingElement("geometry") != nullptr) {
      report_.object(e, sdf_tag(e) + " must contain one <geometry> with one shape");
      return false;
    }
    const SdfElement* known = sdf_element("geometry", shape->Name());
    const bool is_visual = std::string(e.Name()) == "visual";
    const bool is_part = shape->FirstChildElement("submesh") != nullptr;
    if (known != nullptr &&
        (known->use == Use::noted || (is_visual && (known->use == Use::refused || is_part)))) {
      report_.note(*shape, sdf_tag(e) + " with " + (is_part ? "<submesh>" : sdf_tag(*shape)));
      return false;
    }
    if (!scan_.options.skip_missing_meshes || std::string(shape->Name()) != "mesh") return true;
    const SdfXml* uri = shape->FirstChildElement("uri");
    if (uri == nullptr || scan_.path.find(file_.path(), trimmed_text(*uri))) return true;
    report_.note(*shape, "mesh `" + trimmed_text(*uri) + "`");
    return false;
  }

  void write_tag(const SdfXml& e, const SdfElement& known) {
    writer_.open(e.Name(), e.GetLineNum());
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
      if (has_word(known.attributes, a->Name()) && std::string(a->Name()) != "auto")
        writer_.attribute(a->Name(), a->Value());
    }
  }

  std::string leaf_text(const SdfXml& e, const std::string& parent) {
    const std::string name = e.Name(), text = trimmed_text(e);
    if (name == "pose" && text.empty())
      return e.Attribute("rotation_format", "quat_xyzw") ? "0 0 0 0 0 0 1" : "0 0 0 0 0 0";
    if (name == "collide_bitmask") return std::to_string(bitmask(text).value_or(0));
    if (parent == "limit" && std::isinf(joint_limit(text).value_or(0)))
      return text.starts_with('-') ? "-1e16" : "1e16";
    if (name != "uri" || parent != "mesh") return text;
    const auto path = scan_.path.find(file_.path(), text);
    const auto wrong = path ? mesh_error(*path) : path.error().message;
    if (wrong) report_.object(e, "mesh `" + text + "` " + *wrong);
    return path.value_or("");
  }

  // Uses the direction of the first directional light. Returns false if the light is not used.
  bool is_lamp(const SdfXml& light) {
    if (scan_.out.to_lamp || light.Parent()->FirstChildElement("kaz:light") != nullptr)
      return false;
    scan_.out.to_lamp = direction_to_lamp(light);
    return scan_.out.to_lamp.has_value();
  }

  // Writes a model in place of <include>, whose parts replace those of the included model.
  void include(const SdfXml& e, bool fixed, std::set<std::string>& names) {
    attributes(e, *sdf_element("world", "include"));
    check_needs(e, report_);
    check_no_text(e, report_);
    const bool was_muted = writer_.is_muted();
    writer_.mute(true);
    children(e, "include", fixed);
    writer_.mute(was_muted);
    const SdfXml* uri = e.FirstChildElement("uri");
    if (uri == nullptr || !report_.sound(*uri)) return;
    const IncludedModel included = model_of(*uri, fixed, truth_of(e, "static"));
    if (included.index < 0) return;
    const auto text_of = [&](const char* child) {
      const SdfXml* part = e.FirstChildElement(child);
      return part == nullptr ? std::string() : trimmed_text(*part);
    };
    const std::string own = text_of("name"), name = own.empty() ? included.name : own,
                      frame = text_of("placement_frame");
    if (!names.insert("model " + name).second)
      report_.object(e, "model `" + name + "` is already defined above; rename it");
    if (!frame.empty() && e.FirstChildElement("pose") == nullptr)
      report_.object(e, "<include> with <placement_frame> lacks <pose>");
    scan_.out.is_plain = scan_.out.is_plain && level_ == 0;
    scan_.out.nesting = std::max(scan_.out.nesting, level_);
    writer_.open("model", e.GetLineNum());
    writer_.attribute("name", name);
    if (!frame.empty()) writer_.attribute("placement_frame", frame);
    for (const char* part : {"static", "pose"}) {
      const SdfXml* child = e.FirstChildElement(part);
      if (child == nullptr) continue;
      write_tag(*child, *sdf_element("include", part));
      writer_.content(leaf_text(*child, "include"));
      writer_.close(part);
    }
    writer_.open(kIncludePlace, e.GetLineNum());
    writer_.attribute("file", std::to_string(included.index));
    writer_.close(kIncludePlace);
    writer_.close("model");
  }

  IncludedModel model_of(const SdfXml& uri, bool fixed, std::optional<bool> is_static) {
    const std::string what = "model `" + trimmed_text(uri) + "` ";
    auto path = scan_.path.find(file_.path(), trimmed_text(uri));
    if (path) path = scan_.path.model_file(*path);
    const bool is_missing = !path, is_floor = trimmed_text(uri) == kFloorModel;
    if (is_missing && trimmed_text(uri) == kSunModel)
      return report_.note(uri, what + "(a light)"), IncludedModel();
    if (is_missing && is_floor) path = kFloorModel;
    if (!path) return report_.object(uri, what + path.error().message), IncludedModel();
    const std::pair key(*path, 2 * (is_static ? 1 + *is_static : 0) + fixed);
    if (const auto known = scan_.known.find(key); known != scan_.known.end()) {
      if (!count_models(uri, known->second.models)) return {};
      return known->second;
    }
    if (scan_.open.size() > kMaxSdfDepth || contains_name(scan_.open, *path))
      return report_.object(uri, what + "includes itself, or files are included more than " +
                                     std::to_string(kMaxSdfDepth) + " deep"),
             IncludedModel();
    const std::size_t before = scan_.models;
    IncludedModel included;
    const auto file = is_missing ? XmlFile::parse(*path, "sdf", kFloorText)
                                 : XmlFile::load(*path, "sdf");
    if (!file) return report_.object(uri, what + "is not valid: " + file.error().message), included;
    scan_.open.push_back(*path);
    const int line = report_.line_of(uri);
    const std::string text =
        SdfFileCheck(scan_, *file, line).model(fixed, is_static, included.name);
    scan_.open.pop_back();
    if (!text.empty()) {
      included.index = static_cast<int>(scan_.out.models.size());
      scan_.out.models.push_back({*path, text});
    }
    included.models = scan_.models - before;
    return scan_.known[key] = included;
  }

  SdfScan& scan_;
  const XmlFile& file_;
  SdfReport report_;
  SdfWriter writer_;
  int minor_ = 0, level_ = 0;
  const SdfXml* root_model_ = nullptr;
  bool root_fixed_ = false;
};

}  // namespace

std::optional<int> sdf_minor_version(std::string_view version) {
  for (int minor = 0; minor <= kNewestMinor; ++minor) {
    if (version == "1." + std::to_string(minor)) return minor;
  }
  return std::nullopt;
}

Result<CheckedSdf> check_sdf(const std::string& path, const ReadOptions& options) {
  const auto file = KAZ_TRY(XmlFile::load(path, "sdf"));
  SdfScan scan(options, path);
  std::error_code ignored;
  scan.open.push_back(std::filesystem::canonical(path, ignored).string());
  scan.out.text = SdfFileCheck(scan, file, 0).world();
  if (scan.errors.empty()) return std::move(scan.out);
  Error error = scan.errors.front();
  for (std::size_t i = 1; i < scan.errors.size(); ++i) {
    error.details.push_back(scan.errors[i].message);
    std::ranges::copy(scan.errors[i].details, std::back_inserter(error.details));
  }
  return tl::unexpected(std::move(error));
}

}  // namespace kaz::sim
