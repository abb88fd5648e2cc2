// Inner loops of the rasteriser with vectors of 16 lanes (avx512).
// SPDX-License-Identifier: Apache-2.0
#define KAZ_RASTER_SET avx512
#define KAZ_RASTER_LANES 16
#include "sim/render/raster/kernel_shade.h"

namespace kaz::sim::raster {

const Kernels& avx512_kernels() {
  return avx512::kKernels;
}

}  // namespace kaz::sim::raster
