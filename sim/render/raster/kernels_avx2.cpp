// Inner loops of the rasteriser with vectors of 8 lanes (avx2).
// SPDX-License-Identifier: Apache-2.0
#define KAZ_RASTER_SET avx2
#define KAZ_RASTER_LANES 8
#include "sim/render/raster/kernel_shade.h"

namespace kaz::sim::raster {

const Kernels& avx2_kernels() {
  return avx2::kKernels;
}

}  // namespace kaz::sim::raster
