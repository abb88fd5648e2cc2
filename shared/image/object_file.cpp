// Fields, names and contents of an object file.
// SPDX-License-Identifier: Apache-2.0
#include "shared/image/object_file.h"

#include <cstdio>

namespace kaz::h8s {
namespace {

// Against files made to exhaust memory.
constexpr std::uint64_t kMaxContents = 0x2000000;

}  // namespace

tl::unexpected<Error> ObjectFile::error(std::size_t at, const std::string& what) const {
  char offset[32];
  std::snprintf(offset, sizeof offset, "0x%zx", at);
  return fail(name_ + ": at offset " + offset + ": " + what);
}

std::string ObjectFile::text(std::size_t at, std::size_t max_length) const {
  std::string s;
  for (std::size_t k = at; k < bytes_.size() && k < at + max_length && bytes_[k] != 0; ++k)
    s += bytes_[k] < 0x20 || bytes_[k] == 0x7f ? '?' : static_cast<char>(bytes_[k]);
  return s;
}

Result<void> ObjectFile::add(std::size_t at, const std::string& what, Segment segment,
                             std::size_t offset, std::size_t size) {
  if (!fits(offset, size)) return error(at, "the contents of " + what + " lie outside the file");
  contents_ += size;
  if (contents_ > kMaxContents)
    return error(
        at, what + " increases the contents to more than 32 MB, but the chip addresses only 16 MB");
  const auto contents = bytes_.subspan(offset, size);
  segment.bytes.assign(contents.begin(), contents.end());
  image_.segments.push_back(std::move(segment));
  return {};
}

}  // namespace kaz::h8s
