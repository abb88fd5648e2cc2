// `kaz conformance`: the protocol certificate of a board, case by case.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board/conformance.h"

#include <algorithm>
#include <cstdio>
#include <tuple>

#include <nlohmann/json.hpp>

#include "hil/bus/bus_suite.h"
#include "hil/conformance/report.h"
#include "host/link/interrupt.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "shared/base/counted.hpp"
#include "shared/base/files.hpp"
#include "sim/mcu/mcu.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"
#include "tools/base/time_lost.h"
#include "tools/base/version.h"
#include "tools/kept/kept_run.h"
#include "tools/lockstep/virtual_bench.h"

namespace kaz::tools {
namespace {

// How late a byte may be read or written through a port of this machine.
constexpr Time kPortSlack = std::chrono::milliseconds(20);

std::vector<std::string> needs_of(const hil::Case& one) {
  std::vector<std::string> words;
  // A bus's cases have needs of their own.
  for (const auto family : {hil::ServoFamily::feetech, hil::ServoFamily::dynamixel}) {
    for (const hil::ServoCase& servo : hil::servo_cases(family)) {
      if (&servo.of != &one) continue;
      for (const auto& [need, word] :
           {std::pair(hil::kServoMotion, "motion"), std::pair(hil::kServoEeprom, "eeprom"),
            std::pair(hil::kServoAlone, "alone"), std::pair(hil::kServoNever, "never run")})
        if ((servo.needs & need) != 0) words.emplace_back(word);
    }
  }
  for (const auto& [need, word] :
       {std::pair(hil::kMotion, "motion"), std::pair(hil::kFlash, "flash"),
        std::pair(hil::kBench, "bench"), std::pair(hil::kExact, "exact clock"),
        std::pair(hil::kDefaultAddress, "default address"),
        std::pair(hil::kPauses, "pauses between bytes")}) {
    if (one.needs & need) words.emplace_back(word);
  }
  return words;
}

// As the entries of the report's `results`, and what each needs.
std::string list_json(const std::vector<const hil::Case*>& taken) {
  auto all = nlohmann::ordered_json::array();
  for (const hil::Case* one : taken)
    all.push_back({{"id", one->id},
                   {"sentence", one->sentence},
                   {"statements", one->statements},
                   {"needs", needs_of(*one)}});
  return all.dump(2) + "\n";
}

Result<void> list_cases(const std::vector<const hil::Case*>& taken, const std::string& json) {
  if (json == "-") {
    std::fputs(list_json(taken).c_str(), stdout);
    return {};
  }
  if (!json.empty()) {
    auto file = KAZ_TRY(OutputFile::open(json, "--json"));
    return file.write(list_json(taken));
  }
  for (const hil::Case* one : taken) {
    std::string about;
    for (const std::string& id : one->statements) about += (about.empty() ? "" : ",") + id;
    char columns[200];
    std::snprintf(columns, sizeof columns, "%-36s %-14s ", one->id.c_str(), about.c_str());
    std::fputs(list_row(columns, one->sentence, list_width()).c_str(), stdout);
  }
  return {};
}

// The reports' files, opened before anything runs.
class Reports {
 public:
  static Result<Reports> open(const ConformanceOptions& arguments) {
    Reports reports;
    int on_output = 0;
    for (const auto& [option, path] :
         {std::pair("--junit", &arguments.junit), std::pair("--json", &arguments.json),
          std::pair("--html", &arguments.html)}) {
      if (*path == "-") ++on_output;
      std::optional<OutputFile> file;
      if (!path->empty() && *path != "-") file = KAZ_TRY(OutputFile::open(*path, option));
      reports.all_.push_back({*path == "-", std::move(file)});
    }
    if (on_output > 1)
      return fail(Fault::usage, "only one of --junit, --json and --html can go to standard output");
    return reports;
  }

  bool any() const {
    return std::ranges::any_of(all_, [](const One& one) { return one.on_output || one.file; });
  }

