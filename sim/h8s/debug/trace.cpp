// Trace: a line of text for each instruction.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/trace.h"

#include <cstdio>

namespace kaz::h8s {
namespace {

template <class... A>
std::string format(const char* pattern, A... values) {
  char text[320];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace

Trace::Trace(const Chip& chip, std::ostream& out) : chip_(chip), out_(&out) {}
Trace::Trace(const Chip& chip, std::size_t lines) : chip_(chip), kept_(lines) {}

void Trace::line(std::string text) {
  if (out_) {
    *out_ << text << '\n';
    return;
  }
  lines_.push_back(std::move(text));
  if (lines_.size() > kept_) lines_.pop_front();
}

std::string Trace::text() const {
  std::string all;
  for (const std::string& l : lines_) all.append(l).append("\n");
  return all;
}

void Trace::before(std::uint32_t pc, States) {
  before_ = chip_.registers();
  // Disassembled before it runs: it may overwrite itself.
  text_ = chip_.disassemble(pc);
  accesses_.clear();
}

void Trace::accessed(const Access& a) {
  if (a.size == 1)
    accesses_ += format(a.write ? "  [%06x]=%02x" : "  [%06x]->%02x", a.address, a.value);
  else
    accesses_ += format(a.write ? "  [%06x]=%04x" : "  [%06x]->%04x", a.address, a.value);
}

void Trace::executed(const Executed& e) {
  std::string text = format("%12lld  %06x  %-20.80s  %-32.100s", static_cast<long long>(e.begin),
                            e.pc, chip_.symbols().describe(e.pc).c_str(), text_.c_str());
  const Registers after = chip_.registers();
  for (unsigned n = 0; n < 8; ++n) {
    if (after.er[n] != before_.er[n]) text += format("  er%u=%08x", n, after.er[n]);
  }
  if (after.ccr != before_.ccr) text += format("  ccr=%02x", after.ccr);
  if (after.exr != before_.exr) text += format("  exr=%02x", after.exr);
  text += accesses_;
  text.erase(text.find_last_not_of(' ') + 1);
  accesses_.clear();
  line(std::move(text));
}

void Trace::entered(const ExceptionEntry& e) {
  line(format("%12lld  interrupt, vector %u, at %06x, to %.80s", static_cast<long long>(e.begin),
              e.vector, e.interrupted, chip_.symbols().describe(e.handler).c_str()) +
       accesses_);
  accesses_.clear();
}

void Trace::slept(States from, States to) {
  line(format("%12lld  asleep for %lld states", static_cast<long long>(from),
              static_cast<long long>(to - from)));
}

void Trace::was_reset(ResetCause cause, States at) {
  const char* why = cause == ResetCause::power_on ? "power-on"
                    : cause == ResetCause::pin    ? "RES"
                                                  : "watchdog";
  line(format("%12lld  reset by %s", static_cast<long long>(at), why));
}

}  // namespace kaz::h8s
