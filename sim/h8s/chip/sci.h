// A serial channel (SCI0, SCI1): asynchronous transmission and reception byte by byte.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "sim/h8s/chip.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Sci {
 public:
  // `offset` 0..6: SMR, BRR, SCR, TDR, SSR, RDR, SCMR.
  std::uint8_t read(Machine& m, unsigned n, unsigned offset, States at);
  void write(Machine& m, unsigned n, unsigned offset, std::uint8_t value, States at);
  std::uint8_t peek(unsigned offset) const;
  // Reset or module stop; what is on the wire stays there.
  void reset(Machine& m, unsigned n, States at);

  States next_event() const;
  void advance(Machine& m, unsigned n, States to);
  std::deque<ReceivedByte>& incoming() { return incoming_; }

  bool drives_txd() const { return (scr_ & 0x20) != 0; }
  // Level of TxD while drives_txd().
  bool txd(States at) const;
  // First state after `at` at which txd() may differ, as far as the byte in the shift register goes.
  States next_change(States at) const;
  States bit_states() const;
  bool waits_for_input() const { return (scr_ & 0x50) == 0x50; }

 private:
  bool synchronous() const { return (smr_ & 0x80) != 0; }
  int data_bits() const { return (smr_ & 0x40) && !synchronous() ? 7 : 8; }
  int frame_bits() const;
  std::uint8_t on_wire(std::uint8_t byte) const;  // SCMR's order and inversion; its own inverse
  void load(Machine& m, unsigned n, States at);
  void end_of_frame(Machine& m, unsigned n, States at);
  void take(Machine& m, unsigned n, const ReceivedByte& byte);
  void enable(Machine& m, unsigned n, std::uint8_t value, States at);
  void update(Machine& m, unsigned n, States at);

  std::uint8_t smr_ = 0, brr_ = 0xff, scr_ = 0, tdr_ = 0xff, rdr_ = 0, scmr_ = 0xf2;
  StickyFlags flags_ = empty();  // TDRE RDRF ORER FER PER in bits 7..3
  bool tend_ = true, mpbt_ = false;
  bool shifting_ = false, preamble_ = false;
  std::uint8_t tsr_ = 0;
  States start_ = 0, end_ = kNever;
  std::deque<ReceivedByte> incoming_;

  static StickyFlags empty() {
    StickyFlags f;
    f.raise(0x80);
    return f;
  }
};

}  // namespace kaz::h8s
