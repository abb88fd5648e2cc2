// Makes a robot model from a compiled MJCF file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_model.h"

#include <set>

#include <mujoco/mjmodel.h>

#include "sim/body/description/mjcf_compile.h"
#include "sim/body/description/mjcf_joints.h"
#include "sim/body/description/mjcf_shapes.h"
#include "sim/body/description/urdf_check.h"

namespace kaz::sim {
namespace {

// Bounds against wrong units, such as millimeters for meters.
constexpr double kLargestBody = 10;    // m
constexpr double kHeaviestBody = 500;  // kg
constexpr int kMaxBodies = 500;

class MjcfReader {
 public:
  MjcfReader(const Mjcf& mjcf, const CompiledMjcf& compiled, const ReadOptions& options)
      : mjcf_(mjcf),
        compiled_(compiled),
        model_(*compiled.model),
        options_(options),
        objections_(mjcf.source.path()),
        shapes_(mjcf, compiled, options, objections_),
        place_(static_cast<std::size_t>(model_.nbody)) {}

  Result<RobotModel> read() {
    const char* name = mjcf_.source.root().Attribute("model");
    robot_.name = name == nullptr || *name == '\0' ? "robot" : name;
    robot_.notes = mjcf_.notes;
    if (model_.nbody > kMaxBodies)
      objections_.add(mjcf_.source.root().GetLineNum(), "<mujoco> has more than 500 bodies");
    else
      find_robot();
    KAZ_TRY(objections_.result());
    if (robot_.fixed_base) KAZ_TRY(add_world());
    for (int body = 1; body < model_.nbody; ++body)
      if (in_robot_[static_cast<std::size_t>(body)]) KAZ_TRY(add(body));
    add_sites();
    MjcfJoints(mjcf_, compiled_, objections_).finish(robot_);
    if (options_.body) check_bodies();
    KAZ_TRY(objections_.result());
    if (options_.strict) KAZ_TRY(check_notes());
    return std::move(robot_);
  }

 private:
  // Pose of a body in the frame of a link.
  struct Place {
    int link = 0;
    Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  };

  std::string name_of(int body) const { return model_.names + model_.name_bodyadr[body]; }
  const tinyxml2::XMLElement& element_of(int body) const {
    return *compiled_.bodies.at(name_of(body));
  }
  void object(int body, const std::string& text) {
    MjcfSource::object(objections_, element_of(body), text);
  }
  // First joint of a body, or -1.
  int joint_of(int body) const {
    return model_.body_jntnum[body] > 0 ? model_.body_jntadr[body] : -1;
  }
  bool moves(int joint) const {  // a hinge or a slide
    return model_.jnt_type[joint] == mjJNT_HINGE || model_.jnt_type[joint] == mjJNT_SLIDE;
  }
  bool is_free(int body) const {
    return joint_of(body) >= 0 && model_.jnt_type[joint_of(body)] == mjJNT_FREE;
  }

  // Selects the bodies of the robot. The other trees are things in the world.
  void find_robot() {
    const auto count = static_cast<std::size_t>(model_.nbody);
    std::vector<bool> has_hinge(count);  // by the first body of a tree
    std::vector<int> top(count);
    for (int b = 1; b < model_.nbody; ++b) {
      const auto i = static_cast<std::size_t>(b);
      top[i] =
          model_.body_parentid[b] == 0 ? b : top[static_cast<std::size_t>(model_.body_parentid[b])];
      for (int j = 0; j < model_.body_jntnum[b]; ++j)
        if (moves(model_.body_jntadr[b] + j))
          has_hinge[static_cast<std::size_t>(top[i])] = true;
    }
    std::vector<int> roots, floating;
    for (int b = 1; b < model_.nbody; ++b) {
      if (!has_hinge[static_cast<std::size_t>(b)]) continue;
      roots.push_back(b);
      if (is_free(b)) floating.push_back(b);
    }
    if (!floating.empty() && roots.size() > 1)
      object(roots[1], "bodies `" + name_of(roots[0]) + "` and `" + name_of(roots[1]) +
                           "` are two robots; a file has one");
    robot_.fixed_base = floating.empty();
    in_robot_.resize(count);
    for (int b = 1; b < model_.nbody; ++b) {
      const int root = top[static_cast<std::size_t>(b)];
      const bool joined = has_hinge[static_cast<std::size_t>(root)] ||
                          (robot_.fixed_base && model_.body_weldid[root] == 0);
      in_robot_[static_cast<std::size_t>(b)] = joined;
      if (!joined && b == root) note_thing(element_of(b), "body `" + name_of(b) + "`");
    }
    for (int geom = 0; geom < model_.body_geomnum[0] && !robot_.fixed_base; ++geom) {
      const auto e = compiled_.geoms.find(model_.names + model_.name_geomadr[geom]);
      if (e != compiled_.geoms.end()) note_thing(*e->second, mjcf_name(*e->second));
    }
  }

