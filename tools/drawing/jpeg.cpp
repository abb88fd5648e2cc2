// JPEG files: for documents, where a PNG of a photograph would be too large.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/jpeg.h"

#include "tools/drawing/figure.h"

namespace kaz::figure {

Result<void> write_jpeg(const std::string& path, const Image& image, int quality) {
  const auto bytes = picture::encode_jpeg(
      {.width = image.width, .height = image.height, .samples = image.rgb}, {.quality = quality});
  if (!bytes) return fail(bytes.error().fault, path + ": " + bytes.error().message);
  return write_file(path, *bytes);
}

}  // namespace kaz::figure
