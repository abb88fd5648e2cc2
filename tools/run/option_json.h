// Writes options of the simulated robot into a JSON object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include <nlohmann/json.hpp>

#include "sim/runtime/simulation/robot_options.h"

namespace kaz::tools {

// Returns an archive (robot_options.h) that appends each option to `to`, which must outlive the archive.
inline auto option_json_writer(nlohmann::ordered_json& to) {
  return [&to]<class T>(const sim::OptionText& text, const T& value, const auto&...) {
    if (text.optional && value == T{}) return;
    if constexpr (std::is_enum_v<T>)
      to[text.name] = to_string(value);
    else
      to[text.name] = value;
  };
}

}  // namespace kaz::tools
