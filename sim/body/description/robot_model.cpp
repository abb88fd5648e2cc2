// The robot as its URDF describes it, in the form that the dynamics needs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/robot_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/mesh_collision.h"
#include "sim/body/description/mjcf_model.h"
#include "sim/body/description/urdf_check.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

Eigen::Vector3d vector_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

// Rotation by roll, pitch and yaw (rad) about the fixed axes x, y, z, in this order. As in urdfdom, by half
// angles.
Eigen::Quaterniond rotation_of(const std::vector<double>& rpy) {
  const double r = rpy[0] / 2, p = rpy[1] / 2, y = rpy[2] / 2;
  return Eigen::Quaterniond(
             std::cos(r) * std::cos(p) * std::cos(y) + std::sin(r) * std::sin(p) * std::sin(y),
             std::sin(r) * std::cos(p) * std::cos(y) - std::cos(r) * std::sin(p) * std::sin(y),
             std::cos(r) * std::sin(p) * std::cos(y) + std::sin(r) * std::cos(p) * std::sin(y),
             std::cos(r) * std::cos(p) * std::sin(y) - std::sin(r) * std::sin(p) * std::cos(y))
      .normalized();
}

// The pose of <origin> in `parent`: translation xyz after the rotation rpy or quat_xyzw.
Eigen::Isometry3d pose_of(const Element& parent) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const Element* origin = parent.FirstChildElement("origin");
  if (origin == nullptr) return out;
  if (const auto xyz = numbers_of(*origin, "xyz", 3); !xyz.empty())
    out.translation() = vector_of(xyz);
  if (const auto rpy = numbers_of(*origin, "rpy", 3); !rpy.empty())
    out.linear() = rotation_of(rpy).normalized().toRotationMatrix();
  if (const auto q = numbers_of(*origin, "quat_xyzw", 4); !q.empty())
    out.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  return out;
}

Rgb color_of(const Element& material) {
  const Element* color = material.FirstChildElement("color");
  const auto rgba = color == nullptr ? std::vector<double>() : numbers_of(*color, "rgba", 4);
  if (rgba.empty()) return {};
  return {static_cast<float>(rgba[0]), static_cast<float>(rgba[1]), static_cast<float>(rgba[2])};
}

class Reader {
 public:
  Reader(const Urdf& urdf, const ReadOptions& options)
      : urdf_(urdf), options_(options), shapes_(options.mesh_collision) {}

  Result<RobotModel> read() {
    const char* name = urdf_.file.root().Attribute("name");
    robot_.name = name == nullptr ? "robot" : name;
    robot_.fixed_base = urdf_.root == kFixedRoot;
    robot_.notes = urdf_.notes;
    for (const Element* joint : urdf_.joints) {
      children_[joint->FirstChildElement("parent")->Attribute("link")].push_back(joint);
      if (urdf_.has_motor(*joint)) joints_.emplace_back(joint->Attribute("name"));
    }
    // The order of links does not depend on the order in the file.
    for (auto& [parent, joints] : children_)
      std::ranges::sort(joints, {},
                        [](const Element* e) { return std::string(e->Attribute("name")); });
    const auto& kaz = joint_names();
    if (std::ranges::is_permutation(joints_, kaz)) joints_.assign(kaz.begin(), kaz.end());
    for (const Element* joint : urdf_.joints) {
      if (urdf_.moves(*joint) && !urdf_.has_motor(*joint))
        joints_.emplace_back(joint->Attribute("name"));
    }
    robot_.joints.resize(joints_.size());
    KAZ_TRY(add(urdf_.root, -1, -1, Eigen::Isometry3d::Identity()));
    KAZ_TRY(couple());
    if (options_.body) KAZ_TRY(check_masses());
    return std::move(robot_);
  }

 private:
  // `at` is the link's pose in the root's frame at the zero posture.
  Result<void> add(const std::string& link, int parent, int joint, const Eigen::Isometry3d& at) {
    const int index = static_cast<int>(robot_.links.size());
    auto rigid = KAZ_TRY(rigid_of(link));
    robot_.links.push_back({std::move(rigid), parent, joint, at});
    robot_.frames[link] = {index, Eigen::Isometry3d::Identity()};
    return add_children(link, index, Eigen::Isometry3d::Identity());
  }

