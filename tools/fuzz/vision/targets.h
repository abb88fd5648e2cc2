// Fuzz targets of vision. Each function accepts any bytes and returns the first violation, if any.
// SPDX-License-Identifier: Apache-2.0
//
// If the code under test returns an error, this is no violation. Violations are a crash, undefined behavior,
// or an invalid result. A result is invalid if it is not finite, outside of the picture, or from another
// frame.
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// Reads the bytes as a picture file: PNG, JPEG, PPM or PGM. Skips files whose header states more than 4
// megapixels, because such files only use much memory.
Complaint try_picture(Bytes bytes);
// Reads the bytes as a calibration file. A valid calibration is written and read again, and used to rectify
// pictures.
Complaint try_calibration(Bytes bytes);
// Reads the bytes as a file of color thresholds, and classifies pixels with these thresholds.
Complaint try_color(Bytes bytes);
// Sends frames to a pipeline of all modules. The bytes determine sizes, contents, camera models, postures,
// sequence numbers and clocks. The last frame is valid, and must give the same results as in a new pipeline.
Complaint try_vision(Bytes bytes);

inline constexpr Target kVisionTargets[] = {{"picture", try_picture, 2000},
                                            {"calibration", try_calibration, 2000},
                                            {"color", try_color, 2000},
                                            {"vision", try_vision, 300}};

}  // namespace kaz::fuzz
