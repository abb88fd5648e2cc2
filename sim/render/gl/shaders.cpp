// GLSL sources of the shading programs; lighting model in lighting.h.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/shaders.h"

#include <array>
#include <cstdio>

#include "sim/render/model/lighting.h"

namespace kaz::sim {

namespace {

std::string header(const SurfaceVariant& variant) {
  std::string text = "#version 330 core\n";
  if (variant.textured) text += "#define TEXTURED\n";
  if (variant.shadow != Shadow::none) text += "#define SHADOW\n";
  if (variant.shadow == Shadow::soft) text += "#define SOFT_SHADOW\n";
  return text;
}

// GLSL text of the numbers in lighting.h.
std::string number(float value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(value));
  const std::string digits = text.data();
  return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

std::string constant(const char* name, float value) {
  return std::string("const float ") + name + " = " + number(value) + ";\n";
}

std::string constant(const char* name, const lighting::Light3& v) {
  return std::string("const vec3 ") + name + " = vec3(" + number(v[0]) + ", " + number(v[1]) +
         ", " + number(v[2]) + ");\n";
}

std::string horizon() {
  return constant("horizon", lighting::kHorizon) + constant("zenith", lighting::kZenith) +
         constant("haze_m2", lighting::kHaze_m2);
}

std::string lights() {
  return constant("key_light", lighting::kKey) + constant("sky_light", lighting::kSky) +
         constant("ground_light", lighting::kGround) + constant("to_fill", lighting::kToFill) +
         constant("fill", lighting::kFill) + constant("highlight", lighting::kHighlight) + R"(
// Ambient and fill light.
vec3 shaded_light(vec3 n) {
  return mix(ground_light, sky_light, 0.5 * n.z + 0.5) + fill * max(dot(n, to_fill), 0.0);
}
)";
}

std::string taps() {
  std::string text =
      constant("soft_texels", lighting::kSoftTexels) + "const vec2 taps[12] = vec2[](";
  for (const auto& tap : lighting::kTaps) {
    text += std::string(&tap == &lighting::kTaps[0] ? "" : ", ") + "vec2(" + number(tap[0]) + ", " +
            number(tap[1]) + ")";
  }
  return text + ");\n";
}

// Textured surfaces, mainly the ground, are flat and matt: lighting per vertex is exact enough and faster,
// as they fill most of the pictures.
constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec3 color;
uniform mat4 world_from_model;
uniform mat4 clip_from_world;
uniform mat4 shadow_from_world;
uniform vec3 eye;
uniform vec3 to_key;
uniform float key_gain;
uniform float shaded_gain;
out vec3 v_to_eye;
#ifdef SHADOW
out vec3 v_shadow;
#endif
#ifdef TEXTURED
uniform float repeats_per_m;
out vec2 v_uv;
flat out vec3 v_shaded;
flat out vec3 v_key;
#else
out vec3 v_normal;
out vec3 v_color;
#endif
void main() {
  vec4 world = world_from_model * vec4(position, 1.0);
  gl_Position = clip_from_world * world;
  v_to_eye = eye - world.xyz;
#ifdef SHADOW
  v_shadow = (shadow_from_world * world).xyz;
#endif
  vec3 n = mat3(world_from_model) * normal;
#ifdef TEXTURED
  v_uv = uv * repeats_per_m;
  v_shaded = color * color * shaded_light(n) * shaded_gain;
  v_key = color * color * key_light * (max(dot(n, to_key), 0.0) * key_gain);
#else
  v_normal = n;
  v_color = color;
#endif
}
)";

constexpr const char* kSurfaceFragment = R"(
in vec3 v_to_eye;
uniform vec3 to_key;
uniform float key_gain;
uniform float shaded_gain;
#ifdef SHADOW
in vec3 v_shadow;
uniform sampler2DShadow shadow_map;
uniform float shadow_texel;
#endif
#ifdef TEXTURED
in vec2 v_uv;
flat in vec3 v_shaded;
flat in vec3 v_key;
uniform sampler2D pattern;
#else
in vec3 v_normal;
in vec3 v_color;
#endif
out vec4 picture;

float lit() {
#ifdef SOFT_SHADOW
  float sum = 0.0;
  for (int i = 0; i < 12; ++i) {
    sum += texture(shadow_map, vec3(v_shadow.xy + taps[i] * (soft_texels * shadow_texel), v_shadow.z));
  }
  return sum * (1.0 / 12.0);
#elif defined(SHADOW)
  return texture(shadow_map, v_shadow);
#else
  return 1.0;
#endif
}

void main() {
  float distance2 = dot(v_to_eye, v_to_eye);
#ifdef TEXTURED
  vec3 pattern_code = texture(pattern, v_uv).rgb;
  vec3 color = pattern_code * pattern_code * (v_shaded + v_key * lit());
#else
  vec3 n = normalize(v_normal);
  float key = max(dot(n, to_key), 0.0) * lit() * key_gain;
  vec3 color = v_color * v_color * (shaded_light(n) * shaded_gain + key_light * key);
  vec3 view = v_to_eye * inversesqrt(distance2);
  float s = max(dot(n, normalize(view + to_key)), 0.0);
  s *= s; s *= s; s *= s; s *= s; s *= s;
  color += highlight * s * key;
#endif
  float haze = distance2 / (distance2 + haze_m2);
  picture = vec4(sqrt(mix(color, horizon, haze)), 1.0);
}
)";

constexpr const char* kDepthVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_model;
void main() { gl_Position = clip_from_model * vec4(position, 1.0); }
)";

constexpr const char* kDepthFragment = R"(#version 330 core
void main() {}
)";

constexpr const char* kBackgroundVertex = R"(#version 330 core
uniform mat4 ray_from_clip;
out vec3 v_ray;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 1.0, 1.0);
  v_ray = (ray_from_clip * vec4(corner, 1.0, 1.0)).xyz;
}
)";

constexpr const char* kBackgroundFragment = R"(
in vec3 v_ray;
out vec4 picture;
void main() {
  float up = clamp(v_ray.z * inversesqrt(dot(v_ray, v_ray)), 0.0, 1.0);
  float t = up * (2.0 - up);
  picture = vec4(sqrt(mix(horizon, zenith, t)), 1.0);
}
)";

}  // namespace

std::string surface_vertex_shader(const SurfaceVariant& variant) {
  return header(variant) + lights() + kSurfaceVertex;
}

std::string surface_fragment_shader(const SurfaceVariant& variant) {
  return header(variant) + horizon() + lights() + taps() + kSurfaceFragment;
}

std::string depth_vertex_shader() {
  return kDepthVertex;
}
std::string depth_fragment_shader() {
  return kDepthFragment;
}
std::string background_vertex_shader() {
  return kBackgroundVertex;
}

std::string background_fragment_shader() {
  return std::string("#version 330 core\n") + horizon() + kBackgroundFragment;
}

}  // namespace kaz::sim
