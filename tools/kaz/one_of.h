// A name for an enumerator.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Takes the names of `values`; CLI11's own transformer would print their numbers too.
template <class T>
CLI::Validator one_of(const std::map<std::string, T>& values) {
  return CLI::Validator(
      [values](std::string& text) {
        const auto found = values.find(text);
        if (found != values.end()) {
          text = std::to_string(static_cast<int>(found->second));
          return std::string{};
        }
        std::string names;
        for (const auto& [name, value] : values) names += (names.empty() ? "" : ", ") + name;
        return "'" + text + "' is none of " + names;
      },
      "");
}

}  // namespace kaz::tools
