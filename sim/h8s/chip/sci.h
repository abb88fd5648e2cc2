// Serial channel (SCI0, SCI1), simulated bit by bit at its pins TxD, RxD and SCK.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// One frame on the line. Bit k of `bits` is the level in the k-th bit time.
struct SerialFrame {
  std::uint16_t bits = 0;
  int count = 0;
  bool at(States k) const { return k >= count || (bits >> k & 1) != 0; }
  template <class A>
  void transfer(A& a) {
    a(bits, count);
    a.require(count >= 0 && count <= 16, "frame");
  }
};

// Serial channel. In all functions, `n` is the number of the channel, 0 or 1.
class Sci {
 public:
  // Registers of a channel, as offsets from SMR.
  enum Register : unsigned { kSmr, kBrr, kScr, kTdr, kSsr, kRdr, kScmr };
  static constexpr std::uint8_t kErrors = SSR::ORER | SSR::FER | SSR::PER;

  // Register accesses. `offset` is a value of Register.
  std::uint8_t read(Machine& m, unsigned n, unsigned offset, States at);
  // Like read(). Precondition: no event is due.
  std::uint8_t read_now(unsigned offset) {
    if (offset == kSsr) flags_.read();
    return peek(offset);
  }
  void write(Machine& m, unsigned n, unsigned offset, std::uint8_t value, States at);
  std::uint8_t peek(unsigned offset) const;
  // Resets the channel, but keeps the bytes of incoming(): these bytes arrive after the reset.
  void reset(Machine& m, unsigned n, States at);

  States next_event() const {
    const States in = incoming_.empty() ? kNever : incoming_.front().at;
    return std::min(std::min(end_, in), std::min(sample_, arrives_));
  }
  void advance(Machine& m, unsigned n, States to) {
    if (next_event() <= to) run_events(m, n, to);
  }
  // Bytes that will arrive at RxD, in order of time.
  std::deque<ReceivedByte>& incoming() { return incoming_; }

  // --- pins --------------------------------------------------------------------------------------
  bool drives_txd() const { return (scr_ & SCR::TE) != 0; }
  // Returns the level of TxD. Precondition: drives_txd() is true. `at` must not be before the start of the
  // current frame.
  bool txd(States at) const;
  // Returns the time of the first change of TxD after the time `after`. Returns kNever if the time of this
  // change is not yet known.
  States txd_change(States after) const;
  // Returns whether SCK is an output. In clocked mode, SCK is an output if the channel uses its internal
  // clock. In asynchronous mode, SCK is an output if CKE is 01; the channel then outputs the bit clock.
  bool drives_sck() const {
    return synchronous() ? !(scr_ & SCR::CKE1) : (scr_ & SCR::CKE) == SCR::CKE0;
  }
  bool sck(States at) const;
  States sck_change(States after) const;
  // SCR.RE makes the RxD pin an input, regardless of the pin's DDR bit.
  bool takes_rxd() const { return (scr_ & SCR::RE) != 0; }
  bool takes_sck() const { return (scr_ & SCR::CKE1) != 0; }
  // Must be called after the board has changed the level of RxD or SCK. `driven` is false if the board has
  // stopped driving RxD. While the board does not drive RxD, the channel receives only the bytes of
  // incoming().
  void rxd_edge(Machine& m, unsigned n, bool level, bool driven, States at);
  void sck_edge(Machine& m, unsigned n, bool rising, States at);

  States bit_states() const;
  bool waits_for_input() const { return (scr_ & SCR::RIE) && (scr_ & SCR::RE); }

