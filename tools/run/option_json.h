// Writes options of the simulated robot into a JSON object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sim/runtime/simulation/robot_options.h"

namespace kaz::tools {

// Archive (robot_options.h) that appends each option to `to`, which must outlive the archive.
class OptionJsonWriter {
 public:
  explicit OptionJsonWriter(nlohmann::ordered_json& to) : to_(to) {}

  template <class T, std::size_t N>
  void choice(const sim::OptionText& text, const T& value, const std::array<T, N>&) {
    to_[text.name] = to_string(value);
  }
  void flag(const sim::OptionText& text, bool value) { put(text, value, !value); }
  void line(const sim::OptionText& text, const std::string& value) {
    put(text, value, value.empty());
  }
  void lines(const sim::OptionText& text, const std::vector<std::string>& value) {
    put(text, value, value.empty());
  }
  void number(const sim::OptionText& text, double value) { to_[text.name] = value; }
  void number(const sim::OptionText& text, double value, const sim::OptionRange&) {
    to_[text.name] = value;
  }
  void whole(const sim::OptionText& text, std::uint64_t value) { to_[text.name] = value; }
  template <std::size_t N>
  void size(const sim::OptionText& text, int value, const std::array<int, N>&) {
    to_[text.name] = value;
  }

 private:
  template <class T>
  void put(const sim::OptionText& text, const T& value, bool is_default) {
    if (!text.optional || !is_default) to_[text.name] = value;
  }

  nlohmann::ordered_json& to_;
};

}  // namespace kaz::tools
