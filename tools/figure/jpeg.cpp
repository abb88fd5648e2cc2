// JPEG files: for documents, where a PNG of a photograph would be too large.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>  // before jpeglib.h, which needs it
#include <cstdlib>

#include <jpeglib.h>

#include "tools/figure/figure.h"

namespace kaz::figure {

Result<void> write_jpeg(const std::string& path, const Image& image, int quality) {
  if (image.width <= 0 || image.height <= 0 || image.width > JPEG_MAX_DIMENSION ||
      image.height > JPEG_MAX_DIMENSION)
    return fail(Fault::usage, path + ": a picture of " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height) + " cannot be a JPEG file");
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);  // into memory and with valid sizes there are none
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width);
  jpeg.image_height = static_cast<JDIMENSION>(image.height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.optimize_coding = TRUE;
  jpeg_start_compress(&jpeg, TRUE);
  for (int row = 0; row < image.height; ++row) {
    auto* line = const_cast<unsigned char*>(
        &image.rgb[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) * 3]);
    jpeg_write_scanlines(&jpeg, &line, 1);
  }
  jpeg_finish_compress(&jpeg);
  const auto written = write_file(path, {bytes, size});
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return written;
}

}  // namespace kaz::figure
