// Scene drawing: shadow map once per pose, then pieces from near to far, the background last.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_scene.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "sim/render/gl/shaders.h"
#include "sim/render/model/ground_shade.h"
#include "sim/render/model/lighting.h"
#include "sim/render/model/visible.h"

namespace kaz::sim {

namespace {

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

Result<GlScene> GlScene::create(const Gl& gl, const SceneModel& model) {
  GlScene scene(gl, model);
  if (Result<void> built = scene.build_programs(); !built) return tl::unexpected(built.error());
  scene.upload_geometry();
  scene.upload_textures();
  for (const int texels : {lighting::kEyeShadowTexels, lighting::kPictureShadowTexels}) {
    Result<void> made = scene.make_shadow_map(texels);
    if (!made) return tl::unexpected(made.error());
  }
  gl.Enable(GL_CULL_FACE);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Disable(GL_DITHER);
  return scene;
}

Result<void> GlScene::build_programs() {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const SurfaceVariant variant{i % 2 == 1, static_cast<Shadow>(i / 2)};
    Result<GlProgram> program =
        GlProgram::build(*gl_, surface_vertex_shader(variant), surface_fragment_shader(variant));
    if (!program) return tl::unexpected(program.error());
    surfaces_[i] = {*program, program->location("world_from_model")};
    program->use();
    program->set_sampler("pattern", 0);
    program->set_sampler("shadow_map", 1);
    program->set("shadow_texel", 1.0 / lighting::kPictureShadowTexels);
  }
  Result<GlProgram> depth = GlProgram::build(*gl_, depth_vertex_shader(), depth_fragment_shader());
  if (!depth) return tl::unexpected(depth.error());
  depth_ = *depth;
  Result<GlProgram> background =
      GlProgram::build(*gl_, background_vertex_shader(), background_fragment_shader());
  if (!background) return tl::unexpected(background.error());
  background_ = *background;
  return {};
}

void GlScene::upload_geometry() {
  gl_->GenVertexArrays(1, &empty_vertex_array_);
  gl_->GenVertexArrays(1, &vertex_array_);
  gl_->BindVertexArray(vertex_array_);
  std::array<GLuint, 2> buffers{};
  gl_->GenBuffers(2, buffers.data());
  gl_->BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  gl_->BufferData(GL_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(model_->vertices.size() * sizeof(ColoredVertex)),
                  model_->vertices.data(), GL_STATIC_DRAW);
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(model_->indices.size() * sizeof(std::uint32_t)),
                  model_->indices.data(), GL_STATIC_DRAW);
  constexpr GLsizei kStride = sizeof(ColoredVertex);
  gl_->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, offset(offsetof(Vertex, position)));
  gl_->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, kStride, offset(offsetof(Vertex, normal)));
  gl_->VertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, kStride, offset(offsetof(Vertex, uv)));
  gl_->VertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride,
                           offset(offsetof(ColoredVertex, color)));
  for (GLuint i = 0; i < 4; ++i) gl_->EnableVertexAttribArray(i);
}

void GlScene::upload_textures() {
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_->ActiveTexture(GL_TEXTURE0);
  for (const Texture& texture : model_->textures) {
    GLuint id = 0;
    gl_->GenTextures(1, &id);
    gl_->BindTexture(GL_TEXTURE_2D, id);
    int size = texture.size;
    for (std::size_t level = 0; level < texture.levels.size(); ++level, size /= 2) {
      gl_->TexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, size, size, 0, GL_RGBA,
                      GL_UNSIGNED_BYTE, texture.levels[level].data());
    }
    gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    textures_.push_back(id);
  }
}

Result<void> GlScene::make_shadow_map(int texels) {
  ShadowMap map;
  map.texels = texels;
  gl_->ActiveTexture(GL_TEXTURE1);
  gl_->GenTextures(1, &map.texture);
  gl_->BindTexture(GL_TEXTURE_2D, map.texture);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT16, texels, texels, 0, GL_DEPTH_COMPONENT,
                  GL_UNSIGNED_SHORT, nullptr);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl_->GenFramebuffers(1, &map.framebuffer);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, map.framebuffer);
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map.texture, 0);
  gl_->DrawBuffer(GL_NONE);
  gl_->ReadBuffer(GL_NONE);
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return fail(Fault::environment,
                "this OpenGL cannot draw into a depth texture: install Mesa 22.3 or newer");
  }
  shadow_maps_.push_back(std::move(map));
  return {};
}

void GlScene::draw_triangles(std::uint32_t first_index, std::uint32_t count) const {
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                    offset(first_index * sizeof(std::uint32_t)));
}

void GlScene::draw_shadow_map(const ScenePose& pose, const Eigen::Vector3d& to_key,
                              ShadowMap& map) {
  const auto same = [](const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return a.matrix() == b.matrix();
  };
  if (map.to_key == to_key &&
      std::equal(pose.frames.begin(), pose.frames.end(), map.pose.begin(), map.pose.end(), same)) {
    return;  // drawn already for the other eye of the pair
  }
  map.pose = pose.frames;
  map.to_key = to_key;
  map.view = fit_shadow_view(model_->pieces, pose, map.texels, to_key);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, map.framebuffer);
  gl_->Viewport(0, 0, map.texels, map.texels);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  gl_->Viewport(1, 1, map.texels - 2, map.texels - 2);
  // Only back faces cast shadows, so that rounding cannot make a lit surface shade itself.
  gl_->FrontFace(GL_CCW);
  gl_->CullFace(GL_FRONT);
  gl_->BindVertexArray(vertex_array_);
  depth_.use();
  const int clip_from_model = depth_.location("clip_from_model");
  for (const Piece& piece : model_->pieces) {
    if (piece.caster_count == 0) continue;
    const Eigen::Matrix4d& world_from_model =
        pose.frames[static_cast<std::size_t>(piece.frame)].matrix();
    depth_.set(clip_from_model, map.view.clip_from_world * world_from_model);
    draw_triangles(piece.coarse_first, piece.caster_count);
  }
  gl_->CullFace(GL_BACK);
}

