// What stands around the robot, as the SDF world describes it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world_model.h"

#include <algorithm>
#include <set>

#include <sdf/sdf.hh>

#include "sim/body/sdf_check.h"
#include "sim/body/xml_file.h"

namespace kaz::sim {
namespace {

const std::set<std::string> kTextures{"checker", "wood", "carpet"};

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

class Reader {
 public:
  explicit Reader(std::string path) : path_(std::move(path)) {}

  Result<WorldModel> read() {
    sdf::ParserConfig config;
    config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
    config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
    config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::ERR);
    // Nothing is looked for outside the file: no model paths, no downloads.
    config.SetFindCallback([](const std::string&) { return std::string(); });
    sdf::Root root;
    if (const sdf::Errors errors = root.Load(path_, config); !errors.empty()) {
      return first_of(errors);
    }
    if (root.WorldCount() != 1) return error(1, "holds no single <world>");
    const sdf::World& world = *root.WorldByIndex(0);
    out_.gravity = vector_of(world.Gravity());
    if (auto ok = robot_start(world.Element()); !ok) return tl::unexpected(ok.error());
    for (std::uint64_t i = 0; i < world.ModelCount(); ++i) {
      if (auto ok = add(*world.ModelByIndex(i)); !ok) return tl::unexpected(ok.error());
    }
    return std::move(out_);
  }

 private:
  tl::unexpected<Error> error(int line, const std::string& message) const {
    return fail(Fault::usage, path_ + ":" + std::to_string(line) + ": " + message);
  }
  tl::unexpected<Error> error(const sdf::ElementPtr& at, const std::string& message) const {
    return error(at->LineNumber().value_or(1), message);
  }
  tl::unexpected<Error> first_of(const sdf::Errors& errors) const {
    // The parser wraps a precise error in vaguer ones; the precise one knows its line.
    for (const sdf::Error& e : errors) {
      if (e.LineNumber()) return error(*e.LineNumber(), e.Message());
    }
    return error(1, errors.front().Message());
  }

  // Attribute of one of our own elements; the parser keeps those as text.
  Result<std::vector<double>> numbers(const sdf::ElementPtr& element, const char* attribute,
                                      std::size_t count) const {
    const sdf::ParamPtr param = element->GetAttribute(attribute);
    const auto values =
        param ? parse_numbers(param->GetAsString(), count) : std::optional<std::vector<double>>();
    if (!values) {
      return error(element, "<" + element->GetName() + "> needs the attribute `" + attribute +
                                "` with " + std::to_string(count) +
                                (count == 1 ? " number" : " numbers"));
    }
    return *values;
  }

  Result<void> robot_start(const sdf::ElementPtr& world) {
    if (!world->HasElement("kaz:robot")) return {};
    const auto pose = numbers(world->GetElement("kaz:robot"), "pose", 6);
    if (!pose) return tl::unexpected(pose.error());
    const std::vector<double>& p = *pose;
    out_.robot_start = pose_of(ignition::math::Pose3d(p[0], p[1], p[2], p[3], p[4], p[5]));
    return {};
  }

