// The robot's environment as the SDF world describes it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_model.h"

#include <algorithm>
#include <exception>
#include <map>
#include <memory>

#include <sdf/sdf.hh>

#include "sim/body/description/sdf_check.h"
#include "sim/body/description/sdf_link.h"
#include "sim/body/description/sdf_schema.h"
#include "sim/body/description/world_joints.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

std::vector<Kick> kicks_of(const sdf::Model& model) {
  std::vector<Kick> kicks;
  for (auto e = model.Element()->GetFirstElement(); e; e = e->GetNextElement()) {
    if (e->GetName() != "kaz:kick") continue;
    const std::vector<double> v = own_numbers(e, "velocity", 3);
    kicks.push_back({own_numbers(e, "time", 1).front(), {v[0], v[1], v[2]}});
  }
  std::stable_sort(kicks.begin(), kicks.end(),
                   [](const Kick& a, const Kick& b) { return a.time_s < b.time_s; });
  return kicks;
}

// `robot`: the element <kaz:robot>. In the file impulses have the axes of the robot's start.
std::vector<Push> pushes_of(const sdf::ElementPtr& robot, const Eigen::Isometry3d& start) {
  std::vector<Push> pushes;
  for (auto e = robot->GetFirstElement(); e; e = e->GetNextElement()) {
    if (e->GetName() != "kaz:push") continue;
    const std::vector<double> v = own_numbers(e, "impulse", 3);
    pushes.push_back({own_numbers(e, "time", 1).front(), e->GetAttribute("link")->GetAsString(),
                      start.linear() * Eigen::Vector3d(v[0], v[1], v[2])});
  }
  std::stable_sort(pushes.begin(), pushes.end(),
                   [](const Push& a, const Push& b) { return a.time_s < b.time_s; });
  return pushes;
}

Eigen::Isometry3d model_pose(const sdf::Model& model, bool nested) {
  const std::string scope = nested ? "__model__" : "";
  const sdf::SemanticPose pose = model.SemanticPose();
  if (model.PlacementFrameName().empty()) return pose_in(pose, scope);
  ignition::math::Pose3d resolved = pose.RawPose();
  (void)pose.Resolve(resolved, scope);
  return from_sdf(resolved);
}

// Collects the bodies and joints of all models.
struct ModelReader {
  const ReadOptions& options;
  WorldModel& out;
  std::map<std::string, int> body_of = {};  // by "model::link"
  std::vector<SdfJoint> joints = {};

  // `outer`: name of the model that contains `model`, or nothing. check_sdf() has limited the depth.
  Result<void> add(const sdf::Model& model, const std::string& outer,
                   const Eigen::Isometry3d& outer_pose, bool fixed) {
    const bool nested = !outer.empty();
    const std::string name = nested ? outer + "::" + model.Name() : model.Name();
    const Eigen::Isometry3d own = model_pose(model, nested), pose = nested ? outer_pose * own : own;
    fixed = fixed || model.Static();
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      WorldBody body;
      body.model = name;
      body.fixed = fixed;
      body.pose = pose * pose_in(link.SemanticPose(), "");
      body.rigid = KAZ_TRY(rigid_of(link, name + "/" + link.Name(), options));
      if (i == 0) body.kicks = kicks_of(model);
      body_of[name + "::" + link.Name()] = static_cast<int>(out.bodies.size());
      out.bodies.push_back(std::move(body));
    }
    for (std::uint64_t i = 0; i < model.JointCount(); ++i)
      joints.push_back({model.JointByIndex(i), name, pose});
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i)
      KAZ_TRY(add(*model.ModelByIndex(i), name, pose, fixed));
    return {};
  }
};

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find(' ', at), text.size());
    if (end > at) words.push_back(text.substr(at, end - at));
  }
  return words;
}

// First line of a message.
std::string line_of(const std::string& message) {
  return message.substr(0, message.find('\n'));
}

// One of the parser's errors: the first with a line number, as that is the most precise. `has_lines`: lines
// are those of the file `path`.
tl::unexpected<Error> first_of(const sdf::Errors& errors, const std::string& path,
                               bool has_lines = true) {
  for (const sdf::Error& e : errors) {
    if (has_lines && e.LineNumber())
      return fail(Fault::usage,
                  path + ":" + std::to_string(*e.LineNumber()) + ": " + line_of(e.Message()));
  }
  return fail(Fault::usage, path + ": " + line_of(errors.front().Message()));
}

sdf::ParserConfig parser_config(bool is_recent) {
  sdf::ParserConfig config;
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  // Older versions permit names that are not unique.
  config.SetWarningsPolicy(is_recent ? sdf::EnforcementPolicy::ERR : sdf::EnforcementPolicy::LOG);
  config.SetDeprecatedElementsPolicy(is_recent ? sdf::EnforcementPolicy::ERR
                                               : sdf::EnforcementPolicy::LOG);
  // No external resources: no model paths, no downloads.
  config.SetFindCallback([](const std::string&) { return std::string(); });
  return config;
}

