// Translator: finds hot guest code, translates this code to host code, and runs the host code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// Belongs to one Cpu. Translates code at addresses that have been jumped to Options::translate_after times,
// and discards the translated code after a change of the instructions. Programs have the same results as with
// the interpreter.
class Translator final : public CodeCache {
 public:
  Translator();
  ~Translator();
  Translator(const Translator&) = delete;
  Translator& operator=(const Translator&) = delete;

  // Runs instructions until now >= stop.
  void run(Cpu& c) override;
  // Must be called when entries of Cpu::code have changed. `first` is the index of the first of these
  // entries, and `count` is their number. If translated code contains one of these entries, all translated
  // code is discarded.
  void forget(std::uint32_t first, std::uint32_t count) override;
  // Must be called when a code hook was set or cleared at `index`. If translated code contains that
  // instruction, all translated code is discarded.
  void hook_changed(std::uint32_t index);
  // Discards all translated code. Must be called when Cpu::code or the memory map has changed.
  void forget_all() override;
  // Returns the number of blocks translated since construction, for measurements.
  std::int64_t translated() const;
  // Returns the number of instructions executed in translated code since construction or the last
  // reset_count().
  std::int64_t executed() const;
  void reset_count();

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

// Returns null if this build cannot translate.
std::unique_ptr<Translator> make_translator();

}  // namespace kaz::h8s
