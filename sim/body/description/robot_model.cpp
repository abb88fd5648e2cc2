// The robot as its URDF describes it, in the form that the dynamics needs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/robot_model.h"

#include <algorithm>
#include <exception>

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/urdf_check.h"

namespace kaz::sim {
namespace {

// Default softness, with which the gait was repeatable (static sinkage of 0.25 mm). Default friction: above
// that of any floor, so that the floor's counts (the smaller mu of a pair).
constexpr Surface kRobotSurface{.mu = 1.0, .softness = 5e-3};

// check_urdf() accepts a joint of Kaz's table only together with the seventeen others.
bool is_kaz(const std::vector<std::string>& joints) {
  return std::find(joints.begin(), joints.end(), joint_names().front()) != joints.end();
}

Eigen::Vector3d vector_of(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d pose_of(const urdf::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const urdf::Rotation& q = pose.rotation;
  out.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  out.translation() = vector_of(pose.position);
  return out;
}

Shape shape_of(const urdf::Geometry& geometry, const std::string& robot_path) {
  Shape shape;
  switch (geometry.type) {
    case urdf::Geometry::BOX:
      shape.kind = Shape::Kind::box;
      shape.size = vector_of(static_cast<const urdf::Box&>(geometry).dim);
      break;
    case urdf::Geometry::SPHERE:
      shape.kind = Shape::Kind::sphere;
      shape.size.x() = static_cast<const urdf::Sphere&>(geometry).radius;
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      shape.kind = Shape::Kind::cylinder;
      shape.size = {cylinder.radius, cylinder.length, 0};
      break;
    }
    case urdf::Geometry::MESH: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      shape.kind = Shape::Kind::mesh;
      shape.size = vector_of(mesh.scale);
      shape.mesh_path =
          mesh_path(robot_path, mesh.filename).value_or("");  // check_urdf() accepted it
      break;
    }
  }
  return shape;
}

class Reader {
 public:
  Reader(const urdf::ModelInterface& model, UrdfFacts facts, std::string path)
      : model_(model),
        joints_(std::move(facts.revolute)),
        friction_(std::move(facts.friction)),
        path_(std::move(path)) {}

  Result<RobotModel> read() {
    robot_.name = model_.getName();
    robot_.fixed_base = model_.getRoot()->name == kFixedRoot;
    robot_.joints.resize(joints_.size());
    KAZ_TRY(add(*model_.getRoot(), -1, -1, Eigen::Isometry3d::Identity()));
    return std::move(robot_);
  }

 private:
  // `at` is the link's pose in the root's frame at the zero posture.
  Result<void> add(const urdf::Link& link, int parent, int joint, const Eigen::Isometry3d& at) {
    const int index = static_cast<int>(robot_.links.size());
    auto rigid = KAZ_TRY(rigid_of(link));
    robot_.links.push_back({rigid, parent, joint, at});
    robot_.frames[link.name] = {index, Eigen::Isometry3d::Identity()};
    return add_children(link, index, Eigen::Isometry3d::Identity());
  }

  // `in_carrier`: pose of `link` in links[carrier]; that is another link if `link` is welded to it.
  Result<void> add_children(const urdf::Link& link, int carrier,
                            const Eigen::Isometry3d& in_carrier) {
    for (const auto& joint : link.child_joints) {
      const Eigen::Isometry3d in_link =
          in_carrier * pose_of(joint->parent_to_joint_origin_transform);
      const urdf::Link& child = *model_.getLink(joint->child_link_name);
      if (joint->type == urdf::Joint::FIXED) {
        auto part = KAZ_TRY(rigid_of(child));
        weld(robot_.links[static_cast<std::size_t>(carrier)].rigid, part, in_link);
        robot_.frames[child.name] = {carrier, in_link};
        if (auto ok = add_children(child, carrier, in_link); !ok) return ok;
        continue;
      }
      const Eigen::Isometry3d at =
          robot_.links[static_cast<std::size_t>(carrier)].at_zero * in_link;
      const auto number = std::find(joints_.begin(), joints_.end(), joint->name) - joints_.begin();
      RobotJoint& out = robot_.joints[static_cast<std::size_t>(number)];
      out.name = joint->name;
      out.child = static_cast<int>(robot_.links.size());
      out.axis = at.linear() * vector_of(joint->axis).normalized();
      out.lower = joint->limits->lower;
      out.upper = joint->limits->upper;
      if (auto ok = add(child, carrier, static_cast<int>(number), at); !ok) return ok;
    }
    return {};
  }

