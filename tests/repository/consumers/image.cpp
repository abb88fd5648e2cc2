// The firmware's S-records, read.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>

#include "shared/image/image.h"

int main(int count, char** arguments) {
  if (count != 2) return std::puts("usage: image PREFIX/share/kaz"), 2;
  const auto image = kaz::h8s::load_image(std::string(arguments[1]) + "/firmware/kaz.mot");
  if (!image) return std::puts(image.error().message.c_str()), 1;
  std::size_t bytes = 0;
  for (const auto& segment : image->segments) bytes += segment.bytes.size();
  std::printf("%zu bytes in %zu segments\n", bytes, image->segments.size());
  return bytes > 10'000 ? 0 : 1;
}
