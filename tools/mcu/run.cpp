// `kaz mcu run`: the bare chip with any image, no board around it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/mcu/run.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "shared/image/image.h"
#include "sim/h8s/chip/chip.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/mcu/attached.h"

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
      return "asleep without a wake-up source";
  }
  return "unknown";
}

bool healthy(h8s::Stop::Reason reason) {
  return reason == h8s::Stop::Reason::reached || reason == h8s::Stop::Reason::asleep_forever;
}

void print_misuse(const h8s::Chip& chip) {
  for (const h8s::Misuse& misuse : chip.misuse()) {
    std::fprintf(stderr,
                 "misuse: %s (address %06x, by code in %s, %lld times, first at state %lld)\n",
                 misuse.text.c_str(), misuse.address, chip.symbols().describe(misuse.pc).c_str(),
                 static_cast<long long>(misuse.count), static_cast<long long>(misuse.first));
  }
}

// The bytes of a file, given to RxD0 one frame behind the other at the rate that the program has set,
// as soon as it receives.
class Feeder {
 public:
  Result<void> open(const std::string& path) {
    if (path.empty()) return {};
    if (path != "-") {
      const auto regular = open_input(path, "give a file with the bytes to receive, or -");
      if (!regular) return fail(regular.error().fault, "--input " + regular.error().message);
    }
    file_ = path == "-" ? stdin : std::fopen(path.c_str(), "rb");
    if (!file_)
      return fail(Fault::usage, "--input " + path + ": " + std::strerror(errno) +
                                    "; give a file with the bytes to receive, or -");
    next_ = std::fgetc(file_);
    return {};
  }

  // The next look is due after the frame, or a little later where the program does not receive yet.
  h8s::States feed(h8s::Chip& chip, h8s::States idle) {
    constexpr std::uint32_t kSmr = 0xffd8, kBrr = 0xffd9, kScr = 0xffda;
    constexpr h8s::States kLook = 20'000;
    if (next_ < 0) return idle;
    const auto reg = [&](std::uint32_t low) {
      return unsigned{chip.peek(chip_mask(chip) & (0xff0000 | low)).value_or(0)};
    };
    if (!(reg(kScr) & 0x10)) return chip.now() + kLook;
    const unsigned smr = reg(kSmr);
    const h8s::States bit = h8s::States{32} * (h8s::States{1} << (2 * (smr & 3))) * (reg(kBrr) + 1);
    const int bits = 9 + (smr & 0x40 ? 0 : 1) + (smr & 0x20 ? 1 : 0) + (smr & 0x08 ? 1 : 0);
    last_ = std::max(last_, chip.now()) + bit * bits;
    if (chip.receive(0, {static_cast<std::uint8_t>(next_), last_})) next_ = std::fgetc(file_);
    return last_;
  }

 private:
  // Registers stand at the top of 24 or of 16 bits.
  static std::uint32_t chip_mask(const h8s::Chip& chip) {
    return chip.peek(0xffffc5) ? 0xffffff : 0xffff;
  }

  std::FILE* file_ = nullptr;
  int next_ = EOF;
  h8s::States last_ = 0;
};

// In pieces, so that a long run shows that it is alive.
h8s::Stop run_until(h8s::Chip& chip, h8s::States until, bool quiet, Feeder& feeder,
                    const host::Interrupt& interrupt) {
  // With a trace and signals on a slow disc some tenths of a second.
  constexpr h8s::States kPiece = 250'000;
  Progress progress("kaz mcu run", quiet);
  h8s::Stop stop;
  h8s::States shown = 0;
  while (chip.now() < until && stop.reason == h8s::Stop::Reason::reached &&
         !interrupt.requested()) {
    stop = chip.run_until(std::min(until, feeder.feed(chip, chip.now() + kPiece)));
    if (until > 4000 * kPiece && chip.now() - shown >= 80 * kPiece) {
      shown = chip.now();
      progress.update(static_cast<double>(shown) / static_cast<double>(until), "");
    }
  }
  if (shown > 0 && chip.now() >= until) progress.update(1, "");
  return stop;
}

// The address that --entry means, none for a start by reset.
Result<std::optional<std::uint32_t>> entry_of(const McuRunOptions& options,
                                              const h8s::Image& image) {
  if (options.entry.empty()) return std::nullopt;
  if (options.entry == "image") {
    if (!image.entry)
      return fail(Fault::usage, options.image + ": the image has no entry; give --entry=ADDRESS");
    return image.entry;
  }
  char* end = nullptr;
  const unsigned long address = std::strtoul(options.entry.c_str(), &end, 0);
  if (*end != 0 || address > 0xffffff)
    return fail(Fault::usage, "--entry=" + options.entry + ": give an address up to 0xffffff");
  return static_cast<std::uint32_t>(address);
}

