// `kaz mcu run --flat`: programs that need no board, on the CPU in 16 MiB of RAM.
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <nlohmann/json.hpp>

#include "shared/base/counted.hpp"
#include "sim/h8s/flat/flat.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/mcu/run.h"

namespace kaz::tools {
namespace {

using Reason = h8s::FlatStop::Reason;

// The status of an end that is not the program's own, as of a command that could not be run.
constexpr int kNotTheProgram = 125;

const char* name_of(Reason reason) {
  switch (reason) {
    case Reason::reached:
      return "reached the limit";
    case Reason::exited:
      return "exited";
    case Reason::asleep:
      return "asleep without a wake-up source";
    case Reason::undefined_instruction:
      return "undefined instruction";
    case Reason::odd_pc:
      return "instruction at an odd address";
    case Reason::bad_request:
      return "invalid request to the host";
    case Reason::output_failed:
      return "output cannot be written";
  }
  return "unknown";
}

class FlatRun {
 public:
  explicit FlatRun(const McuRunOptions& options)
      : options_(options), flat_({options.engine, options.semihost}) {}

  Result<ExitStatus> run(const h8s::Image& image) {
    if (const auto loaded = flat_.load(image); !loaded)
      return fail(Fault::usage, options_.image + ": " + loaded.error().message);
    const InterruptSignals signals(interrupt_);
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of writing
    flat_.on_output([this](int stream, std::span<const std::uint8_t> bytes) {
      return write(stream == 2 ? stderr : stdout, bytes);
    });
    h8s::FlatStop stop = run_pieces();
    flush();
    if (!write_error_.empty()) {
      stop.reason = Reason::output_failed;
      stop.text = "cannot write standard output: " + write_error_ +
                  stop.text.substr(std::min(stop.text.find(": PC"), stop.text.size()));
    }
    const bool interrupted = interrupt_.requested() && stop.reason == Reason::reached;
    if (stop.reason == Reason::reached && !interrupted) stop.text = limit_text(stop.text);
    auto ended =
        options_.semihost && !interrupted ? end_of_program(stop) : end_of_run(stop, interrupted);
    if (!interrupted) return ended;
    return fail(Fault::interrupted, "interrupted; the output covers the run until then");
  }

 private:
  bool write(std::FILE* stream, std::span<const std::uint8_t> bytes) {
    if (stream == stderr) flush();  // in the order of the program
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size())
      write_error_ = std::strerror(errno);
    return write_error_.empty();
  }

  void flush() {
    if (std::fflush(stdout) != 0 && write_error_.empty()) write_error_ = std::strerror(errno);
  }

  // In pieces, so that what was written is seen soon and a long run shows that it is alive.
  h8s::FlatStop run_pieces() {
    constexpr h8s::States kPiece = 5'000'000;
    Progress progress("kaz mcu run", options_.semihost || options_.json || !isatty(STDERR_FILENO));
    const h8s::States until = options_.max_states.value_or(h8s::Flat::kNoLimit);
    const std::int64_t count = options_.max_insns.value_or(h8s::Flat::kNoLimit);
    for (;;) {
      const h8s::States left = until - flat_.now();
      const h8s::FlatStop stop = flat_.run(left > kPiece ? flat_.now() + kPiece : until, count);
      flush();
      if (!write_error_.empty() || stop.reason != Reason::reached || flat_.now() >= until ||
          flat_.instructions() >= count || interrupt_.requested())
        return stop;
      if (options_.max_states && until > 400 * kPiece)
        progress.update(static_cast<double>(flat_.now()) / static_cast<double>(until), "");
    }
  }

  // "stopped after 10 instructions (--max-insns): PC ...".
  std::string limit_text(const std::string& text) const {
    const bool by_count = options_.max_insns && flat_.instructions() >= *options_.max_insns;
    return "stopped after " +
           (by_count ? counted(flat_.instructions(), "instruction") + " (--max-insns)"
                     : counted(flat_.now(), "state") + " (--max-states)") +
           text.substr(std::min(text.find(": PC"), text.size()));
  }

  void print_counts() {
    if (!options_.count) return;
    std::fprintf(stderr, "insns=%lld\nstates=%lld\n", static_cast<long long>(flat_.instructions()),
                 static_cast<long long>(flat_.now()));
  }

  Result<ExitStatus> end_of_program(const h8s::FlatStop& stop) {
    if (stop.reason != Reason::exited) std::fprintf(stderr, "kaz mcu run: %s\n", stop.text.c_str());
    print_counts();
    return ExitStatus::with_status(stop.reason == Reason::exited ? stop.status : kNotTheProgram);
  }

  Result<ExitStatus> end_of_run(const h8s::FlatStop& stop, bool interrupted) {
    const bool done = stop.reason == Reason::reached || stop.reason == Reason::asleep;
    if (options_.json) {
      nlohmann::ordered_json result{{"stop", interrupted ? "interrupted" : name_of(stop.reason)},
                                    {"states", flat_.now()},
                                    {"insns", flat_.instructions()},
                                    {"pc", stop.pc},
                                    {"report", stop.text},
                                    {"provenance", provenance_json()}};
      if (interrupted) mark_interrupted(result);
      print_json(result);
    } else if (!interrupted || !stop.text.empty()) {
      std::fprintf(stderr, "%s%s\n", done ? "" : "kaz mcu run: ", stop.text.c_str());
    }
    print_counts();
    return done;
  }

  const McuRunOptions& options_;
  host::Interrupt interrupt_;
  h8s::Flat flat_;
  std::string write_error_;
};

}  // namespace

Result<ExitStatus> run_flat(const McuRunOptions& options, const h8s::Image& image) {
  return FlatRun(options).run(image);
}

}  // namespace kaz::tools
