// File format of a saved state.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/snapshot.h"

#include <algorithm>

#include "shared/base/archive.hpp"
#include "sim/runtime/formats/sha256.h"

namespace kaz::sim {
namespace {

constexpr std::string_view kMagic = "KAZSTATE";
constexpr std::size_t kDigestSize = 64;  // hexadecimal digits

tl::unexpected<Error> unusable(const std::string& why) {
  return fail(Fault::usage, "this saved state cannot be restored: " + why);
}

std::string shown(const std::string& value) {
  return value.empty() ? "none" : value;
}

}  // namespace

std::vector<std::uint8_t> Snapshot::pack(const Facts& facts, std::span<const std::uint8_t> state) {
  StateWriter to;
  for (const char c : kMagic) to.number(static_cast<std::uint8_t>(c));
  std::uint32_t number = kVersion;
  Facts stored = facts;
  auto size = static_cast<std::uint64_t>(state.size());
  to(number, stored, size);
  std::vector<std::uint8_t> blob = std::move(to.bytes());
  blob.insert(blob.end(), state.begin(), state.end());
  const std::string digest = sha256_hex(blob);
  blob.insert(blob.end(), digest.begin(), digest.end());
  return blob;
}

Result<std::span<const std::uint8_t>> Snapshot::unpack(std::span<const std::uint8_t> blob,
                                                       const Facts& facts) {
  if (blob.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), blob.begin()))
    return unusable("the data is not a saved state; give a file written by `save`");
  StateReader head(blob.subspan(kMagic.size()));
  std::uint32_t number = 0;
  head(number);
  if (head.good() && number != kVersion)
    return unusable("it has version " + std::to_string(number) + ", this program reads version " +
                    std::to_string(kVersion) + "; save it again with this program");
  if (blob.size() < kMagic.size() + kDigestSize)
    return unusable("it ends too early; the file is damaged");
  const auto reported_digest = blob.last(kDigestSize);
  const auto body = blob.first(blob.size() - kDigestSize);
  const std::string digest = sha256_hex(std::vector<std::uint8_t>(body.begin(), body.end()));
  if (!std::equal(digest.begin(), digest.end(), reported_digest.begin()))
    return unusable("its checksum is wrong; the file is damaged");
  StateReader from(body.subspan(kMagic.size() + 4));
  Facts stored;
  std::uint64_t size = 0;
  from(stored, size);
  if (!from.good() || size != from.left())
    return unusable("the lengths of its parts are inconsistent; the file is damaged");
  for (const auto& [name, value] : facts) {
    const auto other = std::ranges::find(stored, name, &Facts::value_type::first);
    const std::string was = other == stored.end() ? "" : other->second;
    if (was != value)
      return unusable("it was saved with " + name + " " + shown(was) + ", this simulation has " +
                      shown(value) + "; use the same options");
  }
  return body.last(from.left());
}

}  // namespace kaz::sim
