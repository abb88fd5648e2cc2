// Reads the times that a client sends.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/followed_clock.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

namespace kaz::sim {

static_assert(std::endian::native == std::endian::little, "the times are little-endian");

// A clock that counts from its machine's start passes this after 146 years.
constexpr std::int64_t kLatestTime = std::int64_t{1} << 62;

Result<void> ClockStream::feed(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    part_[have_++] = byte;
    if (have_ < part_.size()) continue;
    have_ = 0;
    std::int64_t time = 0;
    std::memcpy(&time, part_.data(), sizeof time);
    if (time < 0 || time > kLatestTime)
      return fail(Fault::environment, "the followed clock sent " + std::to_string(time) +
                                          " ns, which is not a valid time since boot: 8 "
                                          "little-endian bytes are expected");
    if (latest_ && Time(time) < *latest_)
      return fail(Fault::environment, "the followed clock went back by " +
                                          std::to_string(latest_->count() - time) +
                                          " ns: it has to be a CLOCK_MONOTONIC");
    latest_ = Time(time);
  }
  return {};
}

Result<std::unique_ptr<FollowedClock>> FollowedClock::open(const std::string& path) {
  auto listener = KAZ_TRY(UnixListener::open(path));
  return std::unique_ptr<FollowedClock>(new FollowedClock(std::move(listener)));
}

Result<bool> FollowedClock::poll(Time patience) {
  const timespec wait{static_cast<time_t>(patience.count() / 1'000'000'000),
                      static_cast<long>(patience.count() % 1'000'000'000)};
  // A waiting client is looked at only when it would be accepted: its connection stays readable.
  const bool replaceable = !client_ || Clock::now() - heard_ >= kMaxSilence;
  std::array<pollfd, 2> watched{{{client_.get(), POLLIN, 0}, {listener_->fd(), POLLIN, 0}}};
  if (ppoll(watched.data(), replaceable ? 2 : 1, &wait, nullptr) <= 0) return false;
  if (watched[0].revents == 0) {
    if (Descriptor next = listener_->accept()) {
      client_ = std::move(next);
      heard_ = Clock::now();
      stream_.restart();
    }
    return false;
  }
  heard_ = Clock::now();
  const bool first = !stream_.latest();
  std::array<std::uint8_t, 8> bytes{};
  const ssize_t got =
      ::recv(client_.get(), bytes.data(), bytes.size() - stream_.part(), MSG_DONTWAIT);
  if (got > 0) KAZ_TRY(stream_.feed(std::span(bytes).first(static_cast<std::size_t>(got))));
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) client_ = Descriptor();
  if (!stream_.latest()) return false;
  now_ = *stream_.latest();
  return first;
}

}  // namespace kaz::sim
