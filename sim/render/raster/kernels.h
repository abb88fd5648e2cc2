// Data of the rasterizer's inner loops (kernels), and a table of the kernels for each instruction set.
// SPDX-License-Identifier: Apache-2.0
//
// The center of sample (x, y) is at integer coordinates; rows count from the top. Vertices are rounded to
// 1/256 sample; the coverage of the rounded triangles is exact. A sample center that lies exactly on an edge
// belongs to the triangle on the right of the edge or below the edge. Therefore triangles that share an edge
// neither overlap nor leave gaps. The depth is stored as w = 1 / z (1/m), which is linear in the picture. At
// each sample, the triangle with the largest w is visible. If two triangles have the same w, the triangle
// that was drawn later is visible.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kaz::sim::raster {

// Number of extra elements at the end of each array. Vector instructions may access these elements.
inline constexpr std::size_t kPad = 16;
inline constexpr int kSubpixel = 256;

// Vertices of a scene and their positions in a picture, one array per coordinate. Clipping appends vertices.
struct Vertices {
  // Number of vertices, including vertices that clipping appended.
  std::size_t count = 0;
  std::vector<float> x, y, z;          // position in the frame of the piece, m
  std::vector<float> model_normal[3];  // normal in the frame of the piece
  // Normal in the world frame, at the current pose of the piece.
  std::vector<float> normal[3];
  std::vector<float> u, v;                 // texture coordinates, in repeats of the texture
  std::vector<std::array<float, 3>> tint;  // color as linear light
  std::vector<std::int32_t> px, py;        // position in the picture, 1/256 sample
  std::vector<float> w;                    // depth of each vertex, 1 / z
  std::vector<std::int32_t> outside;       // combination of the bits kOutLeft etc.
};

// Bits of Vertices::outside. Each bit means that the vertex is beyond one plane of the view frustum.
inline constexpr std::int32_t kOutLeft = 1, kOutRight = 2, kOutTop = 4, kOutBottom = 8;
inline constexpr std::int32_t kOutNear = 16, kOutFar = 32;
// The magnitude of a coordinate in the picture is above kRange.
inline constexpr std::int32_t kOutOfRange = 64;
inline constexpr std::int32_t kMustClip = kOutNear | kOutFar | kOutOfRange;
inline constexpr int kRange = 1 << 14;  // largest magnitude of a fixed-point coordinate, in samples

struct VertexRange {
  std::uint32_t first = 0, count = 0;
};

// Pinhole view in samples: sample = focal * (x / z) + center.
struct Projection {
  std::array<float, 12> optical_from_model;  // rows of a 3 x 4 matrix
  float focal_x, focal_y, centre_x, centre_y;
  float width, height, near, far;
};

// Linear function of the sample position (x, y): `at + by_x * (x - x0) + by_y * (y - y0)`.
// The origin (x0, y0) is stored in Primitive.
struct Slope {
  float at = 0, by_x = 0, by_y = 0;
};

// A triangle that covers at least one sample.
struct Primitive {
  float x0, y0;
  Slope w;
  std::uint32_t a, b, c;  // indices of the vertices, clockwise in the picture
  // Index of the vertex that defines the color. For textured triangles, the same vertex also defines the
  // normal.
  std::uint32_t provoking;
  std::uint32_t surface;  // index into Shading::surfaces
  bool prepared;          // true: `slopes`, `shaded` and `key` are computed
  // Untextured triangles: the three components of the normal, each multiplied by w. Textured triangles:
  // slopes[0] is u * w, and slopes[1] is v * w.
  std::array<Slope, 3> slopes;
  // For a textured triangle, `shaded` is the light that the triangle reflects in shadow. Outside shadows, the
  // triangle also reflects `key`, the light from the key light. For an untextured triangle, `shaded` is the
  // tint, and `key` is unused.
  std::array<float, 3> shaded, key;
};

// Properties that all triangles of a piece share.
struct Surface {
  int texture = -1;
  // True: shadows fall on this surface only in the marked blocks (Shading::blocks).
  bool lit_outside_blocks = false;
};

