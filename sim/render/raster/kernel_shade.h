// Shading kernels for one instruction set. The kernels shade each visible sample once, with the formulas of
// lighting.h.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/render/model/lighting.h"
#include "sim/render/raster/kernel_fill.h"

KAZ_RASTER_BEGIN
namespace kaz::sim::raster::KAZ_RASTER_SET {

// Computes the slopes of a primitive's interpolated values. For a textured primitive, also computes the
// members `shaded` and `key`.
static inline void prepare(const Vertices& v, const Shading& s, Primitive& p) {
  p.prepared = true;
  const Gradients g(outline_of(v, p.a, p.b, p.c));
  const float wa = v.w[p.a], wb = v.w[p.b], wc = v.w[p.c];
  const auto slope = [&](const std::vector<float>& f) {
    return g.slope(f[p.a] * wa, f[p.b] * wb, f[p.c] * wc);
  };
  const Three& tint = v.tint[p.provoking];
  if (s.surfaces[p.surface].texture < 0) {
    for (std::size_t k = 0; k < 3; ++k) p.slopes[k] = slope(v.normal[k]);
    p.shaded = tint;
    return;
  }
  // Adds whole repeats of the texture to make the coordinates positive. For positive coordinates, truncation
  // equals floor().
  const auto coordinate = [&](const std::vector<float>& f) {
    const float from = 1.0F - std::floor(std::min({f[p.a], f[p.b], f[p.c]}));
    return g.slope((f[p.a] + from) * wa, (f[p.b] + from) * wb, (f[p.c] + from) * wc);
  };
  p.slopes[0] = coordinate(v.u);
  p.slopes[1] = coordinate(v.v);
  const Three n{v.normal[0][p.provoking], v.normal[1][p.provoking], v.normal[2][p.provoking]};
  const auto facing = [&](const Three& l) {
    return std::max(n[0] * l[0] + n[1] * l[1] + n[2] * l[2], 0.0F);
  };
  const float up = 0.5F * n[2] + 0.5F, filled = lighting::kFill * facing(lighting::kToFill);
  const float key = facing(s.to_key) * s.key_gain;
  for (std::size_t k = 0; k < 3; ++k) {
    const float ambient =
        lighting::kGround[k] + (lighting::kSky[k] - lighting::kGround[k]) * up + filled;
    p.shaded[k] = tint[k] * ambient * s.shaded_gain;
    p.key[k] = tint[k] * lighting::kKey[k] * key;
  }
}

struct Vector3 {
  Floats x, y, z;
};

// Three linear functions of the column x in a row: `at[i] + by[i] * x`.
struct Along {
  float at[3], by[3];
};
KAZ_LANES_INLINE Along along_row(const Three& at0, const Three& by_x, const Three& by_y, float y) {
  Along a{};
  for (std::size_t k = 0; k < 3; ++k) {
    a.at[k] = at0[k] + by_y[k] * y;
    a.by[k] = by_x[k];
  }
  return a;
}

struct Row {
  const Shading& s;
  float y;
  int number;
  const float* w;  // 1 / z of each sample
  Along ray, shadow;
  // The squared length of the ray to a sample is the sum of `b2` and a term that depends on the column. All
  // samples of the row have the same `b2`: `b2 = 1 + (by * y + b0)^2`.
  float b2;
};

KAZ_LANES_INLINE Floats square(Floats x) {
  return x * x;
}
// Returns the squared lengths of the rays to the samples.
KAZ_LANES_INLINE Floats ray_square(const Row& row, Floats x) {
  return square(row.s.ax * x + row.s.a0) + row.b2;
}

// Converts linear light of one color channel to codes 0..255.
KAZ_LANES_INLINE Ints code_of(Floats light) {
  const Floats code = root(light) * 255.0F + 0.5F;
  return to_int(smaller(code, splat(255.0F)));
}
KAZ_LANES_INLINE Ints packed(Ints r, Ints g, Ints b) {
  return r | (g << 8) | (b << 16) | static_cast<std::int32_t>(0xFF000000U);
}
KAZ_LANES_INLINE Ints hazy(Floats r, Floats g, Floats b, Floats haze) {
  const auto& h = lighting::kHorizon;
  return packed(code_of(r + (h[0] - r) * haze), code_of(g + (h[1] - g) * haze),
                code_of(b + (h[2] - b) * haze));
}

// Returns the share of the key light that reaches a point. The point is given in shadow map coordinates:
// texels and a depth code. The depth of the point is compared with the depths of the four nearest texels. The
// function interpolates linearly between the four results. OpenGL's LINEAR with COMPARE_REF_TO_TEXTURE does
// the same.
KAZ_LANES_INLINE Floats lit_at(const ShadowTexels& map, Floats sx, Floats sy, Floats depth) {
  const float limit = static_cast<float>(map.side) - 1.5F;
  const Floats fx = larger(smaller(sx - 0.5F, splat(limit)), splat(0.0F));
  const Floats fy = larger(smaller(sy - 0.5F, splat(limit)), splat(0.0F));
  const Ints ix = to_int(fx), iy = to_int(fy);
  const Floats ax = fx - to_float(ix), ay = fy - to_float(iy);
  const Ints index = iy * map.stride + ix;
  const Ints upper = gather_pairs(map.depth.data(), index);
  const Ints lower = gather_pairs(map.depth.data(), index + map.stride);
  const Floats zero = splat(0.0F), one = splat(1.0F);
  const auto passes = [&](Ints texel) { return depth <= to_float(texel) ? one : zero; };
  const Floats u0 = passes(upper & 0xFFFF), u1 = passes((upper >> 16) & 0xFFFF);
  const Floats l0 = passes(lower & 0xFFFF), l1 = passes((lower >> 16) & 0xFFFF);
  const Floats u = u0 + (u1 - u0) * ax, l = l0 + (l1 - l0) * ax;
  return u + (l - u) * ay;
}

KAZ_LANES_INLINE Floats lit(const Row& row, Floats x, Floats z) {
  const Shading& s = row.s;
  const auto at = [&](std::size_t k) {
    return (row.shadow.at[k] + row.shadow.by[k] * x) * z + s.shadow_eye[k];
  };
  const Floats sx = at(0), sy = at(1);
  const Floats depth = larger(smaller(at(2), splat(65535.0F)), splat(0.0F));
  if (!s.soft) return lit_at(*s.shadow, sx, sy, depth);
  Floats sum = splat(0.0F);
  for (const auto& tap : lighting::kTaps)
    sum = sum + lit_at(*s.shadow, sx + tap[0] * lighting::kSoftTexels,
                       sy + tap[1] * lighting::kSoftTexels, depth);
  return sum * (1.0F / 12.0F);
}

KAZ_LANES_INLINE Floats column_numbers(int x) {
  return to_float(lane_numbers() + x);
}

static inline void shade_background(const Row& row, int first, int end, std::uint32_t* codes) {
  for (int at = first; at < end; at += kLanes) {
    const Floats x = column_numbers(at);
    const Floats z = row.ray.at[2] + row.ray.by[2] * x;
    const Floats up = larger(smaller(z / root(ray_square(row, x)), splat(1.0F)), splat(0.0F));
    const Floats t = up * (2.0F - up);
    const auto channel = [&](std::size_t k) {
      return code_of(lighting::kHorizon[k] + (lighting::kZenith[k] - lighting::kHorizon[k]) * t);
    };
    store(codes + at, packed(channel(0), channel(1), channel(2)));
  }
}

// Stores the normals and tints for a run of samples of one primitive. shade_plain() uses the stored values.
static inline void spread(const Primitive& p, const Row& row, int first, int end,
                          RowScratch& scratch) {
  float at[3];
  for (std::size_t k = 0; k < 3; ++k) at[k] = p.slopes[k].at + p.slopes[k].by_y * (row.y - p.y0);
  for (int x = first; x < end; x += kLanes) {
    const Floats dx = column_numbers(x) - p.x0;
    for (std::size_t k = 0; k < 3; ++k) {
      store(&scratch.normal[k][static_cast<std::size_t>(x)], at[k] + p.slopes[k].by_x * dx);
      store(&scratch.tint[k][static_cast<std::size_t>(x)], splat(p.shaded[k]));
    }
  }
}

KAZ_LANES_INLINE Floats dot(const Vector3& a, const Vector3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
KAZ_LANES_INLINE Floats dot(const Vector3& a, const Three& b) {
  return a.x * b[0] + a.y * b[1] + a.z * b[2];
}

// Shades the untextured samples `first .. end - 1`, which may belong to several primitives.
static inline void shade_plain(const Row& row, int first, int end, const RowScratch& scratch,
                               std::uint32_t* codes) {
  const Shading& s = row.s;
  for (int at = first; at < end; at += kLanes) {
    const auto i = static_cast<std::size_t>(at);
    const Floats x = column_numbers(at);
    const Vector3 raw{load(&scratch.normal[0][i]), load(&scratch.normal[1][i]),
                      load(&scratch.normal[2][i])};
    const Floats shorten = 1.0F / root(dot(raw, raw));
    const Vector3 n{raw.x * shorten, raw.y * shorten, raw.z * shorten};
    const Floats z = 1.0F / load(row.w + at);
    const Floats square_ray = ray_square(row, x), zero = splat(0.0F);
    const Floats distance2 = square_ray * square(z);
    // `view` is the direction to the eye, opposite to the ray.
    const Floats back = -1.0F / root(square_ray);
    const Vector3 view{(row.ray.at[0] + row.ray.by[0] * x) * back,
                       (row.ray.at[1] + row.ray.by[1] * x) * back,
                       (row.ray.at[2] + row.ray.by[2] * x) * back};
    Floats key = larger(dot(n, s.to_key), zero);
    if (any(key > 0.0F)) key = key * lit(row, x, z) * s.key_gain;
    const Vector3 half{view.x + s.to_key[0], view.y + s.to_key[1], view.z + s.to_key[2]};
    Floats shine = larger(dot(n, half) / root(dot(half, half)), zero);
    for (int k = 0; k < 5; ++k) shine = shine * shine;
    shine = lighting::kHighlight * shine * key;
    const Floats up = 0.5F * n.z + 0.5F;
    const Floats filled = lighting::kFill * larger(dot(n, lighting::kToFill), zero);
    const auto channel = [&](std::size_t k) {
      const Floats ambient =
          lighting::kGround[k] + (lighting::kSky[k] - lighting::kGround[k]) * up + filled;
      const Floats light = ambient * s.shaded_gain + lighting::kKey[k] * key;
      return load(&scratch.tint[k][i]) * light + shine;
    };
    const Floats haze = distance2 / (distance2 + lighting::kHaze_m2);
    store(codes + at, hazy(channel(0), channel(1), channel(2), haze));
  }
}

// Texture value: three color channels, 0..255.
struct Pattern {
  Floats r, g, b;
};
KAZ_LANES_INLINE Pattern mix(const Pattern& a, const Pattern& b, Floats share) {
  return {a.r + (b.r - a.r) * share, a.g + (b.g - a.g) * share, a.b + (b.b - a.b) * share};
}
// The four texels around a point, and the position of the point between these texels.
struct Footprint {
  Ints index;
  Floats across, down;
};
KAZ_LANES_INLINE Floats interpolated(Ints four, const Footprint& f) {
  const Floats a = to_float(four & 255), b = to_float((four >> 8) & 255);
  const Floats c = to_float((four >> 16) & 255), d = to_float((four >> 24) & 255);
  const Floats upper = a + (b - a) * f.across, lower = c + (d - c) * f.across;
  return upper + (lower - upper) * f.down;
}
KAZ_LANES_INLINE Pattern interpolated(const TextureLevels& t, const Footprint& f) {
  if (t.grey) {
    const Floats grey = interpolated(gather(t.words.data(), f.index), f);
    return {grey, grey, grey};
  }
  const ThreeWords words = gather_three(t.words.data(), f.index);
  return {interpolated(words.first, f), interpolated(words.second, f),
          interpolated(words.third, f)};
}

// Returns the footprint at (u, v). u and v are in repeats of the texture and must be positive. `side_bits`,
// `mask` and `offset` describe the mip level: one level for all lanes, or one level per lane.
template <class Level>
KAZ_LANES_INLINE Footprint footprint(Floats u, Floats v, Floats side, Level side_bits, Level mask,
                                     Level offset) {
  const Floats fu = u * side - 0.5F, fv = v * side - 0.5F;
  const Ints iu = to_int(fu), iv = to_int(fv);
  return {((iv & mask) << side_bits) + ((iu & mask) + offset), fu - to_float(iu),
          fv - to_float(iv)};
}
KAZ_LANES_INLINE Pattern texel_at(const TextureLevels& t, Floats u, Floats v, int level) {
  const int side_bits = t.side_bits - level, mask = (1 << side_bits) - 1;
  const Floats side = splat(static_cast<float>(mask + 1));
  return interpolated(
      t, footprint(u, v, side, side_bits, mask, t.offset[static_cast<std::size_t>(level)]));
}
KAZ_LANES_INLINE Pattern texel_at(const TextureLevels& t, Floats u, Floats v, Ints level) {
  const Ints side_bits = t.side_bits - level, mask = (1 << side_bits) - 1;
  const Ints offset = look_up(t.offset.data(), level);
  return interpolated(t, footprint(u, v, to_float(mask + 1), side_bits, mask, offset));
}

// Texture coordinates of a primitive in a row of samples, and the differences of these coordinates within
// blocks of 2 x 2 samples.
struct TextureRow {
  // The products `u * w` and `v * w`, and w itself. Each is a linear function of the column x:
  // `at + by * (x - x0)`.
  Along plane;
  float x0;
  // From one column to the next column, w changes to `w'`. The change of u is this fraction:
  // `(by_u * w - by_w * u * w) / (w * w')`. The change of v is this fraction:
  // `(by_v * w - by_w * v * w) / (w * w')`. The numerator of each fraction is the same at all columns of a
  // row. In the upper row of the block, `across_u` is the numerator of the change of u, and `across_v` is
  // the numerator of the change of v.
  float across_u, across_v;
  // From the upper to the lower row of the block, the changes of u and v are fractions, too. `down_u` is the
  // numerator of the change of u, and `down_v` is the numerator of the change of v. `down_u` and `down_v`
  // have the type Slope, and their value at the column x is `at + by_x * (x - x0)`.
  Slope down_u, down_v;
  float w_upper, w_lower;  // w of the upper and lower row of the block, at x0
  float by_w;
};

KAZ_LANES_INLINE TextureRow texture_row(const Primitive& p, const Row& row) {
  TextureRow t{};
  const Slope* f[3] = {&p.slopes[0], &p.slopes[1], &p.w};
  const float dy = row.y - p.y0;
  const float upper = static_cast<float>(row.number & ~1) - p.y0;
  float at[3];
  for (int k = 0; k < 3; ++k) {
    t.plane.at[k] = f[k]->at + f[k]->by_y * dy;
    t.plane.by[k] = f[k]->by_x;
    at[k] = f[k]->at + f[k]->by_y * upper;
  }
  t.x0 = p.x0;
  t.by_w = p.w.by_x;
  t.w_upper = at[2];
  t.w_lower = at[2] + p.w.by_y;
  t.across_u = p.slopes[0].by_x * at[2] - p.w.by_x * at[0];
  t.across_v = p.slopes[1].by_x * at[2] - p.w.by_x * at[1];
  const auto down = [&](int k) {
    return Slope{f[k]->by_y * at[2] - p.w.by_y * at[k],
                 f[k]->by_y * p.w.by_x - p.w.by_y * f[k]->by_x, 0.0F};
  };
  t.down_u = down(0);
  t.down_v = down(1);
  return t;
}

// Each sample has two neighbors: the next sample in the row and the next sample in the column. The function
// computes how far the texture coordinates of each neighbor are from the texture coordinates of the sample,
// in texels of level 0. Returns the square of the larger distance. The samples of a 2 x 2 block have the same
// result.
KAZ_LANES_INLINE Floats texels_a_sample(const TextureRow& t, int at, float side) {
  const Floats dx = to_float((lane_numbers() + at) & ~1) - t.x0;
  const Floats w00 = t.w_upper + t.by_w * dx, w10 = t.w_upper + t.by_w * (dx + 1.0F);
  const Floats w01 = t.w_lower + t.by_w * dx;
  const float across = t.across_u * t.across_u + t.across_v * t.across_v;
  const Floats down =
      square(t.down_u.at + t.down_u.by_x * dx) + square(t.down_v.at + t.down_v.by_x * dx);
  return larger(across / square(w00 * w10), down / square(w00 * w01)) * (side * side);
}

KAZ_LANES_INLINE Ints exponent(Floats x) {
  return ((bits(x) >> 23) & 255) - 127;
}

// Returns round(log2(root(texels2))), limited to 0..last.
// The result is half the binary exponent of `2 * texels2`.
KAZ_LANES_INLINE Ints nearest_level(Floats texels2, int last) {
  const Ints level = exponent(texels2 * 2.0F) >> 1;
  return larger_int(smaller_int(level, splat_int(last)), splat_int(0));
}

// If `soft` is false, samples the texture at the nearest mip level, like OpenGL's LINEAR_MIPMAP_NEAREST in
// llvmpipe. If `soft` is true, interpolates linearly between two mip levels, like OpenGL's
// LINEAR_MIPMAP_LINEAR in llvmpipe. In llvmpipe, LINEAR_MIPMAP_LINEAR mixes two levels only if the fractional
// part of the computed level is between 0.25 and 0.75. Otherwise LINEAR_MIPMAP_LINEAR uses only the nearest
// level.
KAZ_LANES_INLINE Pattern pattern(const TextureLevels& t, Floats u, Floats v, Floats texels2,
                                 bool soft) {
  if (!soft) return texel_at(t, u, v, nearest_level(texels2, t.last));
  const Ints last = splat_int(t.last), zero = splat_int(0);
  // `lod` is log2(root(texels2)) + 0.25. The logarithm is interpolated linearly between powers of two.
  const Floats mantissa = (Floats)((bits(texels2) & 0x007FFFFF) | 0x3F800000);
  const Floats lod = 0.5F * (to_float(exponent(texels2)) + (mantissa - 1.0F)) + 0.25F;
  const Floats whole = floor_of(lod);
  const Ints level = to_int(whole);
  const Floats share = larger((lod - whole) * 2.0F - 1.0F, splat(0.0F));
  const Ints fine = larger_int(smaller_int(level, last), zero);
  const Ints coarse = larger_int(smaller_int(level + 1, last), zero);
  const Floats part = level < 0 ? splat(0.0F) : share;
  const Pattern one = texel_at(t, u, v, fine);
  if (!any(part > 0.0F)) return one;
  return mix(one, texel_at(t, u, v, coarse), part);
}

// Returns the mip level if all samples `first .. end - 1` have the same level. Returns -1 if the samples may
// have several levels. The function computes the smallest and the largest possible level from the first and
// the last sample. The samples in between are within these bounds, because w and the numerators are linear
// functions of the column.
static inline int level_of_all(const TextureRow& t, const TextureLevels& texture, int first,
                               int end) {
  const float from = static_cast<float>(first & ~1) - t.x0;
  const float to = static_cast<float>((end - 1) | 1) - t.x0;
  const float w[4] = {t.w_upper + t.by_w * from, t.w_upper + t.by_w * to, t.w_lower + t.by_w * from,
                      t.w_lower + t.by_w * to};
  const float w_low = std::min({w[0], w[1], w[2], w[3]});
  const float w_high = std::max({w[0], w[1], w[2], w[3]});
  if (!(w_low > 0.0F)) return -1;
  const auto square_of = [](float x) { return x * x; };
  float low = 0, high = 0;
  for (const Slope* s : {&t.down_u, &t.down_v}) {
    const float a = s->at + s->by_x * from, b = s->at + s->by_x * to;
    high += std::max(square_of(a), square_of(b));
    if ((a > 0) == (b > 0)) low += std::min(square_of(a), square_of(b));
  }
  const float across = square_of(t.across_u) + square_of(t.across_v);
  const auto side = static_cast<float>(1 << texture.side_bits);
  constexpr float kMargin = 1.0001F;
  const float smallest = std::max(low, across) * square_of(side / square_of(w_high)) / kMargin;
  const float largest = std::max(high, across) * square_of(side / square_of(w_low)) * kMargin;
  const auto level = [&](float texels2) {
    const Ints levels = nearest_level(splat(texels2), texture.last);
    return static_cast<int>(levels[0]);
  };
  const int fine = level(smallest);
  return fine == level(largest) ? fine : -1;
}

template <bool kShadowed, bool kOneLevel>
static inline void shade_textured(const Row& row, const Primitive& p, const TextureRow& t,
                                  int first, int end, int level, std::uint32_t* codes) {
  const Shading& s = row.s;
  const TextureLevels& texture =
      s.textures[static_cast<std::size_t>(s.surfaces[p.surface].texture)];
  const auto side = static_cast<float>(1 << texture.side_bits);
  for (int at = first; at < end; at += kLanes) {
    const Floats x = column_numbers(at), dx = x - t.x0;
    const Floats w = t.plane.at[2] + t.plane.by[2] * dx;
    // Divisions are slow. Therefore the code divides only once: `both = 1 / (w * sum)`. Then `both * sum` is
    // `1 / w`, and `both * w` is `1 / sum`.
    const Floats q = ray_square(row, x), near = lighting::kHaze_m2 * square(w), sum = q + near;
    const Floats both = 1.0F / (w * sum), z = both * sum, share = both * w;
    const Floats u = (t.plane.at[0] + t.plane.by[0] * dx) * z;
    const Floats v = (t.plane.at[1] + t.plane.by[1] * dx) * z;
    Pattern texel;
    if constexpr (kOneLevel) {
      texel = texel_at(texture, u, v, level);
    } else {
      texel = pattern(texture, u, v, texels_a_sample(t, at, side), s.soft);
    }
    const Floats key = kShadowed ? lit(row, x, z) : splat(1.0F);
    const Floats clear = near * share * (1.0F / (255.0F * 255.0F)), haze = q * share;
    const auto channel = [&](std::size_t k, Floats code) {
      return code_of(square(code) * (p.shaded[k] + p.key[k] * key) * clear +
                     lighting::kHorizon[k] * haze);
    };
    store(codes + at, packed(channel(0, texel.r), channel(1, texel.g), channel(2, texel.b)));
  }
}

constexpr int kOneLevelSamples = 64;

template <bool kShadowed>
static inline void shade_textured(const Row& row, const Primitive& p, const TextureRow& t,
                                  int first, int end, std::uint32_t* codes) {
  const Shading& s = row.s;
  const TextureLevels& texture =
      s.textures[static_cast<std::size_t>(s.surfaces[p.surface].texture)];
  while (first < end) {
    const int stop = std::min(end, first + kOneLevelSamples);
    const int level = s.soft ? -1 : level_of_all(t, texture, first, stop);
    if (level >= 0) {
      shade_textured<kShadowed, true>(row, p, t, first, stop, level, codes);
    } else {
      shade_textured<kShadowed, false>(row, p, t, first, stop, level, codes);
    }
    first = stop;
  }
}

// Shades a run of textured samples. Splits the run at the columns where marked blocks (Shading::blocks) begin
// and end.
static inline void shade_textured_run(const Row& row, const Primitive& p, int first, int end,
                                      std::uint32_t* codes) {
  const Shading& s = row.s;
  const TextureRow t = texture_row(p, row);
  if (!s.surfaces[p.surface].lit_outside_blocks)
    return shade_textured<true>(row, p, t, first, end, codes);
  const std::uint8_t* marked = s.blocks.data() + static_cast<std::size_t>(row.number / kBlock) *
                                                     static_cast<std::size_t>(s.block_columns);
  while (first < end) {
    const std::uint8_t kind = marked[first / kBlock];
    int stop = (first / kBlock + 1) * kBlock;
    while (stop < end && marked[stop / kBlock] == kind) stop += kBlock;
    stop = std::min(stop, end);
    if (kind != 0) {
      shade_textured<true>(row, p, t, first, stop, codes);
    } else {
      shade_textured<false>(row, p, t, first, stop, codes);
    }
    first = stop;
  }
}

// Returns the first column after `x` that belongs to another primitive. Returns `right` if the columns up to
// `right - 1` all belong to the same primitive.
static inline int run_end(const std::uint32_t* owner, int x, int right) {
  const Ints mine = splat_int(static_cast<std::int32_t>(owner[x]));
  for (; x < right; x += kLanes) {
    const std::uint32_t others = mask_bits(load_ints(owner + x) != mine);
    if (others != 0) return std::min(x + __builtin_ctz(others), right);
  }
  return right;
}

static inline void shade_row(const Vertices& v, const Shading& s, const Target& target,
                             std::vector<Primitive>& primitives, int y, RowScratch& scratch) {
  const std::size_t begin =
      static_cast<std::size_t>(y - target.top) * static_cast<std::size_t>(target.stride);
  const std::uint32_t* owner = target.primitive.data() + begin;
  const auto fy = static_cast<float>(y);
  const float b = s.by * fy + s.b0;
  const Row row{s,
                fy,
                y,
                target.w.data() + begin,
                along_row(s.ray0, s.ray_x, s.ray_y, fy),
                along_row(s.shadow0, s.shadow_x, s.shadow_y, fy),
                1.0F + b * b};
  std::uint32_t* codes = scratch.codes.data();
  // First column of the untextured samples that are not shaded yet; -1: no such samples.
  int plain = -1;
  for (int x = target.left; x < target.right;) {
    const int end = run_end(owner, x, target.right);
    Primitive& p = primitives[owner[x]];
    if (owner[x] != 0 && !p.prepared) prepare(v, s, p);
    const bool is_plain = owner[x] != 0 && s.surfaces[p.surface].texture < 0;
    if (is_plain) {
      if (plain < 0) plain = x;
      spread(p, row, x, end, scratch);
    } else {
      if (plain >= 0) shade_plain(row, plain, x, scratch, codes);
      plain = -1;
      if (owner[x] == 0) {
        shade_background(row, x, end, codes);
      } else {
        shade_textured_run(row, p, x, end, codes);
      }
    }
    x = end;
  }
  if (plain >= 0) shade_plain(row, plain, target.right, scratch, codes);
}

static inline void pack(const std::uint32_t* rgba, int count, std::uint8_t* rgb) {
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  int i = 0;
  for (; i + 4 <= count; i += 4, rgb += 12) {
    const Bytes four = load_as<Bytes>(rgba + i);
    const Bytes three =
        __builtin_shufflevector(four, four, 0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    store(rgb, three);
  }
  for (; i < count; ++i, rgb += 3) std::memcpy(rgb, rgba + i, 4);
}

inline constexpr Kernels kKernels{turn_normals,   project,   fill, fill_shadow,
                                  project_shadow, shade_row, pack};

}  // namespace kaz::sim::raster::KAZ_RASTER_SET
KAZ_RASTER_END
