// Reading an image file of whatever format.
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iterator>

#include "sim/h8s/image.h"

namespace kaz::h8s {

Result<Image> load_image(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(path + ": cannot open the file");
  const std::vector<char> content{std::istreambuf_iterator<char>(file),
                                  std::istreambuf_iterator<char>()};
  if (file.bad()) return fail(path + ": cannot read the file");
  if (content.empty()) return fail(path + ": the file is empty");
  const std::string_view text(content.data(), content.size());
  if (text[0] == 'S') return parse_srecord(text, path);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(content.data());
  if (content.size() >= 2 && bytes[0] == 0x83) return parse_coff({bytes, content.size()}, path);
  return fail(path + ": neither an S-record file (starts with S) nor H8 COFF (starts with 83 02)");
}

}  // namespace kaz::h8s