  Result<RigidLink> rigid_of(const urdf::Link& link) {
    RigidLink rigid;
    rigid.name = link.name;
    if (link.inertial) {
      const urdf::Inertial& in = *link.inertial;
      const Eigen::Isometry3d origin = pose_of(in.origin);
      Eigen::Matrix3d tensor;
      tensor << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
      rigid.mass = in.mass;
      rigid.com = origin.translation();
      rigid.inertia = origin.linear() * tensor * origin.linear().transpose();
    }
    for (const auto& collision : link.collision_array) {
      CollisionShape shape;
      shape.in_link = pose_of(collision->origin);
      shape.shape = shape_of(*collision->geometry, path_);
      shape.surface = kRobotSurface;
      if (const auto mu = friction_.find(link.name); mu != friction_.end())
        shape.surface.mu = mu->second;
      if (shape.shape.kind == Shape::Kind::mesh) {
        return fail(Fault::usage, path_ + ": a collision of link `" + link.name +
                                      "` is a mesh; use boxes, spheres and cylinders instead");
      }
      rigid.collisions.push_back(shape);
    }
    for (const auto& visual : link.visual_array) {
      Visual look;
      const std::string own =
          visual->name.empty() ? std::to_string(rigid.visuals.size()) : visual->name;
      look.name = link.name + "/" + own;
      look.in_frame = pose_of(visual->origin);
      look.shape = shape_of(*visual->geometry, path_);
      if (visual->material) {
        const urdf::Color& color = visual->material->color;
        look.color = {color.r, color.g, color.b};
      }
      rigid.visuals.push_back(look);
    }
    return rigid;
  }

  const urdf::ModelInterface& model_;
  std::vector<std::string>
      joints_;  // names of the revolute joints, in the order of RobotModel::joints
  std::map<std::string, double> friction_;  // by link
  std::string path_;
  RobotModel robot_;
};

}  // namespace

std::vector<std::string> RobotModel::joint_order() const {
  std::vector<std::string> names;
  for (const RobotJoint& joint : joints) names.push_back(joint.name);
  return names;
}

int RobotModel::eyes_link() const {
  const auto left = frames.find("left_eye"), right = frames.find("right_eye");
  if (left == frames.end() || right == frames.end()) return -1;
  return left->second.link == right->second.link ? left->second.link : -1;
}

double RobotModel::mass() const {
  double sum = 0;
  for (const RobotLink& link : links) sum += link.rigid.mass;
  return sum;
}

Eigen::AlignedBox3d RobotModel::extent() const {
  Eigen::AlignedBox3d box;
  for (const RobotLink& link : links) {
    for (const CollisionShape& shape : link.rigid.collisions) {
      box.extend(sim::extent(shape.shape, link.at_zero * shape.in_link));
    }
  }
  return box;
}

Result<RobotModel> load_robot(const std::string& urdf_path) {
  auto facts = KAZ_TRY(check_urdf(urdf_path));
  // The bytes that were checked, in case the file changes meanwhile.
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(facts.text);
  } catch (const std::exception&) {  // treated as a parse error
  }
  if (!model) {
    return fail(Fault::usage, urdf_path + ": the URDF parser rejects it; see its message above");
  }
  const auto& kaz = joint_names();
  if (is_kaz(facts.revolute)) facts.revolute.assign(kaz.begin(), kaz.end());
  return Reader(*model, std::move(facts), urdf_path).read();
}

}  // namespace kaz::sim
