// Image for the flash of an H8S/2128: bytes, lines in use, and the application's identity.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/flash/image.h"
#include "shared/image/image.h"

namespace kaz::host {

inline constexpr std::uint32_t kFlashBytes = 0x20000;
inline constexpr std::uint32_t kFlashLine = 32;  // number of bytes programmed at once
// Number of blocks; each block is erased as a whole.
inline constexpr int kFlashBlocks = 10;
// First address of each erase block EB0..EB9, and the end of the flash.
inline constexpr std::uint32_t kBlockStart[kFlashBlocks + 1] = {
    0x0000, 0x0400, 0x0800, 0x0c00, 0x1000, 0x8000, 0xc000, 0xe000, 0x10000, 0x18000, 0x20000};
// Blocks that an update through the resident loader keeps (firmware/kaz.ld).
inline constexpr int kVectorBlock = 0, kLoaderBlock = 6;
// Block 1 contains the calibration, block 2 the second copy of the calibration, and block 3 the board's
// address.
inline constexpr int kSettingsBlocks[] = {1, 2, 3};

struct FlashRange {
  std::uint32_t from = 0, to = 0;  // `to` is one past the last byte
  std::uint32_t size() const { return to - from; }
};

// The header of a Kaz application (shared/flash/image.h).
struct ImageIdentity {
  std::uint16_t board_id = 0, version = 0;
  std::uint32_t build_id = 0, length = 0;
  std::uint16_t crc = 0;
};

class FlashImage {
 public:
  FlashImage();
  // Loads an S-record, Intel HEX, COFF or ELF file, and detects the format from the contents. Also loads a
  // raw file at the address in `options`. Errors (usage): a damaged file, or bytes outside the flash.
  static Result<FlashImage> load(const std::string& path, const h8s::LoadOptions& options = {});

  // Copies bytes into the image. All flash lines that contain these bytes become part of the image. The bytes
  // must lie within the flash.
  void put(std::uint32_t address, std::span<const std::uint8_t> bytes);
  std::span<const std::uint8_t> bytes(FlashRange range) const {
    return std::span(bytes_).subspan(range.from, range.size());
  }
  // Returns the non-blank lines of the image. Consecutive lines are joined to ranges of at most `longest`
  // bytes.
  std::vector<FlashRange> ranges(std::uint32_t longest = kFlashBytes) const;
  // Like ranges(), but includes the blank lines of the image.
  std::vector<FlashRange> all_ranges(std::uint32_t longest = kFlashBytes) const;
  // Returns whether any line of the block is part of the image.
  bool touches(int block) const;
  std::uint32_t size() const;  // number of bytes in all ranges()

  // Returns the header of a Kaz application, valid or not; nullopt for other images.
  std::optional<ImageIdentity> identity() const;
  // Checks the application against its header. Returns a description of the fault; empty if the application
  // is valid.
  std::string damage() const;
  // Returns whether the image contains bytes in the vectors' block or in the loader's block. An update
  // through the loader writes neither vectors nor loader: the board keeps its own vectors and loader.
  bool has_loader() const { return touches(kVectorBlock) || touches(kLoaderBlock); }
  // Compares the CRC of vectors and loader with the CRC in the loader's mark (shared/flash/image.h). Returns
  // a description of the difference. The description is empty if the two CRCs are equal.
  std::string loader_damage() const;

 private:
  // Returns the CRC-16 of the range. The initial value is `from`, for example the CRC of the preceding bytes.
  std::uint16_t crc(FlashRange range, std::uint16_t from) const;
  std::vector<FlashRange> ranges(std::uint32_t longest, bool with_blank) const;

  std::vector<std::uint8_t> bytes_;
  std::vector<bool> lines_;
};

inline FlashRange block_range(int block) {
  return {kBlockStart[block], kBlockStart[block + 1]};
}

}  // namespace kaz::host
