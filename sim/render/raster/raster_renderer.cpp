// The rasteriser's passes: shadow map, depth and primitive of each sample, shading, packing.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "sim/render/model/ground_shade.h"
#include "sim/render/model/lighting.h"
#include "sim/render/model/projection.h"
#include "sim/render/model/resample.h"
#include "sim/render/model/visible.h"
#include "sim/render/raster/raster.h"
#include "sim/render/raster/raster_scene.h"

namespace kaz::sim {
namespace raster {
namespace {

// Samples of a band of rows, which are drawn at a time: bounds the memory of large pictures.
constexpr int kBandSamples = 1 << 20;

const Kernels& kernels_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return avx512_kernels();
  if (set == InstructionSet::avx2) return avx2_kernels();
#endif
  return plain_kernels();
}

bool same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return a.matrix() == b.matrix();
}

Three floats(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// The upper three rows, row by row.
std::array<float, 12> rows_of(const Eigen::Matrix4d& m) {
  std::array<float, 12> rows{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c)
      rows[static_cast<std::size_t>(4 * r + c)] = static_cast<float>(m(r, c));
  }
  return rows;
}

struct ShadowMap {
  ShadowTexels texels;
  Eigen::Matrix4d texels_from_world;  // texels, texels, depth 0..65535
  double texel_m = 0;
  std::vector<Eigen::Isometry3d> pose;  // for which it was drawn; empty: never
  Eigen::Vector3d to_key = Eigen::Vector3d::Zero();
};

class RasterRenderer final : public Renderer {
 public:
  explicit RasterRenderer(InstructionSet set) : kernels_(kernels_of(set)) {}

  Result<void> set_scene(const Scene& scene) override {
    if (scene_)
      return fail(Fault::usage, "a renderer accepts only one scene: create another renderer");
    Result<SceneModel> model = build_scene_model(scene);
    if (!model) return tl::unexpected(model.error());
    scene_.emplace(std::move(*model));
    shading_.textures = scene_->textures;
    return {};
  }

  Result<void> render(const ScenePose& pose, const View& view, vision::Image& picture) override {
    if (!scene_) return fail(Fault::usage, "a renderer needs a scene before its first picture");
    if (auto checked = check_view(scene_->model.frames, pose, view); !checked) return checked;
    const bool soft = view.samples_per_axis > 1;
    ShadowMap& map = shadow_maps_[soft ? 1 : 0];
    draw_shadow_map(pose, view.light.to_key, soft, map);
    take_pose(pose);
    take_view(pose, view, map);
    draw(view, picture);
    return {};
  }

 private:
  const Piece& piece(std::size_t i) const { return scene_->model.pieces[i]; }
  const Eigen::Isometry3d& frame(const ScenePose& pose, const Piece& piece) const {
    return pose.frames[static_cast<std::size_t>(piece.frame)];
  }
  void draw_shadow_map(const ScenePose& pose, const Eigen::Vector3d& to_key, bool soft,
                       ShadowMap& map);
  void take_pose(const ScenePose& pose);
  void take_view(const ScenePose& pose, const View& view, const ShadowMap& map);
  void mark_blocks(const ScenePose& pose, const View& view, const ShadowMap& map);
  void draw(const View& view, vision::Image& picture);
  void fill_band(int top, int bottom);
  void shade_band(int n, vision::Image& picture);

  struct Drawn {
    Batch batch;
    Projection projection;
  };

