// Fill kernels for one instruction set: clipping, triangle setup, coverage, depth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/render/raster/kernel_vertices.h"

KAZ_RASTER_BEGIN
namespace kaz::sim::raster::KAZ_RASTER_SET {

// A triangle in fixed-point coordinates, clockwise in the picture (y down).
struct Outline {
  std::int32_t x[3], y[3];
};

static inline std::int32_t first_centre(std::int32_t at) {  // ceil(at / kSubpixel)
  return (at + (kSubpixel - 1)) >> 8;
}
static_assert(kSubpixel == 1 << 8);

// Computes where an edge of a triangle crosses the rows of the picture. For each row, column() returns the
// column of the leftmost sample center that is on the edge or to the right of the edge. The edge goes through
// the point (x0, y0) and has the direction (dx, dy). In the row with the number `row`, the edge has this x
// coordinate: `x = x0 + dx * (kSubpixel * row - y0) / dy`. The column is `ceil(x / kSubpixel)`. The
// calculation is exact, in integers.
class Edge {
 public:
  Edge(const Outline& t, int from, int to, std::int64_t row) {
    const std::int64_t dx = std::int64_t{t.x[to]} - t.x[from],
                       dy = std::int64_t{t.y[to]} - t.y[from];
    divisor_ = kSubpixel * dy;
    const std::int64_t numerator =
        t.x[from] * dy + dx * (kSubpixel * row - t.y[from]) + divisor_ - 1;
    column_ = floor_divided(numerator, divisor_);
    rest_ = numerator - column_ * divisor_;
    step_ = floor_divided(dx, dy);
    rest_step_ = kSubpixel * (dx - step_ * dy);
  }
  int column() const { return static_cast<int>(column_); }
  void next() {
    column_ += step_;
    rest_ += rest_step_;
    if (rest_ >= divisor_) {
      rest_ -= divisor_;
      ++column_;
    }
  }