  // `in_carrier`: pose of `link` in links[carrier]; that is another link if `link` is welded to it.
  Result<void> add_children(const std::string& link, int carrier,
                            const Eigen::Isometry3d& in_carrier) {
    for (const Element* joint : children_[link]) {
      const Eigen::Isometry3d in_link = in_carrier * pose_of(*joint);
      const std::string child = joint->FirstChildElement("child")->Attribute("link");
      if (!urdf_.moves(*joint)) {
        const auto part = KAZ_TRY(rigid_of(child));
        weld(robot_.links[static_cast<std::size_t>(carrier)].rigid, part, in_link);
        robot_.frames[child] = {carrier, in_link};
        KAZ_TRY(add_children(child, carrier, in_link));
        continue;
      }
      const Eigen::Isometry3d at =
          robot_.links[static_cast<std::size_t>(carrier)].at_zero * in_link;
      const int number = number_of_joint(joint->Attribute("name"));
      RobotJoint& out = robot_.joints[static_cast<std::size_t>(number)];
      out = joint_of(*joint, at);
      out.child = static_cast<int>(robot_.links.size());
      KAZ_TRY(add(child, carrier, number, at));
    }
    return {};
  }

  int number_of_joint(const std::string& name) const {
    return static_cast<int>(std::ranges::find(joints_, name) - joints_.begin());
  }

  Result<void> couple() {
    for (const auto& [name, mimic] : urdf_.mimics)
      set_coupling(robot_.joints, number_of_joint(name),
                  {number_of_joint(mimic.joint), mimic.ratio, mimic.offset});
    const auto stuck = narrow_for_followers(robot_.joints);
    if (!stuck) return {};
    const RobotJoint& follower = robot_.joints[*stuck];
    const Element* mimic =
        urdf_.joint_to.at(robot_.links[static_cast<std::size_t>(follower.child)].rigid.name)
            ->FirstChildElement("mimic");
    return urdf_.file.error(
        *mimic, "the limits of joint `" + follower.name + "` leave no range to joint `" +
                    urdf_.mimics.at(follower.name).joint +
                    "`, which it follows; correct limits, multiplier or offset");
  }

  static RobotJoint joint_of(const Element& joint, const Eigen::Isometry3d& at) {
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    RobotJoint out;
    out.name = joint.Attribute("name");
    const Element* axis = joint.FirstChildElement("axis");
    const auto xyz = axis == nullptr ? std::vector<double>() : numbers_of(*axis, "xyz", 3);
    out.axis = at.linear() * (xyz.empty() ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                                          : vector_of(xyz).normalized());
    const Element* limit = joint.FirstChildElement("limit");
    const auto limit_of = [&](const char* name, double otherwise) {
      return limit == nullptr ? otherwise : number_of(*limit, name, otherwise);
    };
    const bool continuous = joint.Attribute("type", "continuous") != nullptr;
    const auto side = [&](const char* name, double otherwise) {
      const double stated = limit_of(name, 0);
      return continuous || std::abs(stated) >= kStatedUnlimited ? otherwise : stated;
    };
    out.lower = side("lower", -kNoLimit);
    out.upper = side("upper", kNoLimit);
    // Exporters write 0 for limits that nobody has stated.
    const double velocity = limit_of("velocity", 0), effort = limit_of("effort", 0);
    out.velocity = velocity > 0 ? velocity : kNoLimit;
    out.effort = effort > 0 ? effort : kNoLimit;
    if (const Element* dynamics = joint.FirstChildElement("dynamics")) {
      out.damping = number_of(*dynamics, "damping", 0);
      out.friction = number_of(*dynamics, "friction", 0);
    }
    if (joint.Attribute("type", "prismatic") != nullptr) {
      out.pinion_m = pinion_radius(out.lower, out.upper);
      convert_to_pinion(out);
    }
    return out;
  }

  Result<RigidLink> rigid_of(const std::string& name) {
    RigidLink rigid;
    rigid.name = name;
    if (!options_.body) return rigid;
    const Element& link = *urdf_.links.at(name);
    if (const Element* inertial = link.FirstChildElement("inertial")) add_mass(*inertial, rigid);
    if (const auto scale = urdf_.inertia_scales.find(name); scale != urdf_.inertia_scales.end())
      rigid.inertia *= scale->second;
    for (const Element* e = link.FirstChildElement("collision"); e;
         e = e->NextSiblingElement("collision"))
      KAZ_TRY(add_collision(*e, rigid));
    for (const Element* e = link.FirstChildElement("visual"); e;
         e = e->NextSiblingElement("visual"))
      add_visual(*e, rigid);
    return rigid;
  }