Result<void> start(h8s::Chip& chip, const McuRunOptions& options, const h8s::Image& image) {
  const auto entry = KAZ_TRY(entry_of(options, image));
  const auto fill = static_cast<std::uint8_t>(options.ram_fill);
  if (!entry) {
    if (const auto loaded = chip.load(image); !loaded)
      return fail(Fault::usage, options.image + ": " + loaded.error().message);
    chip.power_on(fill);
    return {};
  }
  chip.power_on(fill);
  if (const auto placed = chip.place(image, *entry); !placed)
    return fail(Fault::usage, options.image + ": " + placed.error().message);
  return {};
}

}  // namespace

Result<ExitStatus> run_mcu(const McuRunOptions& options) {
  auto image = h8s::load_image(options.image, options.load);
  if (!image) return fail(Fault::usage, image.error().message);
  if (options.flat) {
    const auto entry = KAZ_TRY(entry_of(options, *image));
    if (entry) image->entry = entry;
    return run_flat(options, *image);
  }
  h8s::Options chosen;
  chosen.engine = options.engine;
  chosen.mode = options.mode;
  h8s::Chip chip(chosen);
  const auto debug = KAZ_TRY(McuDebug::attach(chip, image->symbols, options.debug));
  KAZ_TRY(start(chip, options, *image));
  if (options.entry.empty() && chip.peek32(0).value_or(0) == 0xffffffff)
    return fail(Fault::usage,
                options.image +
                    ": the reset vector (address 0) is empty: give --entry to start at the image's "
                    "entry address, or --flat to run the image without a chip");
  chip.on_transmit([](int sci, const h8s::TransmittedByte& byte) {
    if (sci == 0) std::fputc(byte.value, stdout);
  });
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  std::signal(SIGPIPE, SIG_DFL);  // as before: standard output may be a pipe that is closed
  Feeder feeder;
  KAZ_TRY(feeder.open(options.input));

  Attached attached;
  KAZ_TRY(attached.open(chip, options.netlist, options.vcd, options.signals, options.crystal_hz));

  using Seconds = std::chrono::duration<double>;
  const auto begin = std::chrono::steady_clock::now();
  const h8s::States until =
      options.max_states.value_or(static_cast<h8s::States>(options.crystal_hz));
  if (!options.debug.gdb.empty()) {
    KAZ_TRY(serve_gdb(chip, options.debug.gdb, interrupt.descriptor()));
    KAZ_TRY(attached.close());
    KAZ_TRY(debug->report());
    if (interrupt.requested()) return tl::unexpected(host::Interrupt::error());
    return true;
  }
  const h8s::Stop stop = run_until(chip, until, options.json, feeder, interrupt);
  const bool interrupted =
      interrupt.requested() && stop.reason == h8s::Stop::Reason::reached && chip.now() < until;
  const double wall_s = Seconds(std::chrono::steady_clock::now() - begin).count();
  KAZ_TRY(attached.close());
  if (std::fflush(stdout) != 0)
    return fail(Fault::environment,
                std::string("cannot write standard output: ") + std::strerror(errno));

  KAZ_TRY(debug->report());

  const double chip_s = static_cast<double>(chip.now()) / options.crystal_hz;
  if (options.json) {
    nlohmann::ordered_json result{{"stop", interrupted ? "interrupted" : name_of(stop.reason)},
                                  {"states", chip.now()},
                                  {"insns", chip.instructions()},
                                  {"chip_s", chip_s},
                                  {"wall_s", wall_s},
                                  {"misuse", chip.misuse().size()},
                                  {"report", stop.report},
                                  {"provenance", provenance_json()}};
    if (interrupted) mark_interrupted(result);
    print_json(result);
  } else {
    print_misuse(chip);
    // A program that has ended in SLEEP has not crashed: its first line says it all.
    if (healthy(stop.reason) && !stop.report.empty())
      std::fprintf(stderr, "%s\n", stop.report.substr(0, stop.report.find('\n')).c_str());
    else if (!stop.report.empty())
      std::fprintf(stderr, "%s\n", stop.report.c_str());
    std::fprintf(
        stderr, "%s after %lld states: %.3f s of the chip in %.3f s, %.3g times real time\n",
        interrupted ? "interrupted" : name_of(stop.reason), static_cast<long long>(chip.now()),
        chip_s, wall_s, wall_s > 0 ? chip_s / wall_s : 0);
  }
  if (options.count)
    std::fprintf(stderr, "insns=%lld\nstates=%lld\n", static_cast<long long>(chip.instructions()),
                 static_cast<long long>(chip.now()));
  if (interrupted)
    return fail(Fault::interrupted, "interrupted; outputs and files cover the run until then");
  return healthy(stop.reason);
}

}  // namespace kaz::tools