// Sets program, texture and pose for a piece.
void GlScene::use(const Surface& surface, const Piece& piece, Frame& frame) {
  const GlProgram& program = surface.program;
  if (frame.in_use != &surface) {
    program.use();
    program.set("clip_from_world", frame.clip_from_world);
    program.set("shadow_from_world", frame.map.view.texture_from_world);
    program.set("eye", Eigen::Vector3d(frame.view.world_from_optical.translation()));
    program.set("to_key", Eigen::Vector3d(frame.view.light.to_key.normalized()));
    program.set("key_gain", frame.view.light.key);
    program.set("shaded_gain", frame.view.light.shaded);
    frame.in_use = &surface;
  }
  if (piece.texture >= 0) {
    const auto texture = static_cast<std::size_t>(piece.texture);
    gl_->BindTexture(GL_TEXTURE_2D, textures_[texture]);
    // Trilinear filtering would take an eighth of an eye's drawing time.
    gl_->TexParameteri(
        GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
        frame.view.samples_per_axis > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST);
    program.set("repeats_per_m", 1 / model_->textures[texture].repeat_m);
  }
  program.set(surface.world_from_model,
              frame.pose.frames[static_cast<std::size_t>(piece.frame)].matrix());
}

// Samples the shadow map only where shadows may fall.
void GlScene::draw_ground(const Piece& piece, Frame& frame) {
  const Eigen::Isometry3d& pose = frame.pose.frames[static_cast<std::size_t>(piece.frame)];
  GroundPlane plane;
  plane.normal = pose.linear() * piece.normal;
  plane.distance = piece.distance + plane.normal.dot(pose.translation());
  // Width of the shadow's edge, 3 texels: covers the linear filter (one) and the rasterisation of the
  // casters' edges (one).
  const double texel_m =
      2 / (frame.map.view.clip_from_world.block<1, 3>(0, 0).norm() * frame.map.texels);
  const GroundParts parts =
      parts_of_ground(model_->pieces, frame.pose, frame.view, plane, 3 * texel_m);
  const auto draw = [&](std::span<const PictureRectangle> rectangles, Shadow shadow) {
    if (rectangles.empty()) return;
    use(surface(piece, shadow), piece, frame);
    for (const PictureRectangle& part : rectangles) {
      gl_->Scissor(part.x, part.y, part.width, part.height);
      draw_triangles(piece.fine_first, piece.fine_count);
    }
  };
  gl_->Enable(GL_SCISSOR_TEST);
  draw(parts.shaded, Shadow::hard);
  draw(parts.lit, Shadow::none);
  gl_->Disable(GL_SCISSOR_TEST);
}

void GlScene::draw_surfaces(Frame& frame) {
  const View& view = frame.view;
  gl_->BindVertexArray(vertex_array_);
  gl_->ActiveTexture(GL_TEXTURE1);
  gl_->BindTexture(GL_TEXTURE_2D, frame.map.texture);
  gl_->ActiveTexture(GL_TEXTURE0);
  const Shadow shadow = view.samples_per_axis > 1 ? Shadow::soft : Shadow::hard;
  // Front to back, so that hidden pixels are not shaded.
  for (const VisiblePiece& v : visible_pieces(*model_, frame.pose, view)) {
    const Piece& piece = *v.piece;
    if (piece.flat && shadow == Shadow::hard) {
      draw_ground(piece, frame);
      continue;
    }
    use(surface(piece, shadow), piece, frame);
    if (v.fine) {
      draw_triangles(piece.fine_first, piece.fine_count);
    } else {
      draw_triangles(piece.coarse_first, piece.coarse_count);
    }
  }
}

void GlScene::draw(const ScenePose& pose, const View& view, GLuint framebuffer) {
  const int n = view.samples_per_axis;
  ShadowMap& map = shadow_maps_[n > 1 ? 1 : 0];
  draw_shadow_map(pose, view.light.to_key, map);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl_->Viewport(0, 0, view.camera.width * n, view.camera.height * n);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  // y points down in clip space, which inverts the winding order.
  gl_->FrontFace(GL_CW);
  const Eigen::Matrix4d projection = clip_from_optical(view.camera);
  const Eigen::Matrix4d clip_from_world = projection * view.world_from_optical.inverse().matrix();
  Frame frame{pose, view, map, clip_from_world};
  draw_surfaces(frame);

  Eigen::Matrix4d ray_from_clip = Eigen::Matrix4d::Zero();
  ray_from_clip.topLeftCorner<3, 3>() = view.world_from_optical.linear();
  Eigen::Matrix4d optical_from_clip = Eigen::Matrix4d::Zero();
  optical_from_clip(0, 0) = 1 / projection(0, 0);
  optical_from_clip(0, 2) = -projection(0, 2) / projection(0, 0);
  optical_from_clip(1, 1) = 1 / projection(1, 1);
  optical_from_clip(1, 2) = -projection(1, 2) / projection(1, 1);
  optical_from_clip(2, 2) = 1;
  gl_->BindVertexArray(empty_vertex_array_);
  gl_->Disable(GL_CULL_FACE);
  background_.use();
  background_.set("ray_from_clip", Eigen::Matrix4d(ray_from_clip * optical_from_clip));
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  gl_->Enable(GL_CULL_FACE);
}

}  // namespace kaz::sim
