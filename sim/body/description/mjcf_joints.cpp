// Joints of an MJCF robot: limits, actuators, couplings, order.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <mujoco/mjmodel.h>

#include "sim/body/description/joint_names.h"

namespace kaz::sim {
namespace {

constexpr double kNoMjcfLimit = std::numeric_limits<double>::infinity();
constexpr double kLargestMjcfTurn = 100;  // rad

double largest_of(const double* range) {
  return std::max(std::abs(range[0]), std::abs(range[1]));
}

}  // namespace

MjcfJoints::MjcfJoints(const Mjcf& mjcf, const CompiledMjcf& compiled, Objections& objections)
    : mjcf_(mjcf), model_(*compiled.model), compiled_(compiled), objections_(objections) {}

std::string MjcfJoints::name_of(int joint) const {
  return model_.names + model_.name_jntadr[joint];
}

const tinyxml2::XMLElement& MjcfJoints::element_of(int joint) const {
  const auto named = compiled_.joints.find(name_of(joint));
  if (named != compiled_.joints.end()) return *named->second;
  return *compiled_.bodies.at(model_.names + model_.name_bodyadr[model_.jnt_bodyid[joint]]);
}

void MjcfJoints::object(int joint, const std::string& text) {
  MjcfSource::object(objections_, element_of(joint), text);
}

void MjcfJoints::finish(RobotModel& robot) {
  std::map<int, int> number;  // index into robot.joints by joint of the model
  for (int joint = 0; joint < model_.njnt; ++joint) {
    if (model_.jnt_type[joint] != mjJNT_HINGE && model_.jnt_type[joint] != mjJNT_SLIDE) continue;
    const auto found = std::ranges::find(robot.joints, name_of(joint), &RobotJoint::name);
    if (name_of(joint).empty() && found != robot.joints.end())
      object(joint, "<joint> has no name; Kaz's joints have names: give it a `name`");
    else if (found != robot.joints.end())
      number[joint] = static_cast<int>(found - robot.joints.begin());
  }
  read_actuators();
  read_couplings(number);
  pass_tendon_forces();
  for (const auto& [joint, index] : number) {
    RobotJoint& out = robot.joints[static_cast<std::size_t>(index)];
    read_limits(joint, out);
    if (couplings_.contains(joint)) {
      const Coupling coupling = resolved(joint);
      if (number.contains(coupling.leader))
        set_coupling(robot.joints, index, {number.at(coupling.leader), coupling.ratio, coupling.offset});
    } else if (model_.nu > 0 && !force_.contains(joint)) {
      robot.notes.push_back(mjcf_.source.note(
          element_of(joint), "passive motion of joint `" + out.name + "` (it gets a motor)"));
    }
  }
  check_names(robot);
  order(robot);
  check_followers(robot);
}

void MjcfJoints::read_actuators() {
  for (int actuator = 0; actuator < model_.nu; ++actuator) {
    const int type = model_.actuator_trntype[actuator];
    if (type == mjTRN_TENDON) read_tendon(actuator);
    if (type != mjTRN_JOINT && type != mjTRN_JOINTINPARENT) continue;
    force_[model_.actuator_trnid[2 * actuator]] += force_of(actuator);
  }
}

// A fixed tendon pulls at each of its joints with its force times `coef`.
void MjcfJoints::read_tendon(int actuator) {
  const int tendon = model_.actuator_trnid[2 * actuator];
  for (int i = 0; i < model_.tendon_num[tendon]; ++i) {
    const int wrap = model_.tendon_adr[tendon] + i;
    if (model_.wrap_type[wrap] == mjWRAP_JOINT && model_.wrap_prm[wrap] != 0)
      pull_[model_.wrap_objid[wrap]] += std::abs(model_.wrap_prm[wrap]) * force_of(actuator);
  }
}

// The pull at a joint that follows another one acts at that joint.
void MjcfJoints::pass_tendon_forces() {
  for (const auto& [follower, unused] : couplings_) {
    const auto pull = pull_.find(follower);
    if (pull == pull_.end()) continue;
    const Coupling coupling = resolved(follower);
    pull_[coupling.leader] += std::abs(coupling.ratio) * pull->second;
    pull_.erase(follower);
  }
  for (const auto& [joint, pull] : pull_) force_[joint] += pull;
}

// Largest torque at the joint; infinite if nothing limits it.
double MjcfJoints::force_of(int actuator) const {
  const double gear = std::abs(model_.actuator_gear[6 * actuator]);
  if (model_.actuator_forcelimited[actuator])
    return gear * largest_of(model_.actuator_forcerange + 2 * actuator);
  const bool is_motor = model_.actuator_gaintype[actuator] == mjGAIN_FIXED &&
                        model_.actuator_biastype[actuator] == mjBIAS_NONE;
  if (!is_motor || !model_.actuator_ctrllimited[actuator]) return kNoMjcfLimit;
  return gear * std::abs(model_.actuator_gainprm[mjNGAIN * actuator]) *
         largest_of(model_.actuator_ctrlrange + 2 * actuator);
}

void MjcfJoints::read_limits(int joint, RobotJoint& out) {
  const bool limited = model_.jnt_limited[joint] != 0;
  out.lower = limited ? model_.jnt_range[2 * joint] : -kNoMjcfLimit;
  out.upper = limited ? model_.jnt_range[2 * joint + 1] : kNoMjcfLimit;
  if (limited && largest_of(model_.jnt_range + 2 * joint) > kLargestMjcfTurn)
    object(joint,
           "a limit of joint `" + out.name +
               "` is beyond 100 rad; check `angle` of <compiler>, which is degree or radian");
  const int dof = model_.jnt_dofadr[joint];
  out.damping = model_.dof_damping[dof];
  out.friction = model_.dof_frictionloss[dof];
  if (out.damping < 0 || out.friction < 0)
    object(joint,
           "`damping` or `frictionloss` of joint `" + out.name + "` is negative; correct it");
  const auto force = force_.find(joint);
  out.effort = force == force_.end() ? kNoMjcfLimit : force->second;
  const tinyxml2::XMLElement& e = element_of(joint);
  const char* range = mjcf_.source.value(e, "actuatorfrcrange");
  const char* acts = mjcf_.source.value(e, "actuatorfrclimited");
  const auto stated = parse_numbers(range == nullptr ? "" : range, 2);
  if (stated && (acts == nullptr || std::string_view(acts) != "false"))
    out.effort = std::min(out.effort, largest_of(stated->data()));
  if (out.effort == 0) out.effort = kNoMjcfLimit;
  if (out.pinion_m > 0) convert_to_pinion(out);
}

void MjcfJoints::read_couplings(const std::map<int, int>& number) {
  for (int equality = 0; equality < model_.neq; ++equality) {
    if (model_.eq_type[equality] != mjEQ_JOINT || !model_.eq_active[equality]) continue;
    const int one = model_.eq_obj1id[equality], two = model_.eq_obj2id[equality];
    if (!number.contains(one)) continue;
    if (two < 0 || !number.contains(two))
      object(one, "joint `" + name_of(one) +
                      "` is coupled to no joint of the robot; remove the joint, or give `joint2`");
    else
      couple(equality, one, two);
  }
}

// MuJoCo's rule: angle1 - ref1 = c0 + c1 (angle2 - ref2).
void MjcfJoints::couple(int equality, int one, int two) {
  const double* c = model_.eq_data + mjNEQDATA * equality;
  if (c[1] == 0 || c[2] != 0 || c[3] != 0 || c[4] != 0)
    return object(one, "the coupling of joint `" + name_of(one) +
                           "` is not linear; give polycoef=\"OFFSET RATIO 0 0 0\"");
  Coupling coupling{two, c[1], 0};
  coupling.offset =
      model_.qpos0[model_.jnt_qposadr[one]] + c[0] - c[1] * model_.qpos0[model_.jnt_qposadr[two]];
  if (force_.contains(one)) {
    if (force_.contains(two))
      return object(one, "joints `" + name_of(one) + "` and `" + name_of(two) +
                             "` are coupled, and both have an actuator; remove one");
    std::swap(one, two);
    coupling = {two, 1 / coupling.ratio, -coupling.offset / coupling.ratio};
  }
  if (!couplings_.emplace(one, coupling).second)
    object(one, "joint `" + name_of(one) + "` follows two joints; remove one of the couplings");
}

// The coupling to a joint that does not follow another one.
MjcfJoints::Coupling MjcfJoints::resolved(int follower) {
  Coupling sum{follower, 1, 0};
  for (std::size_t steps = 0; steps <= couplings_.size(); ++steps) {
    const auto next = couplings_.find(sum.leader);
    if (next == couplings_.end()) return sum;
    sum.offset += sum.ratio * next->second.offset;
    sum.ratio *= next->second.ratio;
    sum.leader = next->second.leader;
  }
  object(follower, "joint `" + name_of(follower) + "` follows itself; remove one of the couplings");
  return sum;
}

void MjcfJoints::check_followers(RobotModel& robot) {
  const auto stuck = narrow_for_followers(robot.joints);
  if (!stuck) return;
  const RobotJoint& follower = robot.joints[*stuck];
  const auto joint = compiled_.joints.find(follower.name);
  MjcfSource::object(
      objections_, joint == compiled_.joints.end() ? mjcf_.source.root() : *joint->second,
      "the limits of joint `" + follower.name + "` leave no range to joint `" +
          robot.joints[static_cast<std::size_t>(follower.follows->joint)].name +
          "`, which it follows; correct `range` or `polycoef`");
}

void MjcfJoints::check_names(const RobotModel& robot) {
  const std::vector<std::string> names = robot.joint_order();
  for (const JointNameError& error : joint_name_errors(names)) {
    const auto joint = error.joint < 0
                           ? compiled_.joints.end()
                           : compiled_.joints.find(names[static_cast<std::size_t>(error.joint)]);
    MjcfSource::object(objections_,
                       joint == compiled_.joints.end() ? mjcf_.source.root() : *joint->second,
                       error.text);
  }
}

// Joints with a motor first, in the order of the file; a Kaz has the order of the board.
void MjcfJoints::order(RobotModel& robot) const {
  std::vector<std::size_t> from(robot.joints.size());
  std::iota(from.begin(), from.end(), std::size_t{0});
  const auto& kaz = joint_names();
  const bool is_kaz = std::ranges::is_permutation(robot.joint_order(), kaz);
  std::ranges::stable_sort(from, {}, [&](std::size_t i) {
    const RobotJoint& joint = robot.joints[i];
    if (joint.follows) return static_cast<std::ptrdiff_t>(robot.joints.size());
    return is_kaz ? std::ranges::find(kaz, joint.name) - kaz.begin() : 0;
  });
  std::vector<int> to(from.size());
  std::vector<RobotJoint> joints;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[from[i]] = static_cast<int>(i);
    joints.push_back(robot.joints[from[i]]);
  }
  for (RobotJoint& joint : joints)
    if (joint.follows) joint.follows->joint = to[static_cast<std::size_t>(joint.follows->joint)];
  for (RobotLink& link : robot.links)
    if (link.joint >= 0) link.joint = to[static_cast<std::size_t>(link.joint)];
  robot.joints = std::move(joints);
}

}  // namespace kaz::sim
