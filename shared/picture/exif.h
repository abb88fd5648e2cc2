// Orientation of a picture by its EXIF segment, as digital cameras and phones write it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "shared/picture/picture.h"

namespace kaz::picture {

// Returns the orientation (1 to 8) that the data of an APP1 segment state in their first directory
// (Exif 2.32, tag 0x0112). Returns 1, which means upright, if the segment is not EXIF, is damaged, or states
// no valid orientation.
int exif_orientation(std::span<const std::uint8_t> app1);

// Returns the picture turned upright. `orientation` is from 1 to 8. From 5 on, width and height
// are exchanged.
Image turned_upright(Image picture, int orientation);

}  // namespace kaz::picture
