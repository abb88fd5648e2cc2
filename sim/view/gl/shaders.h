// The shading programs, in GLSL 3.30.
// SPDX-License-Identifier: Apache-2.0
//
// Transfer function: a colour code c, 0..1, stands for the light c^2 (close to sRGB, and cheap). Lights are
// summed linearly: a key light from the upper right front with a shadow, hemispheric ambient light, a weak
// fill light from the left, a small specular highlight. Distant surfaces fade to the horizon's colour.
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
