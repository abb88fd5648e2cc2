// Bytes sent at TxD0 of the emulated chip, decoded from the edges at the pin.
// SPDX-License-Identifier: Apache-2.0
//
// The edges are those that a recording of the pin (vcd.h) has. While the pin is not driven the board's
// pull-up holds the line at mark.
#pragma once

#include <vector>

#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/uart_decoder.h"

namespace kaz::sim {

class TxdWatch {
 public:
  // `mcu` outlives this.
  explicit TxdWatch(H8Mcu& mcu);
  ~TxdWatch();
  TxdWatch(const TxdWatch&) = delete;
  TxdWatch& operator=(const TxdWatch&) = delete;

  // Bytes whose stop bit was sampled a bit's time ago or earlier, with times of the board.
  std::vector<DecodedByte> take();
  // The chip was reset or its power cut: a byte in progress is dropped.
  void restart();

 private:
  H8Mcu& mcu_;
  int watch_ = 0;
  UartDecoder decoder_;
};

}  // namespace kaz::sim
