// Flooding from the markers' borders.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/watershed.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace kaz::vision {
namespace {

constexpr int kBits = 64, kLevels = 256;
constexpr std::uint8_t kQueued = 4, kMarkers = Watershed::kFirst | Watershed::kSecond;

int difference(const std::uint8_t* a, const std::uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

// Eight bytes that are the bits of `eight`, 0 or 1.
std::uint64_t spread(std::uint64_t eight) {
  const std::uint64_t bits = (eight * 0x0101010101010101U) & 0x8040201008040201U;
  return ((bits + 0x7f7f7f7f7f7f7f7fU) >> 7) & 0x0101010101010101U;
}

}  // namespace

void Watershed::set_markers(const BitImage& first, const BitImage& second) {
  for (int v = 0; v < height_; ++v) {
    std::uint8_t* row = &label_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_)];
    const std::uint64_t *a = first.row(v), *b = second.row(v);
    for (int u = 0; u < width_; u += kBits, ++a, ++b) {
      if (u + kBits <= width_ && (*a == ~std::uint64_t{0} || *b == ~std::uint64_t{0})) {
        std::memset(row + u, *a != 0 ? kFirst : kSecond, kBits);
        continue;
      }
      for (int k = 0; k < kBits && u + k < width_; k += 8) {
        const std::uint64_t labels =
            spread(*a >> k & 0xff) * kFirst + spread(*b >> k & 0xff) * kSecond;
        std::memcpy(row + u + k, &labels, static_cast<std::size_t>(std::min(8, width_ - u - k)));
      }
    }
    row[0] = row[width_ - 1] = kLine;
  }
  std::fill(label_.begin(), label_.begin() + width_, kLine);
  std::fill(label_.end() - width_, label_.end(), kLine);
}

void Watershed::push(int level, int pixel) {
  const auto queue = static_cast<std::size_t>(level);
  if (head_[queue] < 0) {
    head_[queue] = pixel;
  } else {
    next_[static_cast<std::size_t>(tail_[queue])] = pixel;
  }
  tail_[queue] = pixel;
  next_[static_cast<std::size_t>(pixel)] = -1;
}

// In the order of the rows, at the smallest difference from a marker beside.
void Watershed::queue_beside_markers(const std::uint8_t* rgb, const BitImage& first,
                                     const BitImage& second) {
  const auto known = [&](int v, std::size_t i) { return first.row(v)[i] | second.row(v)[i]; };
  for (int v = 1; v + 1 < height_; ++v) {
    for (std::size_t i = 0; i < first.words(); ++i) {
      const std::uint64_t here = known(v, i);
      std::uint64_t beside = here << 1 | here >> 1 | known(v - 1, i) | known(v + 1, i);
      if (i > 0) beside |= known(v, i - 1) >> (kBits - 1);
      if (i + 1 < first.words()) beside |= known(v, i + 1) << (kBits - 1);
      for (std::uint64_t todo = beside & ~here; todo != 0; todo &= todo - 1) {
        const int u = static_cast<int>(i) * kBits + std::countr_zero(todo);
        if (u == 0 || u + 1 >= width_) continue;
        const int pixel = v * width_ + u;
        int level = kLevels;  // where the markers beside are on the frame, which is a line
        for (const int step : {-1, 1, -width_, width_}) {
          if ((label_[static_cast<std::size_t>(pixel + step)] & kMarkers) == 0) continue;
          level = std::min(level, difference(rgb + 3 * static_cast<std::ptrdiff_t>(pixel),
                                             rgb + 3 * static_cast<std::ptrdiff_t>(pixel + step)));
        }
        if (level == kLevels) continue;
        push(level, pixel);
        label_[static_cast<std::size_t>(pixel)] = kQueued;
      }
    }
  }
}

void Watershed::flood(const std::uint8_t* rgb) {
  int active = 0;
  for (;;) {
    while (active < kLevels && head_[static_cast<std::size_t>(active)] < 0) ++active;
    if (active == kLevels) return;
    const std::int32_t pixel = head_[static_cast<std::size_t>(active)];
    head_[static_cast<std::size_t>(active)] = next_[static_cast<std::size_t>(pixel)];
    std::uint8_t* const at = &label_[static_cast<std::size_t>(pixel)];
    const std::uint8_t markers = (at[-1] | at[1] | at[-width_] | at[width_]) & kMarkers;
    if (markers == kMarkers) {
      *at = kLine;
      continue;
    }
    *at = markers;
    const std::uint8_t* const color = rgb + 3 * static_cast<std::ptrdiff_t>(pixel);
    for (const int step : {-1, 1, -width_, width_}) {
      if (at[step] != 0) continue;
      const int level = difference(color, color + 3 * static_cast<std::ptrdiff_t>(step));
      push(level, pixel + step);
      at[step] = kQueued;
      active = std::min(active, level);
    }
  }
}

const std::vector<std::uint8_t>& Watershed::grow(const std::uint8_t* rgb, const BitImage& first,
                                                 const BitImage& second) {
  width_ = first.width();
  height_ = first.height();
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  label_.resize(pixels);
  next_.resize(pixels);
  head_.fill(-1);
  set_markers(first, second);
  queue_beside_markers(rgb, first, second);
  flood(rgb);
  return label_;
}

}  // namespace kaz::vision
