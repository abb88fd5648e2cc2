// The bench: steps of an eighth of a millisecond.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/flash_bench_testing.h"

#include <algorithm>

#include "host/link/requester.h"
#include "host/robot/connect.h"
#include "shared/flash/image.h"
#include "sim/runtime/time.h"

namespace kaz::lockstep {
namespace {

constexpr sim::States kStep = KZ_STATES_PER_TICK / 8;

}  // namespace

FlashBench::FlashBench(const std::string& image, const h8s::Options& options, std::uint64_t seed)
    : line_(seed) {
  if (image.empty()) {
    mcu_ = sim::H8Mcu::erased(options);
  } else if (auto loaded = sim::H8Mcu::load(image, options)) {
    mcu_ = std::move(*loaded);
  } else {
    std::abort();  // the caller's own image
  }
  mcu_->on_hang([](const std::string&) {});
  mcu_->set_analog([](int channel, const sim::PinLevels& levels, sim::States) {
    const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
    if (input == KZ_ANALOG_SUPPLY) return 10'000.0 / KZ_SUPPLY_FULL_MV;
    return 0.5;
  });
}

void FlashBench::set_latency(Time latency) {
  latency_ = sim::states_of(latency);
}

Time FlashBench::now() const {
  return sim::time_of(now_);
}

Error FlashBench::unplugged() const {
  return {Fault::environment, "the port `bench` was closed, because the board was unplugged"};
}

Result<void> FlashBench::step() {
  now_ += kStep;
  const bool powered = !cut_at_ || now() < *cut_at_ || now() >= *cut_at_ + cut_length_;
  if (powered && !power_) mcu_->power_cycle();
  power_ = powered;
  const auto arrived = line_.take_for_board(now_ - latency_);
  if (!power_) {
    off_ += kStep;
    mcu_->take_transmitted();
    return {};
  }
  for (sim::SerialByte byte : arrived) {
    byte.at = std::max(byte.at + latency_ - off_, mcu_->now());
    mcu_->receive(byte);
  }
  if (auto ran = mcu_->run_until(now_ - off_); !ran) return ran;
  auto sent = mcu_->take_transmitted();
  for (sim::SerialByte& byte : sent) byte.at += off_;
  line_.from_board(sent);
  if (on_application_) watch();
  return {};
}

void FlashBench::watch() {
  const std::uint32_t pc = chip().registers().pc;
  const bool was = in_application_;
  in_application_ =
      !chip().in_boot_rom() && pc >= KZ_APPLICATION && pc < KZ_APPLICATION + KZ_APPLICATION_MAX;
  if (in_application_ && !was) on_application_();
}

Result<void> FlashBench::sleep_until(Time t) {
  while (now() < t) {
    if (auto stepped = step(); !stepped) return stepped;
  }
  return {};
}

Result<void> FlashBench::set_baud(int baud) {
  line_.set_host_bit(KZ_CLOCK_HZ / baud);
  return {};
}

Result<void> FlashBench::write(std::span<const std::uint8_t> bytes) {
  if (unplug_at_ && now() >= *unplug_at_) return tl::unexpected(unplugged());
  line_.write(bytes, now_);
  return {};
}

Result<std::size_t> FlashBench::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (true) {
    if (unplug_at_ && now() >= *unplug_at_) return tl::unexpected(unplugged());
    const std::size_t count = line_.read(bytes, now_ - latency_);
    if (count > 0 || now() >= deadline) return count;
    KAZ_TRY(step());
  }
}

Result<void> FlashBench::reset(bool boot) {
  if (auto set = mcu_->set_boot_pins(boot); !set) return set;
  mcu_->reset();
  return {};
}

void FlashBench::repair() {
  line_.set_faults(nullptr);
  unplug_at_.reset();
  cut_at_.reset();
  (void)sleep_until(now() + std::chrono::milliseconds(200));
  line_.drop_unread();
}

std::optional<std::uint16_t> FlashBench::running_image() {
  (void)set_baud(115200);
  (void)sleep_until(now() + std::chrono::milliseconds(300));
  line_.drop_unread();
  host::Requester requester(*this, *this, {});
  requester.limit_tries(3);
  const auto board = host::identify_board(requester);
  if (!board) return std::nullopt;
  return board->image_crc;
}

}  // namespace kaz::lockstep
