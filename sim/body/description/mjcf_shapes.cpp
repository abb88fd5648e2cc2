// Shapes of an MJCF robot: geoms as collision shapes and visuals.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_shapes.h"

#include <algorithm>
#include <optional>

#include <mujoco/mjmodel.h>

#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

constexpr double kLargestGeom = 10;  // m
constexpr int kLastDrawnGroup = 2;
constexpr float kDefaultGray = 0.5f;  // MuJoCo's color of a geom without a color

// Shape of a primitive; nullopt for other types. MuJoCo states half lengths.
std::optional<Shape> mjcf_primitive(int type, const Eigen::Vector3d& size) {
  Shape shape;
  if (type == mjGEOM_BOX) {
    shape.kind = Shape::Kind::box;
    shape.size = 2 * size;
  } else if (type == mjGEOM_SPHERE) {
    shape.kind = Shape::Kind::sphere;
    shape.size = {size.x(), 0, 0};
  } else if (type == mjGEOM_CAPSULE || type == mjGEOM_CYLINDER) {
    shape.kind = type == mjGEOM_CAPSULE ? Shape::Kind::capsule : Shape::Kind::cylinder;
    shape.size = {size.x(), 2 * size.y(), 0};
  } else {
    return std::nullopt;
  }
  return shape;
}

}  // namespace

Eigen::Vector3d mjcf_vector(const double* numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Matrix3d mjcf_rotation(const double* q) {
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

Eigen::Isometry3d mjcf_pose(const double* position, const double* quaternion) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = mjcf_vector(position);
  pose.linear() = mjcf_rotation(quaternion);
  return pose;
}

const tinyxml2::XMLElement& MjcfShapes::element_of(int geom) const {
  return *compiled_.geoms.at(model_.names + model_.name_geomadr[geom]);
}

void MjcfShapes::object(int geom, const std::string& text) {
  MjcfSource::object(objections_, element_of(geom), text);
}

bool MjcfShapes::collides(int geom) const {
  return model_.geom_contype[geom] != 0 || model_.geom_conaffinity[geom] != 0;
}

bool MjcfShapes::is_drawn(int geom) const {
  return model_.geom_rgba[4 * geom + 3] > 0 && model_.geom_group[geom] <= kLastDrawnGroup;
}

Result<void> MjcfShapes::add(int body, RigidLink& rigid, std::vector<FileNote>& notes) {
  for (int i = 0; i < model_.body_geomnum[body]; ++i) {
    const int geom = model_.body_geomadr[body] + i;
    const std::string name = model_.names + model_.name_geomadr[geom];
    if (!compiled_.geoms.contains(name)) continue;  // of the mass only
    if (body == 0 && model_.geom_type[geom] == mjGEOM_PLANE) {
      const tinyxml2::XMLElement& e = element_of(geom);
      notes.push_back(mjcf_.source.note(e, mjcf_name(e) + " of the world (use --world)"));
      continue;
    }
    KAZ_TRY(add_geom(geom, rigid));
  }
  return {};
}

Result<void> MjcfShapes::add_geom(int geom, RigidLink& rigid) {
  if (model_.geom_friction[3 * geom] < 0)
    object(geom, mjcf_name(element_of(geom)) + " has a negative `friction`; correct it");
  if (const char* name = element_of(geom).Attribute("mesh")) {
    const auto mesh = mjcf_.meshes.find(name);
    const bool is_primitive = mjcf_mesh_of(mjcf_.source, element_of(geom)) == nullptr;
    if (mesh != mjcf_.meshes.end() && is_primitive && !mesh->second.path.empty())
      return add_primitive(geom, rigid);
    if (mesh != mjcf_.meshes.end()) return add_mesh(geom, mesh->second, rigid);
    object(geom, "<geom> refers to mesh `" + std::string(name) +
                     "`, which does not exist; check the spelling");
    return {};
  }
  return add_primitive(geom, rigid);
}

Result<void> MjcfShapes::add_primitive(int geom, RigidLink& rigid) {
  const auto shape =
      mjcf_primitive(model_.geom_type[geom], mjcf_vector(model_.geom_size + 3 * geom));
  if (!shape) {
    if (collides(geom))
      object(geom, mjcf_name(element_of(geom)) +
                       " is a plane or an ellipsoid, which is not supported as a collision shape; "
                       "use a box, a capsule or a mesh");
    return {};
  }
  if (shape->size.maxCoeff() > kLargestGeom)
    object(geom, mjcf_name(element_of(geom)) + " is larger than 10 m; give its size in m");
  CollisionShape collision;
  collision.shape = *shape;
  add_collision(geom, std::move(collision), rigid);
  add_visual(geom, *shape, rigid);
  return {};
}

Result<void> MjcfShapes::add_mesh(int geom, const MjcfMesh& mesh, RigidLink& rigid) {
  if (mesh.path.empty()) return {};
  if (collides(geom)) {
    add_collision(geom, KAZ_TRY(shapes_.around(mesh.path, mesh.scale)), rigid);
  }
  Shape shape;
  shape.kind = Shape::Kind::mesh;
  shape.size = mesh.scale;
  shape.mesh_path = mesh.path;
  add_visual(geom, std::move(shape), rigid);
  return {};
}

void MjcfShapes::add_collision(int geom, CollisionShape shape, RigidLink& rigid) const {
  if (!collides(geom)) return;
  shape.in_link =
      mjcf_pose(model_.geom_pos + 3 * geom, model_.geom_quat + 4 * geom) * shape.in_link;
  shape.surface = kRobotSurface;
  // A contact with condim 1 has no friction.
  shape.surface.mu = model_.geom_condim[geom] == 1 ? 0 : model_.geom_friction[3 * geom];
  rigid.collisions.push_back(std::move(shape));
}

void MjcfShapes::add_visual(int geom, Shape shape, RigidLink& rigid) const {
  if (!is_drawn(geom)) return;
  Visual look;
  const char* name = element_of(geom).Attribute("name");
  look.name = rigid.name + "/" +
              (name == nullptr ? std::to_string(rigid.visuals.size()) : std::string(name));
  look.in_frame = mjcf_pose(model_.geom_pos + 3 * geom, model_.geom_quat + 4 * geom);
  look.shape = std::move(shape);
  look.color = color_of(geom);
  rigid.visuals.push_back(std::move(look));
}

Rgb MjcfShapes::color_of(int geom) const {
  const float* rgba = model_.geom_rgba + 4 * geom;
  const bool stated = !(rgba[0] == kDefaultGray && rgba[1] == kDefaultGray &&
                        rgba[2] == kDefaultGray && rgba[3] == 1);
  const int material = model_.geom_matid[geom];
  if (!stated && material >= 0) rgba = model_.mat_rgba + 4 * material;
  return {rgba[0], rgba[1], rgba[2]};
}

}  // namespace kaz::sim