  const Kernels& kernels_;
  std::optional<RasterScene> scene_;
  std::array<ShadowMap, 2> shadow_maps_;  // for the eyes, and for supersampled pictures
  std::vector<Eigen::Isometry3d> pose_;   // of the world normals
  std::vector<Drawn> drawn_;              // visible pieces of the current view
  Shading shading_;
  Target target_;
  std::vector<Primitive> primitives_;
  RowScratch scratch_;
  std::vector<std::uint32_t> samples_;  // of a row of pixels
};

void RasterRenderer::draw_shadow_map(const ScenePose& pose, const Eigen::Vector3d& to_key,
                                     bool soft, ShadowMap& map) {
  if (map.to_key == to_key &&
      std::equal(pose.frames.begin(), pose.frames.end(), map.pose.begin(), map.pose.end(), same))
    return;  // drawn already for the other eye of the pair
  map.pose = pose.frames;
  map.to_key = to_key;
  const int side = soft ? lighting::kPictureShadowTexels : lighting::kEyeShadowTexels;
  const ShadowView view = fit_shadow_view(scene_->model.pieces, pose, side, to_key);
  map.texel_m = 2 / (view.clip_from_world.block<1, 3>(0, 0).norm() * side);
  map.texels_from_world =
      Eigen::Vector4d(side, side, 65535, 1).asDiagonal() * view.texture_from_world;
  map.texels.side = side;
  map.texels.stride = side + static_cast<int>(kPad);
  map.texels.depth.assign(
      static_cast<std::size_t>(side) * static_cast<std::size_t>(map.texels.stride) + kPad, 65535);
  for (std::size_t i = 0; i < scene_->model.pieces.size(); ++i) {
    if (piece(i).caster_count == 0) continue;
    Eigen::Matrix4d texels_from_model = map.texels_from_world * frame(pose, piece(i)).matrix();
    texels_from_model.topRightCorner<2, 1>().array() -= 0.5;  // centres at integer coordinates
    kernels_.project_shadow(scene_->vertices, scene_->ranges[i].coarse, rows_of(texels_from_model));
    kernels_.fill_shadow(scene_->vertices,
                         {scene_->indices.data() + piece(i).coarse_first, piece(i).caster_count, 0},
                         map.texels);
  }
}

// World normals.
void RasterRenderer::take_pose(const ScenePose& pose) {
  if (std::equal(pose.frames.begin(), pose.frames.end(), pose_.begin(), pose_.end(), same)) return;
  pose_ = pose.frames;
  for (std::size_t i = 0; i < scene_->model.pieces.size(); ++i) {
    const std::array<float, 12> rows = rows_of(frame(pose, piece(i)).matrix());
    const std::array<float, 9> rotation{rows[0], rows[1], rows[2], rows[4], rows[5],
                                        rows[6], rows[8], rows[9], rows[10]};
    kernels_.turn_normals(scene_->vertices, scene_->ranges[i].fine, rotation);
    kernels_.turn_normals(scene_->vertices, scene_->ranges[i].coarse, rotation);
  }
}

// Projects what is visible and computes what shading needs of the view.
void RasterRenderer::take_view(const ScenePose& pose, const View& view, const ShadowMap& map) {
  const int n = view.samples_per_axis;
  const vision::CameraModel& c = view.camera;
  Projection p{};
  p.focal_x = static_cast<float>(n * c.fx);
  p.focal_y = static_cast<float>(n * c.fy);
  p.centre_x = static_cast<float>(n * (c.cx + 0.5) - 0.5);
  p.centre_y = static_cast<float>(n * (c.cy + 0.5) - 0.5);
  p.width = static_cast<float>(n * c.width);
  p.height = static_cast<float>(n * c.height);
  p.near = static_cast<float>(kNear_m);
  p.far = static_cast<float>(kFar_m);
  const Eigen::Matrix4d optical_from_world = view.world_from_optical.inverse().matrix();

  Shading& s = shading_;
  s.surfaces.clear();
  drawn_.clear();
  scene_->vertices.count = scene_->own_vertices;
  for (const VisiblePiece& v : visible_pieces(scene_->model, pose, view)) {
    const auto at = static_cast<std::size_t>(v.piece - scene_->model.pieces.data());
    p.optical_from_model = rows_of(optical_from_world * frame(pose, *v.piece).matrix());
    kernels_.project(scene_->vertices, v.fine ? scene_->ranges[at].fine : scene_->ranges[at].coarse,
                     p);
    const auto surface = static_cast<std::uint32_t>(s.surfaces.size());
    s.surfaces.push_back({v.piece->texture, v.piece->flat && n == 1});
    const std::uint32_t first = v.fine ? v.piece->fine_first : v.piece->coarse_first;
    const std::uint32_t count = v.fine ? v.piece->fine_count : v.piece->coarse_count;
    drawn_.push_back({{scene_->indices.data() + first, count, surface}, p});
  }

  const Eigen::Matrix3d turn = view.world_from_optical.linear();
  const Eigen::Vector3d eye = view.world_from_optical.translation();
  const double ax = 1 / (n * c.fx), a0 = (0.5 / n - 0.5 - c.cx) / c.fx;
  const double by = 1 / (n * c.fy), b0 = (0.5 / n - 0.5 - c.cy) / c.fy;
  const Eigen::Vector3d ray0 = turn * Eigen::Vector3d(a0, b0, 1);
  const Eigen::Vector3d ray_x = turn.col(0) * ax, ray_y = turn.col(1) * by;
  s.ray0 = floats(ray0);
  s.ray_x = floats(ray_x);
  s.ray_y = floats(ray_y);
  s.ax = static_cast<float>(ax);
  s.a0 = static_cast<float>(a0);
  s.by = static_cast<float>(by);
  s.b0 = static_cast<float>(b0);
  s.to_key = floats(view.light.to_key.normalized());
  s.key_gain = static_cast<float>(view.light.key);
  s.shaded_gain = static_cast<float>(view.light.shaded);
  const Eigen::Matrix3d texels = map.texels_from_world.topLeftCorner<3, 3>();
  s.shadow_eye = floats(texels * eye + map.texels_from_world.topRightCorner<3, 1>());
  s.shadow0 = floats(texels * ray0);
  s.shadow_x = floats(texels * ray_x);
  s.shadow_y = floats(texels * ray_y);
  s.shadow = &map.texels;
  s.soft = n > 1;
  mark_blocks(pose, view, map);
}

// Blocks of the picture in which shadows may fall on a flat ground.
void RasterRenderer::mark_blocks(const ScenePose& pose, const View& view, const ShadowMap& map) {
  Shading& s = shading_;
  s.block_columns = (view.camera.width + kBlock - 1) / kBlock;
  const int block_rows = (view.camera.height + kBlock - 1) / kBlock;
  s.blocks.assign(static_cast<std::size_t>(s.block_columns) * static_cast<std::size_t>(block_rows),
                  0);
  for (const Piece& ground : scene_->model.pieces) {
    if (!ground.flat || view.samples_per_axis > 1) continue;
    const Eigen::Isometry3d& at = frame(pose, ground);
    GroundPlane plane;
    plane.normal = at.linear() * ground.normal;
    plane.distance = ground.distance + plane.normal.dot(at.translation());
    for (const PictureRectangle& part :
         parts_of_ground(scene_->model.pieces, pose, view, plane, 3 * map.texel_m).shaded) {
      for (int y = part.y / kBlock; y * kBlock < part.y + part.height; ++y) {
        for (int x = part.x / kBlock; x * kBlock < part.x + part.width; ++x)
          s.blocks[static_cast<std::size_t>(y * s.block_columns + x)] = 1;
      }
    }
  }
}

void RasterRenderer::fill_band(int top, int bottom) {
  target_.top = top;
  target_.bottom = bottom;
  const std::size_t size =
      static_cast<std::size_t>(bottom - top) * static_cast<std::size_t>(target_.stride) + kPad;
  target_.w.resize(std::max(target_.w.size(), size));
  target_.primitive.resize(target_.w.size());
  for (int row = 0; row < bottom - top; ++row) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * target_.stride + target_.left;
    std::fill_n(target_.w.begin() + first, target_.right - target_.left, 0.0F);
    std::fill_n(target_.primitive.begin() + first, target_.right - target_.left, 0U);
  }
  primitives_.resize(1);  // number 0 is the background
  scene_->vertices.count = scene_->own_vertices;
  for (const Drawn& d : drawn_)
    kernels_.fill(scene_->vertices, d.batch, d.projection, target_, primitives_);
}

