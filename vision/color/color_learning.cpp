// Thresholds of a colour from a marked region of a picture.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/color_learning.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace kaz::vision {
namespace {

constexpr int kMinMarkedPixels = 25;
constexpr double kOneHue_rad = 0.6, kNoise_rad = 0.06;
constexpr double kGrey = 0.15;  // of chroma over lightness; pure red has 2.1
constexpr double kDark = 8;     // of 255: the hue of darker pixels is noise

double percentile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::string text(const PictureRegion& r) {
  return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
         std::to_string(r.height);
}

// The region's pixels in YIQ.
std::vector<Yiq> pixels_of(const Image& image, const PictureRegion& region) {
  std::vector<Yiq> pixels;
  for (int v = region.y; v < region.y + region.height; ++v) {
    for (int u = region.x; u < region.x + region.width; ++u) {
      const std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      pixels.push_back(yiq_from_rgb(p[0], p[1], p[2]));
    }
  }
  return pixels;
}

// What the range lets through, in the region and beside it.
void measure(const Image& image, const PictureRegion& region, LearnedColor& learned) {
  Mask mask;
  ColorExtractor(learned.range).extract(image, mask);
  long inside = 0, all = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      if (mask.pixels[static_cast<std::size_t>(v * image.width + u)] == 0) continue;
      ++all;
      inside += u >= region.x && v >= region.y && u < region.x + region.width &&
                v < region.y + region.height;
    }
  }
  const double region_pixels = 1.0 * region.width * region.height;
  const double others = 1.0 * image.width * image.height - region_pixels;
  learned.inside = static_cast<double>(inside) / region_pixels;
  learned.outside = others > 0 ? static_cast<double>(all - inside) / others : 0;
}

// Widens `range` to contain `other`. Hues are angles, so `other` is first turned near to the range.
void widen(ColorRange& range, ColorRange other) {
  const double apart = range.hue_min + range.hue_max - other.hue_min - other.hue_max;
  const double turns = 2 * std::numbers::pi * std::round(apart / (4 * std::numbers::pi));
  range.hue_min = std::min(range.hue_min, other.hue_min + turns);
  range.hue_max = std::max(range.hue_max, other.hue_max + turns);
  range.saturation_min = std::min(range.saturation_min, other.saturation_min);
  range.y_min = std::min(range.y_min, other.y_min);
}

}  // namespace

Result<LearnedColor> learn_color(std::span<const MarkedPicture> pictures) {
  if (pictures.empty()) return fail(Fault::usage, "no picture to learn a color from: give one");
  LearnedColor all;
  for (const MarkedPicture& picture : pictures) {
    const auto learned = learn_color(picture.image, picture.region);
    if (!learned) return fail(learned.error().fault, picture.name + ": " + learned.error().message);
    if (&picture == pictures.data()) {
      all.range = learned->range;
    } else {
      widen(all.range, learned->range);
    }
    if (all.range.hue_max - all.range.hue_min >= std::numbers::pi)
      return fail(Fault::failed,
                  picture.name +
                      ": its color differs too much from that of the pictures before "
                      "it: mark the same object in all pictures");
  }
  for (const MarkedPicture& picture : pictures) {
    LearnedColor one{all.range, 0, 0};
    measure(picture.image, picture.region, one);
    all.inside += one.inside / static_cast<double>(pictures.size());
    all.outside += one.outside / static_cast<double>(pictures.size());
  }
  return all;
}

Result<LearnedColor> learn_color(const Image& image, const PictureRegion& region) {
  const auto bytes =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
  if (image.width < 1 || image.height < 1 || image.rgb.size() != bytes)
    return fail(Fault::usage, "the picture is empty");
  if (region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1 ||
      region.width > image.width - region.x || region.height > image.height - region.y)
    return fail(Fault::usage, "the region " + text(region) + " is not within the picture of " +
                                  std::to_string(image.width) + " x " +
                                  std::to_string(image.height) + " pixels");
  if (static_cast<long>(region.width) * region.height < kMinMarkedPixels)
    return fail(Fault::usage, "the region " + text(region) + " has fewer than " +
                                  std::to_string(kMinMarkedPixels) +
                                  " pixels: mark more of the object");
  const std::vector<Yiq> pixels = pixels_of(image, region);
  double i = 0, q = 0, chroma = 0, lightness = 0;
  for (const Yiq& p : pixels) {
    i += p.i;
    q += p.q;
    chroma += std::hypot(p.i, p.q);
    lightness += p.y;
  }
  if (chroma <= kGrey * lightness || lightness <= kDark * static_cast<double>(pixels.size()))
    return fail(Fault::failed,
                "the region " + text(region) + " is gray or black: color extraction needs a hue");
  const double middle = std::atan2(q, i);
  std::vector<double> hue, saturation, y;
  for (const Yiq& p : pixels) {
    const double off = std::remainder(std::atan2(p.q, p.i) - middle, 2 * std::numbers::pi);
    const double s = std::hypot(p.i, p.q) / std::max(p.y, 1.0);
    if (p.y < kDark || s < kGrey || std::abs(off) > kOneHue_rad) continue;
    hue.push_back(off);
    saturation.push_back(s);
    y.push_back(p.y);
  }
  if (2 * hue.size() < pixels.size())
    return fail(Fault::failed,
                "the region " + text(region) +
                    " has several colors: the object must fill more than half of the region");
  LearnedColor learned;
  learned.range.hue_min = middle + percentile(hue, 0.01) - kNoise_rad;
  learned.range.hue_max = middle + percentile(hue, 0.99) + kNoise_rad;
  learned.range.saturation_min = 0.8 * percentile(saturation, 0.02);
  learned.range.y_min = 0.5 * percentile(y, 0.02);
  measure(image, region, learned);
  return learned;
}

}  // namespace kaz::vision
