// Files appear whole or not at all.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/files.hpp"
#include "tools/drawing/figure.h"

namespace kaz::figure {

Result<void> write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  return write_whole_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace kaz::figure
