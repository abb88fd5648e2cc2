// Empties a link before a request.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/drain.h"

#include <array>

namespace kaz::host {

namespace {

// More than a kernel keeps of a port whose program was stopped.
constexpr std::size_t kMostBytes = 65536;
constexpr Time kLongest = std::chrono::milliseconds(100);

}  // namespace

Result<void> drain(Link& link, Clock& clock) {
  const Time begin = clock.now();
  std::array<std::uint8_t, 1024> old{};
  std::size_t bytes = 0;
  while (const std::size_t count = KAZ_TRY(link.read(old, clock.now()))) {
    bytes += count;
    const Time taken = clock.now() - begin;
    if (bytes <= kMostBytes && taken <= kLongest) continue;
    return fail(Fault::environment,
                link.name() + ": unrequested bytes keep arriving, " + std::to_string(bytes) +
                    " in " + std::to_string(taken.count() / 1'000'000) +
                    " ms (limits: " + std::to_string(kMostBytes) +
                    " bytes and 100 ms): disconnect the device that sends on its own, or end the "
                    "other program at this port");
  }
  return {};
}

}  // namespace kaz::host
