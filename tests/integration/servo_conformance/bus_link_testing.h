// For tests: a virtual servo bus as link and clock in simulated time, which can modify requests and answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "sim/bus/virtual_bus.h"

namespace kaz::test {

// Waiting advances the bus. `bus` must outlive this object.
class BusLink final : public host::Link, public host::Clock {
 public:
  using Bytes = std::vector<std::uint8_t>;
  explicit BusLink(sim::VirtualBus& bus) : bus_(bus) {}
  // Modifies a request on its way to the servos. Returning no bytes drops it. May be null.
  std::function<Bytes(Bytes)> request;
  // Modifies the bytes of an answer. May be null.
  std::function<Bytes(Bytes)> answer;

  std::string name() const override { return "bus"; }
  Time byte_time() const override { return std::chrono::microseconds(10); }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    Bytes sent(bytes.begin(), bytes.end());
    if (request) sent = request(std::move(sent));
    bus_.advance(bus_.write(sent));
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    while (waiting_.empty() && bus_.time() < deadline) {
      bus_.advance(std::min(deadline, bus_.time() + std::chrono::milliseconds(1)));
      // Waits for the end of an answer.
      while (bus_.line().busy_until() > bus_.time()) bus_.advance(bus_.line().busy_until());
      Bytes come;
      for (; !bus_.received().empty(); bus_.received().pop_front())
        come.push_back(bus_.received().front().byte);
      waiting_ = answer && !come.empty() ? answer(std::move(come)) : std::move(come);
    }
    const std::size_t count = std::min(bytes.size(), waiting_.size());
    std::copy_n(waiting_.begin(), count, bytes.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  Time now() const override { return bus_.time(); }
  Result<void> sleep_until(Time t) override {
    bus_.advance(t);
    return {};
  }

 private:
  sim::VirtualBus& bus_;
  Bytes waiting_;
};

// Returns whether `wire` is a Feetech write or sync write that switches the torque off.
inline bool switches_off(const BusLink::Bytes& wire) {
  return wire.size() > 7 && wire[5] == 40 && (wire[4] == 0x83 ? wire[8] : wire[6]) == 0 &&
         (wire[4] == 3 || wire[4] == 0x83);
}

}  // namespace kaz::test
