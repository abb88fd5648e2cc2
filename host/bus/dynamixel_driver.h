// Driver of DYNAMIXEL X-series servos, protocol 2.0.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "host/bus/bus_exchange.h"
#include "shared/dynamixel/packet.h"

namespace kaz::host {

class DynamixelDriver final : public BusDriver {
 public:
  DynamixelDriver(Link& link, Clock& clock) : BusDriver(clock), exchange_(link, clock) {}

  Result<std::optional<Greeting>> greet(const Servo& servo) override;
  int position_mode() const override { return 3; }
  Result<std::optional<int>> read(const Servo& servo, std::string_view name) override;
  Result<std::optional<std::vector<std::uint8_t>>> read_block(const Servo& servo,
                                                              std::string_view first,
                                                              std::size_t count) override;
  Result<bool> write(const Servo& servo, std::string_view name, int value) override;
  Result<void> write_all(Servos servos, std::string_view name, int value) override;
  Result<std::vector<std::optional<ServoState>>> read_all(Servos servos) override;
  Result<void> move(std::span<const Goal> goals) override;
  Result<std::vector<bool>> recover(std::span<const Goal> troubled) override;
  const Counts& counts() const override { return exchange_.counts(); }

 private:
  struct Wire {
    using Packet = dynamixel::Packet;
    using Reader = dynamixel::PacketReader;
    static std::vector<std::uint8_t> wire_of(const Packet& packet) {
      return dynamixel::wire_of(packet);
    }
    static bool answers(const Packet& packet, std::size_t parameters) {
      const bool failed = (packet.error & ~dynamixel::kAlert) != 0;
      return packet.is_status() && packet.parameters.size() == (failed ? 0 : parameters);
    }
    static bool is_to_all(const Packet& packet) {
      return packet.id == dynamixel::kBroadcast && !packet.is_status();
    }
  };
  using Exchange = BusExchange<Wire>;
  Result<Exchange::Answer> ping(const Servo& servo);
  Result<std::vector<Exchange::Answer>> read_blocks(Servos servos, std::string_view first,
                                                    std::size_t count);

  // Reads all servos with one packet, a fast sync read. Only newer firmware supports fast sync read. Returns
  // nullopt if the answer is incomplete.
  using Blocks = std::vector<Exchange::Answer>;
  Result<std::optional<Blocks>> read_fast(Servos servos, const std::vector<std::uint8_t>& sync_read,
                                          std::size_t count);

  Exchange exchange_;
  // The first complete answer to a fast sync read sets was_fast_ to true. If may_be_fast_ is false, the
  // driver does not use fast sync read. Two events set may_be_fast_ to false:
  // - The firmware of a servo is too old for fast sync read.
  // - Two fast sync reads got no answer, and was_fast_ is still false.
  bool may_be_fast_ = true, was_fast_ = false;
  int fast_silences_ = 0;
  Time circuit_due_{};  // time at which voltages and temperatures are read next
};

}  // namespace kaz::host
