// Non-volatile memory of the native engine: flash blocks with a calibration log and an address log.
// SPDX-License-Identifier: Apache-2.0
//
// Both logs have the format of shared/servo/store.h, as in the firmware (firmware/memory.c). A write applies
// one pulse after the other, as on the chip. If power is lost during a pulse, only a fraction of the pulse's
// cells changes, in proportion to the elapsed time. Random numbers with a fixed seed select these cells.
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

  // Copies the logs' contents to `startup`. Values that are not in the logs stay unchanged.
  void load(kz_startup& startup);
  // Copies the sequence number of the calibration log, and the erase counts of the log's two blocks, to
  // `input`.
  void report(kz_tick_input& input) const;

  // Schedules a write to flash. The write begins at the time `from`. The motors must be off.
  void store_calibration(const kz_servo& servo, States from);
  void store_address(const kz_servo& servo, States from);
  // Returns the time at which the board stops serving the serial line because of the write.
  States deaf_from() const { return deaf_from_; }
  // Returns the planned end of the write. cut() can abort the write before that time.
  States over_at() const { return over_at_; }
  // Returns the time that the firmware needs to verify the write and to read the log.
  States read_back_states() const { return read_back_; }
  // Returns how many lines of the two logs are not blank.
  int lines() const;
  // Completes the write and reads both logs again. Returns whether flash has the intended contents.
  bool finish();
  // Must be called if the board loses power or is reset at the time `at`. Aborts a write that is in progress
  // at the time `at`.
  void cut(States at);

  // Returns the blocks EB1 to EB3, like Mcu::memory().
  std::span<const std::uint8_t, Mcu::kMemorySize> bytes() const { return bytes_; }
  void set_bytes(std::span<const std::uint8_t, Mcu::kMemorySize> bytes);

  // Serializes the complete state (archive.hpp).
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
    int line;   // flash line that the pulse programs; -1: the pulse erases the block
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
               const std::array<std::uint8_t, Mcu::kMemorySize>& of) const;
  void plan(const kz_store& log, int first_block, States from,
            const std::function<void(u8* data, u8 part)>& pack);
  // Applies a pulse. `share` (0..1) is the length of the pulse as a fraction of the full length.
  void apply(const Pulse& pulse, double share);
  void advance(States to);

  std::array<std::uint8_t, Mcu::kMemorySize> bytes_;
  kz_store calibration_{}, address_{};
  std::deque<Pulse> pulses_;
  States deaf_from_ = 0, over_at_ = 0, read_back_ = 0;
  std::array<std::uint8_t, Mcu::kMemorySize> wanted_{};  // intended flash contents
  std::uint64_t pulses_done_ = 0;
};

}  // namespace kaz::sim
