// Supersampling: averages samples to pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::sim {

// Converts `rgba`, width x height samples, to (width / n) x (height / n) RGB pixels. A pixel is the rounded
// sqrt(mean of code^2) of its n x n samples, which is their mean light (lighting.h).
void pack_rgb(std::span<const std::uint8_t> rgba, int width, int height, int n,
              std::vector<std::uint8_t>& rgb);

// Computes one row of pixels from `n` rows of `width` samples.
void average_row(const std::uint8_t* rgba, int width, int n, std::uint8_t* rgb);

}  // namespace kaz::sim
