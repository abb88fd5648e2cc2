// Writes a robot model as URDF.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/urdf_writer.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <vector>

#include "shared/base/xml_text.hpp"
#include "sim/body/description/convex_hull.h"
#include "sim/body/description/mjcf_model.h"
#include "sim/body/description/urdf_check.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

namespace fs = std::filesystem;

std::string exact(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string exact(const Eigen::Vector3d& v) {
  return exact(v.x()) + " " + exact(v.y()) + " " + exact(v.z());
}

// A space and name="value", with XML's special characters escaped.
std::string attribute_text(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + xml_text(value) + "\"";
}

// Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll). Roll is computed after yaw is undone, which is exact
// also for a pitch of 90 degrees.
Eigen::Vector3d rpy_of(const Eigen::Matrix3d& r) {
  const double yaw = std::atan2(r(1, 0), r(0, 0)), s = std::sin(yaw), c = std::cos(yaw);
  return {std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1)),
          std::atan2(-r(2, 0), c * r(0, 0) + s * r(1, 0)), yaw};
}

std::string origin_text(const Eigen::Isometry3d& pose) {
  return "<origin" + attribute_text("xyz", exact(pose.translation())) +
         attribute_text("rpy", exact(rpy_of(pose.linear()))) + "/>";
}

class UrdfWriter {
 public:
  UrdfWriter(const RobotModel& robot, std::string folder)
      : robot_(robot), folder_(std::move(folder)) {
    for (const RobotJoint& joint : robot.joints) joint_names_.insert(joint.name);
    for (const auto& [name, frame] : robot.frames) link_names_.insert(name);
  }

  std::string text() {
    text_ = "<?xml version=\"1.0\"?>\n<robot" + attribute_text("name", robot_.name) + ">\n";
    for (const RobotLink& link : robot_.links) add_link(link.rigid);
    for (const RobotJoint& joint : robot_.joints) add_joint(joint);
    for (const auto& [name, frame] : robot_.frames) {
      const std::string& carrier = robot_.links[static_cast<std::size_t>(frame.link)].rigid.name;
      if (name == carrier) continue;
      text_ += "<link" + attribute_text("name", name) + "/>\n";
      add_fixed(carrier, name, frame.in_link);
    }
    return text_ + "</robot>\n";
  }

 private:
  static std::string unused(const std::set<std::string>& names, std::string name) {
    while (names.contains(name)) name += '_';
    return name;
  }

  void add_link(const RigidLink& link) {
    text_ += "<link" + attribute_text("name", link.name) + ">\n";
    if (link.mass > 0) add_inertial(link);
    for (const Visual& look : link.visuals) add_visual(look);
    if (link.collisions.empty()) {
      text_ += "</link>\n";
      return;
    }
    std::set<double> others;
    const double mu = link.collisions.front().surface.mu;
    for (const CollisionShape& shape : link.collisions)
      if (shape.surface.mu != mu) others.insert(shape.surface.mu);
    add_collisions(link, link.name, mu);
    for (const double other : others) {
      const std::string part = unused(link_names_, link.name + "_mu_" + exact(other));
      link_names_.insert(part);
      text_ += "<link" + attribute_text("name", part) + ">\n";
      add_collisions(link, part, other);
      add_fixed(link.name, part, Eigen::Isometry3d::Identity());
    }
  }

  void add_inertial(const RigidLink& link) {
    const Eigen::Matrix3d& i = link.inertia;
    text_ += "<inertial><origin" + attribute_text("xyz", exact(link.com)) + "/><mass" +
             attribute_text("value", exact(link.mass)) + "/><inertia" +
             attribute_text("ixx", exact(i(0, 0))) + attribute_text("ixy", exact(i(0, 1))) +
             attribute_text("ixz", exact(i(0, 2))) + attribute_text("iyy", exact(i(1, 1))) +
             attribute_text("iyz", exact(i(1, 2))) + attribute_text("izz", exact(i(2, 2))) +
             "/></inertial>\n";
  }

  // Adds the shapes with this friction, and ends the link `name`.
  void add_collisions(const RigidLink& link, const std::string& name, double mu) {
    for (const CollisionShape& shape : link.collisions) {
      if (shape.surface.mu != mu) continue;
      Eigen::Isometry3d pose = shape.in_link;
      Shape shown = shape.shape;
      if (shown.kind == Shape::Kind::hull) {
        const HullMesh& mesh = shown.hull->mesh;
        pose.translation() += pose.linear() * mesh.origin;
        shown.mesh_path = mesh.path;
        shown.size = mesh.scale;
      }
      text_ += "<collision>" + origin_text(pose) + geometry_text(shown) + "</collision>\n";
    }
    text_ += "</link>\n";
    if (mu != kRobotSurface.mu)
      text_ += "<gazebo" + attribute_text("reference", name) + "><mu1>" + exact(mu) +
               "</mu1><mu2>" + exact(mu) + "</mu2></gazebo>\n";
  }

