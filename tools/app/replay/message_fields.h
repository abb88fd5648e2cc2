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
  std::string recorded, now;  // "angle[3] = 0.12 (2 more differ)"
};

// Returns the first field that differs. Returns nullopt for topics without a fixed layout, or if a length is
// wrong.
std::optional<FieldDifference> field_difference(std::string_view topic,
                                                std::span<const std::uint8_t> recorded,
                                                std::span<const std::uint8_t> now);

}  // namespace kaz::tools
