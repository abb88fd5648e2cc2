// What the inner loops of the rasteriser read and write, and their table for each set of instructions.
// SPDX-License-Identifier: Apache-2.0
//
// Sample (x, y) has its centre at integer coordinates; rows count from the top. Vertices are snapped to
// 1/256 sample and coverage is exact: a centre on an edge belongs to the triangle on its right or below, so
// triangles that share an edge neither overlap nor leave gaps. Depth is w = 1 / z (1/m), which is linear in
// the picture; the larger w wins, of equal ones the later.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::sim::raster {

// Arrays that vectors read are longer by this number of elements.
inline constexpr std::size_t kPad = 16;
inline constexpr int kSubpixel = 256;

// Vertices of a scene and their images in a view; one array for each number. Clipping appends vertices.
struct Vertices {
  std::size_t count = 0;                   // those of clipping included
  std::vector<float> x, y, z;              // in the frame of their piece, m
  std::vector<float> model_normal[3];      // likewise
  std::vector<float> normal[3];            // world frame, for the current pose
  std::vector<float> u, v;                 // repeats of the texture
  std::vector<std::array<float, 3>> tint;  // linear light of the colour
  std::vector<std::int32_t> px, py;        // samples / 256
  std::vector<float> w;                    // 1 / z
  std::vector<std::int32_t> outside;       // bits as below
};

// Bits of Vertices::outside.
inline constexpr std::int32_t out_left = 1, out_right = 2, out_top = 4, out_bottom = 8;
inline constexpr std::int32_t out_near = 16, out_far = 32;
inline constexpr std::int32_t out_of_range = 64;  // too far from the picture for the fixed point
inline constexpr std::int32_t kMustClip = out_near | out_far | out_of_range;
inline constexpr int kRange = 1 << 14;  // samples: of fixed point coordinates

struct VertexRange {
  std::uint32_t first = 0, count = 0;
};

// Pinhole view in samples: sample = focal * (x / z) + centre.
struct Projection {
  std::array<float, 12> optical_from_model;  // rows of a 3 x 4 matrix
  float focal_x, focal_y, centre_x, centre_y;
  float width, height, near, far;
};

// Linear function of the sample: f(x, y) = at + by_x (x - x0) + by_y (y - y0), x0, y0 of the primitive.
struct Slope {
  float at = 0, by_x = 0, by_y = 0;
};

// A triangle that covers samples.
struct Primitive {
  float x0, y0;
  Slope w;
  std::uint32_t a, b, c;    // vertices, clockwise in the picture
  std::uint32_t provoking;  // vertex whose colour and, where textured, normal hold for the whole
  std::uint32_t surface;    // index into Shading::surfaces
  bool prepared;            // the rest is computed
  std::array<Slope, 3> slopes;  // normal * w; textured: u * w, v * w
  std::array<float, 3> shaded,
      key;  // textured: light in shadow, and what the key light adds; else the colour
};

// What is the same for all triangles of a piece.
struct Surface {
  int texture = -1;
  bool lit_outside_blocks = false;  // shadows fall only in the marked blocks of the picture
};

// First depth and primitive of each sample in a band of rows.
struct Target {
  int left = 0, right = 0;  // columns left .. right - 1 are drawn
  int top = 0, bottom = 0;  // rows top .. bottom - 1
  int stride = 0;           // columns, from 0 on; padded by kPad
  std::vector<float> w;     // 0: nothing there
  std::vector<std::uint32_t> primitive;
};

struct ShadowTexels {
  int side = 0;  // texels; the outermost ring stays free
  int stride = 0;
  std::vector<std::uint16_t> depth;  // 65535: nothing there
};

// Triangles of a piece.
struct Batch {
  const std::uint32_t* indices;
  std::uint32_t count;
  std::uint32_t surface;
};

// Each word holds the codes of one channel at the four texels (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1),
// the first in the lowest byte: one look-up is enough for linear interpolation. A grey texture has one word
// a texel, others four: red, green, blue, and one that is unused.
struct TextureLevels {
  int side_bits = 0;  // side of level 0 is 2^side_bits texels
  int last = 0;
  bool grey = false;                      // the three channels are the same
  std::vector<std::uint32_t> words;       // of all levels
  std::array<std::int32_t, 16> offset{};  // of a level, texels
};

using Three = std::array<float, 3>;

struct Shading {
  std::vector<Surface> surfaces;
  std::vector<TextureLevels> textures;
  // Ray to the sample with z = 1 in the optical frame; its square is 1 + (ax x + a0)^2 + (by y + b0)^2.
  Three ray0, ray_x, ray_y;  // world frame: ray0 + ray_x x + ray_y y
  float ax, a0, by, b0;
  Three to_key;
  float key_gain, shaded_gain;
  // Shadow map coordinates (texels, texels, depth 0..65535) of the eye and of the ray.
  Three shadow_eye, shadow0, shadow_x, shadow_y;
  const ShadowTexels* shadow = nullptr;
  bool soft = false;      // many taps, and linear between levels of textures
  int block_columns = 0;  // of blocks of kBlock samples
  std::vector<std::uint8_t> blocks;
};
inline constexpr int kBlock = 32;

// Arrays that shading uses for a row.
struct RowScratch {
  std::vector<float> normal[3], tint[3];
  std::vector<std::uint32_t> codes;  // RGBA
};

struct Kernels {
  // World normals of vertices; `rotation`: rows of a 3 x 3 matrix.
  void (*turn_normals)(Vertices&, VertexRange, const std::array<float, 9>& rotation);
  void (*project)(Vertices&, VertexRange, const Projection&);
  // Draws the triangles that face the eye; appends to `primitives`.
  void (*fill)(Vertices&, const Batch&, const Projection&, Target&, std::vector<Primitive>&);
  // Vertices projected with w = depth 0..65535: draws triangles that face away from the lamp.
  void (*fill_shadow)(const Vertices&, const Batch&, ShadowTexels&);
  void (*project_shadow)(Vertices&, VertexRange, const std::array<float, 12>& texels_from_model);
  // Colours of a row of the target: RGBA.
  void (*shade_row)(const Vertices&, const Shading&, const Target&, std::vector<Primitive>&, int y,
                    RowScratch&);
  // RGBA to RGB; writes up to 16 bytes too many.
  void (*pack)(const std::uint32_t* rgba, int count, std::uint8_t* rgb);
};

const Kernels& plain_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace kaz::sim::raster
