// What is to stand in the flash of an H8S/2128: bytes, which lines of it, and whose program it is.
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
inline constexpr std::uint32_t kFlashLine = 32;  // bytes programmed at once
inline constexpr int kFlashBlocks = 10;          // blocks that are erased one by one
// First addresses of EB0..EB9, and the end.
inline constexpr std::uint32_t kBlockStart[kFlashBlocks + 1] = {
    0x0000, 0x0400, 0x0800, 0x0c00, 0x1000, 0x8000, 0xc000, 0xe000, 0x10000, 0x18000, 0x20000};
// Areas that an update through the resident loader keeps (firmware/kaz.ld).
inline constexpr int kVectorBlock = 0, kLoaderBlock = 6;
// Calibration, its second copy, the board's address.
inline constexpr int kSettingsBlocks[] = {1, 2, 3};

struct FlashRange {
  std::uint32_t from = 0, to = 0;  // one past the last byte
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
  // S-record, Intel HEX, COFF, ELF, recognised by their contents; raw with an address. Errors (usage): a
  // damaged file, bytes outside the flash.
  static Result<FlashImage> load(const std::string& path, const h8s::LoadOptions& options = {});

  // Copies bytes into the image; the lines that they touch become part of it.
  void put(std::uint32_t address, std::span<const std::uint8_t> bytes);
  std::span<const std::uint8_t> bytes(FlashRange range) const {
    return std::span(bytes_).subspan(range.from, range.size());
  }
  // Non-blank lines of the image; consecutive lines are joined to ranges of at most `longest` bytes.
  std::vector<FlashRange> ranges(std::uint32_t longest = kFlashBytes) const;
  // The same with lines that are blank in it.
  std::vector<FlashRange> all_ranges(std::uint32_t longest = kFlashBytes) const;
  // Whether any line of the block is part of the image.
  bool touches(int block) const;
  std::uint32_t size() const;  // bytes of all ranges

  // Header of a Kaz application, valid or not; nullopt for other images.
  std::optional<ImageIdentity> identity() const;
  // Error of the application, checked against its header; empty: valid.
  std::string damage() const;
  // Whether vectors or loader are part of the image; updates through the loader keep those of the board.
  bool has_loader() const { return touches(kVectorBlock) || touches(kLoaderBlock); }
  // Error of vectors and loader, checked against the loader's mark; empty: valid.
  std::string loader_damage() const;

 private:
  // CRC-16 continued from `from`.
  std::uint16_t crc(FlashRange range, std::uint16_t from) const;
  std::vector<FlashRange> ranges(std::uint32_t longest, bool with_blank) const;

  std::vector<std::uint8_t> bytes_;
  std::vector<bool> lines_;
};

inline FlashRange block_range(int block) {
  return {kBlockStart[block], kBlockStart[block + 1]};
}

}  // namespace kaz::host
