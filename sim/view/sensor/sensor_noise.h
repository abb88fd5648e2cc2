// Image sensor noise of a row of pixels: exposure, shot noise, read noise, quantisation to codes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/view/instruction_set.h"

namespace kaz::sim {

// Photon-transfer model: a code c stands for the light c^2 (lighting.h), code 255 for `full_well_e`
// electrons; variance of the electron count = n + read_noise_e^2 (EMVA 1288, shot and dark noise).
struct NoiseLaw {
  double exposure = 1.0;  // factor on the light
  double full_well_e = 10'000;
  double read_noise_e = 12;  // rms
};

// Applies the law to rows; light in units of codes squared.
class NoiseRow {
 public:
  explicit NoiseRow(const NoiseLaw& law);

  // Values of a row: first .. end - 1.
  struct Range {
    std::size_t first = 0, end = 0;
  };
  // Converts values of a row in 1/64 codes to codes. n electrons are read as n + z sqrt(n + read^2), z with
  // mean 0 and sigma 1: the sum of four random bytes (nearly normal, |z| <= 3.46), a function of `key` and
  // the position in the row. `with` must be available.
  void expose(const std::uint16_t* codes64, std::uint8_t* codes, Range range, std::uint64_t key,
              InstructionSet with = best_instructions()) const;

  struct Factors {
    float code = 0;  // codes per 1/64 code, times sqrt(exposure)
    float shot = 0,
          read = 0;  // variance = shot * code^2 + read, for the unscaled sum of random bytes
  };

 private:
  void expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, Range range,
                    std::uint64_t key) const;

  Factors factors_;
};

}  // namespace kaz::sim
