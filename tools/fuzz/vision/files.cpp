// Files: pictures, calibrations, colours.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tools/fuzz/vision/targets.h"
#include "tools/vision/color_file.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/camera_info.h"
#include "vision/calibration/rectify.h"
#include "vision/image/picture_file.h"

namespace kaz::fuzz {
namespace {

std::string text_of(Bytes bytes) {
  return {bytes.begin(), bytes.end()};
}

bool finite(const vision::CameraModel& c) {
  return std::isfinite(c.fx) && c.fx > 0 && std::isfinite(c.fy) && c.fy > 0 &&
         std::isfinite(c.cx) && std::isfinite(c.cy) && std::isfinite(c.baseline_m) &&
         c.baseline_m > 0;
}

// Two camera_info files in one input, between which is a line "---".
Complaint try_camera_info(const std::string& text, std::size_t mark) {
  const auto read = vision::parse_camera_info({text.substr(0, mark), text.substr(mark + 5)},
                                              {"case.left", "case.right"});
  if (!read) {
    if (read.error().message.starts_with("case.")) return std::nullopt;
    return "the error does not name the file: " + read.error().message;
  }
  if (!finite(read->rectified)) return "an invalid camera model was read";
  const auto again = vision::parse_camera_info(vision::camera_info_text(*read), {"left", "right"});
  if (!again) return "written data cannot be read back: " + again.error().message;
  return std::nullopt;
}

}  // namespace

Complaint try_picture(Bytes bytes) {
  const auto image = vision::decode_picture(bytes, "case");
  if (!image) {
    if (image.error().message.rfind("case", 0) == 0) return std::nullopt;
    return "the error does not name the file: " + image.error().message;
  }
  const auto pixels =
      static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
  if (image->width < 1 || image->height < 1 || image->rgb.size() != 3 * pixels)
    return "the number of pixels does not match the size of the picture";
  return std::nullopt;
}

Complaint try_calibration(Bytes bytes) {
  const std::string text = text_of(bytes);
  if (const auto mark = text.find("\n---\n"); mark != std::string::npos)
    return try_camera_info(text, mark);
  const auto read = vision::parse_calibration(text, "case");
  if (!read) {
    if (read.error().message.rfind("case", 0) == 0) return std::nullopt;
    return "the error does not name the file: " + read.error().message;
  }
  if (!finite(read->rectified)) return "an invalid camera model was read";
  using Format = vision::CalibrationFormat;
  for (const auto format : {Format::yaml, Format::json, Format::xml}) {
    const auto again = vision::parse_calibration(vision::calibration_text(*read, format), "again");
    if (!again) return "written data cannot be read back: " + again.error().message;
  }
  if (static_cast<long long>(read->width) * read->height > 100000) return std::nullopt;
  vision::StereoImages raw, rectified;
  raw.left.width = raw.right.width = read->width;
  raw.left.height = raw.right.height = read->height;
  raw.left.rgb.assign(
      3 * static_cast<std::size_t>(read->width) * static_cast<std::size_t>(read->height), 77);
  raw.right.rgb = raw.left.rgb;
  vision::Rectifier(*read).rectify(raw, rectified);
  if (rectified.left.rgb.size() != raw.left.rgb.size())
    return "the rectified picture has another size";
  return std::nullopt;
}

Complaint try_color(Bytes bytes) {
  const auto range = tools::parse_color(text_of(bytes), "case");
  if (!range) {
    if (range.error().message.rfind("case", 0) == 0) return std::nullopt;
    return "the error does not name the file: " + range.error().message;
  }
  vision::Image image{16, 4, {}};
  for (int i = 0; i < 16 * 4 * 3; ++i)
    image.rgb.push_back(bytes.empty() ? 0 : bytes[static_cast<std::size_t>(i) % bytes.size()]);
  const vision::ColorExtractor extractor(*range);
  vision::Mask vectors, plain;
  extractor.extract(image, vectors, true);
  extractor.extract(image, plain, false);
  if (vectors.pixels != plain.pixels) return "vector and plain code classify colors differently";
  const auto again = tools::parse_color(tools::color_json(*range).dump(), "again");
  if (!again) return "written data cannot be read back: " + again.error().message;
  return std::nullopt;
}

}  // namespace kaz::fuzz