// Parses the texts of check_sdf() and puts the included models in place.
struct SdfParser {
  const CheckedSdf& checked;
  sdf::ParserConfig config = parser_config(checked.is_recent);
  std::string schema = sdf_schema(checked.is_plain && checked.models.empty(), checked.nesting);

  Result<sdf::SDFPtr> parse(const std::string& path, const std::string& text) const {
    auto parsed = std::make_shared<sdf::SDF>();
    sdf::Errors errors;
    // Not into the SDFPtr: on an error, libsdformat would then try to read the text as a URDF.
    if (!sdf::initString(schema, parsed) ||
        !sdf::readString(text, config, parsed->Root(), errors)) {
      if (!errors.empty()) return first_of(errors, path);
      return fail(Fault::usage, path + ": the SDF parser rejects it without a reason");
    }
    if (!errors.empty()) return first_of(errors, path);
    KAZ_TRY(expand(parsed->Root()));
    return parsed;
  }

  // Puts included models in their places below `element`.
  Result<void> expand(const sdf::ElementPtr& element) const {
    for (auto e = element->GetFirstElement(); e; e = e->GetNextElement()) {
      if (e->GetName() == "world") KAZ_TRY(expand(e));
      if (e->GetName() != "model") continue;
      if (e->HasElement(kIncludePlace))
        KAZ_TRY(fill(e));
      else
        KAZ_TRY(expand(e));
    }
    return {};
  }

  // As libsdformat does it: parts of the <include> replace those of the model.
  Result<void> fill(const sdf::ElementPtr& model) const {
    const sdf::ElementPtr place = model->GetElement(kIncludePlace);
    const auto index = std::stoul(place->GetAttribute("file")->GetAsString());
    const IncludedText& file = checked.models.at(index);
    const auto parsed = KAZ_TRY(parse(file.path, file.text));
    const sdf::ElementPtr included = parsed->Root()->GetElement("model");
    model->RemoveChild(place);
    const bool has_pose = model->HasElement("pose"), is_static = model->HasElement("static");
    for (const char* name : {"canonical_link", "placement_frame"}) {
      const std::string own = model->Get<std::string>(name);
      if (own.empty()) model->GetAttribute(name)->SetFromString(included->Get<std::string>(name));
    }
    for (auto e = included->GetFirstElement(); e; e = e->GetNextElement()) {
      if ((e->GetName() == "pose" && has_pose) || (e->GetName() == "static" && is_static)) continue;
      const sdf::ElementPtr copy = e->Clone();
      copy->SetParent(model);
      model->InsertElement(copy);
    }
    return {};
  }
};

Result<void> read_world(const sdf::World& world, const CheckedSdf& checked,
                        const ReadOptions& options, WorldModel& out) {
  out.gravity = from_sdf(world.Gravity());
  if (world.Element()->HasElement("kaz:robot")) {
    const sdf::ElementPtr robot = world.Element()->GetElement("kaz:robot");
    const auto p = own_numbers(robot, "pose", 6);
    out.robot_start = from_sdf(ignition::math::Pose3d(p[0], p[1], p[2], p[3], p[4], p[5]));
    out.pushes = pushes_of(robot, out.robot_start);
    if (const auto feet = robot->GetAttribute("first_step"); feet)
      out.feet = words_of(feet->GetAsString());
  }
  if (world.Element()->HasElement("kaz:light")) {
    const sdf::ElementPtr e = world.Element()->GetElement("kaz:light");
    const auto to_lamp = own_numbers(e, "to_lamp", 3);
    out.light = {{to_lamp[0], to_lamp[1], to_lamp[2]},
                 own_numbers(e, "lamp", 1).front(),
                 own_numbers(e, "shade", 1).front()};
  } else if (checked.to_lamp) {
    out.light.to_key = *checked.to_lamp;
  }
  ModelReader reader{options, out};
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i)
    KAZ_TRY(reader.add(*world.ModelByIndex(i), "", Eigen::Isometry3d::Identity(), false));
  return add_joints(reader.joints, reader.body_of, out);
}

}  // namespace

Result<WorldModel> load_world(const std::string& sdf_path, const ReadOptions& options) {
  const CheckedSdf checked = KAZ_TRY(check_sdf(sdf_path, options));
  // The parser also prints its errors: silence it.
  sdf::Console::Instance()->SetQuiet(true);
  try {
    const SdfParser parser{checked};
    const auto parsed = KAZ_TRY(parser.parse(sdf_path, checked.text));
    sdf::Root root;
    if (const sdf::Errors errors = root.Load(parsed, parser.config); !errors.empty())
      return first_of(errors, sdf_path, checked.models.empty());
    WorldModel out;
    out.notes = checked.notes;
    if (const auto read = read_world(*root.WorldByIndex(0), checked, options, out); !read)
      return fail(Fault::usage, sdf_path + ": " + read.error().message);
    return out;
  } catch (const std::exception& thrown) {
    return fail(Fault::usage, sdf_path + ": the SDF parser rejects it: " + line_of(thrown.what()));
  }
}

}  // namespace kaz::sim
