// Noise of an image sensor for a row of pixels: exposure, shot noise, read noise, quantization to codes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/view/instruction_set.h"

namespace kaz::sim {

// Photon-transfer model (EMVA 1288, shot and dark noise). A code c stands for the light c^2 (lighting.h), and
// code 255 for `full_well_e` electrons. The variance of a count of n electrons is n + read_noise_e^2.
struct NoiseLaw {
  double exposure = 1.0;  // factor on the light
  double full_well_e = 10'000;
  double read_noise_e = 12;  // rms
};

// Applies a NoiseLaw to rows of pixels. Light is in codes squared.
class NoiseRow {
 public:
  explicit NoiseRow(const NoiseLaw& law);

  // Values first .. end - 1 of a row.
  struct Range {
    std::size_t first = 0, end = 0;
  };
  // Converts values of a row from 1/64 codes to codes. A count of n electrons is read as
  // n + z sqrt(n + read^2), where z has mean 0 and sigma 1. It is a scaled sum of four random bytes (nearly
  // normal, |z| <= 3.46), which depend on `key` and the position in the row. `with` must be available; all
  // sets give the same codes.
  void expose(const std::uint16_t* codes64, std::uint8_t* codes, Range range, std::uint64_t key,
              InstructionSet with = best_instructions()) const;

  struct Factors {
    float code = 0;  // codes per 1/64 code, times sqrt(exposure)
    // Variance = shot * code^2 + read, for the unscaled sum of random bytes.
    float shot = 0, read = 0;
  };

 private:
  void expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, Range range,
                    std::uint64_t key) const;

  Factors factors_;
};

}  // namespace kaz::sim
