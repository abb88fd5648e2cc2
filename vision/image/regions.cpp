// Connected regions by runs and union-find.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/regions.h"

#include <algorithm>
#include <cstring>

namespace kaz::vision {

void RegionFinder::collect_runs(const Mask& mask) {
  runs_.clear();
  row_start_.clear();
  const auto width = static_cast<std::size_t>(mask.width);
  for (int y = 0; y < mask.height; ++y) {
    row_start_.push_back(static_cast<int>(runs_.size()));
    const std::uint8_t* row = mask.pixels.data() + static_cast<std::size_t>(y) * width;
    const std::uint8_t* end = row + width;
    const std::uint8_t* at = row;
    while (at < end) {
      const void* set = std::memchr(at, 255, static_cast<std::size_t>(end - at));
      if (set == nullptr) break;
      const auto* first = static_cast<const std::uint8_t*>(set);
      const void* clear = std::memchr(first, 0, static_cast<std::size_t>(end - first));
      const auto* behind = clear == nullptr ? end : static_cast<const std::uint8_t*>(clear);
      runs_.push_back({y, static_cast<int>(first - row), static_cast<int>(behind - row) - 1});
      at = behind;
    }
  }
  row_start_.push_back(static_cast<int>(runs_.size()));
}

int RegionFinder::root(int run) {
  auto at = static_cast<std::size_t>(run);
  while (parent_[at] != static_cast<int>(at)) {
    const auto above = static_cast<std::size_t>(parent_[at]);
    parent_[at] = parent_[above];
    at = above;
  }
  return static_cast<int>(at);
}

// The smaller index becomes the root: a region's root is its first run from the top.
void RegionFinder::join_rows() {
  parent_.resize(runs_.size());
  for (std::size_t i = 0; i < runs_.size(); ++i) parent_[i] = static_cast<int>(i);
  for (std::size_t y = 1; y + 1 < row_start_.size(); ++y) {
    int above = row_start_[y - 1], here = row_start_[y];
    while (above < row_start_[y] && here < row_start_[y + 1]) {
      const Run& a = runs_[static_cast<std::size_t>(above)];
      const Run& b = runs_[static_cast<std::size_t>(here)];
      if (a.left <= b.right + 1 && b.left <= a.right + 1) {
        const int ra = root(above), rb = root(here);
        parent_[static_cast<std::size_t>(std::max(ra, rb))] = std::min(ra, rb);
      }
      // Of the two, the one that ends first can touch no other.
      if (a.right < b.right) {
        ++above;
      } else {
        ++here;
      }
    }
  }
}

std::span<const Region> RegionFinder::find(const Mask& mask, int min_area) {
  regions_.clear();
  if (mask.width <= 0 || mask.height <= 0 ||
      mask.pixels.size() !=
          static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height)) {
    return {};
  }
  collect_runs(mask);
  join_rows();

  // Areas first, so that the many specks of a noisy mask cost no memory.
  std::vector<int>& area = area_;
  area.assign(runs_.size(), 0);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    parent_[i] = root(static_cast<int>(i));
    area[static_cast<std::size_t>(parent_[i])] += runs_[i].right - runs_[i].left + 1;
  }
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const auto r = static_cast<std::size_t>(parent_[i]);
    if (r == i) {
      // From here on the entry of a root is the number of its region, or -1.
      const int pixels = area[i];
      area[i] = pixels >= min_area ? static_cast<int>(regions_.size()) : -1;
      if (area[i] < 0) continue;
      Region region;
      region.area = pixels;
      region.left = mask.width;
      region.top = runs_[i].row;
      regions_.push_back(std::move(region));
    }
    if (area[r] < 0) continue;
    Region& region = regions_[static_cast<std::size_t>(area[r])];
    const Run& run = runs_[i];
    const double length = run.right - run.left + 1;
    region.left = std::min(region.left, run.left);
    region.right = std::max(region.right, run.right);
    region.bottom = run.row;
    region.centroid_x += 0.5 * (run.left + run.right) * length;
    region.centroid_y += run.row * length;
    region.runs.push_back(run);
  }
  for (Region& region : regions_) {
    region.centroid_x /= region.area;
    region.centroid_y /= region.area;
  }
  std::stable_sort(regions_.begin(), regions_.end(),
                   [](const Region& a, const Region& b) { return a.area > b.area; });
  return regions_;
}

}  // namespace kaz::vision
