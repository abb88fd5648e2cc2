// Selection among interrupt requests, and the interrupt controller's registers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/interrupts.h"

#include <algorithm>
#include <bit>

namespace kaz::h8s {
namespace {

// ICR register (0..2 for A..C) and bit of each vector; 0xff: none.
constexpr std::array<std::uint8_t, vec::kCount> icr_bits() {
  std::array<std::uint8_t, vec::kCount> t{};
  for (auto& e : t) e = 0xff;
  auto give = [&t](unsigned from, unsigned to, unsigned reg, unsigned bit) {
    for (unsigned v = from; v <= to; ++v) t[v] = static_cast<std::uint8_t>(reg * 8 + bit);
  };
  give(16, 16, 0, 7), give(17, 17, 0, 6), give(18, 19, 0, 5), give(20, 21, 0, 4),
      give(22, 23, 0, 3);
  give(24, 24, 0, 2), give(25, 25, 0, 1), give(26, 26, 0, 0);
  give(28, 28, 1, 7), give(48, 54, 1, 6), give(64, 66, 1, 3), give(68, 70, 1, 2),
      give(72, 75, 1, 1);
  give(80, 83, 2, 7), give(84, 87, 2, 6), give(92, 93, 2, 4), give(94, 94, 2, 3);
  return t;
}
constexpr auto kIcrBits = icr_bits();

}  // namespace

void Interrupts::reset() {
  const std::uint8_t irq = irq_level_;
  const bool nmi = nmi_level_;
  *this = Interrupts{};
  irq_level_ = irq;
  nmi_level_ = nmi;
}

void Interrupts::change(unsigned vector, bool level, States at) {
  const std::uint64_t bit = 1ull << (vector % 64);
  const unsigned half = vector / 64;
  raw_[half] ^= bit;
  pending_[half] = raw_[half] & ~diverted_[half];
  since_[vector] = level ? at : kNever;
  raised_ |= level;
}

// A request returned to the CPU is decided again.
void Interrupts::divert(const std::array<std::uint64_t, 2>& vectors, States at) {
  for (unsigned half = 0; half < 2; ++half) {
    std::uint64_t back = diverted_[half] & ~vectors[half] & raw_[half];
    for (; back != 0; back &= back - 1)
      since_[half * 64 + static_cast<unsigned>(std::countr_zero(back))] = at;
    diverted_[half] = vectors[half];
    pending_[half] = raw_[half] & ~diverted_[half];
  }
  raised_ = true;
}

States Interrupts::diverted_since() const {
  States first = kNever;
  for (unsigned half = 0; half < 2; ++half)
    for (std::uint64_t left = raw_[half] & diverted_[half]; left != 0; left &= left - 1)
      first = std::min(first, since_[half * 64 + static_cast<unsigned>(std::countr_zero(left))]);
  return first;
}

unsigned Interrupts::first_diverted(States limit) const {
  for (unsigned half = 0; half < 2; ++half) {
    for (std::uint64_t left = raw_[half] & diverted_[half]; left != 0; left &= left - 1) {
      const unsigned v = half * 64 + static_cast<unsigned>(std::countr_zero(left));
      if (since_[v] <= limit) return v;
    }
  }
  return 0;
}

void Interrupts::taken_by_dtc(unsigned vector, States at) {
  accepted(vector, at);
}

bool Interrupts::priority(unsigned vector) const {
  const unsigned bit = kIcrBits[vector];
  return bit != 0xff && (icr_[bit / 8] >> (bit % 8) & 1) != 0;
}

bool Interrupts::acceptable(unsigned vector, std::uint8_t control, bool two_level) const {
  if (vector == vec::kNmi) return true;
  if (!(control & CCR::I)) return true;
  return two_level && !(control & CCR::UI) && priority(vector);
}

Interrupts::Choice Interrupts::choose(States boundary, std::uint8_t control, bool two_level,
                                      int decision) const {
  Choice choice;
  // Nearly always there is one, and it is not masked.
  if (const std::uint64_t one = pending_[0] | pending_[1];
      !(control & CCR::I) && (one & (one - 1)) == 0 && (pending_[0] == 0 || pending_[1] == 0) &&
      one != 0) {
    const unsigned v = (pending_[0] == 0 ? 64u : 0u) + static_cast<unsigned>(std::countr_zero(one));
    choice.earliest = since_[v] + decision + 1;
    if (boundary >= choice.earliest) choice.vector = v;
    return choice;
  }
  for (unsigned half = 0; half < 2; ++half) {
    for (std::uint64_t left = pending_[half]; left != 0; left &= left - 1) {
      const unsigned v = half * 64 + static_cast<unsigned>(std::countr_zero(left));
      if (!acceptable(v, control, two_level)) continue;
      const States from = since_[v] + decision + 1;
      choice.earliest = std::min(choice.earliest, from);
      if (boundary < from) continue;
      if (v == vec::kNmi || priority(v)) {
        choice.vector = v;
        return choice;
      }
      if (choice.vector == 0) choice.vector = v;
    }
  }
  return choice;
}

void Interrupts::accepted(unsigned vector, States at) {
  if (vector == vec::kNmi) set(vector, false, at);
  if (vector == vec::kAddressBreak) {
    abrkcr_ &= ~ABRKCR::CMF;
    set(vector, false, at);
  }
  if (vector < vec::kIrq0 || vector >= vec::kIrq0 + 3) return;
  const unsigned n = vector - vec::kIrq0;
  if (sense(n) != 0 || (irq_level_ >> n & 1)) isr_.drop(static_cast<std::uint8_t>(1u << n));
  update_irq(at);
}

void Interrupts::update_irq(States at) {
  for (unsigned n = 0; n < 3; ++n) {
    const auto bit = static_cast<std::uint8_t>(1u << n);
    if (sense(n) == 0 && !(irq_level_ & bit)) isr_.raise(bit);
    set(vec::kIrq0 + n, (isr_.value() & ier_ & bit) != 0, at);
  }
}

void Interrupts::set_irq_pin(unsigned n, bool level, States at) {
  const auto bit = static_cast<std::uint8_t>(1u << n);
  const bool before = (irq_level_ & bit) != 0;
  irq_level_ = static_cast<std::uint8_t>(level ? irq_level_ | bit : irq_level_ & ~bit);
  const unsigned edge = sense(n);
  if (before && !level && (edge == 1 || edge == 3)) isr_.raise(bit);
  if (!before && level && (edge == 2 || edge == 3)) isr_.raise(bit);
  update_irq(at);
}

void Interrupts::set_nmi_pin(bool level, bool rising_edge, States at) {
  if (level != nmi_level_ && level == rising_edge) set(vec::kNmi, true, at);
  nmi_level_ = level;
}

std::optional<std::uint8_t> Interrupts::peek(std::uint32_t address) const {
  switch (address) {
    case io::ICRA:
    case io::ICRB:
    case io::ICRC:
      return icr_[address - io::ICRA];
    case io::ISR:
      return isr_.value();
    case io::ISCRH:
      return iscrh_;
    case io::ISCRL:
      return iscrl_;
    case io::ABRKCR:
      return abrkcr_;
    case io::BARA:
    case io::BARB:
    case io::BARC:
      return bar_[address - io::BARA];
    case io::IER:
      return ier_;
    default:
      return std::nullopt;
  }
}

std::optional<std::uint8_t> Interrupts::read(std::uint32_t address) {
  if (address == io::ISR) return isr_.read();
  return peek(address);
}

bool Interrupts::write(std::uint32_t address, std::uint8_t value, States at) {
  switch (address) {
    case io::ICRA:
    case io::ICRB:
    case io::ICRC:
      icr_[address - io::ICRA] = value;
      break;
    case io::ISR:
      isr_.write(value);
      break;
    case io::ISCRH:
      iscrh_ = value;
      break;
    case io::ISCRL:
      iscrl_ = value;
      break;
    case io::ABRKCR:
      abrkcr_ = (abrkcr_ & ABRKCR::CMF) | (value & ABRKCR::BIE);
      if (!(value & ABRKCR::BIE)) {
        abrkcr_ = 0;
        set(vec::kAddressBreak, false, at);
      }
      break;
    case io::BARA:
    case io::BARB:
      bar_[address - io::BARA] = value;
      break;
    case io::BARC:
      bar_[2] = value & ~BARC::ZERO;
      break;
    case io::IER:
      ier_ = value;
      break;
    default:
      return false;
  }
  update_irq(at);
  return true;
}

}  // namespace kaz::h8s
