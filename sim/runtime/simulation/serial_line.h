// The serial line between host and board. The format is 8N1. Host and board each have their own bit rate, by
// default 115,200 baud.
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

// The serial line and the host's adapter. Bytes wait in the adapter until the line is free. Times are in
// states (periods of the board's crystal).
class SerialLine {
 public:
  explicit SerialLine(std::uint64_t seed = 1)
      : fault_to_board_(seed, faults::Way::to_board), fault_to_host_(seed, faults::Way::to_host) {}
  // Restarts the random numbers of the link faults with another seed.
  void reseed(std::uint64_t seed) {
    fault_to_board_ = faults::LinkFaults(seed, faults::Way::to_board);
    fault_to_host_ = faults::LinkFaults(seed, faults::Way::to_host);
  }
  // Sets the faults of the line. The faults affect only bytes that are written or sent after this call. If
  // `schedule` is null, the line has no faults. `schedule` must outlive the line.
  void set_faults(const faults::Schedule* schedule) { schedule_ = schedule; }
  // Sets the host's bit time from now on. The board's bit time is part of each SerialByte from the board. If
  // the two bit times differ, the receiver samples the waveform at the receiver's own rate.
  void set_host_bit(States bit) { host_bit_ = bit; }
  // Queues bytes that the host writes at `now`. If the line is free, the first byte starts at `now`. If the
  // line is busy with earlier bytes, the first byte starts after the last of the earlier bytes.
  void write(std::span<const std::uint8_t> bytes, States now);
  // Like write(), but with a framing error in every byte.
  void write_garbled(std::span<const std::uint8_t> bytes, States now);
  // Returns the number of written bytes whose stop bit has not ended by `now`. With this number, callers can
  // model an adapter that blocks the writer while the adapter's buffer is full.
  std::size_t waiting(States now) const;
  // Removes and returns the bytes that arrive at the board by `until`.
  std::vector<SerialByte> take_for_board(States until);

  // Queues bytes that the board has sent. `bytes` must be sorted by time.
  void from_board(std::span<const SerialByte> bytes);
  // Moves the bytes whose stop bit has ended by `now` into `bytes`. Returns the number of moved bytes.
  std::size_t read(std::span<std::uint8_t> bytes, States now);
  bool readable(States now) const;
  // Discards bytes that the host has not read. Call this function when the host closes the port.
  void drop_unread() { to_host_.clear(); }

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(fault_to_board_, fault_to_host_, to_board_, to_host_, wire_free_, host_bit_);
    a.require(host_bit_ > 0 && host_bit_ <= KZ_CLOCK_HZ, "bit time");
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
