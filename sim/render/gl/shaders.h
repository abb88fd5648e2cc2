// Sources of the shaders in GLSL 3.30, for the lighting model of lighting.h.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::sim {

enum class Shadow {
  none,  // for parts of the picture without shadows: the shadow map is not read
  hard,  // one sample of the shadow map, for the eyes
  soft,  // twelve samples of the shadow map, for supersampled pictures
};
struct SurfaceVariant {
  bool textured = false;
  Shadow shadow = Shadow::none;
};

std::string surface_vertex_shader(const SurfaceVariant& variant);
std::string surface_fragment_shader(const SurfaceVariant& variant);
// Shaders that compute only positions, for the shadow map.
std::string depth_vertex_shader();
std::string depth_fragment_shader();
// Shaders for the background: one triangle over the whole picture, at maximum depth.
std::string background_vertex_shader();
std::string background_fragment_shader();

}  // namespace kaz::sim