void RasterRenderer::shade_band(int n, vision::Image& picture) {
  const int width = target_.right - target_.left;
  const auto row_bytes = 3 * static_cast<std::size_t>(picture.width);
  for (int y = target_.top; y < target_.bottom; ++y) {
    kernels_.shade_row(scene_->vertices, shading_, target_, primitives_, y, scratch_);
    std::uint8_t* to = picture.rgb.data() + static_cast<std::size_t>(y / n) * row_bytes +
                       3 * static_cast<std::size_t>(target_.left / n);
    const std::uint32_t* codes = scratch_.codes.data() + target_.left;
    if (n == 1) {
      kernels_.pack(codes, width, to);
      continue;
    }
    std::copy_n(codes, width, samples_.data() + static_cast<std::ptrdiff_t>(y % n) * width);
    if (y % n == n - 1)
      average_row(reinterpret_cast<const std::uint8_t*>(samples_.data()), width, n, to);
  }
}

void RasterRenderer::draw(const View& view, vision::Image& picture) {
  const int n = view.samples_per_axis;
  const PicturePart part =
      view.part.value_or(PicturePart{0, 0, view.camera.width, view.camera.height});
  target_.left = n * part.left;
  target_.right = n * part.right;
  target_.stride = n * view.camera.width + static_cast<int>(kPad);
  const auto width = static_cast<std::size_t>(n * view.camera.width);
  for (auto& list : scratch_.normal) list.resize(width + kPad);
  for (auto& list : scratch_.tint) list.resize(width + kPad);
  scratch_.codes.resize(width + kPad);
  samples_.resize(width * static_cast<std::size_t>(n));
  picture.width = view.camera.width;
  picture.height = view.camera.height;
  const std::size_t bytes =
      3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  picture.rgb.resize(bytes + kPad);  // pack() writes beyond its pixels
  const int rows = std::max(kBandSamples / target_.stride / n, 1) * n;
  for (int top = n * part.top; top < n * part.bottom; top += rows) {
    fill_band(top, std::min(top + rows, n * part.bottom));
    shade_band(n, picture);
  }
  picture.rgb.resize(bytes);
}

}  // namespace
}  // namespace raster

std::unique_ptr<Renderer> make_raster_with(InstructionSet set) {
  return std::make_unique<raster::RasterRenderer>(set);
}

Result<std::unique_ptr<Renderer>> make_raster_renderer() {
  return make_raster_with(best_instructions());
}

}  // namespace kaz::sim
