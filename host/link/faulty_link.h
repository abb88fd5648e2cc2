// A link that injects line faults (docs/reference/simulator.md) on simulated and real ports.
// SPDX-License-Identifier: Apache-2.0
//
// Supports only faults of the line. This class cannot inject framing errors. So an error of the bit rate
// changes only the values of the bytes. Only write() and read() send delayed bytes to the board. If a delay
// ends while neither function runs, the byte waits for the next call of write() or read(). Start times of
// faults count from the construction of the FaultyLink.
#pragma once

#include <deque>

#include "host/link/link.h"
#include "shared/faults/link_faults.h"

namespace kaz::host {

class FaultyLink final : public Link {
 public:
  // `link` and `clock` must outlive this object.
  FaultyLink(Link& link, Clock& clock, faults::Schedule schedule, std::uint64_t seed);

  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override { return link_.set_baud(baud); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

  Result<void> reopen() override {
    for_board_.clear();
    for_host_.clear();
    return link_.reopen();
  }

  // Adds a fault. The fault starts when age() reaches the start time of the fault.
  void add(const faults::Fault& fault) { schedule_.add(fault); }
  const faults::Schedule& schedule() const { return schedule_; }
  // Time since construction.
  Time age() const { return clock_.now() - start_; }

 private:
  struct Late {
    Time due;
    std::uint8_t value;
  };

  void pass(faults::LinkFaults& faults, std::uint8_t value, std::deque<Late>& to);
  Result<void> flush();
  std::size_t take(std::span<std::uint8_t> bytes);

  Link& link_;
  Clock& clock_;
  faults::Schedule schedule_;
  Time start_;
  faults::LinkFaults to_board_, to_host_;
  std::deque<Late> for_board_, for_host_;
};

}  // namespace kaz::host