  // All that can be written; the error is that of the first that cannot.
  Result<void> write(const hil::RunReport& report, const hil::ReportFacts& facts) {
    Result<void> written;
    const std::string texts[] = {hil::junit_text(report, facts), hil::json_text(report, facts),
                                 hil::html_text(report, facts)};
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (all_[i].on_output) std::fputs(texts[i].c_str(), stdout);
      if (all_[i].file) written = together(std::move(written), all_[i].file->write(texts[i]));
    }
    return written;
  }

 private:
  struct One {
    bool on_output;
    std::optional<OutputFile> file;
  };
  std::vector<One> all_;
};

void say(const hil::CaseResult& one) {
  char columns[120];
  std::snprintf(columns, sizeof columns, "%-9s %-36s ", verdict_text(one.verdict),
                one.of->id.c_str());
  std::fputs(list_row(columns, one.verdict == hil::Verdict::passed ? one.of->sentence : one.message,
                      list_width())
                 .c_str(),
             stdout);
  if (one.runs > 1 && one.verdict != hil::Verdict::undecided)
    std::printf("          ran %d times, because this machine was late in the earlier runs\n",
                one.runs);
  if (one.verdict == hil::Verdict::failed) {
    for (const std::string& id : one.of->statements) {
      for (const hil::Statement& statement : hil::statements()) {
        if (statement.id == id)
          print_lines("          %s: %s\n", id.c_str(), statement.text.c_str());
      }
    }
  }
}

Result<hil::RunReport> run_virtual(ConformanceOptions& arguments, hil::ReportFacts& facts,
                                   host::Interrupt& interrupt) {
  std::unique_ptr<sim::Mcu> mcu;
  if (arguments.mcu == sim::McuKind::h8) {
    const auto image = KAZ_TRY(firmware_image(arguments.image));
    auto made = KAZ_TRY(sim::make_h8(image));
    mcu = std::move(made);
  } else {
    mcu = sim::make_native();
  }
  lockstep::VirtualBench board(std::move(mcu));
  facts.port = board.name();
  InterruptibleClock clock(board, interrupt);
  InterruptibleLink link(board, board, interrupt);
  return hil::run_suite(link, clock, &board, Time::zero(), arguments.run);
}

Result<hil::RunReport> run_port(ConformanceOptions& arguments, hil::ReportFacts& facts,
                                host::Interrupt& interrupt) {
  const auto port = KAZ_TRY(parse_port(arguments.port));
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  facts.port = port.name();
  host::LatenessMeter meter(*link, clock, time_lost_behind(port.name(), interrupt));
  arguments.run.lateness = &meter;
  arguments.run.address = arguments.address;
  const auto kept = KAZ_TRY(KeptRun::begin(*link, clock, interrupt,
                                           {.verb = "kaz conformance",
                                            .port = port.name(),
                                            .address = arguments.address,
                                            .flash = arguments.allow_flash,
                                            .reset = true,
                                            .alone = true}));
  if (kept->before().shared_line)
    return fail(Fault::environment,
                "the board on " + port.name() +
                    " is set to share its line and therefore refuses telemetry, which the suite "
                    "needs: if the board is alone on its line, give `kaz recover " +
                    host::robot_option(port.name()) + " --address " +
                    std::to_string(arguments.address) + " --shared-line off`");
  auto report = hil::run_suite(meter, meter, nullptr, kPortSlack, arguments.run);
  auto left = kept->end();
  if (report && report->interrupted && !left) {
    // The results until then are kept all the same.
    std::fprintf(stderr, "kaz conformance: %s\n", left.error().message.c_str());
    return report;
  }
  return together(std::move(report), left);
}

hil::ServoFamily family_of(servo_bus::Protocol protocol) {
  return protocol == servo_bus::Protocol::feetech ? hil::ServoFamily::feetech
                                                  : hil::ServoFamily::dynamixel;
}

hil::BusRunOptions bus_run(const ConformanceOptions& arguments) {
  hil::BusRunOptions run;
  run.family = family_of(*arguments.bus);
  run.id = arguments.id;
  run.filter = arguments.run.filter;
  run.allowed = (arguments.allow_motion ? hil::kServoMotion : 0U) |
                (arguments.allow_eeprom ? hil::kServoEeprom : 0U) |
                (arguments.alone ? hil::kServoAlone : 0U);
  run.release = arguments.release;
  return run;
}

Result<hil::RunReport> run_bus(ConformanceOptions& arguments, hil::ReportFacts& facts,
                               host::Interrupt& interrupt) {
  const auto port = KAZ_TRY(parse_one_bus(arguments.port, arguments.bus, arguments.baud)).port;
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  facts.port = port.name();
  host::LatenessMeter meter(*link, clock, time_lost_behind(port.name(), interrupt));
  hil::BusRunOptions run = bus_run(arguments);
  run.interrupt = &interrupt;
  run.lateness = &meter;
  run.progress = arguments.run.progress;
  // A second Ctrl-C ends the program at once.
  leaves_behind("a conformance case may have left changed values in the registers of servo " +
                std::to_string(arguments.id) + " on " + port.name() +
                ": switch the servo's supply off and on" +
                (arguments.allow_eeprom ? ", and check the values in the servo's EEPROM" : ""));
  auto report = hil::run_bus_suite(meter, meter, run);
  leaves_behind("");
  return report;
}

// Cases of the board's suite or of a bus's, as the reports have them.
Result<std::vector<const hil::Case*>> taken_by(const ConformanceOptions& arguments) {
  if (!arguments.bus) return hil::chosen(arguments.run.filter);
  const auto cases = KAZ_TRY(hil::chosen(family_of(*arguments.bus), arguments.run.filter));
  const unsigned allowed = bus_run(arguments).allowed;
  unsigned missing = 0;
  bool some_can_run = false;
  std::vector<const hil::Case*> taken;
  for (const hil::ServoCase* one : cases) {
    taken.push_back(&one->of);
    missing |= one->needs & ~allowed;
    some_can_run = some_can_run || (one->needs & ~allowed) == 0;
  }
  if (!some_can_run && !arguments.list)
    return fail(Fault::usage,
                "no case that --filter " + arguments.run.filter +
                    " selects can run here (reason: " + hil::missing_servo_text(missing) +
                    "); `kaz conformance --bus PROTOCOL --list` lists all cases of the protocol");
  return taken;
}

// Of the cases that a filter takes none may be left: that nothing failed would then be no result.
Result<void> check_needs(const std::vector<const hil::Case*>& taken, unsigned allowed,
                         const std::string& filter) {
  unsigned missing = 0;
  for (const hil::Case* one : taken) {
    if ((one->needs & ~allowed) == 0) return {};
    missing |= one->needs & ~allowed;
  }
  return fail(Fault::usage, "no case that --filter " + filter +
                                " selects can run here (reason: " + hil::missing_text(missing) +
                                "); `kaz conformance --list` lists all cases");
}

// 3 where cases are undecided: neither the board nor its protocol is to blame.
ExitStatus exit_status_of(const hil::RunReport& report) {
  if (report.count(hil::Verdict::failed) > 0) return false;
  const int undecided = report.count(hil::Verdict::undecided);
  if (undecided == 0) return true;
  std::fprintf(
      stderr,
      "kaz conformance: this machine was too slow to judge %s; end other programs and run %s "
      "again\n",
      counted(undecided, "case").c_str(), undecided == 1 ? "it" : "them");
  return ExitStatus::with_status(static_cast<int>(Fault::environment));
}

}  // namespace

