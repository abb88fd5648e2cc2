// `kaz mcu run`: the bare chip with any image, no board around it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/mcu_run.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sim/h8s/chip.h"
#include "sim/h8s/image.h"
#include "tools/kaz/output.h"

namespace kaz::tools {
namespace {

const char* name_of(h8s::Stop::Reason reason) {
  using Reason = h8s::Stop::Reason;
  switch (reason) {
    case Reason::reached:
      return "reached the limit";
    case Reason::breakpoint:
      return "breakpoint";
    case Reason::undefined_instruction:
      return "undefined instruction";
    case Reason::unmapped_access:
      return "unmapped access";
    case Reason::stack_outside_ram:
      return "stack outside RAM";
    case Reason::undefined_register_use:
      return "undefined register use";
    case Reason::requested:
      return "stopped by an observer";
    case Reason::asleep_forever:
      return "asleep with nothing to wake it";
  }
  return "unknown";
}

bool healthy(h8s::Stop::Reason reason) {
  return reason == h8s::Stop::Reason::reached || reason == h8s::Stop::Reason::asleep_forever;
}

// One line an instruction: time in states, address, text, the registers it starts from.
h8s::Stop trace_until(h8s::Chip& chip, h8s::States until) {
  h8s::Stop stop;
  while (chip.now() < until && stop.reason == h8s::Stop::Reason::reached) {
    const h8s::Registers r = chip.registers();
    if (chip.asleep()) {
      std::fprintf(stderr, "%12lld  asleep\n", static_cast<long long>(chip.now()));
    } else {
      std::fprintf(stderr, "%12lld  %06x  %-32s ccr=%02x er0=%08x er1=%08x sp=%08x\n",
                   static_cast<long long>(chip.now()), r.pc, chip.disassemble(r.pc).c_str(), r.ccr,
                   r.er[0], r.er[1], r.er[7]);
    }
    stop = chip.step();
  }
  return stop;
}

// In pieces, so that a long run shows that it is alive.
h8s::Stop run_until(h8s::Chip& chip, h8s::States until, bool quiet) {
  constexpr h8s::States kPiece = 20'000'000;
  Progress progress("kaz mcu run", quiet);
  h8s::Stop stop;
  for (h8s::States t = chip.now(); t < until && stop.reason == h8s::Stop::Reason::reached;) {
    t = std::min(until, t + kPiece);
    stop = chip.run_until(t);
    if (until > 50 * kPiece) {
      progress.update(static_cast<double>(t) / static_cast<double>(until), "");
    }
  }
  return stop;
}

void print_misuse(const h8s::Chip& chip) {
  for (const h8s::Misuse& misuse : chip.misuse()) {
    std::fprintf(stderr, "misuse: %s (register %06x, from %s, %lld times, first at state %lld)\n",
                 misuse.text.c_str(), misuse.address, chip.symbols().describe(misuse.pc).c_str(),
                 static_cast<long long>(misuse.count), static_cast<long long>(misuse.first));
  }
}

}  // namespace

Result<bool> run_mcu(const McuRunOptions& options) {
  const auto image = h8s::load_image(options.image);
  if (!image) return fail(Fault::usage, image.error().message);
  h8s::Chip chip;
  if (const auto loaded = chip.load(*image); !loaded) {
    return fail(Fault::usage, options.image + ": " + loaded.error().message);
  }
  chip.on_transmit([](int sci, const h8s::TransmittedByte& byte) {
    if (sci == 0) std::fputc(byte.value, stdout);
  });
  chip.power_on();

  using Seconds = std::chrono::duration<double>;
  const auto begin = std::chrono::steady_clock::now();
  const h8s::Stop stop = options.trace ? trace_until(chip, options.max_states)
                                       : run_until(chip, options.max_states, options.json);
  const double wall_s = Seconds(std::chrono::steady_clock::now() - begin).count();
  std::fflush(stdout);

  const double chip_s = static_cast<double>(chip.now()) / 18.432e6;
  if (options.json) {
    nlohmann::ordered_json result{{"stop", name_of(stop.reason)},
                                  {"states", chip.now()},
                                  {"chip_s", chip_s},
                                  {"wall_s", wall_s},
                                  {"misuse", chip.misuse().size()},
                                  {"report", stop.report}};
    std::printf("%s\n", result.dump(2).c_str());
  } else {
    print_misuse(chip);
    if (!stop.report.empty()) std::fprintf(stderr, "%s\n", stop.report.c_str());
    std::fprintf(stderr, "%s after %lld states: %.3f s of the chip in %.3f s, %.0f times real\n",
                 name_of(stop.reason), static_cast<long long>(chip.now()), chip_s, wall_s,
                 wall_s > 0 ? chip_s / wall_s : 0);
  }
  return healthy(stop.reason);
}

}  // namespace kaz::tools
