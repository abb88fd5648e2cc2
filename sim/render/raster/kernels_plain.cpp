// Inner loops of the rasteriser with vectors of 4 lanes (plain).
// SPDX-License-Identifier: Apache-2.0
#define KAZ_RASTER_SET plain
#define KAZ_RASTER_LANES 4
#include "sim/render/raster/kernel_shade.h"

namespace kaz::sim::raster {

const Kernels& plain_kernels() {
  return plain::kKernels;
}

}  // namespace kaz::sim::raster
