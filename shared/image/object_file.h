// Base class of the parsers of COFF and ELF: big-endian fields at offsets, and contents of segments.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/image/image.h"

namespace kaz::h8s {

class ObjectFile {
 public:
  // Both arguments must outlive the object. `name` names the file in messages.
  ObjectFile(std::span<const std::uint8_t> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

 protected:
  // Maximum length of a name. Without a maximum, a hostile file could exhaust the memory.
  static constexpr std::size_t kLongestName = 1024;

  // Returns whether `size` bytes at offset `at` lie inside the file.
  bool fits(std::size_t at, std::size_t size) const {
    return at <= bytes_.size() && size <= bytes_.size() - at;
  }
  // Read a number at offset `at`. Precondition: the number lies inside the file.
  unsigned u16(std::size_t at) const {
    return static_cast<unsigned>(bytes_[at] << 8 | bytes_[at + 1]);
  }
  std::uint32_t u32(std::size_t at) const {
    return static_cast<std::uint32_t>(u16(at)) << 16 | static_cast<std::uint32_t>(u16(at + 2));
  }
  // Returns an error that names the file and the offset.
  tl::unexpected<Error> error(std::size_t at, const std::string& what) const;
  // Returns the text at offset `at`, up to a zero byte. Control characters become '?', because error messages
  // contain such texts.
  std::string text(std::size_t at, std::size_t max_length) const;
  // Adds `segment` with `size` bytes at file offset `offset`. `at` (offset of the segment's header) and
  // `what` (name of the segment) are only used for error messages. Returns an error if contents are outside
  // the file, or if all contents together exceed 32 MB.
  Result<void> add(std::size_t at, const std::string& what, Segment segment, std::size_t offset,
                   std::size_t size);

  std::span<const std::uint8_t> bytes_;
  std::vector<Symbol> symbols_;
  Image image_;

 private:
  const std::string& name_;
  // Sum of the sizes of all added segments. A byte of the file that lies in two segments counts twice.
  std::uint64_t contents_ = 0;
};

}  // namespace kaz::h8s
