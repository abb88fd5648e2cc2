// Data of the rasterizer's inner loops, and the table of these functions for each instruction set.
// SPDX-License-Identifier: Apache-2.0
//
// Sample (x, y) has its center at integer coordinates; rows count from the top. Vertices are snapped to 1/256
// sample, and coverage is exact. A center on an edge belongs to the triangle on its right or below, so
// triangles that share an edge neither overlap nor leave gaps. Depth is w = 1 / z (1/m), which is linear in
// the picture. The larger w wins; if equal, the later triangle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::sim::raster {

// Number of extra elements at the end of arrays that are accessed with vectors.
inline constexpr std::size_t kPad = 16;
inline constexpr int kSubpixel = 256;

// Vertices of a scene and their images in a view, one array per coordinate. Clipping appends vertices.
struct Vertices {
  std::size_t count = 0;                   // with the vertices of clipping
  std::vector<float> x, y, z;              // frame of the piece, m
  std::vector<float> model_normal[3];      // frame of the piece
  std::vector<float> normal[3];            // world frame, for the current pose
  std::vector<float> u, v;                 // repeats of the texture
  std::vector<std::array<float, 3>> tint;  // color as linear light
  std::vector<std::int32_t> px, py;        // position in the picture, 1/256 sample
  std::vector<float> w;                    // 1 / z
  std::vector<std::int32_t> outside;       // bits below
};

// Bits of Vertices::outside.
inline constexpr std::int32_t out_left = 1, out_right = 2, out_top = 4, out_bottom = 8;
inline constexpr std::int32_t out_near = 16, out_far = 32;
inline constexpr std::int32_t out_of_range = 64;  // too far from the picture for fixed point
inline constexpr std::int32_t kMustClip = out_near | out_far | out_of_range;
inline constexpr int kRange = 1 << 14;  // largest magnitude of fixed-point coordinates, samples

struct VertexRange {
  std::uint32_t first = 0, count = 0;
};

// Pinhole view in samples: sample = focal * (x / z) + center.
struct Projection {
  std::array<float, 12> optical_from_model;  // rows of a 3 x 4 matrix
  float focal_x, focal_y, centre_x, centre_y;
  float width, height, near, far;
};

// Linear function of the sample: f(x, y) = at + by_x (x - x0) + by_y (y - y0), with the primitive's x0, y0.
struct Slope {
  float at = 0, by_x = 0, by_y = 0;
};

// A triangle that covers samples.
struct Primitive {
  float x0, y0;
  Slope w;
  std::uint32_t a, b, c;        // vertices, clockwise in the picture
  std::uint32_t provoking;      // vertex that defines the color and, if textured, the normal
  std::uint32_t surface;        // index into Shading::surfaces
  bool prepared;                // the members below are computed
  std::array<Slope, 3> slopes;  // normal * w; textured: u * w, v * w
  // Textured: light in shadow, and light that the key light adds. Else `shaded` is the tint.
  std::array<float, 3> shaded, key;
};

// Properties of all triangles of a piece.
struct Surface {
  int texture = -1;
  bool lit_outside_blocks = false;  // shadows fall only in the marked blocks of the picture
};

// Depth and number of the nearest primitive of each sample in a band of rows.
struct Target {
  int left = 0, right = 0;               // columns left .. right - 1 are drawn
  int top = 0, bottom = 0;               // rows top .. bottom - 1
  int stride = 0;                        // columns from 0 on, padded by kPad
  std::vector<float> w;                  // 0: background
  std::vector<std::uint32_t> primitive;  // 0: background
};

struct ShadowTexels {
  int side = 0;  // texels; the outermost ring stays free
  int stride = 0;
  std::vector<std::uint16_t> depth;  // 65535: empty
};

// Triangles of a piece.
struct Batch {
  const std::uint32_t* indices;
  std::uint32_t count;
  std::uint32_t surface;
};

// A texture with its mip levels. Each word holds one channel at four texels, the first in the lowest byte:
// (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1). One look-up is thus enough for linear interpolation. A gray
// texture has one word per texel. Others have four: red, green, blue, and an unused one.
struct TextureLevels {
  int side_bits = 0;                      // the side of level 0 is 2^side_bits texels
  int last = 0;                           // number of the last level
  bool grey = false;                      // the three channels are equal
  std::vector<std::uint32_t> words;       // all levels
  std::array<std::int32_t, 16> offset{};  // start of each level, texels
};

using Three = std::array<float, 3>;

struct Shading {
  std::vector<Surface> surfaces;
  std::vector<TextureLevels> textures;
  // Ray to the sample (x, y), with z = 1 in the optical frame.
  // Its square is 1 + (ax x + a0)^2 + (by y + b0)^2.
  Three ray0, ray_x, ray_y;  // world frame: ray0 + ray_x x + ray_y y
  float ax, a0, by, b0;
  Three to_key;
  float key_gain, shaded_gain;
  // Shadow map coordinates (texels, texels, depth 0..65535) of the eye and of the ray.
  Three shadow_eye, shadow0, shadow_x, shadow_y;
  const ShadowTexels* shadow = nullptr;
  bool soft = false;      // many shadow taps, and linear interpolation between mip levels
  int block_columns = 0;  // number of blocks in a row of the picture
  std::vector<std::uint8_t> blocks;  // 1: a shadow may fall on a flat ground in this block
};
inline constexpr int kBlock = 32;  // side of a block, samples

// Memory for shading a row.
struct RowScratch {
  std::vector<float> normal[3], tint[3];
  std::vector<std::uint32_t> codes;  // RGBA
};

struct Kernels {
  // Computes world normals. `rotation` has the rows of a 3 x 3 matrix.
  void (*turn_normals)(Vertices&, VertexRange, const std::array<float, 9>& rotation);
  // Computes `px`, `py`, `w` and `outside` of vertices.
  void (*project)(Vertices&, VertexRange, const Projection&);
  // Draws the triangles that face the eye, after project(). Appends those that cover samples to the list.
  void (*fill)(Vertices&, const Batch&, const Projection&, Target&, std::vector<Primitive>&);
  // Draws the triangles that face away from the lamp, after project_shadow().
  void (*fill_shadow)(const Vertices&, const Batch&, ShadowTexels&);
  // Computes `px`, `py` in the shadow map, with depth 0..65535 as `w`.
  void (*project_shadow)(Vertices&, VertexRange, const std::array<float, 12>& texels_from_model);
  // Computes RowScratch::codes of a row of the target.
  void (*shade_row)(const Vertices&, const Shading&, const Target&, std::vector<Primitive>&, int y,
                    RowScratch&);
  // Converts RGBA to RGB. May write up to kPad bytes beyond the end.
  void (*pack)(const std::uint32_t* rgba, int count, std::uint8_t* rgb);
};

const Kernels& plain_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace kaz::sim::raster
