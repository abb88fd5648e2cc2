// File format of a saved state: header, metadata, payload, checksum.
// SPDX-License-Identifier: Apache-2.0
//
// A file begins with "KAZSTATE", the version (4 bytes) and the facts (options as pairs of name and value).
// The facts are followed by the length of the payload, and by the payload itself (state of all parts). The
// file ends with the SHA-256 of all earlier bytes, in hexadecimal.
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
  static constexpr std::uint32_t kVersion = 2;

  static std::vector<std::uint8_t> pack(const Facts& facts, std::span<const std::uint8_t> state);
  // Returns the payload as a view into `blob`. Returns Fault::usage if `blob` is not a saved state of this
  // version, or if `blob` is damaged. Also returns Fault::usage if the options in `blob` differ from `facts`.
  // The error message is one sentence. If an option differs, the message names the option.
  static Result<std::span<const std::uint8_t>> unpack(std::span<const std::uint8_t> blob,
                                                      const Facts& facts);
};

}  // namespace kaz::sim
