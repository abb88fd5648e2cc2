// Stack depth, and reads of uninitialised RAM.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/memory_checks.h"

#include <algorithm>
#include <cstdio>

namespace kaz::h8s {

namespace {

bool is_ram(std::uint32_t address) {
  const std::uint32_t a = address & 0xffff;
  if (address > 0xffff && address < 0xff0000) return false;
  return (a >= 0xe080 && a < 0xf000) || (a >= 0xff00 && a < 0xff80);
}

}  // namespace

void StackMeter::look(States at) {
  const std::uint32_t sp = chip_.registers().er[7] & 0xffffff;
  // Before the program has set its stack pointer it is arbitrary.
  if (!is_ram(sp) && !is_ram(sp - 1)) return;
  highest_ = std::max(highest_, sp);
  // A call lowers ER7 and then begins its frame, at the same time.
  if (sp > lowest_ || (sp == lowest_ && at != at_)) return;
  lowest_ = sp;
  chain_ = frames_;
  at_ = at;
}

std::string StackMeter::text() const {
  if (chain_.empty()) return "the stack was not used\n";
  char line[256];
  std::snprintf(line, sizeof line,
                "stack: %u bytes used; lowest address %06x, reached at state %lld in\n", used(),
                lowest_, static_cast<long long>(at_));
  std::string out = line;
  for (const Frame& frame : chain_) {
    std::snprintf(line, sizeof line, "  %.120s%s\n",
                  chip_.symbols().describe(frame.function).c_str(),
                  frame.interrupt ? " (interrupt)" : "");
    out += line;
  }
  return out;
}

void UninitialisedReads::accessed(const Access& access) {
  // In advanced mode the low 64 KiB are flash.
  if (!is_ram(access.address) || (access.address <= 0xffff && chip_.peek(0xe000))) return;
  bool fresh = false;
  for (unsigned k = 0; k < access.size; ++k) {
    if (access.write)
      written_.set(place(access.address + k));
    else
      fresh = fresh || !written_.test(place(access.address + k));
  }
  if (fresh && reported_.insert(access.pc).second)
    reads_.push_back({access.address, access.pc, access.at});
}

void UninitialisedReads::was_reset(ResetCause cause, States) {
  if (cause == ResetCause::power_on) written_.reset();
}

void UninitialisedReads::changed(std::uint32_t address, std::uint32_t size) {
  if (size == 0) {
    written_.set();
    return;
  }
  for (std::uint32_t k = 0; k < size; ++k) {
    if (is_ram(address + k)) written_.set(place(address + k));
  }
}

std::string UninitialisedReads::text() const {
  if (reads_.empty()) return "no reads of uninitialized RAM\n";
  std::string out;
  for (const UninitialisedRead& r : reads_) {
    char line[256];
    std::snprintf(line, sizeof line, "%.120s reads uninitialized %06x (%.60s) at state %lld\n",
                  chip_.symbols().describe(r.pc).c_str(), r.address,
                  chip_.symbols().describe(r.address).c_str(), static_cast<long long>(r.at));
    out += line;
  }
  return out;
}

}  // namespace kaz::h8s
