// Non-volatile memory of the native engine's board.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/native_memory.h"

#include <algorithm>

#include "shared/base/random.hpp"

namespace kaz::sim {
namespace {

constexpr int kAddressBlock = 2;  // after the two of the calibration
constexpr std::uint64_t kSeed = 1;

// Durations in the firmware (firmware/flash_ram.c); they need not be exact to the state.
constexpr States microseconds(double us) {
  return static_cast<States>(us * KZ_CLOCK_HZ / 1e6);
}
constexpr States kEraseSetup = microseconds(210), kErasePulse = microseconds(5200),
                 kEraseVerify = microseconds(1900);
constexpr States kProgramSetup = microseconds(210), kProgramPulse = microseconds(180),
                 kProgramVerify = microseconds(178);
// Before the line is left alone; then the routine is copied to RAM; in the end it is overwritten, and
// the log is read.
constexpr States kPrepareCalibration = 732, kPrepareAddress = 280, kCopyRoutine = 1960,
                 kClearRoutine = 1957;
constexpr States kReadCalibration = 27950, kReadAddress = 14730, kReadLine = 681;
// Pulse lengths: the one that changes every cell, and the longest that changes none.
constexpr double kEraseMin = 5000.0 / 5200.0, kProgramMin = 150.0 / 180.0;
constexpr double kNothingBelow = 0.125;

}  // namespace

std::array<const u8*, 2> NativeMemory::calibration_images() const {
  return {bytes_.data(), bytes_.data() + KZ_STORE_BLOCK};
}

std::array<const u8*, 1> NativeMemory::address_image() const {
  return {bytes_.data() + kAddressBlock * KZ_STORE_BLOCK};
}

void NativeMemory::scan() {
  kz_store_scan(&calibration_, calibration_images().data(), KZ_CALIBRATION_BLOCKS,
                KZ_CALIBRATION_PARTS);
  kz_store_scan(&address_, address_image().data(), KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS);
}

int NativeMemory::lines_of(int first_block, int blocks,
                           const std::array<std::uint8_t, Mcu::kMemorySize>& of) const {
  int lines = 0;
  for (int at = first_block * KZ_STORE_BLOCK; at < (first_block + blocks) * KZ_STORE_BLOCK;
       at += KZ_STORE_LINE) {
    const auto* line = of.data() + at;
    if (std::any_of(line, line + KZ_STORE_LINE, [](std::uint8_t byte) { return byte != 0xFF; }))
      ++lines;
  }
  return lines;
}

int NativeMemory::lines() const {
  return lines_of(0, KZ_CALIBRATION_BLOCKS + KZ_ADDRESS_BLOCKS, bytes_);
}

void NativeMemory::load(kz_startup& startup) {
  scan();
  kz_store_load_calibration(&calibration_, calibration_images().data(), &startup);
  kz_store_load_address(&address_, address_image().data(), &startup);
}

void NativeMemory::report(kz_tick_input& input) const {
  input.calibration_sequence = calibration_.sequence;
  input.erases_a = calibration_.erases[0];
  input.erases_b = calibration_.erases[1];
}

void NativeMemory::plan(const kz_store& log, int first_block, States from,
                        const std::function<void(u8* data, u8 part)>& pack) {
  kz_store_plan next;
  kz_store_plan_next(&log, &next);
  const int block = first_block + next.block;
  wanted_ = bytes_;
  const bool calibration = first_block != kAddressBlock;
  deaf_from_ = from + (calibration ? kPrepareCalibration : kPrepareAddress);
  States at = deaf_from_ + kCopyRoutine;
  if (next.erase) {
    at += kEraseSetup;
    pulses_.push_back({at, at + kErasePulse, block, -1, {}});
    at += kErasePulse + kEraseVerify;
    std::fill_n(wanted_.begin() + block * KZ_STORE_BLOCK, KZ_STORE_BLOCK, std::uint8_t{0xFF});
  }
  for (u8 part = 0; part < log.parts; ++part) {
    u8 data[KZ_STORE_DATA];
    Pulse pulse{
        at + kProgramSetup, at + kProgramSetup + kProgramPulse, block, next.line + part, {}};
    pack(data, part);
    kz_store_encode(pulse.data.data(), &log, &next, part, data);
    std::copy(pulse.data.begin(), pulse.data.end(),
              wanted_.begin() + block * KZ_STORE_BLOCK + pulse.line * KZ_STORE_LINE);
    at = pulse.end + kProgramVerify;
    pulses_.push_back(pulse);
  }
  over_at_ = at + kClearRoutine;
  read_back_ =
      (calibration ? kReadCalibration : kReadAddress) +
      kReadLine *
          lines_of(first_block, calibration ? KZ_CALIBRATION_BLOCKS : KZ_ADDRESS_BLOCKS, wanted_);
}

void NativeMemory::store_calibration(const kz_servo& servo, States from) {
  std::array<s16, KZ_JOINTS> centre{}, scale{};
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    centre[i] = servo.joint[i].pot_centre;
    scale[i] = servo.joint[i].pot_scale;
  }
  plan(calibration_, 0, from, [&](u8* data, u8 part) {
    kz_store_pack_calibration(data, part, centre.data(), scale.data());
  });
}

void NativeMemory::store_address(const kz_servo& servo, States from) {
  plan(address_, kAddressBlock, from, [&](u8* data, u8) {
    kz_store_pack_address(data, servo.new_address, servo.new_shared_line);
  });
}

void NativeMemory::apply(const Pulse& pulse, double share) {
  ++pulses_done_;
  share /= pulse.line < 0 ? kEraseMin : kProgramMin;
  if (share < kNothingBelow) return;
  const bool erases = pulse.line < 0;
  const int first = pulse.block * KZ_STORE_BLOCK + (erases ? 0 : pulse.line * KZ_STORE_LINE);
  const int count = erases ? KZ_STORE_BLOCK : KZ_STORE_LINE;
  for (int i = 0; i < count; ++i) {
    std::uint8_t& cell = bytes_[static_cast<std::size_t>(first + i)];
    const std::uint8_t target =
        erases ? 0xFF : static_cast<std::uint8_t>(cell & pulse.data[static_cast<std::size_t>(i)]);
    unsigned moves = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      const auto place = static_cast<std::uint64_t>(first + i) * 8 + bit;
      Random random(mix64(kSeed ^ mix64(place) ^ pulses_done_ << 40));
      if (share >= 1 || random.chance(share)) moves |= 1u << bit;
    }
    cell = static_cast<std::uint8_t>(cell ^ ((cell ^ target) & moves));
  }
}

void NativeMemory::advance(States to) {
  while (!pulses_.empty() && pulses_.front().end <= to) {
    apply(pulses_.front(), 1);
    pulses_.pop_front();
  }
}

bool NativeMemory::finish() {
  advance(over_at_);
  scan();
  return bytes_ == wanted_;
}

void NativeMemory::cut(States at) {
  advance(at);
  if (!pulses_.empty() && pulses_.front().start < at) {
    const Pulse& pulse = pulses_.front();
    apply(pulse,
          static_cast<double>(at - pulse.start) / static_cast<double>(pulse.end - pulse.start));
  }
  pulses_.clear();
  over_at_ = 0;
}

void NativeMemory::set_bytes(std::span<const std::uint8_t, Mcu::kMemorySize> bytes) {
  std::copy(bytes.begin(), bytes.end(), bytes_.begin());
}

}  // namespace kaz::sim
