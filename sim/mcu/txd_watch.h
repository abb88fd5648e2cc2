// Observes the edges at the pin TxD0 of the emulated chip and decodes the bytes that the chip sends.
// SPDX-License-Identifier: Apache-2.0
//
// The edges are the same as in a recording of the pin (vcd.h). While the pin is not driven, the board's
// pull-up holds the line at mark.
#pragma once

#include <vector>

#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/uart_decoder.h"

namespace kaz::sim {

class TxdWatch {
 public:
  // `mcu` must outlive this object.
  explicit TxdWatch(H8Mcu& mcu);
  ~TxdWatch();
  TxdWatch(const TxdWatch&) = delete;
  TxdWatch& operator=(const TxdWatch&) = delete;

  // Removes and returns the bytes whose stop bit was sampled at least one bit time ago. The times of the
  // bytes are board times.
  std::vector<DecodedByte> take();
  // Drops a partly received byte. Must be called after a reset or power cut of the chip.
  void restart();

 private:
  H8Mcu& mcu_;
  int watch_ = 0;
  UartDecoder decoder_;
};

}  // namespace kaz::sim
