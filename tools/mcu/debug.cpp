// What `kaz mcu run` can look at while it runs: trace, profile, coverage, stack, fresh RAM, GDB.
// SPDX-License-Identifier: Apache-2.0
#include "tools/mcu/debug.h"

#include <cstdio>
#include <fstream>
#include <iostream>
#include <optional>

#include "sim/h8s/debug/coverage.h"
#include "sim/h8s/debug/gdb_port.h"
#include "sim/h8s/debug/memory_checks.h"
#include "sim/h8s/debug/profile.h"
#include "sim/h8s/debug/trace.h"
#include "tools/base/output_file.h"

namespace kaz::tools {
namespace {

Result<std::uint32_t> address_of(const h8s::SymbolTable& symbols, const std::string& text) {
  if (const auto at = symbols.address_of(text)) return *at;
  if (text.starts_with("0x") && text.size() > 2 &&
      text.find_first_not_of("0123456789abcdefABCDEF", 2) == std::string::npos && text.size() < 9)
    return static_cast<std::uint32_t>(std::stoul(text, nullptr, 16));
  return fail(Fault::usage,
              "--tick: the image has no symbol '" + text +
                  "'; give a symbol of a COFF or ELF image or an address such as 0x1234");
}

// To standard error without a file.
Result<void> write(std::optional<OutputFile>& file, const std::string& text) {
  if (file) return file->write(text);
  std::fputs(text.c_str(), stderr);
  return {};
}

// None for standard error, or if not wanted.
Result<std::optional<OutputFile>> open_file(const std::string& path, const std::string& option) {
  if (path.empty() || path == "-") return std::nullopt;
  return OutputFile::open(path, option);
}

}  // namespace

struct McuDebug::Parts {
  h8s::Chip& chip;
  McuDebugOptions options;
  std::optional<OutputFile> trace_file, profile_file, coverage_file;
  std::ofstream trace_stream;
  std::optional<h8s::Trace> trace;
  std::optional<h8s::Profile> profile;
  std::optional<h8s::Coverage> coverage;
  std::optional<h8s::UninitialisedReads> fresh;
  std::optional<h8s::StackMeter> stack;

  template <class Visit>
  void each(Visit visit) {
    if (trace) visit(*trace);
    if (profile) visit(*profile);
    if (coverage) visit(*coverage);
    if (fresh) visit(*fresh);
    if (stack) visit(*stack);
  }
};

McuDebug::McuDebug(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

McuDebug::~McuDebug() {
  parts_->each([this](h8s::Observer& o) { parts_->chip.detach(o); });
}

Result<std::unique_ptr<McuDebug>> McuDebug::attach(h8s::Chip& chip, const h8s::SymbolTable& symbols,
                                                   const McuDebugOptions& options) {
  auto parts = std::unique_ptr<Parts>(new Parts{chip, options, {}, {}, {}, {}, {}, {}, {}, {}, {}});
  parts->trace_file = KAZ_TRY(open_file(options.trace, "--trace"));
  parts->profile_file = KAZ_TRY(open_file(options.profile, "--profile"));
  parts->coverage_file = KAZ_TRY(open_file(options.coverage, "--coverage"));
  if (options.trace == "-") {
    parts->trace.emplace(chip, std::cerr);
  } else if (!options.trace.empty()) {
    parts->trace_stream.open(parts->trace_file->part());
    parts->trace.emplace(chip, parts->trace_stream);
  }
  if (!options.profile.empty()) {
    std::optional<h8s::ProfileWindow> window;
    if (!options.tick.empty()) {
      const std::size_t comma = options.tick.find(',');
      if (comma == std::string::npos)
        return fail(Fault::usage, "--tick: give two labels, BEGIN,END, not '" + options.tick + "'");
      const auto begin = KAZ_TRY(address_of(symbols, options.tick.substr(0, comma)));
      const auto end = KAZ_TRY(address_of(symbols, options.tick.substr(comma + 1)));
      window = h8s::ProfileWindow{begin, end};
    }
    parts->profile.emplace(chip, window);
  }
  if (!options.coverage.empty()) {
    if (symbols.symbols().empty())
      return fail(Fault::usage, "--coverage needs symbols: give a COFF or ELF image");
    parts->coverage.emplace(chip);
  }
  if (options.check_uninitialised) parts->fresh.emplace(chip);
  if (options.stack) parts->stack.emplace(chip);
  parts->each([&](h8s::Observer& o) { chip.attach(o); });
  return std::unique_ptr<McuDebug>(new McuDebug(std::move(parts)));
}

Result<void> McuDebug::report() {
  Parts& p = *parts_;
  if (p.profile) {
    const std::string& format = p.options.profile_format;
    const auto written = write(p.profile_file, format == "json"        ? p.profile->json()
                                               : format == "callgrind" ? p.profile->callgrind()
                                                                       : p.profile->text());
    if (!written) return written;
  }
  if (p.coverage) {
    const auto written = write(p.coverage_file, p.coverage->lcov());
    if (!written) return written;
    std::fputs(p.coverage->text().c_str(), stderr);
  }
  if (p.fresh) std::fputs(p.fresh->text().c_str(), stderr);
  if (p.stack) std::fputs(p.stack->text().c_str(), stderr);
  if (p.trace_file) {
    p.trace_stream.close();
    if (!p.trace_stream) return tl::unexpected(p.trace_file->failure());
    return p.trace_file->commit();
  }
  return {};
}

Result<bool> serve_gdb(h8s::Chip& chip, const std::string& where, int stop) {
  auto port = h8s::GdbPort::open(where);
  if (!port) return fail(Fault::usage, "--gdb: " + port.error().message);
  std::fprintf(stderr, "waiting for GDB: %s\n", port->hint().c_str());
  h8s::GdbServer server(chip);
  const auto served = port->serve(server, 1'000'000, stop, [](const std::string& line) {
    std::fprintf(stderr, "%s\n", line.c_str());
  });
  if (!served) return fail(Fault::environment, served.error().message);
  return true;
}

}  // namespace kaz::tools
