// Non-volatile memory of the native engine's board: calibration and address, in flash of its own.
// SPDX-License-Identifier: Apache-2.0
//
// The logs are those of shared/servo/store.h, as in the firmware (firmware/memory.c). Writing takes
// pulse after pulse as on the chip. If power is lost during a pulse, only a fraction of its cells has
// changed, in proportion to the time elapsed, selected by a seed.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>

#include "shared/servo/servo.h"
#include "shared/servo/store.h"
#include "sim/mcu/mcu.h"
#include "sim/mcu/native_state.h"

namespace kaz::sim {

class NativeMemory {
 public:
  NativeMemory() { bytes_.fill(0xFF); }

  // Copies the contents of the logs to `startup`; values that are not in them are unchanged.
  void load(kz_startup& startup);
  void report(kz_tick_input& input) const;

  // Plans a store that begins at `from`. Motors are off.
  void store_calibration(const kz_servo& servo, States from);
  void store_address(const kz_servo& servo, States from);
  // Time from which the line is not served.
  States deaf_from() const { return deaf_from_; }
  // Time at which the write ends, if power lasts.
  States over_at() const { return over_at_; }
  // Duration of the firmware's verification of the write and the log around it.
  States read_back_states() const { return read_back_; }
  // Lines of both logs that are not blank.
  int lines() const;
  // Verification: whether the stored values can be read back. Reads both logs again.
  bool finish();
  // Power loss or reset aborts a write in progress.
  void cut(States at);

  // Blocks EB1 to EB3, as memory of the board (mcu.h).
  std::span<const std::uint8_t, Mcu::memory_size> bytes() const { return bytes_; }
  void set_bytes(std::span<const std::uint8_t, Mcu::memory_size> bytes);

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(bytes_, pulses_, deaf_from_, over_at_, read_back_, wanted_, pulses_done_);
    a.plain(calibration_);
    a.plain(address_);
    a.require(is_possible(calibration_, KZ_CALIBRATION_BLOCKS, KZ_CALIBRATION_PARTS) &&
                  is_possible(address_, KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS),
              "log in flash");
  }

 private:
  struct Pulse {
    States start, end;
    int block;  // 0..2
    int line;   // -1: erases the block
    std::array<u8, KZ_STORE_LINE> data;
    template <class A>
    void transfer(A& a) {
      a(start, end, block, line, data);
      a.require(start < end && block >= 0 && block < KZ_CALIBRATION_BLOCKS + KZ_ADDRESS_BLOCKS &&
                    line >= -1 && line < KZ_STORE_LINES,
                "write to flash");
    }
  };

  std::array<const u8*, 2> calibration_images() const;
  std::array<const u8*, 1> address_image() const;
  void scan();
  int lines_of(int first_block, int blocks,
               const std::array<std::uint8_t, Mcu::memory_size>& of) const;
  void plan(const kz_store& log, int first_block, States from,
            const std::function<void(u8* data, u8 part)>& pack);
  // Changes the cells of a pulse of `share` (0..1) of its full length.
  void apply(const Pulse& pulse, double share);
  void advance(States to);

  std::array<std::uint8_t, Mcu::memory_size> bytes_;
  kz_store calibration_{}, address_{};
  std::deque<Pulse> pulses_;
  States deaf_from_ = 0, over_at_ = 0, read_back_ = 0;
  std::array<std::uint8_t, Mcu::memory_size> wanted_{};  // contents of flash after the write
  std::uint64_t pulses_done_ = 0;
};

}  // namespace kaz::sim
