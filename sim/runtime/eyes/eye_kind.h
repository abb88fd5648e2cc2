// The kinds of simulated eyes and their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class EyeKind {
  ideal,  // exactly parallel pinhole cameras without noise
  real,   // cameras with lens, exposure and noise as in the camera file; the pictures are rectified
  none,   // no pictures, as if the robot had no eyes
};
inline constexpr std::array kEyeKinds{EyeKind::ideal, EyeKind::real, EyeKind::none};

constexpr const char* to_string(EyeKind kind) {
  return kind == EyeKind::ideal ? "ideal" : kind == EyeKind::real ? "real" : "none";
}

}  // namespace kaz::sim
