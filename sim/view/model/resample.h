// Supersampling: averages samples to pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::sim {

// `rgba`: width x height samples; writes (width / n) x (height / n) RGB pixels. Code of a pixel:
// sqrt(mean of code^2) over n x n samples, i.e. the mean light (lighting.h), rounded.
void pack_rgb(std::span<const std::uint8_t> rgba, int width, int height, int n,
              std::vector<std::uint8_t>& rgb);

// One row of pixels from `n` rows of `width` samples; n above 1.
void average_row(const std::uint8_t* rgba, int width, int n, std::uint8_t* rgb);

}  // namespace kaz::sim
