// Pictures from files: PNG, JPEG, PPM and PGM.
// SPDX-License-Identifier: Apache-2.0
//
// Strict: a file that ends early or is damaged is an error, not half a picture. (OpenCV's imread
// returns what there was, and its library loads a hundred others at every start of a program.)
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/picture/picture.h"
#include "vision/image/frame.h"

namespace kaz::vision {

inline constexpr int kLargestPictureSide = picture::kMaxSide;  // px

// Grey pictures come as RGB of equal parts, transparency is left out, 16 bits become 8.
// Errors name the file and what is wrong with it.
Result<Image> read_picture(const std::string& path);
// The same of a file's content; `name` stands in the errors.
Result<Image> decode_picture(std::span<const std::uint8_t> bytes, const std::string& name);

// By its first bytes: PNG, JPEG, PPM or PGM. False where it cannot be read.
bool looks_like_picture(const std::string& path);

}  // namespace kaz::vision
