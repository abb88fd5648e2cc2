// Links of SDF: mass, collision shapes, visuals.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_link.h"

#include <initializer_list>
#include <utility>

#include "sim/body/description/mesh_collision.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

constexpr double kLargestDrawn = 9000;  // m

// Value of a descendant such as friction/ode/mu, or `otherwise` where the file has none.
double value_at(sdf::ElementPtr element, std::initializer_list<const char*> path,
                double otherwise) {
  for (const char* name : path) {
    if (!element || !element->HasElement(name)) return otherwise;
    element = element->GetElement(name);
  }
  return element->Get<double>();
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
    case sdf::GeometryType::MESH:  // check_sdf() made the path absolute
      shape.kind = Shape::Kind::mesh;
      shape.size = from_sdf(geometry.MeshShape()->Scale());
      shape.mesh_path = geometry.MeshShape()->Uri();
      break;
    default:
      shape.kind = Shape::Kind::box;
      shape.size = from_sdf(geometry.BoxShape()->Size());
      break;
  }
  return shape;
}

// Our planes have their normal along z.
Eigen::Isometry3d turn_of(const sdf::Geometry& geometry) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  if (geometry.Type() == sdf::GeometryType::PLANE) {
    turn.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                       from_sdf(geometry.PlaneShape()->Normal()))
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
        own_numbers(e->GetElement("kaz:rolling_resistance"), "metres", 1).front();
  }
  return surface;
}

Visual look_of(const sdf::Visual& visual, const std::string& link) {
  Visual look;
  look.name = link + "/" + visual.Name();
  look.shape = shape_of(*visual.Geom());
  // The renderer's limit. A larger ground plane ends beyond the horizon.
  if (look.shape.kind == Shape::Kind::plane)
    look.shape.size = look.shape.size.cwiseMin(kLargestDrawn);
  look.in_frame = pose_in(visual.SemanticPose(), "") * turn_of(*visual.Geom());
  if (const sdf::Material* material = visual.Material()) {
    const auto& color = material->Diffuse();
    look.color = {color.R(), color.G(), color.B()};
  }
  if (visual.Element()->HasElement("kaz:texture")) {
    look.texture = visual.Element()->GetElement("kaz:texture")->GetAttribute("name")->GetAsString();
  }
  return look;
}

Result<CollisionShape> collision_of(const sdf::Collision& collision, const ReadOptions& options) {
  CollisionShape out{pose_in(collision.SemanticPose(), "") * turn_of(*collision.Geom()),
                     shape_of(*collision.Geom()), surface_of(collision.Element())};
  const sdf::ElementPtr e = collision.Element();
  out.mask =
      static_cast<std::uint16_t>(value_at(e, {"surface", "contact", "collide_bitmask"}, out.mask));
  if (out.shape.kind != Shape::Kind::mesh) return out;
  auto around = KAZ_TRY(mesh_collision(out.shape.mesh_path, out.shape.size, options.mesh_collision));
  out.shape = std::move(around.shape);
  out.in_link = out.in_link * around.in_link;
  return out;
}

}  // namespace

Eigen::Vector3d from_sdf(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

Eigen::Isometry3d from_sdf(const ignition::math::Pose3d& p) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const auto& q = p.Rot();
  out.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized().toRotationMatrix();
  out.translation() = from_sdf(p.Pos());
  return out;
}

// check_sdf() and sdf::Root::Load() accepted all names of frames.
Eigen::Isometry3d pose_in(const sdf::SemanticPose& pose, const std::string& scope) {
  if (pose.RelativeTo().empty()) return from_sdf(pose.RawPose());
  ignition::math::Pose3d resolved = pose.RawPose();
  (void)pose.Resolve(resolved, scope);
  return from_sdf(resolved);
}

std::vector<double> own_numbers(const sdf::ElementPtr& element, const char* attribute,
                                std::size_t count) {
  return parse_numbers(element->GetAttribute(attribute)->GetAsString(), count).value();
}

Result<RigidLink> rigid_of(const sdf::Link& link, const std::string& name,
                           const ReadOptions& options) {
  RigidLink rigid;
  rigid.name = name;
  const ignition::math::Inertiald& in = link.Inertial();
  const ignition::math::Matrix3d tensor = in.Moi();
  rigid.mass = in.MassMatrix().Mass();
  rigid.com = from_sdf(in.Pose().Pos());
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      rigid.inertia(r, c) = tensor(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
    }
  }
  for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
    rigid.collisions.push_back(KAZ_TRY(collision_of(*link.CollisionByIndex(i), options)));
  }
  for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
    rigid.visuals.push_back(look_of(*link.VisualByIndex(i), name));
  }
  return rigid;
}

}  // namespace kaz::sim
