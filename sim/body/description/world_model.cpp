// The robot's environment as the SDF world describes it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_model.h"

#include <algorithm>
#include <exception>
#include <memory>

#include <sdf/sdf.hh>

#include "sim/body/description/sdf_check.h"
#include "sim/body/description/sdf_schema.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

Eigen::Vector3d vector_of(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

Eigen::Isometry3d pose_of(const ignition::math::Pose3d& p) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const auto& q = p.Rot();
  out.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized().toRotationMatrix();
  out.translation() = vector_of(p.Pos());
  return out;
}

// Value of a descendant such as friction/ode/mu, or `otherwise` where the file has none.
double value_at(sdf::ElementPtr element, std::initializer_list<const char*> path,
                double otherwise) {
  for (const char* name : path) {
    if (!element || !element->HasElement(name)) return otherwise;
    element = element->GetElement(name);
  }
  return element->Get<double>();
}

// Attributes of our own elements. The parser keeps them as text; check_sdf() has validated them.
std::vector<double> numbers(const sdf::ElementPtr& element, const char* attribute,
                            std::size_t count) {
  return parse_numbers(element->GetAttribute(attribute)->GetAsString(), count).value();
}

Shape shape_of(const sdf::Geometry& geometry) {
  Shape shape;
  switch (geometry.Type()) {
    case sdf::GeometryType::SPHERE:
      shape.kind = Shape::Kind::sphere;
      shape.size.x() = geometry.SphereShape()->Radius();
      break;
    case sdf::GeometryType::CYLINDER:
      shape.kind = Shape::Kind::cylinder;
      shape.size = {geometry.CylinderShape()->Radius(), geometry.CylinderShape()->Length(), 0};
      break;
    case sdf::GeometryType::CAPSULE:
      shape.kind = Shape::Kind::capsule;
      shape.size = {geometry.CapsuleShape()->Radius(), geometry.CapsuleShape()->Length(), 0};
      break;
    case sdf::GeometryType::PLANE:
      shape.kind = Shape::Kind::plane;
      shape.size = {geometry.PlaneShape()->Size().X(), geometry.PlaneShape()->Size().Y(), 0};
      break;
    default:
      shape.kind = Shape::Kind::box;
      shape.size = vector_of(geometry.BoxShape()->Size());
      break;
  }
  return shape;
}

// Our planes have their normal along z.
Eigen::Isometry3d turn_of(const sdf::Geometry& geometry) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  if (geometry.Type() == sdf::GeometryType::PLANE) {
    turn.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                       vector_of(geometry.PlaneShape()->Normal()))
                        .toRotationMatrix();
  }
  return turn;
}

Surface surface_of(const sdf::ElementPtr& collision) {
  Surface surface;
  if (!collision->HasElement("surface")) return surface;
  const sdf::ElementPtr e = collision->GetElement("surface");
  surface.mu = value_at(e, {"friction", "ode", "mu"}, surface.mu);
  surface.softness = value_at(e, {"contact", "ode", "soft_cfm"}, surface.softness);
  surface.restitution = value_at(e, {"bounce", "restitution_coefficient"}, surface.restitution);
  surface.bounce_threshold = value_at(e, {"bounce", "threshold"}, surface.bounce_threshold);
  if (e->HasElement("kaz:rolling_resistance")) {
    surface.rolling_resistance =
        numbers(e->GetElement("kaz:rolling_resistance"), "metres", 1).front();
  }
  return surface;
}

Visual look_of(const sdf::Visual& visual, const std::string& link) {
  Visual look;
  look.name = link + "/" + visual.Name();
  look.shape = shape_of(*visual.Geom());
  look.in_frame = pose_of(visual.RawPose()) * turn_of(*visual.Geom());
  if (const sdf::Material* material = visual.Material()) {
    const auto& color = material->Diffuse();
    look.color = {color.R(), color.G(), color.B()};
  }
  if (visual.Element()->HasElement("kaz:texture")) {
    look.texture = visual.Element()->GetElement("kaz:texture")->GetAttribute("name")->GetAsString();
  }
  return look;
}

std::vector<Kick> kicks_of(const sdf::Model& model) {
  std::vector<Kick> kicks;
  for (auto e = model.Element()->GetFirstElement(); e; e = e->GetNextElement()) {
    if (e->GetName() != "kaz:kick") continue;
    const std::vector<double> v = numbers(e, "velocity", 3);
    kicks.push_back({numbers(e, "time", 1).front(), {v[0], v[1], v[2]}});
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
    const std::vector<double> v = numbers(e, "impulse", 3);
    pushes.push_back({numbers(e, "time", 1).front(), e->GetAttribute("link")->GetAsString(),
                      start.linear() * Eigen::Vector3d(v[0], v[1], v[2])});
  }
  std::stable_sort(pushes.begin(), pushes.end(),
                   [](const Push& a, const Push& b) { return a.time_s < b.time_s; });
  return pushes;
}

