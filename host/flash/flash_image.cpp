// Flash images: lines, blocks, and the application's header.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/flash_image.h"

#include <algorithm>

#include "host/flash/diagnostic.h"
#include "shared/protocol/crc16.h"

namespace kaz::host {
namespace {

// Of the application's header and of the loader's mark.
constexpr std::uint32_t kCrcOffset = 30;

std::uint32_t big(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace

FlashImage::FlashImage() : bytes_(kFlashBytes, 0xff), lines_(kFlashBytes / kFlashLine) {}

Result<FlashImage> FlashImage::load(const std::string& path, const h8s::LoadOptions& options) {
  const auto image = h8s::load_image(path, options);
  if (!image) return kaz::fail(Fault::usage, image.error().message);
  FlashImage flash;
  for (const h8s::Segment& segment : image->segments) {
    if (segment.load_address > kFlashBytes ||
        segment.bytes.size() > kFlashBytes - segment.load_address) {
      return kaz::fail(Fault::usage,
                       path + ": '" + segment.name + "' at " + hex_address(segment.load_address) +
                           " with " + std::to_string(segment.bytes.size()) +
                           " bytes does not fit into the flash (000000 to 01ffff); build it for "
                           "the H8S/2128");
    }
    flash.put(segment.load_address, segment.bytes);
  }
  return flash;
}

void FlashImage::put(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  std::copy(bytes.begin(), bytes.end(), bytes_.begin() + address);
  const auto end = address + static_cast<std::uint32_t>(bytes.size());
  for (std::uint32_t a = address / kFlashLine; a * kFlashLine < end; ++a) lines_[a] = true;
}

std::vector<FlashRange> FlashImage::ranges(std::uint32_t longest) const {
  return ranges(longest, false);
}

std::vector<FlashRange> FlashImage::all_ranges(std::uint32_t longest) const {
  return ranges(longest, true);
}

std::vector<FlashRange> FlashImage::ranges(std::uint32_t longest, bool with_blank) const {
  std::vector<FlashRange> found;
  for (std::uint32_t line = 0; line < lines_.size(); ++line) {
    const std::uint32_t at = line * kFlashLine;
    const auto first = bytes_.begin() + at;
    const bool blank = std::all_of(first, first + kFlashLine, [](auto b) { return b == 0xff; });
    if (!lines_[line] || (blank && !with_blank)) continue;
    if (!found.empty() && found.back().to == at && found.back().size() + kFlashLine <= longest)
      found.back().to += kFlashLine;
    else
      found.push_back({at, at + kFlashLine});
  }
  return found;
}

bool FlashImage::touches(int block) const {
  const FlashRange range = block_range(block);
  return std::any_of(lines_.begin() + range.from / kFlashLine,
                     lines_.begin() + range.to / kFlashLine, [](bool line) { return line; });
}

std::uint32_t FlashImage::size() const {
  std::uint32_t sum = 0;
  for (const FlashRange& range : ranges()) sum += range.size();
  return sum;
}

std::optional<ImageIdentity> FlashImage::identity() const {
  const auto field = [this](std::uint32_t offset, std::uint32_t size) {
    return big(std::span(bytes_).subspan(KZ_APPLICATION_HEADER + offset, size));
  };
  if (field(0, 4) != KZ_IMAGE_ID) return std::nullopt;
  ImageIdentity identity;
  identity.board_id = static_cast<std::uint16_t>(field(4, 2));
  identity.version = static_cast<std::uint16_t>(field(6, 2));
  identity.build_id = field(8, 4);
  identity.length = field(12, 4);
  identity.crc = static_cast<std::uint16_t>(field(kCrcOffset, 2));
  return identity;
}

std::uint16_t FlashImage::crc(FlashRange range, std::uint16_t from) const {
  for (const std::uint8_t byte : bytes(range)) from = kz_crc16_step(from, byte);
  return from;
}

std::string FlashImage::damage() const {
  const auto is = identity();
  if (!is) return "no header of a Kaz application at " + hex_address(KZ_APPLICATION_HEADER);
  if (is->length > KZ_APPLICATION_MAX || is->length < KZ_APPLICATION_CODE - KZ_APPLICATION)
    return "a header with an invalid length of " + std::to_string(is->length) + " bytes";
  const std::uint32_t at = KZ_APPLICATION_HEADER + kCrcOffset;
  const auto end = static_cast<std::uint32_t>(KZ_APPLICATION + is->length);
  const std::uint16_t has = crc({at + 2, end}, crc({KZ_APPLICATION, at}, 0xffff));
  if (has == is->crc) return "";
  return "CRC " + hex_word(is->crc) + " in the header, but CRC " + hex_word(has) + " of the bytes";
}

std::string FlashImage::loader_damage() const {
  const auto mark = std::span(bytes_).subspan(KZ_LOADER_MARK, kFlashLine);
  if (big(mark.first(4)) != KZ_LOADER_ID)
    return "no mark at " + hex_address(KZ_LOADER_MARK) + " (the last line of the loader's block)";
  const auto wanted = static_cast<std::uint16_t>(big(mark.subspan(kCrcOffset, 2)));
  const std::uint16_t has = crc({KZ_LOADER, KZ_LOADER_MARK}, crc({0, KZ_VECTORS_SIZE}, 0xffff));
  if (has == wanted) return "";
  return "CRC " + hex_word(wanted) + " in the loader's mark, but CRC " + hex_word(has) +
         " of vectors and loader";
}

}  // namespace kaz::host
