// Vertex kernels for one instruction set: world normals, projection to fixed point.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/render/raster/kernels.h"
#include "sim/render/raster/vectors.h"

KAZ_RASTER_BEGIN
namespace kaz::sim::raster::KAZ_RASTER_SET {

static inline void turn_normals(Vertices& v, VertexRange range, const std::array<float, 9>& m) {
  for (std::size_t i = range.first; i < range.first + range.count; i += kLanes) {
    const Floats x = load(&v.model_normal[0][i]), y = load(&v.model_normal[1][i]),
                 z = load(&v.model_normal[2][i]);
    for (std::size_t r = 0; r < 3; ++r)
      store(&v.normal[r][i], m[3 * r] * x + m[3 * r + 1] * y + m[3 * r + 2] * z);
  }
}

// Returns the product of one row of a 3 x 4 matrix and (x, y, z, 1).
KAZ_LANES_INLINE Floats row_times(const float* row, Floats x, Floats y, Floats z) {
  return row[0] * x + row[1] * y + (row[2] * z + row[3]);
}

// Returns the integer nearest to `samples` * kSubpixel. `samples` must be within kRange.
KAZ_LANES_INLINE Ints snap(Floats samples) {
  const Floats scaled = samples * static_cast<float>(kSubpixel);
  return to_int(scaled + (scaled < 0.0F ? splat(-0.5F) : splat(0.5F)));
}

KAZ_LANES_INLINE Floats within_range(Floats x) {
  const float range = kRange;
  return larger(smaller(x, splat(range)), splat(-range));
}

static inline void project(Vertices& v, VertexRange range, const Projection& p) {
  const float* m = p.optical_from_model.data();
  for (std::size_t i = range.first; i < range.first + range.count; i += kLanes) {
    const Floats x = load(&v.x[i]), y = load(&v.y[i]), z = load(&v.z[i]);
    const Floats forward = row_times(m + 8, x, y, z);
    const Ints behind = forward < p.near;
    const Floats w = 1.0F / (behind ? splat(p.near) : forward);
    const Floats px = p.focal_x * row_times(m, x, y, z) * w + p.centre_x;
    const Floats py = p.focal_y * row_times(m + 4, x, y, z) * w + p.centre_y;
    const Floats cx = within_range(px), cy = within_range(py);
    Ints outside = (behind & kOutNear) | ((forward > p.far) & kOutFar);
    outside |= ((px < 0.0F) & kOutLeft) | ((px > p.width) & kOutRight);
    outside |= ((py < 0.0F) & kOutTop) | ((py > p.height) & kOutBottom);
    outside |= ((cx != px) | (cy != py)) & kOutOfRange;
    // If a point is nearer than `p.near` or behind the eye, `px` and `py` are not its true position in the
    // picture. Therefore such a point gets only the bit kOutNear.
    outside = behind ? splat_int(kOutNear) : outside;
    store(&v.px[i], snap(cx));
    store(&v.py[i], snap(cy));
    store(&v.w[i], w);
    store(&v.outside[i], outside);
  }
}

static inline void project_shadow(Vertices& v, VertexRange range, const std::array<float, 12>& m) {
  for (std::size_t i = range.first; i < range.first + range.count; i += kLanes) {
    const Floats x = load(&v.x[i]), y = load(&v.y[i]), z = load(&v.z[i]);
    store(&v.px[i], snap(within_range(row_times(m.data(), x, y, z))));
    store(&v.py[i], snap(within_range(row_times(m.data() + 4, x, y, z))));
    store(&v.w[i], row_times(m.data() + 8, x, y, z));
  }
}

}  // namespace kaz::sim::raster::KAZ_RASTER_SET
KAZ_RASTER_END
