// File format of a saved state: header, metadata, payload, checksum.
// SPDX-License-Identifier: Apache-2.0
//
// "KAZSTATE", version (4 bytes), facts (options as pairs of name and value), length, payload (state of all
// parts), SHA-256 of everything before it.
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
  // The payload, a view into `blob`. Errors (usage), one sentence each: not a saved state, damaged, another
  // version, options that differ from `facts` (named).
  static Result<std::span<const std::uint8_t>> unpack(std::span<const std::uint8_t> blob,
                                                      const Facts& facts);
};

}  // namespace kaz::sim
