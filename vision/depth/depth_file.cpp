// Depth as PNG by libpng, points as PLY.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_file.h"

#include <png.h>

#include <cmath>
#include <cstring>
#include <string>

namespace kaz::vision {

Result<std::vector<std::uint8_t>> depth_png(const DepthImage& depth) {
  if (depth.width < 1 || depth.height < 1)
    return fail(Fault::usage, "an empty depth image is no PNG");
  // libpng's simplified interface takes 16 bits as linear light and would write a gamma chunk for
  // it; these numbers are no light.
  std::vector<std::uint8_t> rows;
  rows.reserve(2 * depth.disparity_px.size());
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const double mm = depth.known(u, v) ? std::round(1e3 * depth.depth_m(u, v)) : 0;
      const auto code = static_cast<std::uint16_t>(mm <= 65535 ? mm : 0);
      rows.push_back(static_cast<std::uint8_t>(code >> 8));  // PNG is big-endian
      rows.push_back(static_cast<std::uint8_t>(code & 0xff));
    }
  }
  struct Writer {
    png_structp png = png_create_write_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
        [](png_structp, png_const_charp) {});
    png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
    ~Writer() { png_destroy_write_struct(&png, &info); }
  } writer;
  std::vector<std::uint8_t> bytes;
  if (writer.info == nullptr || setjmp(png_jmpbuf(writer.png)) != 0)
    return fail(Fault::failed, "the depth image could not be made a PNG: out of memory?");
  png_set_write_fn(
      writer.png, &bytes,
      [](png_structp p, png_bytep data, png_size_t size) {
        auto& all = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
        all.insert(all.end(), data, data + size);
      },
      [](png_structp) {});
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(depth.width),
               static_cast<png_uint_32>(depth.height), 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writer.png, writer.info);
  for (int v = 0; v < depth.height; ++v)
    png_write_row(writer.png, rows.data() + static_cast<std::ptrdiff_t>(2) * v * depth.width);
  png_write_end(writer.png, nullptr);
  return bytes;
}

Result<std::vector<std::uint8_t>> points_ply(const PointCloud& cloud, const Image& colors) {
  if (cloud.width != colors.width || cloud.height != colors.height ||
      colors.rgb.size() != 3 * cloud.points.size())
    return fail(Fault::usage, "points and picture are of different size: no PLY of them");
  std::size_t count = 0;
  for (const Eigen::Vector3f& point : cloud.points) count += std::isfinite(point.z()) ? 1 : 0;
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment m; colours of the left eye\nelement vertex " +
      std::to_string(count) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nend_header\n";
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 15 * count);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!std::isfinite(cloud.points[i].z())) continue;
    for (const float part : cloud.points[i]) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &part, sizeof bits);
      for (int shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
    for (std::size_t c = 0; c < 3; ++c) bytes.push_back(colors.rgb[3 * i + c]);
  }
  return bytes;
}

}  // namespace kaz::vision
