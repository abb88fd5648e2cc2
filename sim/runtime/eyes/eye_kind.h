// The kinds of simulated eyes and their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kaz::sim {

enum class EyeKind {
  ideal,  // exactly parallel pinhole cameras without noise
  real,   // lens, exposure and noise of the camera file; pictures are rectified
  none,   // no pictures, as for a robot without eyes
};
inline constexpr std::array kEyeKinds{EyeKind::ideal, EyeKind::real, EyeKind::none};

constexpr const char* to_string(EyeKind kind) {
  return kind == EyeKind::ideal ? "ideal" : kind == EyeKind::real ? "real" : "none";
}

}  // namespace kaz::sim
