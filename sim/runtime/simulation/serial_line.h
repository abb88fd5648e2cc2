// The wire between host and board: 8N1, each side at its own bit rate, 115,200 baud if not told.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "shared/faults/link_faults.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// The host's side of the line with its adapter: bytes queue there until the wire is free. Time in
// states.
class SerialLine {
 public:
  explicit SerialLine(std::uint64_t seed = 1)
      : fault_to_board_(seed, faults::Way::to_board), fault_to_host_(seed, faults::Way::to_host) {}
  // Its link faults happen to bytes that are written or sent from now on. Null: none. Must outlive the
  // line.
  void set_faults(const faults::Schedule* schedule) { schedule_ = schedule; }
  // The host's bit rate from now on; the board's is that of its bytes. Where they differ, each hears
  // what that makes of a byte.
  void set_host_bit(States bit) { host_bit_ = bit; }
  // Bytes that the host gives at `now`. The first starts then, or when the byte before it has left.
  void write(std::span<const std::uint8_t> bytes, States now);
  // The same with every byte damaged.
  void write_garbled(std::span<const std::uint8_t> bytes, States now);
  // Bytes written whose stop bit has not passed by `now`: full adapters make their writers wait.
  std::size_t waiting(States now) const;
  // Takes what arrives at the board until `until`, to be handed to it.
  std::vector<SerialByte> take_for_board(States until);

  // What the board sent, in order of time.
  void from_board(std::span<const SerialByte> bytes);
  // Moves bytes whose stop bit has passed by `now` into `bytes`; returns how many.
  std::size_t read(std::span<std::uint8_t> bytes, States now);
  bool readable(States now) const;
  // The host hung up: what it had not read is gone.
  void drop_unread() { to_host_.clear(); }

  // All that it remembers (archive.h).
  template <class A>
  void transfer(A& a) {
    a(fault_to_board_, fault_to_host_, to_board_, to_host_, wire_free_, host_bit_);
  }

 private:
  void queue(std::span<const std::uint8_t> bytes, States now, bool framing_error);

  void pass(faults::LinkFaults& link, const SerialByte& byte, std::deque<SerialByte>& to);

  const faults::Schedule* schedule_ = nullptr;
  faults::LinkFaults fault_to_board_, fault_to_host_;
  std::deque<SerialByte> to_board_, to_host_;
  States wire_free_ = 0;
  States host_bit_ = KZ_STATES_PER_BIT;
};

}  // namespace kaz::sim
