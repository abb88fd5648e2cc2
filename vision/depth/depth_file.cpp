// Depth as PNG, points as PLY.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth_file.h"

#include <cmath>
#include <cstring>
#include <string>

#include "shared/picture/png.h"

namespace kaz::vision {

Result<std::vector<std::uint8_t>> depth_png(const DepthImage& depth) {
  if (depth.width < 1 || depth.height < 1)
    return fail(Fault::usage, "an empty depth image cannot be written as PNG");
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
  auto bytes = picture::encode_png({depth.width, depth.height, 1, 16, rows});
  if (!bytes)
    return fail(Fault::failed,
                "the depth image could not be written as PNG: check the free memory");
  return bytes;
}

Result<std::vector<std::uint8_t>> points_ply(const PointCloud& cloud, const Image& colors) {
  if (cloud.width != colors.width || cloud.height != colors.height ||
      colors.rgb.size() != 3 * cloud.points.size())
    return fail(Fault::usage, "points and picture differ in size: cannot write a PLY");
  std::size_t count = 0;
  for (const Eigen::Vector3f& point : cloud.points) count += std::isfinite(point.z()) ? 1 : 0;
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment coordinates in m, colors of the left "
      "eye\nelement vertex " +
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