 private:
  static std::int64_t floor_divided(std::int64_t a, std::int64_t b) {
    const std::int64_t q = a / b;
    return q * b > a ? q - 1 : q;
  }
  std::int64_t column_, rest_, step_, rest_step_, divisor_;
};

// Calls span(row, first, end) for each row that contains covered sample centers. Ignores sample centers
// outside the columns `left .. right - 1` and outside the rows `top .. bottom - 1`.
template <class Span>
static inline void scan(const Outline& t, int left, int top, int right, int bottom,
                        const Span& span) {
  int a = 0, b = 1, c = 2;
  if (t.y[b] < t.y[a]) std::swap(a, b);
  if (t.y[c] < t.y[b]) std::swap(b, c);
  if (t.y[b] < t.y[a]) std::swap(a, b);
  const int first = std::max(first_centre(t.y[a]), top),
            end = std::min(first_centre(t.y[c]), bottom);
  if (first >= end) return;
  Edge whole(t, a, c, first);
  const bool bend_is_right = (b - a + 3) % 3 == 1;  // a, b, c are clockwise
  const int middle = std::clamp(first_centre(t.y[b]), first, end);
  const auto rows = [&](int from, int to, int upper, int lower) {
    if (from >= to) return;
    Edge part(t, upper, lower, from);
    for (int row = from; row < to; ++row, whole.next(), part.next()) {
      const int one = whole.column(), other = part.column();
      const int start = std::max(bend_is_right ? one : other, left);
      const int stop = std::min(bend_is_right ? other : one, right);
      if (start < stop) span(row, start, stop);
    }
  };
  rows(first, middle, a, b);
  rows(middle, end, b, c);
}

static inline std::int64_t twice_area(const Outline& t) {
  const std::int64_t dx1 = std::int64_t{t.x[1]} - t.x[0], dy1 = std::int64_t{t.y[1]} - t.y[0];
  const std::int64_t dx2 = std::int64_t{t.x[2]} - t.x[0], dy2 = std::int64_t{t.y[2]} - t.y[0];
  return dx1 * dy2 - dx2 * dy1;
}

// Computes the slopes of a linear function over a triangle from the function's values f0, f1 and f2 at the
// corners:
//   by_x = ((f1 - f0) dy2 - (f2 - f0) dy1) / (2 area), by_y = ((f2 - f0) dx1 - (f1 - f0) dx2) / (2 area).
// For a triangle that is thinner than 1/256 sample, the slopes could become infinite. Therefore a thin
// triangle gets the mean of the three values, with slopes of 0.
struct Gradients {
  double dx1, dy1, dx2, dy2;
  bool flat;
  explicit Gradients(const Outline& t) {
    const double area = static_cast<double>(twice_area(t));
    const std::int64_t wide =
        std::max({t.x[0], t.x[1], t.x[2]}) - std::min({t.x[0], t.x[1], t.x[2]});
    const std::int64_t high =
        std::max({t.y[0], t.y[1], t.y[2]}) - std::min({t.y[0], t.y[1], t.y[2]});
    flat = twice_area(t) <= std::max(wide, high);
    const double scale = flat ? 0.0 : kSubpixel / area;
    dx1 = scale * (t.x[1] - t.x[0]);
    dy1 = scale * (t.y[1] - t.y[0]);
    dx2 = scale * (t.x[2] - t.x[0]);
    dy2 = scale * (t.y[2] - t.y[0]);
  }
  Slope slope(float f0, float f1, float f2) const {
    if (flat) return {(f0 + f1 + f2) * (1.0F / 3.0F), 0.0F, 0.0F};
    const double one = static_cast<double>(f1) - static_cast<double>(f0);
    const double two = static_cast<double>(f2) - static_cast<double>(f0);
    return {f0, static_cast<float>(one * dy2 - two * dy1),
            static_cast<float>(two * dx1 - one * dx2)};
  }
};

static inline Outline outline_of(const Vertices& v, std::uint32_t a, std::uint32_t b,
                                 std::uint32_t c) {
  return {{v.px[a], v.px[b], v.px[c]}, {v.py[a], v.py[b], v.py[c]}};
}

// Compares the depth of a primitive with the depth of the samples `first .. end - 1` of a row. Stores
// `number`, the primitive's number, at the samples where the primitive is nearest.
KAZ_LANES_INLINE void fill_span(Target& target, const Primitive& p, std::uint32_t number, int row,
                                int first, int end) {
  const std::size_t begin =
      static_cast<std::size_t>(row - target.top) * static_cast<std::size_t>(target.stride);
  float* depth = target.w.data() + begin;
  std::uint32_t* owner = target.primitive.data() + begin;
  const float base = p.w.at + p.w.by_y * (static_cast<float>(row) - p.y0);
  const Ints lanes = lane_numbers();
  const Ints mine = splat_int(static_cast<std::int32_t>(number));
  for (int x = first; x < end; x += kLanes) {
    const Ints column = lanes + x;
    const Floats w = base + p.w.by_x * (to_float(column) - p.x0);
    const Floats before = load(depth + x);
    const Ints wins = (w >= before) & (column < end);
    store(depth + x, wins ? w : before);
    const Ints owners = load_ints(owner + x);
    store(owner + x, wins ? mine : owners);
  }
}

struct FillJob {
  Vertices& v;
  Target& target;
  std::vector<Primitive>& primitives;
  std::uint32_t surface;
};

// Fills a triangle in front of the eye. The vertices a, b, c are counter-clockwise as seen from outside the
// body.
static inline void fill_triangle(const FillJob& job, std::uint32_t a, std::uint32_t b,
                                 std::uint32_t c, std::uint32_t provoking) {
  // Because the y axis points down, a triangle that faces the eye has a negative area. Therefore b and c are
  // swapped.
  const Outline t = outline_of(job.v, a, c, b);
  if (twice_area(t) <= 0) return;
  Primitive p{};
  p.x0 = static_cast<float>(t.x[0]) * (1.0F / kSubpixel);
  p.y0 = static_cast<float>(t.y[0]) * (1.0F / kSubpixel);
  p.w = Gradients(t).slope(job.v.w[a], job.v.w[c], job.v.w[b]);
  p.a = a;
  p.b = c;
  p.c = b;
  p.provoking = provoking;
  p.surface = job.surface;
  const auto number = static_cast<std::uint32_t>(job.primitives.size());
  bool covers = false;
  scan(t, job.target.left, job.target.top, job.target.right, job.target.bottom,
       [&](int row, int first, int end) {
         fill_span(job.target, p, number, row, first, end);
         covers = true;
       });
  if (covers) job.primitives.push_back(p);
}

// Corner of a polygon during clipping: position (optical frame, m), and three weights. The weights are used
// to interpolate between the values at the triangle's three vertices.
struct ClipCorner {
  std::array<double, 3> at;
  std::array<double, 3> weight;
};
struct ClipPolygon {
  std::array<ClipCorner, 12> corners;
  int count = 0;
};

// Returns the part of the polygon where plane . (x, y, z, 1) >= 0 (Sutherland & Hodgman).
static inline ClipPolygon clipped(const ClipPolygon& from, const std::array<double, 4>& plane) {
  ClipPolygon to;
  const auto height = [&](const ClipCorner& c) {
    return plane[0] * c.at[0] + plane[1] * c.at[1] + plane[2] * c.at[2] + plane[3];
  };
  for (int i = 0; i < from.count; ++i) {
    const ClipCorner& a = from.corners[static_cast<std::size_t>(i)];
    const ClipCorner& b = from.corners[static_cast<std::size_t>((i + 1) % from.count)];
    const double ha = height(a), hb = height(b);
    if (ha >= 0) to.corners[static_cast<std::size_t>(to.count++)] = a;
    if ((ha >= 0) == (hb >= 0)) continue;
    ClipCorner& cut = to.corners[static_cast<std::size_t>(to.count++)];
    // The cut point is always interpolated from the corner that is kept to the corner that is cut off.
    // Therefore, if a plane cuts an edge that two triangles share, both triangles get exactly the same cut
    // point.
    const ClipCorner &in = ha >= 0 ? a : b, &out = ha >= 0 ? b : a;
    const double share = height(in) / (height(in) - height(out));
    for (std::size_t k = 0; k < 3; ++k) {
      cut.at[k] = in.at[k] + share * (out.at[k] - in.at[k]);
      cut.weight[k] = in.weight[k] + share * (out.weight[k] - in.weight[k]);
    }
  }
  return to;
}

static inline std::uint32_t append_vertex(Vertices& v, const ClipCorner& corner,
                                          const std::array<std::uint32_t, 3>& of,
                                          const Projection& p) {
  const auto mixed = [&](const std::vector<float>& values) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += corner.weight[k] * static_cast<double>(values[of[k]]);
    return static_cast<float>(sum);
  };
  const auto number = static_cast<std::uint32_t>(v.count);
  const std::size_t size = ++v.count + kPad;
  if (v.w.size() < size) {
    const std::size_t roomy = size + size / 8;
    for (std::vector<float>* list : {&v.normal[0], &v.normal[1], &v.normal[2], &v.u, &v.v, &v.w})
      list->resize(roomy);
    v.px.resize(roomy);
    v.py.resize(roomy);
    v.outside.resize(roomy);
  }
  for (auto& list : v.normal) list[number] = mixed(list);
  v.u[number] = mixed(v.u);
  v.v[number] = mixed(v.v);
  const double w = 1 / corner.at[2];
  const double x =
      static_cast<double>(p.focal_x) * corner.at[0] * w + static_cast<double>(p.centre_x);
  const double y =
      static_cast<double>(p.focal_y) * corner.at[1] * w + static_cast<double>(p.centre_y);
  const auto fixed = [](double at) {
    return static_cast<std::int32_t>(
        std::floor(std::clamp(at, -1.0 * kRange, 1.0 * kRange) * kSubpixel + 0.5));
  };
  v.px[number] = fixed(x);
  v.py[number] = fixed(y);
  v.w[number] = static_cast<float>(w);
  return number;
}

