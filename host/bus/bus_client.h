// Requests to servos on a bus of Feetech's, and their answers.
// SPDX-License-Identifier: Apache-2.0
//
// One request is under way at a time: the line is half-duplex. An answer that does not come, or comes
// damaged, is requested once more; then it is missing, and counted. Errors are the port's alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host/link/link.h"
#include "shared/feetech/bus_file.h"
#include "shared/feetech/packet.h"

namespace kaz::host {

class BusClient {
 public:
  // Longer than an adapter without low latency keeps an answer.
  static constexpr Time kAnswerWithin = std::chrono::milliseconds(30);

  // Both must outlive it.
  BusClient(Link& link, Clock& clock) : link_(link), clock_(clock) {}

  using Answer = std::optional<feetech::Packet>;
  using Servos = std::span<const feetech::BusServo* const>;

  Result<bool> ping(const feetech::BusServo& servo);
  // Values are those of the model's register of this name, which must exist.
  Result<std::optional<int>> read(const feetech::BusServo& servo, std::string_view name);
  // False: not acknowledged.
  Result<bool> write(const feetech::BusServo& servo, std::string_view name, int value);
  // `count` bytes from `address` on of each servo, in their order.
  Result<std::vector<Answer>> read_all(Servos servos, std::uint8_t address, std::uint8_t count);
  // The same address and count for all; nobody answers. `data` by servo.
  Result<void> write_all(Servos servos, std::uint8_t address,
                         std::span<const std::vector<std::uint8_t>> data);

  struct Counts {
    std::uint64_t requests = 0, missing = 0, damaged = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  Result<void> send(const feetech::Packet& request);
  Result<Answer> receive(std::uint8_t id, std::size_t parameters, const feetech::Packet& request);
  Result<Answer> query(const feetech::Packet& request, std::size_t parameters);

  Link& link_;
  Clock& clock_;
  feetech::PacketReader reader_;
  std::vector<std::uint8_t> come_;  // not read into packets yet
  Counts counts_;
};

}  // namespace kaz::host