  void note_thing(const tinyxml2::XMLElement& e, const std::string& what) {
    robot_.notes.push_back(mjcf_.source.note(e, what + " of the world (use --world)"));
  }

  Result<void> add_world() {
    RigidLink rigid;
    rigid.name = kFixedRoot;
    KAZ_TRY(add_shapes(0, rigid));
    robot_.links.push_back({std::move(rigid), -1, -1, Eigen::Isometry3d::Identity()});
    robot_.frames[kFixedRoot] = {0, Eigen::Isometry3d::Identity()};
    return {};
  }

  Result<void> add_shapes(int body, RigidLink& rigid) {
    if (!options_.body) return {};
    return shapes_.add(body, rigid, robot_.notes);
  }

  Result<void> add(int body) {
    RigidLink part;
    part.name = name_of(body);
    if (options_.body && model_.body_mass[body] >= kLightestLink) {
      part.mass = model_.body_mass[body];
      part.com = mjcf_vector(model_.body_ipos + 3 * body);
      const Eigen::Matrix3d axes = mjcf_rotation(model_.body_iquat + 4 * body);
      part.inertia =
          axes * mjcf_vector(model_.body_inertia + 3 * body).asDiagonal() * axes.transpose();
    }
    KAZ_TRY(add_shapes(body, part));
    const Place at = is_free(body) ? root_link(part) : carried_by(body, part);
    place_[static_cast<std::size_t>(body)] = at;
    weld(robot_.links[static_cast<std::size_t>(at.link)].rigid, part, at.in_link);
    claim(body, part.name);
    robot_.frames[part.name] = {at.link, at.in_link};
    return {};
  }

  // Reserves the name of a link.
  void claim(int body, const std::string& name) {
    if (!frame_names_.insert(name).second)
      object(body, "the name `" + name + "` is used twice for links; rename the body");
  }

  Place root_link(const RigidLink& part) {
    RigidLink rigid;
    rigid.name = part.name;
    robot_.links.push_back({std::move(rigid), -1, -1, Eigen::Isometry3d::Identity()});
    return {};
  }

  // The place of a body without a joint, or of one with a hinge, which gets a link of its own.
  Place carried_by(int body, const RigidLink& part) {
    const Place& parent = place_[static_cast<std::size_t>(model_.body_parentid[body])];
    const Eigen::Isometry3d in_link =
        parent.in_link * mjcf_pose(model_.body_pos + 3 * body, model_.body_quat + 4 * body);
    Place at{parent.link, in_link};
    const int count = model_.body_jntnum[body];
    for (int i = 0; i < count; ++i) {
      const int number = model_.body_jntadr[body] + i;
      if (moves(number))
        at = link_at(number, part, at, i + 1 == count);
      else
        object(body,
               "body `" + part.name + "` has a ball joint, which is not supported; use hinges");
    }
    return at;
  }

