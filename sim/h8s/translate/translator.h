// The translator: finds hot code, translates it to host code and runs that.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// Belongs to one Cpu. Code is translated at addresses that have been jumped to `Options::translate_after`
// times, and discarded when its instructions change. The guest cannot observe the difference.
class Translator final : public CodeCache {
 public:
  Translator();
  ~Translator();
  Translator(const Translator&) = delete;
  Translator& operator=(const Translator&) = delete;

  // Runs instructions until now >= stop.
  void run(Cpu& c) override;
  // Instructions in Cpu::code from `first` on, `count` of them, have changed.
  void forget(std::uint32_t first, std::uint32_t count) override;
  // A code hook was set or cleared at `index`: blocks that hold the instruction are translated again.
  void hook_changed(std::uint32_t index);
  // Discards all; also needed when the code array itself or the memory map has changed.
  void forget_all() override;
  // Blocks translated since the start, for measurements.
  std::int64_t translated() const;
  // Instructions executed in translated code since construction or the last reset_count().
  std::int64_t executed() const;
  void reset_count();

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

// Null where this build cannot translate.
std::unique_ptr<Translator> make_translator();

}  // namespace kaz::h8s
