// What an image sensor does to the light of a row of pixels: exposure, shot and read noise, codes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::sim {

// A code c stands for the light c^2 (shaders.h), code 255 for `full_well_e` electrons.
struct NoiseLaw {
  double exposure = 1.0;  // light is multiplied by this before it is caught
  double full_well_e = 10'000;
  double read_noise_e = 12;  // rms
};

// For all rows: the law in units of codes squared.
class NoiseRow {
 public:
  explicit NoiseRow(const NoiseLaw& law);

  // `count` numbers in 64ths of a code to codes. Of n electrons, n + z sqrt(n + read^2) are counted,
  // z a deviate of mean 0 and sigma 1: the sum of four random bytes, so at most 3.46. `key` decides
  // it with the place in the row. The same bytes with and without AVX2, which is used where the
  // processor has it.
  void expose(const std::uint16_t* codes64, std::uint8_t* codes, std::size_t count,
              std::uint64_t key) const;
  void expose_plain(const std::uint16_t* codes64, std::uint8_t* codes, std::size_t count,
                    std::uint64_t key) const;

  struct Factors {
    float code = 0;            // of a 64th, exposure included
    float shot = 0, read = 0;  // variance = shot * code^2 + read, for z of random bytes
  };

 private:
  Factors factors_;
};

}  // namespace kaz::sim
