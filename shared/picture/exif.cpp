// EXIF: a TIFF file within a JPEG file. Offsets in it may point anywhere, so each access is checked.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/exif.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace kaz::picture {
namespace {

constexpr std::string_view kExif("Exif\0\0", 6);
constexpr std::uint32_t kTiff = 42, kOrientation = 0x0112;
constexpr std::uint64_t kEntrySize = 12, kValue = 8;  // bytes; offset of the value in an entry

class Tiff {
 public:
  explicit Tiff(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  // Returns whether the header names a byte order.
  bool valid() const {
    return bytes_.size() >= 2 && bytes_[0] == bytes_[1] && (bytes_[0] == 'I' || bytes_[0] == 'M');
  }
  // Returns a number of `size` bytes, or 0 if the number lies outside the data.
  std::uint32_t number(std::uint64_t at, std::uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) return 0;
    const bool little = bytes_[0] == 'I';
    std::uint32_t value = 0;
    for (std::uint64_t k = 0; k < size; ++k)
      value = value << 8 | bytes_[little ? at + size - 1 - k : at + k];
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace

int exif_orientation(std::span<const std::uint8_t> app1) {
  if (app1.size() < kExif.size() || !std::equal(kExif.begin(), kExif.end(), app1.begin())) return 1;
  const Tiff tiff(app1.subspan(kExif.size()));
  if (!tiff.valid() || tiff.number(2, 2) != kTiff) return 1;
  const std::uint64_t directory = tiff.number(4, 4);
  const std::uint32_t entries = tiff.number(directory, 2);
  for (std::uint32_t k = 0; k < entries; ++k) {
    const std::uint64_t at = directory + 2 + k * kEntrySize;
    if (tiff.number(at, 2) != kOrientation) continue;
    const std::uint32_t value = tiff.number(at + kValue, 2);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

// The eight orientations are combinations of a transposition and two mirrors.
Image turned_upright(Image picture, int orientation) {
  if (orientation == 1) return picture;
  const bool transposed = orientation >= 5;
  const bool mirror_x =
      orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool mirror_y =
      orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  Image turned{picture.width, picture.height, std::vector<std::uint8_t>(picture.rgb.size())};
  if (transposed) std::swap(turned.width, turned.height);
  auto to = turned.rgb.begin();
  for (int y = 0; y < turned.height; ++y) {
    for (int x = 0; x < turned.width; ++x) {
      int column = mirror_x ? turned.width - 1 - x : x;
      int row = mirror_y ? turned.height - 1 - y : y;
      if (transposed) std::swap(column, row);
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(column);
      to = std::copy_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel), 3, to);
    }
  }
  return turned;
}

}  // namespace kaz::picture
