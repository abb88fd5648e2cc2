// Rays against the triangles of the robot's links.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/own_body.h"

#include <algorithm>
#include <cstddef>

#include "sim/render/model/mesh.h"

namespace kaz::tools {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

constexpr double kNearest_m = 0.008;  // pictures have nothing nearer to the eye

double distance_to_ray(const Vector3d& at, const Vector3d& from, const Vector3d& way) {
  const double along = std::clamp((at - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (from + along * way - at).norm();
}

// Part of `way` at which it enters the triangle from outside; 1 or more if it does not before its end
// (Moeller and Trumbore 1997).
double entered(const Vector3d& from, const Vector3d& way, const Vector3d& corner,
               const Vector3d& second, const Vector3d& third) {
  constexpr double kNever = 2;
  const Vector3d normal = second.cross(third);
  const double against = -normal.dot(way);
  if (!(against > 0)) return kNever;  // from inside, as pictures have it
  const Vector3d off = from - corner, turned = off.cross(way);
  const double u = third.dot(turned), v = -second.dot(turned);
  if (u < 0 || v < 0 || u + v > against) return kNever;
  return normal.dot(off) / against;
}

}  // namespace

Result<OwnBody> OwnBody::make(const sim::Scene& scene, std::span<const std::string> links) {
  OwnBody body;
  for (const sim::Visual& visual : scene.visuals) {
    const std::string& frame = scene.frames[static_cast<std::size_t>(visual.frame)];
    if (std::ranges::find(links, frame) == links.end()) continue;
    const sim::Mesh mesh = KAZ_TRY(sim::make_mesh(visual.shape));
    Part part{.frame = visual.frame,
              .in_frame = visual.in_frame,
              .into = Isometry3d::Identity(),
              .triangles = {}};
    const auto corner = [&](std::size_t i) {
      const auto& p = mesh.vertices[mesh.indices[i]].position;
      return Vector3d(p[0], p[1], p[2]);
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const Vector3d a = corner(i), b = corner(i + 1), c = corner(i + 2);
      part.radius_m = std::max({part.radius_m, a.norm(), b.norm(), c.norm()});
      part.triangles.push_back({a, b - a, c - a});
    }
    body.parts_.push_back(std::move(part));
  }
  return body;
}

void OwnBody::move(const sim::ScenePose& pose, const Isometry3d& from_world) {
  for (Part& part : parts_) {
    const Isometry3d& frame = pose.frames[static_cast<std::size_t>(part.frame)];
    part.into = (from_world * frame * part.in_frame).inverse();
  }
}

bool OwnBody::hides(const Vector3d& eye, const Vector3d& at) const {
  const double nearest = kNearest_m / (at - eye).norm();
  return std::ranges::any_of(parts_, [&](const Part& part) {
    const Vector3d from = part.into * eye, way = part.into.linear() * (at - eye);
    if (distance_to_ray(Vector3d::Zero(), from, way) > part.radius_m) return false;
    return std::ranges::any_of(part.triangles, [&](const Triangle& t) {
      const double where = entered(from, way, t.corner, t.to_second, t.to_third);
      return where > nearest && where < 1;
    });
  });
}

}  // namespace kaz::tools
