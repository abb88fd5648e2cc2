// A saved state as bytes: what stands around the parts' own bytes, and whom it fits.
// SPDX-License-Identifier: Apache-2.0
//
// "KAZSTATE", version (4 bytes), facts (what it was made with: name and value each), length, the
// parts' bytes, SHA-256 over all before it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

class Snapshot {
 public:
  using Facts = std::vector<std::pair<std::string, std::string>>;
  static constexpr std::uint32_t version = 2;

  static std::vector<std::uint8_t> pack(const Facts& facts, std::span<const std::uint8_t> state);
  // The parts' bytes, which lie in `blob`. Errors (usage), one sentence each: no saved state, damaged,
  // another version, made with other options than `facts`, which are told.
  static Result<std::span<const std::uint8_t>> unpack(std::span<const std::uint8_t> blob,
                                                      const Facts& facts);

  // Errors name the file.
  static Result<void> write(const std::string& path, std::span<const std::uint8_t> blob);
  static Result<std::vector<std::uint8_t>> read(const std::string& path);
};

}  // namespace kaz::sim
