// Noise of an image sensor for a row of pixels: exposure, shot noise, read noise, quantization to codes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/render/instruction_set.h"

namespace kaz::sim {

// Parameters of a photon-transfer model (EMVA 1288, shot and dark noise). A code c represents the light c^2
// (lighting.h). Code 255 represents `full_well_e` electrons. If a pixel has n electrons on average, the
// variance of the number of electrons is n + read_noise_e^2.
struct NoiseLaw {
  double exposure = 1.0;  // factor that multiplies the light
  double full_well_e = 10'000;
  double read_noise_e = 12;  // read noise in electrons, rms
};

// Applies a NoiseLaw to rows of pixels. The unit of light is the square of a code.
class NoiseRow {
 public:
  explicit NoiseRow(const NoiseLaw& law);

  // Part of a row: the values from index `first` up to, but not including, index `end`.
  struct Range {
    std::size_t first = 0, end = 0;
  };
  // Converts the values of a row to codes. The unit of the values is 1/64 of a code. A pixel with n electrons
  // is read as n + z sqrt(n + read_noise_e^2). Here z is a random number with mean 0 and sigma 1. The number
  // z is a scaled sum of four random bytes (nearly normal, |z| <= 3.46). These bytes depend on `key` and on
  // the position in the row. `with` must be an available instruction set. All instruction sets give the same
  // codes.
  void expose(const std::uint16_t* codes64, std::uint8_t* codes, Range range, std::uint64_t key,
              InstructionSet with = best_instructions()) const;

  struct Factors {
    // Factor that converts values to codes. The factor contains sqrt(exposure). The unit of the values is
    // 1/64 of a code.
    float code = 0;
    // Parameters of the noise of a pixel. Let c be the code of the pixel without noise. Let z be the sum of
    // four random bytes, minus the mean of this sum. The noise that is added to c^2 is:
    // `z * sqrt(shot * c^2 + read)`.
    float shot = 0, read = 0;
  };

 private:
  void expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, Range range,
                    std::uint64_t key) const;

  Factors factors_;
};

}  // namespace kaz::sim