// Clips and fills a triangle that is partly behind the eye, beyond the far plane, or far outside the picture.
static inline void fill_clipped(const FillJob& job, const Projection& p,
                                const std::array<std::uint32_t, 3>& of) {
  ClipPolygon polygon;
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    ClipCorner& corner = polygon.corners[i];
    const std::size_t n = of[i];
    const double at[3] = {static_cast<double>(job.v.x[n]), static_cast<double>(job.v.y[n]),
                          static_cast<double>(job.v.z[n])};
    for (std::size_t r = 0; r < 3; ++r) {
      const float* row = p.optical_from_model.data() + 4 * r;
      corner.at[r] = static_cast<double>(row[0]) * at[0] + static_cast<double>(row[1]) * at[1] +
                     static_cast<double>(row[2]) * at[2] + static_cast<double>(row[3]);
      corner.weight[r] = r == i ? 1 : 0;
    }
  }
  // The first two clipping planes are the near and the far plane. The other planes limit both picture
  // coordinates to the range from -g to g (samples).
  const double g = 0.5 * kRange, fx = static_cast<double>(p.focal_x),
               fy = static_cast<double>(p.focal_y);
  const double cx = static_cast<double>(p.centre_x), cy = static_cast<double>(p.centre_y);
  const std::array<std::array<double, 4>, 6> planes{{{0, 0, 1, -static_cast<double>(p.near)},
                                                     {0, 0, -1, static_cast<double>(p.far)},
                                                     {fx, 0, cx + g, 0},
                                                     {-fx, 0, g - cx, 0},
                                                     {0, fy, cy + g, 0},
                                                     {0, -fy, g - cy, 0}}};
  for (const auto& plane : planes) {
    polygon = clipped(polygon, plane);
    if (polygon.count < 3) return;
  }
  std::array<std::uint32_t, 12> numbers{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(polygon.count); ++i)
    numbers[i] = append_vertex(job.v, polygon.corners[i], of, p);
  for (std::size_t i = 2; i < static_cast<std::size_t>(polygon.count); ++i)
    fill_triangle(job, numbers[0], numbers[i - 1], numbers[i], of[2]);
}

