// Fuzz targets of vision. Each function accepts any bytes and returns the first violation, if any.
// SPDX-License-Identifier: Apache-2.0
//
// To return an error is correct. Violations are a crash, undefined behavior, or an invalid result: not
// finite, outside of the picture, or from another frame.
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// A picture file: PNG, JPEG, PPM or PGM. Skips files that claim more than 4 megapixels, which only cost
// memory.
Complaint try_picture(Bytes bytes);
// A calibration file. A valid one is written and read again, and used to rectify pictures.
Complaint try_calibration(Bytes bytes);
// A file of color thresholds, and pixels that are classified with it.
Complaint try_color(Bytes bytes);
// Frames for a pipeline of all modules. The bytes choose sizes, contents, camera models, postures, sequence
// numbers and clocks. The last frame is valid and must give the same results as in a new pipeline.
Complaint try_vision(Bytes bytes);

inline constexpr Target kVisionTargets[] = {{"picture", try_picture, 2000},
                                            {"calibration", try_calibration, 2000},
                                            {"color", try_color, 2000},
                                            {"vision", try_vision, 300}};

}  // namespace kaz::fuzz
