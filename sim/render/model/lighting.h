// Constants of the lighting model, shared by all renderers.
// SPDX-License-Identifier: Apache-2.0
//
// Transfer function: a color code c (0..1) represents the light c^2. The function is close to sRGB and fast
// to compute. The contributions of several lights are added as linear light. The key light comes from the
// upper right front, casts shadows and makes a small specular highlight. Ambient light is hemispheric; a weak
// fill light comes from the left. Distant surfaces fade to the color of the horizon.
//
// A surface with color c and unit normal n is seen from the unit direction v at distance d. The unit
// direction l points to the key light. A share s (0..1) of the key light reaches the surface. The key light
// has the gain a, and the ambient light has the gain b (View::light).
//   ambient   = mix(ground, sky, (1 + n.z) / 2) + fill max(n . to_fill, 0)
//   key       = max(n . l, 0) s a
//   light     = c^2 (b ambient + key_light key) + highlight max(n . (v + l) / |v + l|, 0)^32 key
//   haze      = d^2 / (d^2 + haze_m2)
//   code      = sqrt(mix(light, horizon, haze))
// Textured surfaces have no highlight. For textured surfaces, c^2 is multiplied by the light of the texture.
// All points of a textured triangle have the same n. The next formula defines the color code of the
// background in the unit direction r. In the formula, u is r.z, limited to 0..1:
//   code      = sqrt(mix(horizon, zenith, u (2 - u)))
#pragma once

#include <array>

namespace kaz::sim::lighting {

using Light3 = std::array<float, 3>;

inline constexpr Light3 kHorizon{0.66F, 0.68F, 0.70F};
inline constexpr Light3 kZenith{0.20F, 0.29F, 0.42F};
inline constexpr Light3 kKey{0.76F, 0.73F, 0.67F};
inline constexpr Light3 kSky{0.36F, 0.38F, 0.41F};
inline constexpr Light3 kGround{0.16F, 0.145F, 0.13F};
inline constexpr Light3 kToFill{0.38F, 0.76F, 0.53F};
inline constexpr float kFill = 0.10F;
inline constexpr float kHighlight = 0.16F;
inline constexpr float kHaze_m2 = 28.0F;

// Positions of the shadow map samples for soft shadows, relative to the shaded point, in units of
// `kSoftTexels` texels.
inline constexpr std::array<std::array<float, 2>, 12> kTaps{{{-0.33F, -0.84F},
                                                             {0.52F, -0.77F},
                                                             {-0.84F, -0.27F},
                                                             {-0.20F, -0.36F},
                                                             {0.29F, -0.14F},
                                                             {0.90F, -0.22F},
                                                             {-0.58F, 0.21F},
                                                             {0.05F, 0.29F},
                                                             {0.62F, 0.34F},
                                                             {-0.79F, 0.60F},
                                                             {-0.19F, 0.83F},
                                                             {0.42F, 0.86F}}};
inline constexpr float kSoftTexels = 3.0F;

// Side lengths of the shadow maps in texels, including the ring of free texels. The rendering of a picture
// pair for the eyes must not take more than 4 ms. Therefore the shadow map for the eyes is smaller than the
// map for supersampled pictures.
inline constexpr int kEyeShadowTexels = 512, kPictureShadowTexels = 2048;

}  // namespace kaz::sim::lighting
