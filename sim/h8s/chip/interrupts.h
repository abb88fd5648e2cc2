// Interrupt controller: requests and priorities of all sources, and the IRQ and NMI pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <utility>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Vector numbers (hardware manual, exception vector table).
namespace vec {
inline constexpr unsigned kNmi = 7, kIrq0 = 16, kSwdtend = 24, kWovi0 = 25, kWovi1 = 26,
                          kAddressBreak = 27, kAdi = 28, kIcia = 48, kOcia = 52, kOcib = 53,
                          kFovi = 54, kCmia0 = 64, kCmia1 = 68, kCmiay = 72, kIcix = 75, kEri0 = 80,
                          kEri1 = 84;
inline constexpr unsigned kCount = 104;
}  // namespace vec

class Interrupts {
 public:
  // Resets the module, but keeps the levels of the pins.
  void reset();

  // Raises or drops the request of a source. `at` is the time of a raised request.
  void set(unsigned vector, bool level, States at) {
    if (level != ((raw_[vector / 64] >> (vector % 64) & 1) != 0)) change(vector, level, at);
  }
  // Sets the requests of `count` adjacent vectors: bit k of `levels` is the level for vector `first` + k. The
  // adjacent vectors must not include both vector 63 and vector 64.
  void set_all(unsigned first, unsigned count, std::uint64_t levels, States at) {
    const std::uint64_t mask = ((1ull << count) - 1) << (first % 64);
    const std::uint64_t wanted = levels << (first % 64);
    std::uint64_t changed = (raw_[first / 64] & mask) ^ wanted;
    for (; changed != 0; changed &= changed - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(changed));
      change(first / 64 * 64 + bit, (wanted >> bit & 1) != 0, at);
    }
  }
  // Returns whether a request has been raised since the preceding call of take_raised().
  bool take_raised() { return std::exchange(raised_, false); }
  bool requested(unsigned vector) const { return since_[vector] != kNever; }
  // Returns the requests to the CPU: two words with one bit for each vector.
  const std::uint64_t* pending() const { return pending_.data(); }

  // Returns whether the CPU has a request that is not masked by bit I of `control`. With `two_level`, this
  // function ignores the mask bits and returns true for any request. In this case, choose() checks the mask
  // bits I and UI.
  bool any_unmasked(std::uint8_t control, bool two_level) const {
    if ((pending_[0] | pending_[1]) == 0) return false;
    return !(control & CCR::I) || two_level || (pending_[0] >> vec::kNmi & 1) != 0;
  }
  // Decision whether the CPU accepts an interrupt at an instruction boundary.
  struct Choice {
    unsigned vector = 0;       // vector to accept now; 0: accept no vector
    States earliest = kNever;  // if `vector` is 0: earliest time of acceptance
  };
  // `decision` is the value of Options::interrupt_decision_states.
  Choice choose(States boundary, std::uint8_t control, bool two_level, int decision) const;

  // --- for the DTC

  // Selects the sources (one bit for each vector) whose requests activate the DTC instead of the CPU.
  void divert(const std::array<std::uint64_t, 2>& vectors, States at);
  bool any_diverted() const { return ((raw_[0] & diverted_[0]) | (raw_[1] & diverted_[1])) != 0; }
  // Returns the time of the oldest diverted request; kNever if there is no diverted request.
  States diverted_since() const;
  // Returns the lowest vector of the diverted requests that were raised at `limit` or before; 0 if there is
  // no such vector.
  unsigned first_diverted(States limit) const;
  // Must be called after the DTC has served a request of the IRQ pins.
  void taken_by_dtc(unsigned vector, States at);

  // Must be called when the CPU accepts a vector. Clears a request that came from an edge or from the address
  // break.
  void accepted(unsigned vector, States at);

  void set_irq_pin(unsigned n, bool level, States at);
  void set_nmi_pin(bool level, bool rising_edge, States at);
  bool nmi_level() const { return nmi_level_; }
  bool any_irq_enabled() const { return (ier_ & (IER::IRQ2E | IER::IRQ1E | IER::IRQ0E)) != 0; }

  // Returns whether the address break is enabled. If the result is true, fetched() must be called before each
  // instruction.
  bool watches_fetches() const { return (abrkcr_ & ABRKCR::BIE) != 0; }
  void fetched(std::uint32_t pc, States at) {
    const std::uint32_t bar = std::uint32_t{bar_[0]} << 16 | std::uint32_t{bar_[1]} << 8 | bar_[2];
    if (pc != bar) return;
    abrkcr_ |= ABRKCR::CMF;
    set(vec::kAddressBreak, true, at);
  }

  // Register accesses. `address` contains only the low 16 bits of the address. These functions return nullopt
  // or false if the address does not belong to a register of this module.
  std::optional<std::uint8_t> read(std::uint32_t address);
  std::optional<std::uint8_t> peek(std::uint32_t address) const;
  bool write(std::uint32_t address, std::uint8_t value, States at);

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(since_, raw_, diverted_, pending_, raised_, icr_, isr_, iscrh_, iscrl_, ier_, abrkcr_, bar_,
      irq_level_, nmi_level_);
    for (unsigned vector = 0; vector < 128; ++vector) {
      const auto in = [vector](const std::array<std::uint64_t, 2>& bits) {
        return (bits[vector / 64] >> (vector % 64) & 1) != 0;
      };
      const bool is_requested = vector < vec::kCount && requested(vector);
      a.require(in(raw_) == is_requested && (in(raw_) || !in(pending_)) &&
                    (vector < vec::kCount || !in(diverted_)),
                "interrupt");
    }
  }

 private:
  void change(unsigned vector, bool level, States at);
  bool acceptable(unsigned vector, std::uint8_t control, bool two_level) const;
  bool priority(unsigned vector) const;
  unsigned sense(unsigned n) const { return iscrl_ >> (2 * n) & ISCRL::IRQ0SC; }
  void update_irq(States at);

  std::array<States, vec::kCount> since_ = filled();  // time of each request; kNever: no request
  std::array<std::uint64_t, 2> raw_{};                // all requests
  std::array<std::uint64_t, 2> diverted_{};           // sources whose requests go to the DTC
  std::array<std::uint64_t, 2> pending_{};            // requests to the CPU: raw_ without diverted_
  bool raised_ = false;
  std::array<std::uint8_t, 3> icr_{};
  StickyFlags isr_;
  std::uint8_t iscrh_ = 0, iscrl_ = 0, ier_ = 0, abrkcr_ = 0;
  std::array<std::uint8_t, 3> bar_{};
  // Levels of IRQ0..IRQ2, one bit for each pin. All three pins are initially high (inactive).
  std::uint8_t irq_level_ = 7;
  bool nmi_level_ = true;

  static std::array<States, vec::kCount> filled() {
    std::array<States, vec::kCount> a;
    a.fill(kNever);
    return a;
  }
};

}  // namespace kaz::h8s
