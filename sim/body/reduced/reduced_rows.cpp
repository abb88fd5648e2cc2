// World in reduced coordinates: input of the velocity solver for one step, i.e. inertia, momentum and rows.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/body/contact/contact_surface.h"
#include "sim/body/reduced/reduced_world.h"

namespace kaz::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStopWatch = 0.02;    // rad, distance from which a stop gets a row
constexpr double kMinSoftness = 1e-8;  // m/s per N
constexpr double kSamePoint = 3e-3;    // m, max displacement of a contact point in a step

}  // namespace

// Splits the tree into chains of joints without a fork: the blocks of the matrix.
std::vector<ReducedWorld::Chain> ReducedWorld::chains_of(const ArticulatedTree& tree) {
  std::vector<Chain> chains;
  const int root = tree.root_dofs(), dofs = tree.dofs();
  if (root > 0) chains.push_back({0, root, -1});
  std::vector<int> carried(static_cast<std::size_t>(dofs), 0), chain_of(carried);
  for (int i = root; i < dofs; ++i) {
    if (tree.carrier_of_dof(i) >= 0) ++carried[static_cast<std::size_t>(tree.carrier_of_dof(i))];
  }
  for (int i = root; i < dofs; ++i) {
    const int carrier = tree.carrier_of_dof(i);
    if (carrier >= 0 && carrier == i - 1 && carried[static_cast<std::size_t>(carrier)] == 1) {
      ++chains.back().length;
    } else {
      const int on = carrier >= 0 ? chain_of[static_cast<std::size_t>(carrier)] : root > 0 ? 0 : -1;
      chains.push_back({i, 1, on});
    }
    chain_of[static_cast<std::size_t>(i)] = static_cast<int>(chains.size()) - 1;
  }
  return chains;
}

// Writes M: the tree's mass matrix, then for each awake object its inertia about the centre of mass and its
// mass (world axes; angular before linear). Sleeping objects have no coordinates.
void ReducedWorld::write_inertia(Work& work) const {
  int size = tree_.dofs();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    work.coordinate_of[i] = objects_[i].awake ? size : -1;
    if (objects_[i].awake) size += 6;
  }
  work.solver.begin(size);
  BlockMatrix& matrix = work.solver.matrix();
  for (const Chain& chain : layout_->chains)
    matrix.add_block(chain.first, chain.length, chain.carrier);
  tree_.mass_matrix([&matrix](int i) { return matrix.inertia_row(i); });
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const int first = work.coordinate_of[i];
    if (first < 0) continue;
    matrix.add_block(first, 6, -1);
    const Matrix3d inertia = objects_[i].inertia();
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b) matrix.inertia_row(first + a)[first + b] = inertia(a, b);
      double* linear = matrix.inertia_row(first + 3 + a) + first;
      std::fill_n(linear, 6, 0.0);
      linear[3 + a] = objects_[i].mass();
    }
  }
  work.velocity.assign(static_cast<std::size_t>(size), 0);
  work.momentum.assign(work.velocity.size(), 0);
  std::ranges::copy(tree_.velocity, work.velocity.begin());
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (work.coordinate_of[i] < 0) continue;
    double* v = work.velocity.data() + work.coordinate_of[i];
    for (int k = 0; k < 3; ++k) {
      v[k] = objects_[i].angular_velocity()[k];
      v[k + 3] = objects_[i].velocity[k];
    }
  }
}

// Momentum after the step without rows: p = M v - h c(q, v_mid) + h m g + pushes. Velocity-dependent forces
// use the midpoint velocity extrapolated from the last step, v_mid = v + (v - v_before) / 2: second order.
void ReducedWorld::write_momentum(Work& work) {
  for (std::size_t i = 0; i < work.halfway.size(); ++i)
    work.halfway[i] = tree_.velocity[i] + (tree_.velocity[i] - velocity_before_[i]) / 2;
  tree_.bias(work.halfway, gravity_, work.bias);
  work.solver.multiply(work.velocity.data(), work.momentum.data());
  for (std::size_t i = 0; i < work.bias.size(); ++i) work.momentum[i] -= step_s_ * work.bias[i];
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (work.coordinate_of[i] < 0) continue;
    double* linear = work.momentum.data() + work.coordinate_of[i] + 3;
    for (int k = 0; k < 3; ++k) linear[k] += step_s_ * objects_[i].mass() * gravity_[k];
  }
  for (const HandPush& push : hand_pushes_) {
    const int link = static_cast<int>(push.link);
    tree_.add_force(link, tree_.com(link), push.impulse, work.momentum.data());
  }
}

