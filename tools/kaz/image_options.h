// IMAGE and how it is read, the same for every verb that takes one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "shared/image/image.h"

namespace kaz::tools {

// IMAGE, --format and --address. `highest`: where a raw image may begin at the most.
void add_image_options(CLI::App& verb, std::string& path, h8s::LoadOptions& load,
                       std::uint32_t highest);

}  // namespace kaz::tools
