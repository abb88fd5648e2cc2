// What a reader of packets has found in a stream of bytes. Every byte ends up in a packet or in a count.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz {

struct PacketCounts {
  std::uint64_t packets = 0;
  std::uint64_t bad_checksums = 0, bad_lengths = 0;
  std::uint64_t abandoned = 0;      // packets that did not come whole
  std::uint64_t skipped_bytes = 0;  // between packets
  std::uint64_t bad() const { return bad_checksums + bad_lengths + abandoned; }
};

}  // namespace kaz