  // After the DTC has read RDR, taken_by_dtc() must be called. After the DTC has written TDR, filled_by_dtc()
  // must be called. If the DTC passes the interrupt on to the CPU, taken_by_dtc() and filled_by_dtc() must
  // not be called.
  void taken_by_dtc(Machine& m, unsigned n, States at);
  void filled_by_dtc(Machine& m, unsigned n, States at);

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(smr_, brr_, scr_, tdr_, rdr_, scmr_, flags_, tend_, mpbt_, mpb_, clock_base_, sending_, tsr_,
      frame_, before_, start_, bit_, end_, ticks_, incoming_, rxd_, rxd_driven_, receiving_,
      received_, rsr_, edge_, sample_, sample_ticks_, arrived_, arrives_, burst_);
    a.require(bit_ >= 0 && (sending_ != Sending::frame || frame_.count > 0), "bit to send");
    // A frame has at most 12 bits, and each bit lasts at most 16 clocks.
    a.require(received_ >= 0 && received_ <= 12 && sample_ticks_ >= 0 && sample_ticks_ <= 16,
              "received bits");
  }

 private:
  static constexpr std::uint8_t kSevenBits = 0x7f;
  enum class Sending : std::uint8_t { nothing, preamble, waiting, frame };
  friend constexpr Sending last_value(Sending) { return Sending::frame; }

  bool synchronous() const { return (smr_ & SMR::CA) != 0; }
  bool outside_clock() const { return (scr_ & SCR::CKE1) != 0; }
  int data_bits() const { return (smr_ & SMR::CHR) && !synchronous() ? 7 : 8; }
  bool multiprocessor() const { return (smr_ & SMR::MP) != 0 && !synchronous(); }
  bool parity() const { return (smr_ & SMR::PE) != 0 && !(smr_ & SMR::MP) && !synchronous(); }
  int stop_bits() const { return smr_ & SMR::STOP ? 2 : 1; }
  int frame_bits() const;
  // Applies the bit order and inversion of SCMR. The function is its own inverse.
  std::uint8_t on_wire(std::uint8_t byte) const;
  bool parity_of(std::uint8_t wire) const;
  SerialFrame frame_of(std::uint8_t wire) const;

  // --- sending (sci_transmit.cpp)
  void begin(Machine& m, unsigned n, States at);
  void load(Machine& m, unsigned n, States at);
  void send_event(Machine& m, unsigned n, States at);
  void end_of_frame(Machine& m, unsigned n, States at);
  void send_tick(Machine& m, unsigned n, States at);
  void stop_sending();
  bool clock_runs() const;

  // --- receiving (sci_receive.cpp)
  void take(Machine& m, unsigned n, const ReceivedByte& byte);
  void start_bit(States edge);
  void sample(Machine& m, States at);
  void sample_clocked(Machine& m, unsigned n, States at);
  void begin_clocked(States at);
  void judge(Machine& m, States end);
  void stop_receiving();
  void start_reception_clock(States at);

  void run_events(Machine& m, unsigned n, States to);
  void enable(Machine& m, unsigned n, std::uint8_t value, States at);
  void update(Machine& m, unsigned n, States at);

  std::uint8_t smr_ = 0, brr_ = 0xff, scr_ = 0, tdr_ = 0xff, rdr_ = 0, scmr_ = SCMR::ONE;
  StickyFlags flags_ = empty();  // TDRE, RDRF, ORER, FER, PER in bits 7..3
  bool tend_ = true, mpbt_ = false, mpb_ = false;

  States clock_base_ = 0;  // time of an edge of the bit clock
  Sending sending_ = Sending::nothing;
  std::uint8_t tsr_ = 0;
  SerialFrame frame_;
  bool before_ = true;      // level of TxD before the frame
  States start_ = 0;        // start of the frame
  States bit_ = 32;         // bit time of the frame; 0: external clock
  States end_ = kNever;     // time of the transmitter's next step
  std::int64_t ticks_ = 0;  // number of external clock pulses since the frame began

  std::deque<ReceivedByte> incoming_;
  bool rxd_ = true, rxd_driven_ = false;
  bool receiving_ = false;
  int received_ = 0;  // number of received bits of the current frame
  std::uint16_t rsr_ = 0;
  States edge_ = 0;         // time of the start bit's edge
  States sample_ = kNever;  // time of the next sample of RxD
  int sample_ticks_ = 0;    // number of external clock pulses to the next sample
  ReceivedByte arrived_;    // byte that the channel has sampled but not yet delivered
  States arrives_ = kNever;
  // Clocked mode with the internal clock: while only the receiver is on, the channel generates eight clock
  // pulses for each byte. `burst_` is the start time of the eight pulses in progress. If no pulses are in
  // progress, `burst_` is kNever.
  States burst_ = kNever;

  static StickyFlags empty() {
    StickyFlags f;
    f.raise(SSR::TDRE);
    return f;
  }
};

}  // namespace kaz::h8s
