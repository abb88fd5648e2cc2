// Saves and loads the whole machine as bytes.
// SPDX-License-Identifier: Apache-2.0
//
// Decoded instructions are not saved; pointers to them are written as indices. The members are those
// that take_state() (machine.cpp) copies.
#include <algorithm>

#include "shared/base/archive.hpp"
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr std::int64_t kNowhere = -2, kOutside = -1;
constexpr States kMaxNow = States{1} << 50;  // two years

std::int64_t place_of(const Cpu& cpu, const Insn* p) {
  return p == nullptr ? kNowhere : p == &cpu.outside ? kOutside : p - cpu.code;
}

}  // namespace

template <class A>
void Machine::transfer_cpu(A& a) {
  a(cpu.er, cpu.flags, cpu.now, cpu.stall, cpu.executed, cpu.ram_size, cpu.flash_size, cpu.mask,
    cpu.control, cpu.exr, cpu.request, cpu.normal, cpu.two_level, cpu.stc_copies, cpu.rte_holds_off,
    cpu.predecrement_stores_decremented, cpu.hold_off, cpu.asleep, cpu.moving, cpu.fault,
    cpu.fault_address, cpu.fault_pc, cpu.jumps);
  a.require(cpu.mask == (cpu.normal ? 0xffffU : 0xffffffU) &&
                cpu.flash_size == (cpu.normal ? 0xe000U : kFlashSize) &&
                (cpu.ram_size == 0 || cpu.ram_size == kRamSize) && cpu.request < vec::kCount,
            "CPU");
  a.require(cpu.now >= 0 && cpu.now <= kMaxNow && cpu.stall >= 0 && cpu.stall <= kMaxNow, "time");
  if (!a.good()) return;
  // The current instruction and the last jumps.
  std::array<std::int64_t, 1 + 2 * kTrail> places{};
  std::uint32_t outside = 0;
  if constexpr (!A::reading) {
    places[0] = place_of(cpu, cpu.ip);
    for (std::size_t k = 0; k < kTrail; ++k) {
      places[1 + 2 * k] = place_of(cpu, cpu.trail[k].from);
      places[2 + 2 * k] = place_of(cpu, cpu.trail[k].to);
    }
    if (std::ranges::count(places, kOutside) > 0) outside = cpu.outside.imm;
  }
  a(places, outside);
  if constexpr (A::reading) {
    const auto wrong = [](std::int64_t p) { return p < kNowhere || p >= kCodeSize; };
    if (std::ranges::any_of(places, wrong) || places[0] == kNowhere)
      return a.refuse("it refers to a missing instruction");
    if (std::ranges::count(places, kOutside) > 0) at_address(cpu, outside);
    const auto at = [&](std::int64_t p) -> const Insn* {
      return p == kNowhere ? nullptr : p == kOutside ? &cpu.outside : cpu.code + p;
    };
    cpu.ip = at(places[0]);
    for (std::size_t k = 0; k < kTrail; ++k)
      cpu.trail[k] = {at(places[1 + 2 * k]), at(places[2 + 2 * k])};
  }
}

template <class A>
void Machine::transfer(A& a) {
  // Flash without trailing 0xff.
  std::vector<std::uint8_t> used;
  if constexpr (!A::reading) {
    used = flash_;
    while (!used.empty() && used.back() == 0xff) used.pop_back();
  }
  a(used);
  if constexpr (A::reading) {
    if (used.size() > flash_.size()) return a.refuse("its flash is too large");
    std::ranges::fill(flash_, std::uint8_t{0xff});
    std::ranges::copy(used, flash_.begin());
  }
  a(block_);
  transfer_cpu(a);
  if (!a.good()) return;
  a(irq, ports, frt, tmr, tmr_xy, pwm, pwmx, sci, adc, wdt, flash_control, boot, dtc, system, epoch,
    sub_epoch, standby_, watch_, wakes_at_, slow_from_, slow_by_, cause, watchdog_reset, misuses,
    dead, first_after_reset_);
  a.require(slow_by_ >= 1 && slow_by_ <= 32 &&
                (slow_from_ == kNever || (slow_from_ >= 0 && slow_from_ <= kMaxNow)),
            "divided clock");
  a.require(epoch >= 0 && epoch <= kMaxNow && sub_epoch >= 0 && sub_epoch <= kMaxNow, "prescaler");
}

void Machine::write_state(StateWriter& to) {
  transfer(to);
}

void Machine::read_state(StateReader& from) {
  transfer(from);
  if (!from.good()) {
    boot = {};
    flash_control = {};
    cpu.ip = cpu.code;
    cpu.trail = {};
    cpu.now = 0;
    attach();
    return power_on(0xa5);
  }
  hook_done_ = kNoAddress;
  attach();
  forget_all_code();
  pins.forget(*this, cpu.now);
  reschedule_all();
}

}  // namespace kaz::h8s
