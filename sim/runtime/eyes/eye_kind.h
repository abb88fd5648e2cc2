// The kinds of simulated eyes, by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class EyeKind {
  ideal,  // exactly parallel pinholes without noise
  real,   // lens, exposure and noise as the camera file says; the pictures are rectified
};
inline constexpr std::array kEyeKinds{EyeKind::ideal, EyeKind::real};

constexpr const char* to_string(EyeKind kind) {
  return kind == EyeKind::ideal ? "ideal" : "real";
}

}  // namespace kaz::sim