RigidLink rigid_of(const sdf::Link& link, const std::string& name) {
  RigidLink rigid;
  rigid.name = name;
  const ignition::math::Inertiald& in = link.Inertial();
  const ignition::math::Matrix3d tensor = in.Moi();
  rigid.mass = in.MassMatrix().Mass();
  rigid.com = vector_of(in.Pose().Pos());
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      rigid.inertia(r, c) = tensor(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
    }
  }
  for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
    const sdf::Collision& collision = *link.CollisionByIndex(i);
    rigid.collisions.push_back({pose_of(collision.RawPose()) * turn_of(*collision.Geom()),
                                shape_of(*collision.Geom()), surface_of(collision.Element())});
  }
  for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
    rigid.visuals.push_back(look_of(*link.VisualByIndex(i), name));
  }
  return rigid;
}

void add(const sdf::Model& model, WorldModel& out) {
  for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
    const sdf::Link& link = *model.LinkByIndex(i);
    WorldBody body;
    body.model = model.Name();
    body.fixed = model.Static();
    body.pose = pose_of(model.RawPose()) * pose_of(link.RawPose());
    body.rigid = rigid_of(link, model.Name() + "/" + link.Name());
    if (i == 0) body.kicks = kicks_of(model);
    out.bodies.push_back(std::move(body));
  }
}

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

// One of the parser's errors: the first with a line number, as that is the most precise.
tl::unexpected<Error> first_of(const sdf::Errors& errors, const std::string& path) {
  for (const sdf::Error& e : errors) {
    if (e.LineNumber()) {
      return fail(Fault::usage,
                  path + ":" + std::to_string(*e.LineNumber()) + ": " + line_of(e.Message()));
    }
  }
  return fail(Fault::usage, path + ": " + line_of(errors.front().Message()));
}

}  // namespace

Result<WorldModel> load_world(const std::string& sdf_path, const ReadOptions& options) {
  (void)options;
  if (const Result<void> ok = check_sdf(sdf_path); !ok) return tl::unexpected(ok.error());
  sdf::ParserConfig config;
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::ERR);
  // No external resources: no model paths, no downloads.
  config.SetFindCallback([](const std::string&) { return std::string(); });
  // The parser also prints its errors: silence it.
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Root root;
  try {
    const auto parsed = std::make_shared<sdf::SDF>();
    sdf::Errors errors;
    if (!sdf::initString(kSdfSchema, parsed) || !sdf::readFile(sdf_path, config, parsed, errors)) {
      if (!errors.empty()) return first_of(errors, sdf_path);
      return fail(Fault::usage, sdf_path +
                                    ": the SDF parser rejects it without a reason; check that "
                                    "<sdf> has version=\"1.9\"");
    }
    for (const sdf::Error& error : root.Load(parsed, config)) errors.push_back(error);
    if (!errors.empty()) return first_of(errors, sdf_path);
  } catch (const std::exception& thrown) {
    return fail(Fault::usage, sdf_path + ": the SDF parser rejects it: " + line_of(thrown.what()));
  }
  const sdf::World& world = *root.WorldByIndex(0);
  WorldModel out;
  out.gravity = vector_of(world.Gravity());
  if (world.Element()->HasElement("kaz:robot")) {
    const sdf::ElementPtr robot = world.Element()->GetElement("kaz:robot");
    const auto p = numbers(robot, "pose", 6);
    out.robot_start = pose_of(ignition::math::Pose3d(p[0], p[1], p[2], p[3], p[4], p[5]));
    out.pushes = pushes_of(robot, out.robot_start);
    if (const auto feet = robot->GetAttribute("first_step"); feet)
      out.feet = words_of(feet->GetAsString());
  }
  if (world.Element()->HasElement("kaz:light")) {
    const sdf::ElementPtr e = world.Element()->GetElement("kaz:light");
    const auto to_lamp = numbers(e, "to_lamp", 3);
    out.light = {{to_lamp[0], to_lamp[1], to_lamp[2]},
                 numbers(e, "lamp", 1).front(),
                 numbers(e, "shade", 1).front()};
  }
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i) add(*world.ModelByIndex(i), out);
  return out;
}

}  // namespace kaz::sim
