// Driver of Feetech servos.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "host/bus/bus_exchange.h"
#include "shared/feetech/packet.h"

namespace kaz::host {

class FeetechDriver final : public BusDriver {
 public:
  FeetechDriver(Link& link, Clock& clock) : BusDriver(clock), exchange_(link, clock) {}

  Result<std::optional<Greeting>> greet(const Servo& servo) override;
  int position_mode() const override { return 0; }
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
    using Packet = feetech::Packet;
    using Reader = feetech::PacketReader;
    static std::vector<std::uint8_t> wire_of(const Packet& packet) {
      return feetech::wire_of(packet);
    }
    static bool answers(const Packet& packet, std::size_t parameters) {
      return packet.parameters.size() == parameters;
    }
    static bool is_to_all(const Packet& packet) { return packet.id == feetech::kBroadcast; }
  };
  BusExchange<Wire> exchange_;
};

}  // namespace kaz::host