  Result<void> add(const sdf::Model& model) {
    auto kicks = kicks_of(model);
    if (!kicks) return tl::unexpected(kicks.error());
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      WorldBody body;
      body.model = model.Name();
      body.fixed = model.Static();
      body.pose = pose_of(model.RawPose()) * pose_of(link.RawPose());
      body.rigid.name = model.Name() + "/" + link.Name();
      if (i == 0) body.kicks = *kicks;
      const ignition::math::Inertiald& in = link.Inertial();
      const ignition::math::Matrix3d tensor = in.Moi();
      body.rigid.mass = in.MassMatrix().Mass();
      body.rigid.com = vector_of(in.Pose().Pos());
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          body.rigid.inertia(r, c) =
              tensor(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
        }
      }
      if (!body.fixed && !physical(body.rigid.mass, body.rigid.inertia)) {
        return error(link.Element(),
                     "no body can have the mass and inertia of link `" + body.rigid.name + "`");
      }
      for (std::uint64_t c = 0; c < link.CollisionCount(); ++c) {
        const sdf::Collision& collision = *link.CollisionByIndex(c);
        auto shape = shape_of(*collision.Geom(), collision.Element(), body.fixed);
        if (!shape) return tl::unexpected(shape.error());
        CollisionShape out;
        out.in_link = pose_of(collision.RawPose()) * plane_turn(*collision.Geom());
        out.shape = *shape;
        auto surface = surface_of(collision.Element());
        if (!surface) return tl::unexpected(surface.error());
        out.surface = *surface;
        body.rigid.collisions.push_back(out);
      }
      for (std::uint64_t v = 0; v < link.VisualCount(); ++v) {
        auto look = look_of(*link.VisualByIndex(v), body.rigid.name);
        if (!look) return tl::unexpected(look.error());
        body.rigid.visuals.push_back(*look);
      }
      out_.bodies.push_back(std::move(body));
    }
    return {};
  }

  Result<std::vector<Kick>> kicks_of(const sdf::Model& model) const {
    std::vector<Kick> kicks;
    for (auto e = model.Element()->GetFirstElement(); e; e = e->GetNextElement()) {
      if (e->GetName() != "kaz:kick") continue;
      if (model.Static()) {
        return error(e, "model `" + model.Name() + "` is static, so <kaz:kick> cannot move it");
      }
      const auto time = numbers(e, "time", 1);
      if (!time) return tl::unexpected(time.error());
      const auto velocity = numbers(e, "velocity", 3);
      if (!velocity) return tl::unexpected(velocity.error());
      kicks.push_back({time->front(), {(*velocity)[0], (*velocity)[1], (*velocity)[2]}});
    }
    std::stable_sort(kicks.begin(), kicks.end(),
                     [](const Kick& a, const Kick& b) { return a.time_s < b.time_s; });
    return kicks;
  }

  Result<Shape> shape_of(const sdf::Geometry& geometry, const sdf::ElementPtr& at,
                         bool fixed) const {
    Shape shape;
    switch (geometry.Type()) {
      case sdf::GeometryType::BOX:
        shape.kind = Shape::Kind::box;
        shape.size = vector_of(geometry.BoxShape()->Size());
        break;
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
        if (!fixed) return error(at, "a plane can only be part of a static model");
        shape.kind = Shape::Kind::plane;
        shape.size = {geometry.PlaneShape()->Size().X(), geometry.PlaneShape()->Size().Y(), 0};
        break;
      default:
        return error(at, "<geometry> holds no shape");
    }
    return shape;
  }

  // Our planes have their normal along z.
  static Eigen::Isometry3d plane_turn(const sdf::Geometry& geometry) {
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    if (geometry.Type() == sdf::GeometryType::PLANE) {
      turn.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                         vector_of(geometry.PlaneShape()->Normal()))
                          .toRotationMatrix();
    }
    return turn;
  }

  Result<Surface> surface_of(const sdf::ElementPtr& collision) const {
    Surface surface;
    if (!collision->HasElement("surface")) return surface;
    const sdf::ElementPtr e = collision->GetElement("surface");
    surface.mu = value_at(e, {"friction", "ode", "mu"}, surface.mu);
    surface.softness = value_at(e, {"contact", "ode", "soft_cfm"}, surface.softness);
    surface.restitution = value_at(e, {"bounce", "restitution_coefficient"}, surface.restitution);
    surface.bounce_threshold = value_at(e, {"bounce", "threshold"}, surface.bounce_threshold);
    if (e->HasElement("kaz:rolling_resistance")) {
      const sdf::ElementPtr own = e->GetElement("kaz:rolling_resistance");
      const auto rolling = numbers(own, "metres", 1);
      if (!rolling) return tl::unexpected(rolling.error());
      surface.rolling_resistance = rolling->front();
    }
    if (surface.mu < 0 || surface.softness < 0 || surface.restitution < 0 ||
        surface.restitution > 1 || surface.rolling_resistance < 0) {
      return error(e, "<surface> holds a figure below zero or a restitution above one");
    }
    return surface;
  }

  Result<Visual> look_of(const sdf::Visual& visual, const std::string& link) const {
    Visual look;
    look.name = link + "/" + visual.Name();
    auto shape = shape_of(*visual.Geom(), visual.Element(), true);
    if (!shape) return tl::unexpected(shape.error());
    look.shape = *shape;
    look.in_frame = pose_of(visual.RawPose()) * plane_turn(*visual.Geom());
    if (const sdf::Material* material = visual.Material()) {
      const auto& color = material->Diffuse();
      look.color = {color.R(), color.G(), color.B()};
    }
    if (visual.Element()->HasElement("kaz:texture")) {
      const sdf::ElementPtr e = visual.Element()->GetElement("kaz:texture");
      const sdf::ParamPtr name = e->GetAttribute("name");
      look.texture = name ? name->GetAsString() : "";
      if (!kTextures.count(look.texture)) {
        return error(e, "<kaz:texture> names no known texture: checker, wood or carpet");
      }
    }
    return look;
  }

  std::string path_;
  WorldModel out_;
};

}  // namespace

Result<WorldModel> load_world(const std::string& sdf_path) {
  if (const Result<void> ok = check_sdf(sdf_path); !ok) return tl::unexpected(ok.error());
  return Reader(sdf_path).read();
}

}  // namespace kaz::sim
