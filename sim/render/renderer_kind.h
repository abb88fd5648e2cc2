// The renderers and their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "sim/render/renderer.h"

namespace kaz::sim {

enum class RendererKind {
  opengl,  // off-screen Mesa; tests compare the pictures of `raster` with Mesa's pictures
  // The project's own rasterizer; works without OpenGL and needs a third of Mesa's computing time.
  raster,
};
inline constexpr RendererKind kDefaultRenderer = RendererKind::raster;
inline constexpr std::array kRendererKinds{RendererKind::opengl, RendererKind::raster};

constexpr const char* to_string(RendererKind kind) {
  return kind == RendererKind::opengl ? "opengl" : "raster";
}

using RendererMaker = Result<std::unique_ptr<Renderer>> (*)();
constexpr RendererMaker maker_of(RendererKind kind) {
  return kind == RendererKind::opengl ? &make_opengl_renderer : &make_raster_renderer;
}

}  // namespace kaz::sim
