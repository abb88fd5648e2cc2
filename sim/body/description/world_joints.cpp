// Joints of an SDF world.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_joints.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "sim/body/description/sdf_link.h"

namespace kaz::sim {
namespace {

constexpr int kWorldBody = -1;
constexpr double kSdfNoLimit = 1e16;

struct JointEnds {
  int parent = kWorldBody, child = kWorldBody;  // indices into WorldModel::bodies
};

std::string joint_name(const SdfJoint& one) {
  return one.model + "/" + one.joint->Name();
}

Result<int> body_index(const SdfJoint& one, const std::string& link,
                       const std::map<std::string, int>& body_of) {
  if (link == "world") return kWorldBody;
  const auto found = body_of.find(one.model + "::" + link);
  if (found != body_of.end()) return found->second;
  return fail(Fault::usage, "joint `" + joint_name(one) + "` refers to the link `" + link +
                                "`, which does not exist");
}

Result<JointEnds> ends_of(const SdfJoint& one, const std::map<std::string, int>& body_of) {
  std::string parent, child;
  if (!one.joint->ResolveParentLink(parent).empty() || !one.joint->ResolveChildLink(child).empty())
    return fail(Fault::usage, "joint `" + joint_name(one) + "` has no valid parent or child link");
  JointEnds ends;
  ends.parent = KAZ_TRY(body_index(one, parent, body_of));
  ends.child = KAZ_TRY(body_index(one, child, body_of));
  return ends;
}

// The first body of each group of bodies that fixed joints connect.
class WeldGroups {
 public:
  explicit WeldGroups(std::size_t bodies) : first_(bodies) {
    std::iota(first_.begin(), first_.end(), 0);
  }
  void join(int a, int b) {
    const int one = first(a), other = first(b);
    first_[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
  }
  int first(int body) const {
    while (first_[static_cast<std::size_t>(body)] != body)
      body = first_[static_cast<std::size_t>(body)];
    return body;
  }

 private:
  std::vector<int> first_;
};

// Merges the bodies of each group. Returns the new index of each body.
std::vector<int> merge(const WeldGroups& groups, WorldModel& world) {
  std::vector<int> index_of(world.bodies.size());
  std::vector<WorldBody> merged;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    WorldBody& body = world.bodies[i];
    const auto first = static_cast<std::size_t>(groups.first(static_cast<int>(i)));
    if (first == i || body.fixed) {
      index_of[i] = static_cast<int>(merged.size());
      merged.push_back(std::move(body));
      continue;
    }
    index_of[i] = index_of[first];
    WorldBody& whole = merged[static_cast<std::size_t>(index_of[i])];
    weld(whole.rigid, body.rigid, whole.pose.inverse() * body.pose);
    std::ranges::move(body.kicks, std::back_inserter(whole.kicks));
    std::ranges::stable_sort(whole.kicks, {}, &Kick::time_s);
  }
  world.bodies = std::move(merged);
  return index_of;
}

double limit_or_none(double value) {
  return std::abs(value) < kSdfNoLimit
             ? value
             : std::copysign(std::numeric_limits<double>::infinity(), value);
}

// Axis, limits and losses. Balls have none.
Result<void> add_axis(const SdfJoint& one, WorldJoint& out) {
  const sdf::JointAxis* axis = one.joint->Axis();
  ignition::math::Vector3d xyz;
  if (axis == nullptr || !axis->ResolveXyz(xyz, "__model__").empty() || !(xyz.Length() > 0))
    return fail(Fault::usage,
                "joint `" + out.name + "` has no valid axis; give <axis><xyz> in a known frame");
  out.axis = (one.model_pose.linear() * from_sdf(xyz)).normalized();
  if (one.joint->Type() != sdf::JointType::CONTINUOUS) {
    out.lower = limit_or_none(axis->Lower());
    out.upper = limit_or_none(axis->Upper());
  }
  out.damping = axis->Damping();
  out.friction = axis->Friction();
  return {};
}

Result<WorldJoint> joint_of(const SdfJoint& one) {
  WorldJoint out;
  out.name = joint_name(one);
  ignition::math::Pose3d pose;
  if (!one.joint->SemanticPose().Resolve(pose, "__model__").empty())
    return fail(Fault::usage, "joint `" + out.name + "` has a pose in an unknown frame");
  out.anchor = (one.model_pose * from_sdf(pose)).translation();
  const sdf::JointType type = one.joint->Type();
  if (type == sdf::JointType::BALL) {
    out.kind = WorldJoint::Kind::ball;
    return out;
  }
  out.kind =
      type == sdf::JointType::PRISMATIC ? WorldJoint::Kind::prismatic : WorldJoint::Kind::revolute;
  KAZ_TRY(add_axis(one, out));
  return out;
}

// Makes bodies fixed that are welded to the world or to a fixed body.
void fix_groups(const std::vector<JointEnds>& welds, const WeldGroups& groups, WorldModel& world) {
  std::set<int> fixed;
  for (const JointEnds& ends : welds) {
    if (ends.parent == kWorldBody && ends.child != kWorldBody)
      fixed.insert(groups.first(ends.child));
    if (ends.child == kWorldBody && ends.parent != kWorldBody)
      fixed.insert(groups.first(ends.parent));
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].fixed) fixed.insert(groups.first(static_cast<int>(i)));
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (fixed.contains(groups.first(static_cast<int>(i)))) world.bodies[i].fixed = true;
}

}  // namespace

Result<void> add_joints(const std::vector<SdfJoint>& joints, std::map<std::string, int> body_of,
                        WorldModel& world) {
  if (joints.empty()) return {};
  WeldGroups groups(world.bodies.size());
  std::vector<JointEnds> welds;
  for (const SdfJoint& one : joints) {
    const JointEnds ends = KAZ_TRY(ends_of(one, body_of));
    if (one.joint->Type() != sdf::JointType::FIXED) continue;
    welds.push_back(ends);
    if (ends.parent != kWorldBody && ends.child != kWorldBody) groups.join(ends.parent, ends.child);
  }
  fix_groups(welds, groups, world);
  const std::vector<int> index_of = merge(groups, world);
  const auto index = [&](int body) {
    return body == kWorldBody ? kWorldBody : index_of[static_cast<std::size_t>(body)];
  };
  const auto moves = [&](int body) {
    return body != kWorldBody && !world.bodies[static_cast<std::size_t>(body)].fixed;
  };
  for (const SdfJoint& one : joints) {
    if (one.joint->Type() == sdf::JointType::FIXED) continue;
    const JointEnds ends = KAZ_TRY(ends_of(one, body_of));
    WorldJoint out = KAZ_TRY(joint_of(one));
    out.parent = index(ends.parent);
    out.child = index(ends.child);
    if (out.parent == out.child || (!moves(out.parent) && !moves(out.child))) continue;
    if (!moves(out.child)) {
      std::swap(out.parent, out.child);
      out.axis = -out.axis;
    }
    world.joints.push_back(std::move(out));
  }
  return {};
}

}  // namespace kaz::sim