// Impulse of the nearest contact point of the same shapes in the step before, in the axes of `basis`.
VelocitySolver::Impulse ReducedWorld::recall(const Touch& touch, const Matrix3d& basis) const {
  const Memory* best = nullptr;
  double nearest = kSamePoint * kSamePoint;
  for (const Memory& memory : memory_) {
    if (memory.shape_a != touch.shape_a || memory.shape_b != touch.shape_b) continue;
    const double distance = (memory.at - touch.at).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    best = &memory;
  }
  VelocitySolver::Impulse start = VelocitySolver::Impulse::Zero();
  if (best == nullptr) return start;
  start.head<3>() = basis.transpose() * best->impulse;
  const Vector3d moment = basis.transpose() * best->moment;
  start.tail<3>() = Vector3d(moment[1], moment[2], moment[0]);
  return start;
}

// Adds the relative motion of two bodies to the solver. Point of reference: the root's origin if the robot is
// involved, else the centre of mass of the first object.
void ReducedWorld::make_pair(Work& work, const Touch& touch) const {
  std::array<VelocitySolver::Segment, 4> segments;
  std::size_t count = 0;
  const bool robot_a = of_robot(touch.body_a), robot_b = of_robot(touch.body_b);
  const auto coordinate_of = [&](int body) {
    return work.coordinate_of[static_cast<std::size_t>(body) - robot_links_];
  };
  Meeting& meeting = work.meetings.emplace_back();
  meeting = {touch.body_a, touch.body_b, -1, tree_.root_at};
  ArticulatedTree::Span span{tree_.dofs(), 0};
  if (robot_a != robot_b) segments[count++] = {0, tree_.root_dofs(), robot_a ? 1.0 : -1.0};
  for (const int body : {touch.body_a, touch.body_b}) {
    if (!of_robot(body)) continue;
    const ArticulatedTree::Span one = tree_.span_of_link(body);
    if (one.first == one.end) continue;
    span = {std::min(span.first, one.first), std::max(span.end, one.end)};
  }
  if (span.end > 0) segments[count++] = {span.first, span.end - span.first};
  // Coordinates in ascending order.
  std::array<std::pair<int, double>, 2> sides{{{touch.body_a, 1.0}, {touch.body_b, -1.0}}};
  if (sides[0].first > sides[1].first) std::swap(sides[0], sides[1]);
  bool plain = !robot_a && !robot_b;  // identity Jacobian: a free body about its own centre of mass
  for (const auto& [body, sign] : sides) {
    if (body < 0 || of_robot(body)) continue;
    if (plain) meeting.about = object(body).com;
    segments[count++] = {coordinate_of(body), 6, plain ? sign : 0};
    plain = false;
  }
  // A fixed root has no coordinates: the pair has nothing to move.
  if (std::ranges::all_of(std::span(segments).first(count),
                          [](const auto& segment) { return segment.length == 0; }))
    return;
  meeting.pair = work.solver.add_pair(std::span(segments).first(count));
  double* columns = work.solver.columns(meeting.pair);
  if (robot_a) tree_.add_motions(touch.body_a, 1, span.first, columns);
  if (robot_b) tree_.add_motions(touch.body_b, -1, span.first, columns);
  columns += 6 * std::max(0, span.end - span.first);
  for (const VelocitySolver::Segment& segment : std::span(segments).first(count)) {
    if (segment.plain != 0 || segment.first < tree_.dofs()) continue;
    const bool is_a = touch.body_a >= 0 && !robot_a && coordinate_of(touch.body_a) == segment.first;
    const double sign = is_a ? 1 : -1;
    const Vector3d arm = meeting.about - object(is_a ? touch.body_a : touch.body_b).com;
    for (int k = 0; k < 3; ++k, columns += 6) {
      columns[k] = sign;
      Eigen::Map<Vector3d>(columns + 3) = sign * Vector3d::Unit(k).cross(arm);
      columns[18 + 3 + k] = sign;
    }
    columns += 18;
  }
}

const ReducedWorld::Meeting& ReducedWorld::meeting_of(Work& work, const Touch& touch) const {
  for (std::size_t i = work.meetings.size(); i-- > 0;) {
    if (work.meetings[i].body_a == touch.body_a && work.meetings[i].body_b == touch.body_b)
      return work.meetings[i];
  }
  make_pair(work, touch);
  return work.meetings.back();
}

void ReducedWorld::begin_rows(Work& work) const {
  write_inertia(work);
  work.pushes.clear();
  work.meetings.clear();
}

// Fills in place, friction coefficients and softness of a contact point. False: none of the bodies can move.
bool ReducedWorld::place_point(Work& work, std::size_t number,
                               VelocitySolver::Point& point) const {
  const Touch& touch = work.contacts.touches()[number];
  const auto moves = [this](int body) {
    return of_robot(body) || (body >= 0 && object(body).awake);
  };
  if (!moves(touch.body_a) && !moves(touch.body_b)) return false;
  const Meeting& meeting = meeting_of(work, touch);
  if (meeting.pair < 0) return false;
  point.pair = meeting.pair;
  point.arm = touch.at - meeting.about;
  point.basis.col(0) = touch.normal;
  point.basis.col(1) = touch.normal.unitOrthogonal();
  point.basis.col(2) = touch.normal.cross(point.basis.col(1));
  const Surface& surface = touch.surface;
  point.softness =
      softness_for(step_s_, kContactErp, std::max(surface.softness, kMinSoftness)) / step_s_;
  point.mu = surface.mu;
  point.rolling = surface.rolling_resistance;
  return true;
}

