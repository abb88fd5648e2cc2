// Finds the field in which two messages of a recording differ.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kaz::tools {

struct FieldDifference {
  std::string recorded, now;  // texts such as "angle[3] = 0.12 (2 more differ)"
};

// Returns the first field that differs. Returns nullopt if the topic has no fixed layout, or if a message has
// the wrong length.
std::optional<FieldDifference> field_difference(std::string_view topic,
                                                std::span<const std::uint8_t> recorded,
                                                std::span<const std::uint8_t> now);

}  // namespace kaz::tools
