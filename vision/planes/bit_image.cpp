// Morphology by shifts: n shifted copies are joined by doubling, in log2(n) steps.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/bit_image.h"

#include <algorithm>
#include <cstring>

namespace kaz::vision {
namespace {

constexpr int kBits = 64;

// One bit for each of eight bytes that are 0 or 1. The product has byte i at bit 56 + i.
std::uint64_t gathered(const std::uint8_t* bytes) {
  std::uint64_t eight = 0;
  std::memcpy(&eight, bytes, sizeof eight);
  return (eight * 0x0102040810204080U) >> 56;
}

// words[i] |= words shifted towards higher bits by `shift`, 1 to 64.
void join_shifted(std::uint64_t* words, std::size_t count, int shift) {
  if (shift == kBits) {
    for (std::size_t i = count - 1; i > 0; --i) words[i] |= words[i - 1];
    return;
  }
  for (std::size_t i = count - 1; i > 0; --i)
    words[i] |= words[i] << shift | words[i - 1] >> (kBits - shift);
  words[0] |= words[0] << shift;
}

}  // namespace

void BitImage::pack(const std::uint8_t* bytes, int width, int height) {
  width_ = width;
  height_ = height;
  words_ = static_cast<std::size_t>((width + kBits - 1) / kBits);
  bits_.assign(words_ * static_cast<std::size_t>(height), 0);
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* from = bytes + static_cast<std::ptrdiff_t>(v) * width;
    std::uint64_t* to = &bits_[static_cast<std::size_t>(v) * words_];
    int u = 0;
    for (; u + 8 <= width; u += 8) to[u / kBits] |= gathered(from + u) << (u % kBits);
    for (; u < width; ++u) to[u / kBits] |= static_cast<std::uint64_t>(from[u]) << (u % kBits);
  }
}

void BitImage::join(const BitImage& other) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] |= other.bits_[i];
}

void BitImage::remove(const BitImage& other) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] &= ~other.bits_[i];
}

void BitImage::invert() {
  const int beyond = static_cast<int>(words_) * kBits - width_;
  for (std::uint64_t& word : bits_) word = ~word;
  for (std::size_t i = words_ - 1; i < bits_.size(); i += words_)
    bits_[i] &= ~std::uint64_t{0} >> beyond;
}

// Pixel u of the result is the union of the pixels u - reach .. u + reach: first of u - 2 reach .. u, then
// moved by `reach`.
void BitImage::dilate_rows(int reach) {
  const int n = 2 * reach + 1;
  const std::size_t longer = words_ + static_cast<std::size_t>((reach + kBits - 1) / kBits);
  rows_.resize(longer);
  for (int v = 0; v < height_; ++v) {
    std::uint64_t* row = &bits_[static_cast<std::size_t>(v) * words_];
    if (std::all_of(row, row + words_, [](std::uint64_t word) { return word == 0; })) continue;
    std::copy(row, row + words_, rows_.begin());
    std::fill(rows_.begin() + static_cast<std::ptrdiff_t>(words_), rows_.end(), 0);
    int joined = 1;
    for (; 2 * joined <= n; joined *= 2) join_shifted(rows_.data(), longer, joined);
    if (joined < n) join_shifted(rows_.data(), longer, n - joined);
    if (reach == kBits) {
      std::copy(rows_.begin() + 1, rows_.begin() + 1 + static_cast<std::ptrdiff_t>(words_), row);
    } else {
      for (std::size_t i = 0; i < words_; ++i)
        row[i] = rows_[i] >> reach | rows_[i + 1] << (kBits - reach);
    }
    if (const int beyond = static_cast<int>(words_) * kBits - width_; beyond > 0)
      row[words_ - 1] &= ~std::uint64_t{0} >> beyond;
  }
}

// The same of rows.
void BitImage::dilate_columns(int reach) {
  const auto n = static_cast<std::size_t>(2 * reach + 1),
             move = static_cast<std::size_t>(reach) * words_;
  const std::size_t size = bits_.size() + move;
  rows_.resize(size);
  std::copy(bits_.begin(), bits_.end(), rows_.begin());
  std::fill(rows_.begin() + static_cast<std::ptrdiff_t>(bits_.size()), rows_.end(), 0);
  const auto join = [&](std::size_t rows) {
    const std::size_t back = rows * words_;
    for (std::size_t i = size; i-- > back;) rows_[i] |= rows_[i - back];
  };
  std::size_t joined = 1;
  for (; 2 * joined <= n; joined *= 2) join(joined);
  if (joined < n) join(n - joined);
  std::copy(rows_.begin() + static_cast<std::ptrdiff_t>(move), rows_.end(), bits_.begin());
}

void BitImage::dilate(int reach) {
  dilate_rows(reach);
  dilate_columns(reach);
}

void BitImage::erode(int reach) {
  invert();
  dilate(reach);
  invert();
}

}  // namespace kaz::vision
