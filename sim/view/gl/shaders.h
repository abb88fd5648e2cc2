// The shading programs, in GLSL 3.30; the model is that of lighting.h.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::sim {

enum class Shadow {
  none,  // for parts without shadow; same colours as `hard` there
  hard,  // one tap, for the eyes
  soft,  // twelve taps, for pictures
};
struct SurfaceVariant {
  bool textured = false;
  Shadow shadow = Shadow::none;
};

std::string surface_vertex_shader(const SurfaceVariant& variant);
std::string surface_fragment_shader(const SurfaceVariant& variant);
// Positions alone, for the shadow map.
std::string depth_vertex_shader();
std::string depth_fragment_shader();
// One triangle over the whole picture, at the far end.
std::string background_vertex_shader();
std::string background_fragment_shader();

}  // namespace kaz::sim
