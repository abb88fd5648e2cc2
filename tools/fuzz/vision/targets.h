// Hostile input for vision: each function takes any bytes and returns the first error, if any.
// SPDX-License-Identifier: Apache-2.0
//
// Errors are fine, and expected: what may not happen is a crash, undefined behaviour, or a result
// that is not valid (not finite, outside of the picture, of another frame).
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// A file of a picture: PNG, JPEG, PPM, PGM. Files that claim more than 4 megapixels are left out:
// what they cost is memory alone.
Complaint try_picture(Bytes bytes);
// A calibration file; what is read is written and read again, and pictures are rectified by it.
Complaint try_calibration(Bytes bytes);
// A file of colour thresholds, and pixels that are judged by it.
Complaint try_color(Bytes bytes);
// Frames through a pipeline of all modules: the bytes choose sizes, contents, camera models,
// postures, sequence numbers and clocks. The last frame is valid, and must come out as it does
// of a fresh pipeline.
Complaint try_vision(Bytes bytes);

inline constexpr Target kVisionTargets[] = {{"picture", try_picture, 2000},
                                            {"calibration", try_calibration, 2000},
                                            {"color", try_color, 2000},
                                            {"vision", try_vision, 300}};

}  // namespace kaz::fuzz