  // The place of a body behind a hinge or a slide. If the body has several joints, the links between them
  // are empty.
  Place link_at(int number, const RigidLink& part, const Place& from, bool is_last) {
    const int parent = from.link;
    const Eigen::Isometry3d& in_parent = from.in_link;
    const Eigen::Vector3d axis = mjcf_vector(model_.jnt_axis + 3 * number);
    const bool slides = model_.jnt_type[number] == mjJNT_SLIDE;
    Eigen::Vector3d at_joint = Eigen::Vector3d::Zero();
    if (!slides) at_joint = mjcf_vector(model_.jnt_pos + 3 * number);
    // The file describes the posture in which each coordinate is `ref`.
    const double back = -model_.qpos0[model_.jnt_qposadr[number]];
    Eigen::Isometry3d to_zero = Eigen::Isometry3d::Identity();
    if (slides)
      to_zero.translation() = back * axis;
    else
      to_zero.linear() = Eigen::AngleAxisd(back, axis).toRotationMatrix();
    RobotLink link;
    link.parent = parent;
    link.joint = static_cast<int>(robot_.joints.size());
    link.at_zero = robot_.links[static_cast<std::size_t>(parent)].at_zero * in_parent *
                   Eigen::Translation3d(at_joint) * to_zero;
    RobotJoint joint;
    joint.name = model_.names + model_.name_jntadr[number];
    joint.child = static_cast<int>(robot_.links.size());
    joint.axis = link.at_zero.linear() * axis;
    if (slides) joint.pinion_m = pinion_of(number);
    link.rigid.name = part.name;
    if (!is_last || !at_joint.isZero(0)) {
      link.rigid.name += "_at_" + joint.name;
      claim(model_.jnt_bodyid[number], link.rigid.name);
    }
    robot_.frames[link.rigid.name] = {joint.child, Eigen::Isometry3d::Identity()};
    robot_.joints.push_back(std::move(joint));
    robot_.links.push_back(std::move(link));
    return {static_cast<int>(robot_.links.size()) - 1,
            Eigen::Isometry3d(Eigen::Translation3d(-at_joint))};
  }

  double pinion_of(int slide) const {
    const bool limited = model_.jnt_limited[slide] != 0;
    const double* range = model_.jnt_range + 2 * slide;
    return limited ? pinion_radius(range[0], range[1]) : pinion_radius(0, 0);
  }

  void add_sites() {
    for (int site = 0; site < model_.nsite; ++site) {
      const std::string name = model_.names + model_.name_siteadr[site];
      const auto body = static_cast<std::size_t>(model_.site_bodyid[site]);
      if (name.empty() || (body > 0 ? !in_robot_[body] : !robot_.fixed_base)) continue;
      const Place& at = place_[body];
      robot_.frames.try_emplace(
          name, RobotFrame{at.link, at.in_link * mjcf_pose(model_.site_pos + 3 * site,
                                                           model_.site_quat + 4 * site)});
    }
  }

  // Each part that can move, with all bodies that are fixed to it, needs a mass and an inertia.
  void check_bodies() {
    for (int body = 1; body < model_.nbody; ++body) {
      if (!in_robot_[static_cast<std::size_t>(body)]) continue;
      const Place& at = place_[static_cast<std::size_t>(body)];
      const RigidLink& rigid = robot_.links[static_cast<std::size_t>(at.link)].rigid;
      const bool is_link = (at.link > 0 || !robot_.fixed_base) && joint_of(body) >= 0;
      if (is_link && !physical(rigid.mass, rigid.inertia))
        object(body, "body `" + name_of(body) +
                         "` moves but has no possible mass and inertia; give an <inertial>");
      if (model_.body_mass[body] > kHeaviestBody)
        object(body, "body `" + name_of(body) + "` has a mass above 500 kg; give it in kg");
      if (mjcf_vector(model_.body_pos + 3 * body).cwiseAbs().maxCoeff() > kLargestBody)
        object(body, "body `" + name_of(body) +
                         "` is more than 10 m away from its parent; give "
                         "its position in m");
    }
  }

  Result<void> check_notes() {
    for (std::size_t i = mjcf_.notes.size(); i < robot_.notes.size(); ++i)
      objections_.add(
          robot_.notes[i].path, robot_.notes[i].line,
          robot_.notes[i].what + " is not used, which --strict does not permit; remove it");
    return objections_.result();
  }

  const Mjcf& mjcf_;
  const CompiledMjcf& compiled_;
  const mjModel& model_;
  const ReadOptions& options_;
  Objections objections_;
  MjcfShapes shapes_;
  std::vector<Place> place_;    // by body
  std::vector<bool> in_robot_;  // by body
  std::set<std::string> frame_names_;
  RobotModel robot_;
};

}  // namespace

Result<RobotModel> read_mjcf(const XmlFile& file, const ReadOptions& options) {
  const auto mjcf = check_mjcf(file, options);
  if (!mjcf) return tl::unexpected(mjcf.error());
  const auto compiled = KAZ_TRY(compile_mjcf(*mjcf, options));
  return MjcfReader(*mjcf, compiled, options).read();
}

}  // namespace kaz::sim