  void add_visual(const Visual& look) {
    const std::string name = look.name.substr(look.name.find('/') + 1);
    const std::string rgb = exact(
        Eigen::Vector3d(Eigen::Vector3f(look.color.r, look.color.g, look.color.b).cast<double>()));
    text_ += "<visual" + attribute_text("name", name) + ">" + origin_text(look.in_frame) +
             geometry_text(look.shape) + "<material" + attribute_text("name", "rgb " + rgb) +
             "><color" + attribute_text("rgba", rgb + " 1") + "/></material></visual>\n";
  }

  std::string geometry_text(const Shape& shape) const {
    const std::string radius = attribute_text("radius", exact(shape.size.x())),
                      length = attribute_text("length", exact(shape.size.y()));
    std::string inside;
    if (shape.kind == Shape::Kind::box)
      inside = "<box" + attribute_text("size", exact(shape.size));
    else if (shape.kind == Shape::Kind::sphere)
      inside = "<sphere" + radius;
    else if (shape.kind == Shape::Kind::cylinder)
      inside = "<cylinder" + radius + length;
    else if (shape.kind == Shape::Kind::capsule)
      inside = "<capsule" + radius + length;
    else
      inside = "<mesh" + attribute_text("filename", path_text(shape.mesh_path)) +
               attribute_text("scale", exact(shape.size));
    return "<geometry>" + inside + "/></geometry>";
  }

  // The path relative to the folder if it is in the folder.
  std::string path_text(const std::string& path) const {
    const fs::path relative = fs::path(path).lexically_relative(folder_);
    return relative.empty() || *relative.begin() == ".." ? path : relative.generic_string();
  }

  void add_joint(const RobotJoint& joint) {
    const RobotLink& child = robot_.links[static_cast<std::size_t>(joint.child)];
    const RobotLink& parent = robot_.links[static_cast<std::size_t>(child.parent)];
    const bool limited = std::isfinite(joint.lower) || std::isfinite(joint.upper);
    const bool slides = joint.pinion_m > 0;
    const double radius = slides ? joint.pinion_m : 1;  // from rad to the unit of the file
    const auto side = [radius](double limit) {
      return exact(std::isfinite(limit) ? limit * radius : std::copysign(kStatedUnlimited, limit));
    };
    const auto finite = [](double value) { return exact(std::isfinite(value) ? value : 0); };
    const char* type = slides ? "prismatic" : limited ? "revolute" : "continuous";
    text_ += "<joint" + attribute_text("name", joint.name) + attribute_text("type", type) +
             "><parent" +
             attribute_text("link", parent.rigid.name) + "/><child" +
             attribute_text("link", child.rigid.name) + "/>" +
             origin_text(parent.at_zero.inverse() * child.at_zero) + "<axis" +
             attribute_text("xyz", exact(child.at_zero.linear().transpose() * joint.axis)) +
             "/><limit" +
             (limited || slides ? attribute_text("lower", side(joint.lower)) +
                                      attribute_text("upper", side(joint.upper))
                                : std::string()) +
             attribute_text("effort", finite(joint.effort / radius)) +
             attribute_text("velocity", finite(joint.velocity * radius)) + "/><dynamics" +
             attribute_text("damping", exact(joint.damping / (radius * radius))) +
             attribute_text("friction", exact(joint.friction / radius)) + "/>";
    if (joint.follows) add_mimic(*joint.follows, radius);
    text_ += "</joint>\n";
  }

  // `radius`: of the follower, as in add_joint().
  void add_mimic(const JointCoupling& coupling, double radius) {
    const RobotJoint& leader = robot_.joints[static_cast<std::size_t>(coupling.joint)];
    const double of_leader = leader.pinion_m > 0 ? leader.pinion_m : 1;
    text_ += "<mimic" + attribute_text("joint", leader.name) +
             attribute_text("multiplier", exact(coupling.ratio * radius / of_leader)) +
             attribute_text("offset", exact(coupling.offset * radius)) + "/>";
  }

  void add_fixed(const std::string& parent, const std::string& child,
                 const Eigen::Isometry3d& pose) {
    const std::string name = unused(joint_names_, "fixed_" + child);
    joint_names_.insert(name);
    text_ += "<joint" + attribute_text("name", name) + attribute_text("type", "fixed") +
             "><parent" + attribute_text("link", parent) + "/><child" +
             attribute_text("link", child) + "/>" + origin_text(pose) + "</joint>\n";
  }

  const RobotModel& robot_;
  const std::string folder_;
  std::set<std::string> joint_names_, link_names_;
  std::string text_;
};

}  // namespace

std::string urdf_of(const RobotModel& robot, const std::string& folder) {
  return UrdfWriter(robot, folder).text();
}

Result<std::string> robot_urdf(const std::string& path, const RobotModel* loaded) {
  const auto file = XmlFile::load(path, "");
  if (!file) return tl::unexpected(file.error());
  if (std::string(file->root().Name()) != kMjcfRoot) return file->text();
  const fs::path absolute = fs::absolute(path);
  std::error_code error;
  const std::string folder = fs::canonical(absolute.parent_path(), error).string();
  if (loaded != nullptr) return urdf_of(*loaded, folder);
  const auto robot = KAZ_TRY(load_robot(path, {.skip_missing_meshes = true}));
  return urdf_of(robot, folder);
}

}  // namespace kaz::sim
