// Loops over samples, for every processor and for those with AVX2: rounded alike in both.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/ego_motion_rows.h"

#include <cmath>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#define KAZ_X86
#endif

namespace kaz::vision {
namespace {

constexpr double kMinDepth = 0.05;  // of a point before the later camera, in lengths of its ray

struct Pointers {
  const double *u, *v, *flow_u, *flow_v, *min_w, *max_w;  // of the samples
  double *off_u, *off_v, *length, *epipolar_u, *epipolar_v, *valid, *free;
};
struct Pose {
  double fx, fy, cx, cy;
  double r[3][3], t[3];
};

[[gnu::always_inline]] inline void residuals_of(
    const double* __restrict us, const double* __restrict vs, const double* __restrict flow_u,
    const double* __restrict flow_v, const double* __restrict min_w, const double* __restrict max_w,
    double* __restrict off_u, double* __restrict off_v, double* __restrict length,
    double* __restrict epipolar_u, double* __restrict epipolar_v, double* __restrict valid,
    double* __restrict free, const Pose& pose, std::size_t count) {
  const Pose o = pose;
  for (std::size_t i = 0; i < count; ++i) {
    // Flow of a static point at ray (x, y, 1), inverse depth w: pi(R ray + w t) - (u, v), px, with the pose
    // later <- earlier (ego_motion.h); at both ends of the interval of w.
    const double u = us[i], v = vs[i];
    const double x = (u - o.cx) / o.fx, y = (v - o.cy) / o.fy;
    // R ray; the order of the additions is that of Eigen's product in EgoMotion::flow().
    const double rx = o.r[0][0] * x + o.r[0][1] * y + o.r[0][2];
    const double ry = o.r[1][0] * x + o.r[1][1] * y + o.r[1][2];
    const double rz = o.r[2][0] * x + (o.r[2][1] * y + o.r[2][2]);
    const double near_z = rz + min_w[i] * o.t[2], far_z = rz + max_w[i] * o.t[2];
    const double from_u = o.fx * (rx + min_w[i] * o.t[0]) / near_z + o.cx - u;
    const double from_v = o.fy * (ry + min_w[i] * o.t[1]) / near_z + o.cy - v;
    const double to_u = o.fx * (rx + max_w[i] * o.t[0]) / far_z + o.cx - u;
    const double to_v = o.fy * (ry + max_w[i] * o.t[1]) / far_z + o.cy - v;
    // Between these the flows are a segment; the residual is the distance of the measured flow from it, px.
    const double line_u = to_u - from_u, line_v = to_v - from_v;
    const double length2 = line_u * line_u + line_v * line_v;
    const double ahead = (flow_u[i] - from_u) * line_u + (flow_v[i] - from_v) * line_v;
    const double along = length2 > 0 ? ahead / length2 : 0.0;
    const double not_below = along < 0.0 ? 0.0 : along;
    const double inside = 1.0 < not_below ? 1.0 : not_below;
    const double left_u = flow_u[i] - from_u - inside * line_u;
    const double left_v = flow_v[i] - from_v - inside * line_v;
    const bool is_free = (length2 > 0) & (inside == along);
    const double norm = std::sqrt(length2);
    off_u[i] = left_u;
    off_v[i] = left_v;
    length[i] = std::sqrt(left_u * left_u + left_v * left_v);
    epipolar_u[i] = is_free ? line_u / norm : 0.0;
    epipolar_v[i] = is_free ? line_v / norm : 0.0;
    free[i] = is_free ? 1.0 : 0.0;
    valid[i] = !((near_z < kMinDepth) | (far_z < kMinDepth)) ? 1.0 : 0.0;
  }
}

[[gnu::always_inline]] inline void residuals_of(const Pointers& p, const Pose& pose,
                                                std::size_t count) {
  residuals_of(p.u, p.v, p.flow_u, p.flow_v, p.min_w, p.max_w, p.off_u, p.off_v, p.length,
               p.epipolar_u, p.epipolar_v, p.valid, p.free, pose, count);
}

constexpr std::size_t kLow = 4;  // of the six parameters, in one vector; the others in another
using Doubles = double __attribute__((vector_size(8 * kLow)));

// The columns of H with the parameters in two vectors, whose last two numbers are not used.
struct Sums {
  Doubles low[6], high[6], right_low, right_high;
};

[[gnu::always_inline]] inline void add_rows(const Pointers& p, const Pose& o, double cutoff2,
                                            std::size_t count, double* columns, double* right) {
  Sums sums{};
  for (std::size_t i = 0; i < count; ++i) {
    const double off = (p.off_u[i] * p.off_u[i] + p.off_v[i] * p.off_v[i]) / cutoff2;
    if (p.valid[i] == 0 || off >= 1) continue;
    // Tukey's biweight. J: of the flow's two components by rotation (rad) and translation (m) of the later
    // camera, at the matched point's ray and the middle of the interval of inverse depth.
    const double weight = (1 - off) * (1 - off);
    const double x = (p.u[i] + p.flow_u[i] - p.off_u[i] - o.cx) / o.fx;
    const double y = (p.v[i] + p.flow_v[i] - p.off_v[i] - o.cy) / o.fy;
    const double w = (p.min_w[i] + p.max_w[i]) / 2;
    const Doubles u_low = Doubles{-x * y, 1 + x * x, -y, w} * o.fx,
                  u_high = Doubles{0, -x * w, 0, 0} * o.fx;
    const Doubles v_low = Doubles{-1 - y * y, x * y, x, 0} * o.fy,
                  v_high = Doubles{w, -y * w, 0, 0} * o.fy;
    // Where the depth is open within the segment, only the component across the epipolar line is an equation.
    if (p.free[i] != 0) {
      const double across_u = -p.epipolar_v[i], across_v = p.epipolar_u[i];
      const Doubles low = u_low * across_u + v_low * across_v,
                    high = u_high * across_u + v_high * across_v;
      const Doubles weighted_low = weight * low, weighted_high = weight * high;
#pragma GCC unroll 4
      for (std::size_t k = 0; k < kLow; ++k) {
        sums.low[k] += weighted_low * low[k];
        sums.high[k] += weighted_high * low[k];
      }
      sums.high[4] += weighted_high * high[0];
      sums.high[5] += weighted_high * high[1];
      const double gain = weight * (across_u * p.off_u[i] + across_v * p.off_v[i]);
      sums.right_low += gain * low;
      sums.right_high += gain * high;
      continue;
    }
    const Doubles weighted_u_low = weight * u_low, weighted_u_high = weight * u_high;
    const Doubles weighted_v_low = weight * v_low, weighted_v_high = weight * v_high;
#pragma GCC unroll 4
    for (std::size_t k = 0; k < kLow; ++k) {
      sums.low[k] += weighted_u_low * u_low[k] + weighted_v_low * v_low[k];
      sums.high[k] += weighted_u_high * u_low[k] + weighted_v_high * v_low[k];
    }
    sums.high[4] += weighted_u_high * u_high[0] + weighted_v_high * v_high[0];
    sums.high[5] += weighted_u_high * u_high[1] + weighted_v_high * v_high[1];
    sums.right_low += weighted_u_low * p.off_u[i] + weighted_v_low * p.off_v[i];
    sums.right_high += weighted_u_high * p.off_u[i] + weighted_v_high * p.off_v[i];
  }
  for (std::size_t k = 0; k < 6; ++k) {
    std::memcpy(columns + 8 * k, &sums.low[k], sizeof(Doubles));
    std::memcpy(columns + 8 * k + kLow, &sums.high[k], sizeof(Doubles));
  }
  std::memcpy(right, &sums.right_low, sizeof(Doubles));
  std::memcpy(right + kLow, &sums.right_high, sizeof(Doubles));
}

#ifdef KAZ_X86
[[gnu::target("avx2")]] void residuals_avx2(const Pointers& p, const Pose& pose,
                                            std::size_t count) {
  residuals_of(p, pose, count);
}
[[gnu::target("avx2")]] void add_rows_avx2(const Pointers& p, const Pose& pose, double cutoff2,
                                           std::size_t count, double* columns, double* right) {
  add_rows(p, pose, cutoff2, count, columns, right);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

Pointers pointers(const FlowSamples& s) {
  Pointers p{};
  p.u = s.u.data();
  p.v = s.v.data();
  p.flow_u = s.flow_u.data();
  p.flow_v = s.flow_v.data();
  p.min_w = s.min_inverse_depth.data();
  p.max_w = s.max_inverse_depth.data();
  return p;
}

Pose pose_of(const CameraModel& camera, const Eigen::Isometry3d& later) {
  Pose pose{camera.fx, camera.fy, camera.cx, camera.cy, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.r[i][k] = later.linear()(i, k);
    pose.t[i] = later.translation()[i];
  }
  return pose;
}

}  // namespace

void FlowSamples::resize(std::size_t count) {
  for (std::vector<double>* x : {&u, &v, &flow_u, &flow_v, &min_inverse_depth, &max_inverse_depth})
    x->resize(count);
}

FlowSamples FlowSamples::every(std::size_t stride) const {
  FlowSamples some;
  some.resize((size() + stride - 1) / stride);
  for (std::size_t i = 0, k = 0; i < size(); i += stride, ++k)
    some.set(k, u[i], v[i], flow_u[i], flow_v[i], min_inverse_depth[i], max_inverse_depth[i]);
  return some;
}

void find_residuals(const FlowSamples& samples, const CameraModel& camera,
                    const Eigen::Isometry3d& later, FlowResiduals& residuals, bool vectors) {
  FlowResiduals& r = residuals;
  for (std::vector<double>* x :
       {&r.u, &r.v, &r.length, &r.epipolar_u, &r.epipolar_v, &r.valid, &r.free})
    x->resize(samples.size());
  Pointers p = pointers(samples);
  p.off_u = r.u.data();
  p.off_v = r.v.data();
  p.length = r.length.data();
  p.epipolar_u = r.epipolar_u.data();
  p.epipolar_v = r.epipolar_v.data();
  p.valid = r.valid.data();
  p.free = r.free.data();
  const Pose pose = pose_of(camera, later);
#ifdef KAZ_X86
  if (vectors && has_avx2()) return residuals_avx2(p, pose, samples.size());
#endif
  (void)vectors;
  residuals_of(p, pose, samples.size());
}

NormalEquations normal_equations(const FlowSamples& samples, const FlowResiduals& residuals,
                                 const CameraModel& camera, double cutoff2, bool vectors) {
  Pointers p = pointers(samples);
  const FlowResiduals& r = residuals;
  // Only read here.
  p.off_u = const_cast<double*>(r.u.data());
  p.off_v = const_cast<double*>(r.v.data());
  p.epipolar_u = const_cast<double*>(r.epipolar_u.data());
  p.epipolar_v = const_cast<double*>(r.epipolar_v.data());
  p.valid = const_cast<double*>(r.valid.data());
  p.free = const_cast<double*>(r.free.data());
  const Pose pose = pose_of(camera, Eigen::Isometry3d::Identity());
  Eigen::Matrix<double, 8, 6> columns;
  Eigen::Matrix<double, 8, 1> right;
#ifdef KAZ_X86
  if (vectors && has_avx2()) {
    add_rows_avx2(p, pose, cutoff2, samples.size(), columns.data(), right.data());
  } else {
    add_rows(p, pose, cutoff2, samples.size(), columns.data(), right.data());
  }
#else
  (void)vectors;
  add_rows(p, pose, cutoff2, samples.size(), columns.data(), right.data());
#endif
  return {columns.topRows<6>(), right.head<6>()};
}

}  // namespace kaz::vision