  static void add_mass(const Element& inertial, RigidLink& rigid) {
    const Element* mass = inertial.FirstChildElement("mass");
    const Element* inertia = inertial.FirstChildElement("inertia");
    const double value = mass == nullptr ? 0 : number_of(*mass, "value", 0);
    if (value < kLightestLink) return;
    const Eigen::Isometry3d origin = pose_of(inertial);
    rigid.mass = value;
    rigid.com = origin.translation();
    if (inertia != nullptr)
      rigid.inertia = origin.linear() * tensor_of(*inertia) * origin.linear().transpose();
  }

  // Shape of a visual or collision. A mesh that does not exist has none.
  std::optional<Shape> shape_of(const Element& parent) const {
    const Element* geometry = parent.FirstChildElement("geometry");
    const Element* e = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (e == nullptr || urdf_.shapeless.contains(e)) return std::nullopt;
    const std::string kind = e->Name();
    Shape shape;
    if (kind == "box") {
      shape.kind = Shape::Kind::box;
      shape.size = vector_of(numbers_of(*e, "size", 3));
    } else if (kind == "mesh") {
      shape.kind = Shape::Kind::mesh;
      const auto scale = numbers_of(*e, "scale", 3);
      shape.size = scale.empty() ? Eigen::Vector3d(Eigen::Vector3d::Ones()) : vector_of(scale);
      // check_urdf() accepted the path
      shape.mesh_path = mesh_path(urdf_.file.path(), e->Attribute("filename")).value_or("");
    } else {
      shape.kind = kind == "sphere"     ? Shape::Kind::sphere
                   : kind == "cylinder" ? Shape::Kind::cylinder
                                        : Shape::Kind::capsule;
      shape.size = {number_of(*e, "radius", 0), number_of(*e, "length", 0), 0};
    }
    return shape;
  }

  Result<void> add_collision(const Element& e, RigidLink& rigid) {
    const auto found = shape_of(e);
    if (!found) return {};
    CollisionShape shape;
    if (found->kind == Shape::Kind::mesh)
      shape = KAZ_TRY(shapes_.around(found->mesh_path, found->size));
    else
      shape.shape = *found;
    shape.in_link = pose_of(e) * shape.in_link;
    shape.surface = kRobotSurface;
    if (const auto mu = urdf_.friction.find(rigid.name); mu != urdf_.friction.end())
      shape.surface.mu = mu->second;
    rigid.collisions.push_back(std::move(shape));
    return {};
  }

  void add_visual(const Element& e, RigidLink& rigid) const {
    const auto shape = shape_of(e);
    if (!shape) return;
    Visual look;
    const char* name = e.Attribute("name");
    look.name = rigid.name + "/" +
                (name == nullptr || *name == '\0' ? std::to_string(rigid.visuals.size())
                                                  : std::string(name));
    look.in_frame = pose_of(e);
    look.shape = *shape;
    if (const Element* material = e.FirstChildElement("material")) look.color = color(*material);
    rigid.visuals.push_back(std::move(look));
  }

  // A material without a color is defined elsewhere in the file, under the same name.
  Rgb color(const Element& material) const {
    const char* name = material.Attribute("name");
    if (material.FirstChildElement("color") != nullptr || name == nullptr)
      return color_of(material);
    for (const Element* e = urdf_.file.root().FirstChildElement("material"); e;
         e = e->NextSiblingElement("material")) {
      if (e->Attribute("name", name) != nullptr) return color_of(*e);
    }
    for (const auto& [link, element] : urdf_.links) {
      for (const Element* e = element->FirstChildElement("visual"); e;
           e = e->NextSiblingElement("visual")) {
        const Element* own = e->FirstChildElement("material");
        if (own != nullptr && own->Attribute("name", name) != nullptr &&
            own->FirstChildElement("color") != nullptr)
          return color_of(*own);
      }
    }
    return {};
  }

  // Returns whether a link that hangs on this one by joints has a mass. Then the link may be without.
  bool carries_mass(std::size_t link) const {
    std::vector<bool> below(robot_.links.size());
    for (std::size_t i = link + 1; i < robot_.links.size(); ++i) {
      const auto parent = static_cast<std::size_t>(robot_.links[i].parent);
      below[i] = parent == link || below[parent];
      if (below[i] && robot_.links[i].rigid.mass > 0) return true;
    }
    return false;
  }

