// The kinds of simulated eyes, by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class EyeKind {
  ideal,  // exactly parallel pinholes without noise
  real,   // lens, exposure and noise as the camera file says; the pictures are rectified
  none,   // closed: no pictures, as of a robot without eyes
};
inline constexpr std::array kEyeKinds{EyeKind::ideal, EyeKind::real, EyeKind::none};

constexpr const char* to_string(EyeKind kind) {
  return kind == EyeKind::ideal ? "ideal" : kind == EyeKind::real ? "real" : "none";
}

}  // namespace kaz::sim
