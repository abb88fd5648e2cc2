// A rigid part as the files describe it: mass properties, collision shapes, visual shapes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/rigid_link.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "sim/body/description/convex_hull.h"

namespace kaz::sim {
namespace {

// Parallel-axis theorem: inertia of a point mass at `r`.
Eigen::Matrix3d point_inertia(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

}  // namespace

void weld(RigidLink& link, const RigidLink& part, const Eigen::Isometry3d& in_link) {
  if (part.mass > 0) {
    const Eigen::Vector3d part_com = in_link * part.com;
    const Eigen::Matrix3d part_inertia =
        in_link.linear() * part.inertia * in_link.linear().transpose();
    const double mass = link.mass + part.mass;
    const Eigen::Vector3d com = (link.mass * link.com + part.mass * part_com) / mass;
    link.inertia += point_inertia(link.mass, link.com - com) + part_inertia +
                    point_inertia(part.mass, part_com - com);
    link.com = com;
    link.mass = mass;
  }
  for (CollisionShape shape : part.collisions) {
    shape.in_link = in_link * shape.in_link;
    link.collisions.push_back(shape);
  }
  for (Visual visual : part.visuals) {
    visual.in_frame = in_link * visual.in_frame;
    link.visuals.push_back(visual);
  }
}

Eigen::AlignedBox3d extent(const Shape& shape, const Eigen::Isometry3d& pose) {
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  const Eigen::Matrix3d turn = pose.linear();
  switch (shape.kind) {
    case Shape::Kind::box:
      half = turn.cwiseAbs() * shape.size / 2;
      break;
    case Shape::Kind::sphere:
      half.setConstant(shape.size.x());
      break;
    case Shape::Kind::cylinder: {
      const Eigen::Vector3d axis = turn.col(2);
      const Eigen::Array3d across = (1 - axis.array().square()).max(0).sqrt();
      half = axis.cwiseAbs() * shape.size.y() / 2 + shape.size.x() * across.matrix();
      break;
    }
    case Shape::Kind::capsule:
      half = turn.col(2).cwiseAbs() * shape.size.y() / 2;
      half.array() += shape.size.x();
      break;
    case Shape::Kind::hull: {
      Eigen::AlignedBox3d box;
      for (std::size_t i = 0; i < shape.hull->size(); ++i) box.extend(pose * shape.hull->point(i));
      return box;
    }
    case Shape::Kind::plane:
    case Shape::Kind::mesh:
      return Eigen::AlignedBox3d();
  }
  return Eigen::AlignedBox3d(pose.translation() - half, pose.translation() + half);
}

bool inside(const Shape& shape, const Eigen::Vector3d& p, double depth_m) {
  const double radius = shape.size.x() - depth_m, around = p.head<2>().norm(),
               along = std::abs(p.z()) - shape.size.y() / 2;
  switch (shape.kind) {
    case Shape::Kind::box:
      return (p.cwiseAbs().array() < shape.size.array() / 2 - depth_m).all();
    case Shape::Kind::sphere:
      return p.norm() < radius;
    case Shape::Kind::cylinder:
      return around < radius && along < -depth_m;
    case Shape::Kind::capsule:
      return std::hypot(around, std::max(along, 0.0)) < radius;
    case Shape::Kind::hull: {
      const auto& planes = shape.hull->planes;
      for (std::size_t i = 0; i < planes.size(); i += 4) {
        if (Eigen::Vector3d(planes[i], planes[i + 1], planes[i + 2]).dot(p) >
            planes[i + 3] - depth_m)
          return false;
      }
      return true;
    }
    case Shape::Kind::plane:
    case Shape::Kind::mesh:
      break;
  }
  return false;
}

bool physical(double mass, const Eigen::Matrix3d& inertia, double excess) {
  if (!(mass > 0)) return false;
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  return moments[0] > 0 && moments[2] <= excess * (moments[0] + moments[1]);
}

}  // namespace kaz::sim
