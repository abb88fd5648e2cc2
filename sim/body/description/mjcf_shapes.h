// Shapes of an MJCF robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "sim/body/description/mesh_collision.h"
#include "sim/body/description/mjcf_compile.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

// Numbers of a model: a vector, a rotation from a quaternion w x y z, and a pose from both.
Eigen::Vector3d mjcf_vector(const double* numbers);
Eigen::Matrix3d mjcf_rotation(const double* quaternion);
Eigen::Isometry3d mjcf_pose(const double* position, const double* quaternion);

// Reads the shapes of bodies. A geom is a collision shape unless `contype` and `conaffinity` are 0. It is a
// visual if it is not transparent and its group is 0, 1 or 2. MuJoCo's viewer draws the same groups. Planes
// of the world are notes. Objections: other planes, ellipsoids that collide, and sizes above 10 m.
class MjcfShapes {
 public:
  MjcfShapes(const Mjcf& mjcf, const CompiledMjcf& compiled, const ReadOptions& options,
             Objections& objections)
      : mjcf_(mjcf),
        compiled_(compiled),
        model_(*compiled.model),
        objections_(objections),
        shapes_(options.mesh_collision) {}

  // Adds the shapes of `body` to `rigid`, in the frame of the body. Errors: an invalid mesh file.
  Result<void> add(int body, RigidLink& rigid, std::vector<FileNote>& notes);

 private:
  Result<void> add_geom(int geom, RigidLink& rigid);
  Result<void> add_primitive(int geom, RigidLink& rigid);
  Result<void> add_mesh(int geom, const MjcfMesh& mesh, RigidLink& rigid);
  const tinyxml2::XMLElement& element_of(int geom) const;
  void add_collision(int geom, CollisionShape shape, RigidLink& rigid) const;
  void add_visual(int geom, Shape shape, RigidLink& rigid) const;
  bool collides(int geom) const;
  bool is_drawn(int geom) const;
  Rgb color_of(int geom) const;
  void object(int geom, const std::string& text);

  const Mjcf& mjcf_;
  const CompiledMjcf& compiled_;
  const mjModel_& model_;
  Objections& objections_;
  MeshShapes shapes_;
};

}  // namespace kaz::sim
