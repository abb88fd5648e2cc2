// Reads pictures from files: PNG, JPEG, PPM and PGM.
// SPDX-License-Identifier: Apache-2.0
//
// A truncated or damaged file is an error. OpenCV's imread is not used, because imread returns part of a
// damaged picture. In addition, the library that contains imread loads about a hundred other libraries at
// every program start.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/picture/picture.h"
#include "vision/image/frame.h"

namespace kaz::vision {

inline constexpr int kLargestPictureSide = picture::kMaxSide;  // px

// Reads a picture. Gray becomes RGB with equal components, transparency is ignored, and 16-bit samples are
// reduced to 8 bits. A JPEG with an EXIF orientation is turned upright. Errors name the file and the defect.
Result<Image> read_picture(const std::string& path);
// Like read_picture(), but for the content of a file. Errors contain `name`.
Result<Image> decode_picture(std::span<const std::uint8_t> bytes, const std::string& name);

// Returns true if the file begins like a PNG, JPEG, PPM or PGM. Returns false if the file cannot be read.
bool looks_like_picture(const std::string& path);

}  // namespace kaz::vision
