// What COFF and ELF share: a file of big-endian fields at offsets, and contents for the memory.
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
  // Both must outlive it; `name` is used in messages.
  ObjectFile(std::span<const std::uint8_t> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

 protected:
  // Against files made to exhaust memory.
  static constexpr std::size_t kLongestName = 1024;

  bool fits(std::size_t at, std::size_t size) const {
    return at <= bytes_.size() && size <= bytes_.size() - at;
  }
  // Callers have checked that the field lies inside the file.
  unsigned u16(std::size_t at) const {
    return static_cast<unsigned>(bytes_[at] << 8 | bytes_[at + 1]);
  }
  std::uint32_t u32(std::size_t at) const {
    return static_cast<std::uint32_t>(u16(at)) << 16 | static_cast<std::uint32_t>(u16(at + 2));
  }
  tl::unexpected<Error> error(std::size_t at, const std::string& what) const;
  // Names go into messages: one that holds anything but printable characters shows them as '?'.
  std::string text(std::size_t at, std::size_t max_length) const;
  // A segment of the image, described at `at`; `what` names it in messages.
  Result<void> add(std::size_t at, const std::string& what, Segment segment, std::size_t offset,
                   std::size_t size);

  std::span<const std::uint8_t> bytes_;
  std::vector<Symbol> symbols_;
  Image image_;

 private:
  const std::string& name_;
  std::uint64_t contents_ = 0;  // bytes of all segments so far: they may share the file's
};

}  // namespace kaz::h8s