// A band of rows of the picture: for each sample, the depth and the number of the nearest primitive.
struct Target {
  int left = 0, right = 0;  // the columns `left .. right - 1` are drawn
  int top = 0, bottom = 0;  // the rows `top .. bottom - 1` are drawn
  // Number of elements of a row in memory: the width of the picture in samples, plus kPad.
  int stride = 0;
  std::vector<float> w;                  // depth of each sample; 0: background
  std::vector<std::uint32_t> primitive;  // number of the primitive at each sample; 0: background
};

struct ShadowTexels {
  int side = 0;  // side length in texels; the outermost ring of texels stays free
  int stride = 0;
  std::vector<std::uint16_t> depth;  // depth of each texel; 65535: empty
};

// The triangles of a piece.
struct Batch {
  const std::uint32_t* indices;
  std::uint32_t count;
  std::uint32_t surface;
};

// A texture with its mip levels. Each word contains one color channel of four texels. From the lowest byte,
// these texels are (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1). Thus one memory access gives all values
// for a linear interpolation. A gray texture has one word per texel. Other textures have four words: red,
// green, blue, and an unused word.
struct TextureLevels {
  int side_bits = 0;                      // the side of level 0 is 2^side_bits texels
  int last = 0;                           // number of the last level
  bool grey = false;                      // true: the three color channels are equal
  std::vector<std::uint32_t> words;       // words of all levels
  std::array<std::int32_t, 16> offset{};  // index of the first texel of each mip level
};

using Three = std::array<float, 3>;

struct Shading {
  std::vector<Surface> surfaces;
  std::vector<TextureLevels> textures;
  // In the world frame, the ray to the sample (x, y) is `ray0 + ray_x * x + ray_y * y`. In the optical frame,
  // the ray has the z coordinate 1. The squared length of the ray is `1 + (ax * x + a0)^2 + (by * y + b0)^2`.
  Three ray0, ray_x, ray_y;
  float ax, a0, by, b0;
  Three to_key;
  float key_gain, shaded_gain;
  // Shadow map coordinates (texels, texels, depth 0..65535). `shadow_eye` contains the coordinates of the
  // eye. In shadow map coordinates, the ray to the sample (x, y) is `shadow0 + shadow_x * x + shadow_y * y`.
  Three shadow_eye, shadow0, shadow_x, shadow_y;
  const ShadowTexels* shadow = nullptr;
  bool soft = false;      // true: soft shadows, and linear interpolation between mip levels
  int block_columns = 0;  // number of blocks in a row of the picture
  // One value per block: 1 if a shadow can fall on a flat ground in this block, else 0.
  std::vector<std::uint8_t> blocks;
};
inline constexpr int kBlock = 32;  // side length of a block, in samples

// Working memory for shading a row.
struct RowScratch {
  std::vector<float> normal[3], tint[3];
  std::vector<std::uint32_t> codes;  // RGBA
};

struct Kernels {
  // Computes normals in the world frame. `rotation` contains the rows of a 3 x 3 matrix.
  void (*turn_normals)(Vertices&, VertexRange, const std::array<float, 9>& rotation);
  // Computes `px`, `py`, `w` and `outside` of the vertices.
  void (*project)(Vertices&, VertexRange, const Projection&);
  // Draws the triangles that face the eye. Call this function after project(). Appends each triangle that
  // covers a sample to the list of primitives.
  void (*fill)(Vertices&, const Batch&, const Projection&, Target&, std::vector<Primitive>&);
  // Draws the triangles that face away from the lamp into the shadow map. Call this function after
  // project_shadow().
  void (*fill_shadow)(const Vertices&, const Batch&, ShadowTexels&);
  // Computes the positions of vertices in the shadow map. Stores the positions in `px` and `py`, and the
  // depth (0..65535) in `w`.
  void (*project_shadow)(Vertices&, VertexRange, const std::array<float, 12>& texels_from_model);
  // Computes RowScratch::codes for a row of the target.
  void (*shade_row)(const Vertices&, const Shading&, const Target&, std::vector<Primitive>&, int y,
                    RowScratch&);
  // Converts RGBA to RGB. The function may write up to kPad bytes beyond the end of the row.
  void (*pack)(const std::uint32_t* rgba, int count, std::uint8_t* rgb);
};

const Kernels& plain_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace kaz::sim::raster
