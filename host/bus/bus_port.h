// A port with a servo bus, presented as a link to a virtual servo board (bus_board.h).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/bus/bus_board.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"

namespace kaz::host {

class BusPort final : public PortLink {
 public:
  // `port` must have the bit rate of the bus. Returns the errors of BusBoard::open(). `interrupt` may be
  // null; else it must outlive the port.
  static Result<std::unique_ptr<BusPort>> open(std::unique_ptr<PortLink> port,
                                               std::vector<BusJoint> joints,
                                               const Interrupt* interrupt);

  std::string name() const override { return port_->name(); }
  // Frames of the virtual board are exchanged in memory; only the communication with the servos takes time.
  Time byte_time() const override { return Time{1}; }
  // Queues requests. A request that switches all motors off is executed at once.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // Executes queued requests by communication with the servos.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reopen() override;
  Result<void> set_dtr_rts(bool dtr, bool rts) override { return port_->set_dtr_rts(dtr, rts); }
  LowLatency low_latency() const override { return port_->low_latency(); }
  int descriptor() const override { return port_->descriptor(); }
  bool has_unsent() const override { return !answer_.empty() || port_->has_unsent(); }
  std::string still_on() const override { return board_->still_on(); }
  // Returns statistics of the bus, such as "2 of 4100 requests without an answer, 1 answer damaged".
  std::string counts() const override;

 private:
  BusPort(std::unique_ptr<PortLink> port, const Interrupt* interrupt)
      : port_(std::move(port)), clock_(interrupt) {}

  std::unique_ptr<PortLink> port_;
  WallClock clock_;
  std::unique_ptr<BusBoard> board_;
  std::vector<std::uint8_t> answer_;  // bytes that read() has not returned yet
};

}  // namespace kaz::host
