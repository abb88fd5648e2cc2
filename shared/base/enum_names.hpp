// Conversion between enum values and their names in options, files and messages.
// SPDX-License-Identifier: Apache-2.0
//
// For an enum T, the functions need constexpr const char* to_string(T) in the namespace of T, and an array of
// all values of T.
#ifndef KAZ_SHARED_BASE_ENUM_NAMES_HPP
#define KAZ_SHARED_BASE_ENUM_NAMES_HPP

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kaz {

// Returns the value with exactly this name, or nullopt.
template <class T, std::size_t N>
constexpr std::optional<T> parse_enum(const std::array<T, N>& values, std::string_view name) {
  for (const T value : values) {
    if (to_string(value) == name) return value;
  }
  return std::nullopt;
}

// Returns the names in the order of `values`.
template <class T, std::size_t N>
std::vector<std::string> enum_names(const std::array<T, N>& values) {
  std::vector<std::string> names;
  for (const T value : values) names.emplace_back(to_string(value));
  return names;
}

}  // namespace kaz

#endif