static inline void fill(Vertices& v, const Batch& batch, const Projection& p, Target& target,
                        std::vector<Primitive>& primitives) {
  const FillJob job{v, target, primitives, batch.surface};
  for (std::uint32_t i = 0; i < batch.count; i += 3) {
    const std::uint32_t a = batch.indices[i], b = batch.indices[i + 1], c = batch.indices[i + 2];
    const std::int32_t all = v.outside[a] & v.outside[b] & v.outside[c] & ~kOutOfRange;
    if (all != 0) continue;
    if (((v.outside[a] | v.outside[b] | v.outside[c]) & kMustClip) != 0) {
      fill_clipped(job, p, {a, b, c});
    } else {
      fill_triangle(job, a, b, c, c);
    }
  }
}

KAZ_LANES_INLINE void fill_shadow_span(ShadowTexels& map, float x0, float base, float by_x, int row,
                                       int first, int end) {
  std::uint16_t* depth =
      map.depth.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(map.stride);
  const Ints lanes = lane_numbers();
  using Halves = std::uint16_t __attribute__((vector_size(2 * kLanes)));
  for (int x = first; x < end; x += kLanes) {
    const Ints column = lanes + x;
    const Floats z = base + by_x * (to_float(column) - x0);
    const Ints code = to_int(larger(smaller(z, splat(65535.0F)), splat(0.0F)) + 0.5F);
    const Ints before = __builtin_convertvector(load_as<Halves>(depth + x), Ints);
    const Ints wins = (code < before) & (column < end);
    store(depth + x, __builtin_convertvector(wins ? code : before, Halves));
  }
}

static inline void fill_shadow(const Vertices& v, const Batch& batch, ShadowTexels& map) {
  for (std::uint32_t i = 0; i < batch.count; i += 3) {
    const std::uint32_t a = batch.indices[i], b = batch.indices[i + 1], c = batch.indices[i + 2];
    // As seen from the lamp, the row numbers of the shadow map increase upward. Therefore triangles that face
    // away from the lamp have a negative area. Swapping b and c makes the area positive.
    const Outline t = outline_of(v, a, c, b);
    if (twice_area(t) <= 0) continue;
    const float x0 = static_cast<float>(t.x[0]) * (1.0F / kSubpixel);
    const float y0 = static_cast<float>(t.y[0]) * (1.0F / kSubpixel);
    const Slope depth = Gradients(t).slope(v.w[a], v.w[c], v.w[b]);
    scan(t, 1, 1, map.side - 1, map.side - 1, [&](int row, int first, int end) {
      const float base = depth.at + depth.by_y * (static_cast<float>(row) - y0);
      fill_shadow_span(map, x0, base, depth.by_x, row, first, end);
    });
  }
}

}  // namespace kaz::sim::raster::KAZ_RASTER_SET
KAZ_RASTER_END
