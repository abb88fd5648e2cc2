// The loops of depth_rows.h for processors with AVX2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vision/depth/depth_avx2.h"
#include "vision/depth/depth_rows.h"

#ifdef KAZ_DEPTH_AVX2

namespace kaz::vision {

void match_row_avx2(const BlockRow& row);
// take_row_avx2() and take_slanted_row_avx2() process whole vectors only. Both functions return the first
// column that remains to be processed.
int take_row_avx2(const MatchedRow& row, float* disparity, std::int16_t* cost);
int take_slanted_row_avx2(const MatchedRow& row, const DisparityPlane& plane, int v,
                          float* disparity, std::int16_t* cost);

}  // namespace kaz::vision

#endif
