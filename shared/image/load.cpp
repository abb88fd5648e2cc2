// Reading an image file of whatever format.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/files.hpp"
#include "shared/image/image.h"

namespace kaz::h8s {
namespace {

// Against files that are no images of a chip that addresses 16 MB; text needs some three characters
// a byte.
constexpr std::size_t kLargest = 128 * 1024 * 1024;

Format format_of(std::span<const std::uint8_t> bytes) {
  const auto starts = [&](std::size_t k, std::uint8_t value) {
    return bytes.size() > k && bytes[k] == value;
  };
  if (starts(0, 'S')) return Format::srecord;
  if (starts(0, ':')) return Format::intel_hex;
  if (starts(0, 0x83)) return Format::coff;
  if (starts(0, 0x7f) && starts(1, 'E')) return Format::elf;
  return Format::automatic;
}

Result<Image> raw(std::vector<std::uint8_t> bytes, const std::string& path,
                  std::optional<std::uint32_t> address) {
  if (!address) return fail(path + ": a raw image needs the address of its first byte (--at)");
  if (*address > 0xffffff || bytes.size() > 0x1000000 - *address)
    return fail(path + ": " + std::to_string(bytes.size()) +
                " bytes from the given address exceed 0xffffff");
  Image image;
  image.entry = *address;
  image.segments.push_back({*address, *address, "raw image", std::move(bytes)});
  return image;
}

}  // namespace

Result<Image> load_image(const std::string& path, const LoadOptions& options) {
  const auto read =
      KAZ_TRY(read_whole_file(path, kLargest, "give a firmware or program image to read"));
  const std::vector<std::uint8_t> bytes(read.begin(), read.end());
  if (bytes.empty()) return fail(path + ": the file is empty");
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const Format format = options.format == Format::automatic ? format_of(bytes) : options.format;
  if (options.address && format != Format::raw && format != Format::automatic)
    return fail(path +
                ": --at is for raw images (--format raw); this file contains its own addresses");
  switch (format) {
    case Format::srecord:
      return parse_srecord(text, path);
    case Format::intel_hex:
      return parse_intel_hex(text, path);
    case Format::coff:
      return parse_coff(bytes, path);
    case Format::elf:
      return parse_elf(bytes, path);
    case Format::raw:
      return raw(std::move(bytes), path, options.address);
    case Format::automatic:
      break;
  }
  return fail(
      path +
      ": unknown format: not S-record (starts with S), Intel HEX (starts with a colon), H8 COFF "
      "(83 02) or ELF (7f 45 4c 46); for a raw image use --format raw --at A, if the command has "
      "these options");
}

}  // namespace kaz::h8s
