// Runs control cycles at a rate, sent ahead of their replies, and counts them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/wire_load_testing.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

namespace kaz::lockstep {

namespace {

constexpr std::size_t kAhead = 2;  // cycles sent and not received: keeps the window full
constexpr double kSwing = 0.05, kSwingHz = 0.5;
constexpr Time kRamp = std::chrono::milliseconds(12);

}  // namespace

Result<WireLoad> run_wire_load(host::Robot& robot, Time byte_time, double rate_hz, Time duration) {
  host::Clock& clock = robot.clock();
  KAZ_TRY(robot.enable(host::kAllJoints));
  const auto start_posture = KAZ_TRY(robot.state());

  const Time start = clock.now();
  const host::LinkStatistics before = robot.statistics();
  std::deque<Time> sent;
  std::uint64_t received = 0;
  WireLoad load;
  const auto receive = [&](Time deadline) -> Result<bool> {
    auto posture = KAZ_TRY(robot.receive_cycle(deadline));
    if (!posture) return false;
    ++received;
    load.oldest_s = std::max(load.oldest_s, seconds(clock.now() - sent.front()));
    sent.pop_front();
    return true;
  };

  for (std::uint64_t cycle = 0; clock.now() - start < duration; ++cycle) {
    const double phase = 2 * std::numbers::pi * kSwingHz * seconds(clock.now() - start);
    std::array<host::JointTarget, KZ_JOINTS> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto index = static_cast<std::size_t>(j);
      targets[index] = {j, start_posture.angle[index] + kSwing * std::sin(phase)};
    }
    sent.push_back(clock.now());
    KAZ_TRY(robot.send_cycle(targets, kRamp));
    if (rate_hz > 0) {
      const Time next = start + from_seconds(static_cast<double>(cycle + 1) / rate_hz);
      while (clock.now() < next) {
        if (sent.empty()) {
          KAZ_TRY(clock.sleep_until(next));
          continue;
        }
        KAZ_TRY(receive(next));
      }
      if (sent.size() > kAhead) ++load.late;
    }
    while (sent.size() > kAhead || (rate_hz == 0 && sent.size() == kAhead)) {
      KAZ_TRY(receive(Time::max()));
    }
  }
  const double elapsed = seconds(clock.now() - start);
  const host::LinkStatistics after = robot.statistics();
  load.rate_hz = static_cast<double>(received) / elapsed;
  load.share_out =
      static_cast<double>(after.bytes_out - before.bytes_out) * seconds(byte_time) / elapsed;
  load.share_in =
      static_cast<double>(after.bytes_in - before.bytes_in) * seconds(byte_time) / elapsed;
  load.retries = after.retries - before.retries;
  while (!sent.empty()) {
    KAZ_TRY(receive(Time::max()));
  }
  return load;
}

}  // namespace kaz::lockstep
