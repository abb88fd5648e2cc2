// The robot and its world as MuJoCo's model file.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/mujoco/mujoco_model.h"

#include <initializer_list>
#include <iomanip>
#include <limits>
#include <sstream>

#include <Eigen/Geometry>

namespace kaz::sim::bench {
namespace {

std::string text(std::initializer_list<double> numbers) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const double number : numbers) out << (out.tellp() > 0 ? " " : "") << number;
  return out.str();
}
std::string text(const Eigen::Vector3d& v) {
  return text({v.x(), v.y(), v.z()});
}

std::string place(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return " pos=\"" + text(pose.translation()) + "\" quat=\"" + text({q.w(), q.x(), q.y(), q.z()}) +
         "\"";
}

// Empty for a mesh, which is only drawn, and for a hull, which the compared robots do not have.
std::string shape(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case Shape::Kind::box:
      return R"( type="box" size=")" + text(s / 2) + '"';
    case Shape::Kind::sphere:
      return R"( type="sphere" size=")" + text({s.x()}) + '"';
    case Shape::Kind::cylinder:
      return R"( type="cylinder" size=")" + text({s.x(), s.y() / 2}) + '"';
    case Shape::Kind::capsule:
      return R"( type="capsule" size=")" + text({s.x(), s.y() / 2}) + '"';
    case Shape::Kind::plane:
      return R"( type="plane" size="0 0 1")";
    case Shape::Kind::hull:
    case Shape::Kind::mesh:
      break;
  }
  return "";
}

std::string geoms(const RigidLink& link, const Eigen::Isometry3d& at) {
  std::string all;
  for (const CollisionShape& part : link.collisions) {
    const std::string form = shape(part.shape);
    if (form.empty()) continue;
    // Sliding, torsional and rolling friction; the latter two are moments over the normal force, m.
    const Surface& surface = part.surface;
    const bool rolls = surface.rolling_resistance > 0;
    all += "<geom" + form + place(at * part.in_link) + " condim=\"" + (rolls ? "6" : "3") +
           "\" friction=\"" +
           text({surface.mu, surface.rolling_resistance, surface.rolling_resistance}) + "\"/>\n";
  }
  return all;
}

// Empty for a link without mass, which must be fixed.
std::string inertial(const RigidLink& link) {
  if (link.mass == 0) return "";
  const Eigen::Matrix3d& i = link.inertia;
  return "<inertial pos=\"" + text(link.com) + "\" mass=\"" + text({link.mass}) +
         "\" fullinertia=\"" + text({i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)}) +
         "\"/>\n";
}

std::string joint(const RobotModel& robot, const RobotLink& link, double margin) {
  const RobotJoint& from = robot.joints[static_cast<std::size_t>(link.joint)];
  return "<joint name=\"joint" + std::to_string(link.joint) + "\" axis=\"" +
         text(link.at_zero.linear().transpose() * from.axis) + "\" range=\"" +
         text({from.lower - margin, from.upper + margin}) + "\"/>\n";
}

// The link with all that it carries.
std::string subtree(const RobotModel& robot, std::size_t number, const Eigen::Isometry3d& root,
                    const MujocoSettings& settings) {
  const RobotLink& link = robot.links[number];
  const Eigen::Isometry3d at =
      link.parent < 0
          ? root
          : robot.links[static_cast<std::size_t>(link.parent)].at_zero.inverse() * link.at_zero;
  std::string all = "<body name=\"link" + std::to_string(number) + "\"" + place(at) + ">\n";
  if (link.joint >= 0)
    all += joint(robot, link, settings.stop_margin_rad);
  else if (!settings.fixed_base)
    all += "<freejoint/>\n";
  all += inertial(link.rigid) + geoms(link.rigid, Eigen::Isometry3d::Identity());
  for (std::size_t child = number + 1; child < robot.links.size(); ++child)
    if (robot.links[child].parent == static_cast<int>(number))
      all += subtree(robot, child, root, settings);
  return all + "</body>\n";
}

std::string exemptions(const RobotModel& robot, int generations) {
  std::string all;
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    int up = robot.links[link].parent;
    for (int i = 0; i < generations && up >= 0; ++i) {
      all += "<exclude body1=\"link" + std::to_string(link) + "\" body2=\"link" +
             std::to_string(up) + "\"/>\n";
      up = robot.links[static_cast<std::size_t>(up)].parent;
    }
  }
  return all;
}

}  // namespace

std::string mujoco_model(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const Eigen::Isometry3d& root, const MujocoSettings& settings) {
  const std::string contacts = text({settings.solref[0], settings.solref[1]});
  std::string bodies;
  int moving = 0;
  for (const WorldBody& body : world.bodies) {
    if (body.fixed) {
      bodies += geoms(body.rigid, body.pose);
      continue;
    }
    bodies += "<body name=\"body" + std::to_string(moving++) + "\"" + place(body.pose) +
              "><freejoint/>\n" + inertial(body.rigid) +
              geoms(body.rigid, Eigen::Isometry3d::Identity()) + "</body>\n";
  }
  return "<mujoco model=\"" + robot.name +
         "\">\n<compiler angle=\"radian\"/>\n<option timestep=\"" + text({settings.step_s}) +
         "\" gravity=\"" + text(world.gravity) + "\" impratio=\"" + text({settings.impratio}) +
         "\" cone=\"elliptic\" solver=\"Newton\"/>\n<size njmax=\"2000\" "
         "nconmax=\"500\"/>\n<default>\n" +
         "<joint type=\"hinge\" limited=\"true\" armature=\"" + text({motor.rotor_inertia_kgm2}) +
         "\" damping=\"" + text({motor.back_emf_nms_per_rad}) + "\" frictionloss=\"" +
         text({motor.friction_nm}) + "\" solreflimit=\"" + contacts + "\"/>\n<geom solref=\"" +
         contacts + "\" solimp=\"" + text({settings.solimp[0], settings.solimp[1]}) +
         " 0.001\"/>\n</default>\n<worldbody>\n" + bodies + subtree(robot, 0, root, settings) +
         "</worldbody>\n<contact>\n" + exemptions(robot, settings.exempt_generations) +
         "</contact>\n</mujoco>\n";
}

}  // namespace kaz::sim::bench