Result<ExitStatus> run_conformance(ConformanceOptions arguments) {
  const auto taken = KAZ_TRY(taken_by(arguments));
  if (arguments.list) {
    KAZ_TRY(list_cases(taken, arguments.json));
    return ExitStatus(true);
  }
  if (arguments.bus && arguments.port.empty())
    return fail(Fault::usage,
                "--robot is missing: give the servo's bus, such as feetech:/dev/ttyACM0 (kaz bus "
                "scan finds servos)");
  if (arguments.port.empty() != arguments.mcu.has_value()) {
    return fail(Fault::usage,
                "the board is missing; give either --robot KIND:PATH or --virtual h8|native");
  }
  if (!arguments.image.empty() && arguments.mcu != sim::McuKind::h8)
    return fail(Fault::usage, "--image is only valid with --virtual h8");
  for (const auto& [option, given] : {std::pair("--allow-motion", arguments.allow_motion),
                                      {"--allow-flash", arguments.allow_flash}}) {
    if (given && arguments.mcu)
      return fail(Fault::usage, std::string(option) +
                                    " is only valid with a board at a port, because every case "
                                    "runs on a virtual board; leave it out");
  }
  if (arguments.allow_motion) arguments.run.allowed |= hil::kMotion;
  if (arguments.allow_flash) arguments.run.allowed |= hil::kFlash;
  if (arguments.mcu) arguments.run.allowed = hil::kMotion | hil::kFlash | hil::kBench | hil::kExact;
  if (!arguments.port.empty() && !arguments.bus)
    arguments.run.whole_frames = KAZ_TRY(parse_port(arguments.port)).kind == host::PortKind::can;
  const unsigned line = (arguments.address == KZ_ADDRESS_DEFAULT ? hil::kDefaultAddress : 0U) |
                        (arguments.run.whole_frames ? 0U : hil::kPauses);
  if (!arguments.bus)
    KAZ_TRY(check_needs(taken, arguments.run.allowed | line, arguments.run.filter));
  auto reports = KAZ_TRY(Reports::open(arguments));
  const bool quiet = arguments.json == "-" || arguments.junit == "-" || arguments.html == "-";
  hil::ReportFacts facts;
  facts.program = std::string("kaz ") + kVersion;
  facts.seed = arguments.run.seed;
  facts.from = provenance();
  Progress progress("kaz conformance", quiet);
  hil::RunReport until_lost;
  arguments.run.progress = [&](const hil::CaseResult& one, std::size_t number, std::size_t of) {
    until_lost.results.push_back(one);
    if (!quiet) {
      progress.done();
      say(one);
    }
    progress.update(static_cast<double>(number) / static_cast<double>(of), one.of->id);
  };
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto report = arguments.bus            ? run_bus(arguments, facts, interrupt)
                      : arguments.port.empty() ? run_virtual(arguments, facts, interrupt)
                                               : run_port(arguments, facts, interrupt);
  progress.done();
  if (!report) {
    facts.broken_off = report.error().message;
    until_lost.not_run.assign(
        taken.begin() + static_cast<std::ptrdiff_t>(until_lost.results.size()), taken.end());
    // The first error is the one to print, also if its reports cannot be written.
    if (report.error().fault == Fault::environment) (void)reports.write(until_lost, facts);
    return tl::unexpected(report.error());
  }
  if (report->interrupted) facts.signal = received_signal_name();
  KAZ_TRY(reports.write(*report, facts));
  if (!quiet) {
    const char* board = report->board.empty() ? "not identified" : report->board.c_str();
    print_lines("%s on %s: %s, %d passed, %d failed, %d left out, %d undecided\n", board,
                facts.port.c_str(), counted(report->results.size(), "case").c_str(),
                report->count(hil::Verdict::passed), report->count(hil::Verdict::failed),
                report->count(hil::Verdict::left_out), report->count(hil::Verdict::undecided));
  }
  if (report->interrupted)
    return fail(Fault::interrupted,
                "interrupted after " + std::to_string(report->results.size()) + " of " +
                    counted(report->chosen(), "case") +
                    (reports.any() ? "; the reports cover the completed cases" : ""));
  return exit_status_of(*report);
}

}  // namespace kaz::tools
