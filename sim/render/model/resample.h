// Supersampling: averages several samples for each pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::sim {

// Converts the width x height samples in `rgba` to (width / n) x (height / n) RGB pixels. For each pixel, the
// function averages the squares of the color codes of n x n samples. The color code of the pixel is the
// square root of this average, rounded. Thus the pixel shows the mean light of the samples (lighting.h).
void pack_rgb(std::span<const std::uint8_t> rgba, int width, int height, int n,
              std::vector<std::uint8_t>& rgb);

// Computes one row of pixels from `n` rows of `width` samples.
void average_row(const std::uint8_t* rgba, int width, int n, std::uint8_t* rgb);

}  // namespace kaz::sim