  // Each part that can move, with all links that are fixed to it, needs a mass and an inertia.
  Result<void> check_masses() const {
    Objections objections(urdf_.file.path());
    for (std::size_t i = robot_.fixed_base ? 1 : 0; i < robot_.links.size(); ++i) {
      const RigidLink& rigid = robot_.links[i].rigid;
      if (physical(rigid.mass, rigid.inertia, kLargestExcess)) continue;
      if (i > 0 && rigid.mass == 0 && carries_mass(i)) continue;
      objections.add(
          urdf_.links.at(rigid.name)->GetLineNum(),
          rigid.mass > 0
              ? "link `" + rigid.name +
                    "` moves but its inertia is zero; give the moments of inertia"
              : "link `" + rigid.name + "` moves but has no mass; give an <inertial>" +
                    (i == 0 ? ", or name the link `world` to fix the robot in place" : ""));
    }
    return objections.result();
  }

  const Urdf& urdf_;
  const ReadOptions& options_;
  std::map<std::string, std::vector<const Element*>>
      children_;                     // joints, by the name of their parent
  std::vector<std::string> joints_;  // names of turning joints, in the order of RobotModel::joints
  MeshShapes shapes_;
  RobotModel robot_;
};

}  // namespace

std::vector<std::string> RobotModel::joint_order() const {
  std::vector<std::string> names;
  for (const RobotJoint& joint : joints) {
    if (!joint.follows) names.push_back(joint.name);
  }
  return names;
}

std::size_t RobotModel::motors() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(joints, [](const RobotJoint& joint) { return !joint.follows; }));
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

bool RobotModel::is_kaz() const {
  return std::ranges::equal(joint_order(), joint_names());
}

double pinion_radius(double lower_m, double upper_m) {
  constexpr double kUnlimited = 0.01;  // m
  const double range = upper_m - lower_m;
  return std::isfinite(range) && range > 0 ? range / (std::numbers::pi / 2) : kUnlimited;
}

void convert_to_pinion(RobotJoint& joint) {
  const double radius = joint.pinion_m;
  joint.lower /= radius;
  joint.upper /= radius;
  joint.velocity /= radius;
  joint.effort *= radius;
  joint.damping *= radius * radius;
  joint.friction *= radius;
}

void set_coupling(std::vector<RobotJoint>& joints, int follower, const JointCoupling& coupling) {
  const auto radius = [](const RobotJoint& joint) { return joint.pinion_m > 0 ? joint.pinion_m : 1; };
  RobotJoint& joint = joints[static_cast<std::size_t>(follower)];
  const RobotJoint& leader = joints[static_cast<std::size_t>(coupling.joint)];
  joint.follows = {coupling.joint, coupling.ratio * (radius(leader) / radius(joint)),
                   coupling.offset / radius(joint)};
}

Eigen::Isometry3d joint_motion(const RobotJoint& joint, const Eigen::Vector3d& axis, double angle) {
  if (joint.pinion_m > 0)
    return Eigen::Isometry3d(Eigen::Translation3d(joint.pinion_m * angle * axis));
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle, axis));
}

std::optional<std::size_t> narrow_for_followers(std::vector<RobotJoint>& joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const RobotJoint& follower = joints[i];
    if (!follower.follows) continue;
    RobotJoint& leader = joints[static_cast<std::size_t>(follower.follows->joint)];
    const double ratio = follower.follows->ratio, offset = follower.follows->offset;
    const auto [lower, upper] =
        std::minmax({(follower.lower - offset) / ratio, (follower.upper - offset) / ratio});
    leader.lower = std::max(leader.lower, lower);
    leader.upper = std::min(leader.upper, upper);
    leader.velocity = std::min(leader.velocity, follower.velocity / std::abs(ratio));
    leader.effort = std::min(leader.effort, follower.effort * std::abs(ratio));
    if (leader.lower > leader.upper) return i;
  }
  return std::nullopt;
}

Result<RobotModel> load_robot(const std::string& path, const ReadOptions& options) {
  auto file = KAZ_TRY(XmlFile::load(path, ""));
  const std::string root = file.root().Name();
  if (root == kMjcfRoot) return read_mjcf(file, options);
  if (root != "robot")
    return file.error(file.root(),
                      "root element is <" + root + ">, expected <robot> (URDF) or <mujoco> (MJCF)");
  const auto urdf = check_urdf(std::move(file), options);
  if (!urdf) return tl::unexpected(urdf.error());
  return Reader(*urdf, options).read();
}

}  // namespace kaz::sim