void ReducedWorld::add_point(Work& work, std::size_t number, const VelocitySolver::Point& point) {
  work.solver.add_point(point);
  work.pushes.push_back({number, point.basis});
}

// Row of a contact point (contact_surface.h): target velocity = erp / h (depth - kContactLayer), limited to
// kContactMaxCorrection; friction from the stored shear (soft surfaces) or from the impulse of the step
// before (hard ones). A body that bounces leaves the surface by itself: the target does not speed it up.
void ReducedWorld::make_contact_row(Work& work, std::size_t number) const {
  VelocitySolver::Point point;
  if (!place_point(work, number, point)) return;
  const Touch& touch = work.contacts.touches()[number];
  const Surface& surface = touch.surface;
  point.target =
      std::min(erp_for(step_s_, kContactErp) / step_s_ * std::max(0.0, touch.depth - kContactLayer),
               kContactMaxCorrection);
  if (surface.restitution > 0) {
    const double leaving = -approach(touch);
    if (leaving > step_s_ * pressing(touch)) point.target = std::min(point.target, leaving);
  }
  const bool soft = ContactMemory::has_shear(touch);
  if (!soft || point.rolling > 0) point.before = recall(touch, point.basis);
  if (soft) {
    // Impulse of the shear spring, N s: -k h s with k = kContactErp / (kErpStep softness).
    const Vector3d stretch =
        -kContactErp / surface.softness * (step_s_ / kErpStep) * shear_.shear(number);
    point.give = point.softness;
    point.before.segment<2>(1) = (point.basis.transpose() * stretch).tail<2>();
  }
  add_point(work, number, point);
}

Vector3d ReducedWorld::velocity_at(int body, const Vector3d& point) const {
  if (body < 0) return Vector3d::Zero();
  if (of_robot(body)) return tree_.velocity_at(body, point);
  const FreeBody& free = object(body);
  return free.velocity + free.angular_velocity().cross(point - free.com);
}

// Bounded rows: first one motor row for each joint (joint_motor.h, times h: impulses), then one friction row
// for each joint if the motors are identified servos, then the joint stops in reach. A stop: target -gap / h
// while apart (it may close the gap, no more), erp penetration / h beyond.
void ReducedWorld::make_joint_rows(Work& work) const {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const JointMotor::Row& row = rows_[i];
    work.solver.add_bounded({layout_->joints[i].dof, 1, row.velocity, row.softness / step_s_,
                             step_s_ * row.min, step_s_ * row.max});
  }
  // Friction of identified servos holds a shaft with this compliance, rad/s per Nm.
  constexpr double kFrictionSoftness = 1e-6;
  for (std::size_t i = 0; i < rows_.size() && servo_; ++i)
    work.solver.add_bounded({layout_->joints[i].dof, 1, 0, kFrictionSoftness / step_s_,
                             -step_s_ * rows_[i].friction, step_s_ * rows_[i].friction});
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double angle = joint_states_[i].angle;
    const double back = erp_for(step_s_, kStopErp);
    const double yields = softness_for(step_s_, kStopErp, kStopSoftness) / step_s_;
    // Reach: the joint's path in this step at its own or its motor's speed.
    const double watch = kStopWatch + step_s_ * std::max(std::abs(joint_states_[i].velocity),
                                                         std::abs(rows_[i].velocity));
    const auto stop = [&](double gap, double sign) {  // rad; negative: beyond the stop
      if (gap > watch) return;
      const double target = gap > 0 ? -gap / step_s_ : -back * gap / step_s_;
      work.solver.add_bounded({layout_->joints[i].dof, sign, target, yields, 0, kEndless});
    };
    stop(angle - layout_->joints[i].lower, 1);
    stop(layout_->joints[i].upper - angle, -1);
  }
}

// A follower has no stops of its own: the leader's range includes them. Angles are integrated exactly, so the
// whole position error is corrected within the step.
void ReducedWorld::make_coupling_rows(Work& work) const {
  for (const Follower& follower : layout_->followers) {
    const auto angle = [this](int dof) { return tree_.angle[tree_.index_of_dof(dof)]; };
    VelocitySolver::Tie tie;
    tie.first = {follower.leader_dof, follower.dof};
    tie.length = {1, 1};
    tie.entry = {-follower.ratio, 1};
    tie.target =
        -(angle(follower.dof) - follower.ratio * angle(follower.leader_dof) - follower.offset) /
        step_s_;
    work.solver.add_tie(tie);
  }
}

}  // namespace kaz::sim
