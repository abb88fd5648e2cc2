// `kaz fuzz`: cases for a board from a seed and a corpus, each judged.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/campaign.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "hil/fuzz/requests.h"
#include "hil/fuzz/runner.h"
#include "hil/fuzz/search.h"
#include "host/link/faulty_link.h"
#include "host/link/lateness.h"
#include "host/link/port_link.h"
#include "host/link/requester.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "shared/base/counted.hpp"
#include "shared/base/enum_names.hpp"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"
#include "tools/base/suggestion.h"
#include "tools/base/time_lost.h"
#include "tools/fuzz/engine_case.h"
#include "tools/kept/kept_run.h"

namespace kaz::tools {
namespace {

using hil::fuzz::CaseVerdict;
using hil::fuzz::Genome;

using WallTime = std::chrono::steady_clock;

struct Totals {
  long long cases = 0, broken_off = 0, shortening = 0;  // begun, not ended; of the cases
  long long ticks = 0, requests = 0, replies = 0, refusals = 0, damaged = 0;
  double board_s = 0, worst_overshoot_rad = 0;
  std::uint16_t worst_busy_8states = 0;
  std::string emulator_engine;
  long long instructions = 0, translated_instructions = 0;
};

// A board at a port: cases one after the other, each begins with the motors off.
class PortTarget {
 public:
  static Result<std::unique_ptr<PortTarget>> open(const FuzzOptions& options,
                                                  host::Interrupt& interrupt) {
    const auto address = KAZ_TRY(parse_port(options.target));
    auto link = KAZ_TRY(host::open_port(address, &interrupt));
    std::unique_ptr<PortTarget> port(new PortTarget(std::move(link), options, interrupt));
    auto kept = KAZ_TRY(KeptRun::begin(*port->link_, port->clock_, interrupt,
                                       {.verb = "kaz fuzz",
                                        .port = options.target,
                                        .address = options.address,
                                        .flash = options.wear_flash,
                                        .reset = true,
                                        .alone = true}));
    port->kept_ = std::move(kept);
    return port;
  }
  // Of the last case, if an error ended it.
  CaseVerdict broken_off;
  // The board is afterwards as it was found.
  Result<void> end() { return kept_->end(); }
  // A violation is one where this machine and the program at the other end were punctual.
  Result<CaseVerdict> run(const Genome& genome, const hil::fuzz::GrammarOptions& grammar) {
    for (int again = host::LatenessMeter::kRepetitions;; --again) {
      if (options_.wear_flash) {
        KAZ_TRY(bring_home());
      }
      if (was_late_) {
        KAZ_TRY(silence());
      }
      meter_.begin();
      auto verdict = run_once(genome, grammar);
      if (!verdict) return verdict;
      const std::string excuse = meter_.excuse();
      was_late_ = !excuse.empty();
      if (!verdict->violation || !was_late_) return verdict;
      // Also the reply to whether the other end was late is not waited for any longer.
      if (interrupt_.requested()) return tl::unexpected(host::Interrupt::error());
      if (again == 0 || meter_.other_end_gone())
        return fail(Fault::environment,
                    "the result of a case is not decided (" + *verdict->violation + "): " + excuse);
    }
  }

 private:
  Result<CaseVerdict> run_once(const Genome& genome, const hil::fuzz::GrammarOptions& grammar) {
    host::FaultyLink faulty(meter_, meter_, {}, seed_);
    hil::fuzz::RunnerOptions runner;
    runner.patience = std::chrono::milliseconds(200);
    runner.address = options_.address;
    runner.broken_off = &broken_off;
    runner.fault = [&](faults::Fault fault) {
      fault.at = faulty.age();
      faulty.add(fault);
    };
    return hil::fuzz::run_case(faulty, meter_, hil::fuzz::events_of(genome, grammar), runner);
  }

  PortTarget(std::unique_ptr<host::PortLink> link, const FuzzOptions& options,
             host::Interrupt& interrupt)
      : link_(std::move(link)),
        interrupt_(interrupt),
        clock_(&interrupt),
        meter_(*link_, clock_, time_lost_behind(link_->name(), interrupt)),
        options_(options),
        seed_(options.seed) {}

  // The board may answer a late case's requests only now, or still send its telemetry. Waits for the answer
  // to a later request and then for silence, 3 s at most: the next case counts its own replies alone.
  Result<void> silence() {
    constexpr auto kSilence = std::chrono::milliseconds(100);
    const Time until = clock_.now() + std::chrono::seconds(3);
    const std::vector<std::uint8_t> off{0, 0, 0};
    KAZ_TRY(link_->write(hil::fuzz::framed(options_.address, KZ_TYPE_telemetry, 0, off)));
    host::Requester requester(*link_, clock_, {.address = options_.address});
    while (!host::identify_board(requester)) {
      if (interrupt_.requested()) return tl::unexpected(host::Interrupt::error());
      if (!requester.timed_out() || clock_.now() >= until) return {};
    }
    std::array<std::uint8_t, 1024> late{};
    while (clock_.now() < until) {
      if (KAZ_TRY(link_->read(late, clock_.now() + kSilence)) == 0) break;
    }
    return {};
  }

  // A case before may have moved the board to another address.
  Result<void> bring_home() {
    if (!ran_) {
      ran_ = true;
      return {};
    }
    host::Requester requester(*link_, clock_, {.address = options_.address});
    if (host::identify_board(requester)) return {};
    if (!requester.timed_out()) return {};  // the case reports that the port is gone
    return kept_->put_back();
  }

  std::unique_ptr<host::PortLink> link_;
  const host::Interrupt& interrupt_;
  host::WallClock clock_;
  host::LatenessMeter meter_;
  const FuzzOptions& options_;
  std::uint64_t seed_;
  bool ran_ = false;
  bool was_late_ = false;          // the last case
  std::unique_ptr<KeptRun> kept_;  // goes before its link
};

class Fuzzing {
 public:
  explicit Fuzzing(const FuzzOptions& arguments) : arguments_(arguments) {}

  Result<bool> run() {
    const InterruptSignals signals(interrupt_);
    auto ran = run_cases();
    return port_ ? together(std::move(ran), port_->end()) : ran;
  }

 private:
  Result<bool> run_cases() {
    // Not only when there is something to keep.
    if (arguments_.replay.empty())
      out_ = KAZ_TRY(OutputFile::open(arguments_.out, "--out", Existing::keep));
    Genome replayed;
    if (!arguments_.replay.empty()) replayed = KAZ_TRY(replayed_case());
    KAZ_TRY(prepare());
    began_ = WallTime::now();
    if (!arguments_.replay.empty()) return replay(replayed);
    hil::fuzz::Search search(arguments_.seed);
    if (auto loaded = load(search); !loaded) return ended(loaded.error(), search);
    if (failing_) return report_failure(*failing_, search);
    Progress progress("kaz fuzz", arguments_.json);
    const auto started = WallTime::now();  // without the corpus
    const auto elapsed = [&] {
      return std::chrono::duration<double>(WallTime::now() - started).count();
    };
    while (arguments_.cases > 0 ? totals_.cases < arguments_.cases
                                : elapsed() < arguments_.seconds) {
      const Genome genome = search.next();
      const auto ran = one(genome);
      if (!ran) {
        progress.done();
        return ended(ran.error(), search);
      }
      const CaseVerdict& verdict = *ran;
      if (verdict.violation) {
        progress.done();
        return report_failure(genome, search);
      }
      if (search.learn(genome, verdict) && !arguments_.corpus.empty()) {
        const std::string name = arguments_.corpus + "/" + std::to_string(arguments_.seed) + "-" +
                                 std::to_string(totals_.cases);
        if (const auto saved = hil::fuzz::save_genome(name, genome); !saved) {
          progress.done();
          return ended(saved.error(), search);
        }
      }
      const double share = arguments_.cases > 0 ? static_cast<double>(totals_.cases) /
                                                      static_cast<double>(arguments_.cases)
                                                : elapsed() / arguments_.seconds;
      progress.update(std::min(share, 1.0), counted(totals_.cases, "case") + ", " +
                                                counted(search.features(), "feature"));
    }
    progress.update(1, "done");
    progress.done();
    if (totals_.cases == 0)
      return interrupt_.requested() ? fail(Fault::interrupted, "interrupted before the first case")
                                    : fail(Fault::usage,
                                           "--seconds is too short for a single case; give more "
                                           "seconds, or give --cases");
    report(search, std::nullopt, "");
    return true;
  }

  // Before --allow-motion is spoken of: nobody shall add it because of a mistyped name.
  Result<void> check_port() const {
    const std::string& path = arguments_.target;
    std::error_code none;
    if (std::filesystem::exists(path, none)) return {};
    const auto address = KAZ_TRY(parse_port(path));
    auto opened = host::open_port(address, &interrupt_);
    if (opened) return {};
    Error error = opened.error();
    error.message += suggestion(path, enum_names(sim::kMcuKinds));
    return tl::unexpected(std::move(error));
  }

  // Rejects options without effect on this target, and motion without --allow-motion.
  Result<void> check_options(std::optional<sim::McuKind> mcu) const {
    if (!arguments_.image.empty() && mcu != sim::McuKind::h8)
      return fail(Fault::usage, "--image is only valid with --target h8");
    if (mcu) {
      const char* const foreign = arguments_.wear_flash                      ? "--wear-flash"
                                  : arguments_.allow_motion                  ? "--allow-motion"
                                  : arguments_.address != KZ_ADDRESS_DEFAULT ? "--address"
                                                                             : nullptr;
      if (foreign == nullptr) return {};
      return fail(Fault::usage,
                  std::string(foreign) + " is only valid with a board at a port: --target PATH");
    }
    if (arguments_.body)
      return fail(Fault::usage, "--body needs the simulator: give --target native or h8");
    KAZ_TRY(check_port());
    if (arguments_.seed_given && !arguments_.replay.empty())
      return fail(Fault::usage,
                  "--seed is not valid if a case is replayed at a port; leave --seed out, or use "
                  "--target native or h8, which have random noise and faults");
    if (!arguments_.allow_motion)
      return fail(Fault::usage, "kaz fuzz moves the joints of the robot at " + arguments_.target +
                                    " at random: hang up the robot or disconnect the motors' "
                                    "supply, then give --allow-motion");
    return {};
  }

  Result<void> prepare() {
    const auto mcu = parse_enum(sim::kMcuKinds, arguments_.target);
    KAZ_TRY(check_options(mcu));
    if (!mcu) {  // a port
      grammar_.faults = false;
      grammar_.flash = arguments_.wear_flash;
      grammar_.address = arguments_.address;
      auto port = KAZ_TRY(PortTarget::open(arguments_, interrupt_));
      port_ = std::move(port);
      return {};
    }
    engine_.mcu = *mcu;
    engine_.seed = arguments_.seed;
    if (engine_.mcu == sim::McuKind::h8) {
      auto image = KAZ_TRY(firmware_image(arguments_.image));
      engine_.image = image;
    }
    if (arguments_.body) {
      auto world = KAZ_TRY(world_file("empty"));
      auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
      engine_.world_path = world;
      engine_.robot_path = robot;
      grammar_.faults = false;
    }
    return {};
  }

  Result<bool> load(hil::fuzz::Search& search) {
    if (arguments_.corpus.empty()) return true;
    std::error_code error;
    std::filesystem::create_directories(arguments_.corpus, error);
    if (error)
      return fail(Fault::usage, "--corpus " + arguments_.corpus + " cannot be created: " +
                                    error.message() + "; give a writable folder");
    if (std::filesystem::exists(arguments_.corpus + "/" + kResultsMark, error))
      return fail(Fault::usage, "--corpus " + arguments_.corpus +
                                    ": a folder of results, which contains no cases; give another "
                                    "folder");
    auto corpus = KAZ_TRY(hil::fuzz::load_corpus(arguments_.corpus));
    for (const Genome& genome : corpus) {
      const auto verdict = KAZ_TRY(one(genome));
      if (verdict.violation) {
        failing_ = genome;
        return true;
      }
      search.learn(genome, verdict);
    }
    return true;
  }

  // An error that ends the run. What was tried until a signal or the machine ended it is reported.
  Result<bool> ended(const Error& error, const hil::fuzz::Search& search) {
    if (error.fault == Fault::environment) broken_off_ = error.message;
    if (error.fault == Fault::environment || error.fault == Fault::interrupted)
      report(search, std::nullopt, "");
    if (error.fault != Fault::interrupted) return tl::unexpected(error);
    return fail(Fault::interrupted,
                totals_.cases == 0
                    ? std::string("interrupted before the first case was complete")
                    : "interrupted after " + counted(totals_.cases, "case") + "; none failed");
  }

  Result<CaseVerdict> one(const Genome& genome) {
    if (interrupt_.requested()) return tl::unexpected(host::Interrupt::error());
    const auto verdict = one_to_its_end(genome);
    if (verdict) ++totals_.cases;
    if (verdict && verdict->violation && first_violation_.empty())
      first_violation_ = *verdict->violation;
    return verdict;
  }

  Result<CaseVerdict> one_to_its_end(const Genome& genome) {
    if (port_) {
      port_->broken_off = {};
      auto verdict = port_->run(genome, grammar_);
      if (!verdict) begun(port_->broken_off);
      count(verdict ? *verdict : port_->broken_off);
      return verdict;
    }
    engine_.grammar = grammar_;
    engine_.interrupt = &interrupt_;
    kaz::fuzz::EngineVerdict broken_off;
    engine_.broken_off = &broken_off;
    auto verdict = kaz::fuzz::run_engine_case(genome, engine_);
    if (!verdict) begun(broken_off);
    count_engine(verdict ? *verdict : broken_off);
    if (!verdict) return tl::unexpected(verdict.error());
    return *verdict;
  }

  void begun(const CaseVerdict& broken_off) {
    if (broken_off.counts.requests + broken_off.counts.damaged > 0) ++totals_.broken_off;
  }

  void count_engine(const kaz::fuzz::EngineVerdict& verdict) {
    count(verdict);
    if (verdict.emulator_engine.empty() && verdict.ticks == 0) return;
    totals_.ticks += verdict.ticks;
    totals_.emulator_engine = verdict.emulator_engine;
    totals_.instructions += verdict.instructions;
    totals_.translated_instructions += verdict.translated_instructions;
    totals_.worst_busy_8states = std::max(totals_.worst_busy_8states, verdict.worst_busy_8states);
    totals_.worst_overshoot_rad =
        std::max(totals_.worst_overshoot_rad, verdict.worst_overshoot_rad);
  }

  void count(const CaseVerdict& verdict) {
    totals_.requests += verdict.counts.requests;
    totals_.replies += verdict.counts.replies;
    totals_.refusals += verdict.counts.refusals;
    totals_.damaged += verdict.counts.damaged;
    totals_.board_s += verdict.seconds;
  }

  Result<bool> report_failure(const Genome& genome, const hil::fuzz::Search& search) {
    const long long found = totals_.cases;
    const auto runner = [this](const Genome& candidate) { return one(candidate); };
    const Genome shorter = hil::fuzz::shortened(genome, runner, port_ ? 20 : 400);
    const auto verdict = one(shorter);
    totals_.shortening = totals_.cases - found;
    const bool interrupted = !verdict && verdict.error().fault == Fault::interrupted;
    // A board at a port need not fail twice.
    const Genome& kept = !verdict || verdict->violation ? shorter : genome;
    if (!verdict && !interrupted) broken_off_ = verdict.error().message;
    const auto written = out_->write({reinterpret_cast<const char*>(kept.data()), kept.size()});
    reproducer_written_ = written.has_value();
    const auto violation = verdict ? verdict->violation : std::optional<std::string>();
    report(search,
           violation.value_or(first_violation_ +
                              (verdict ? "; it did not occur again when the case was repeated"
                                       : "; the case was still being shortened")),
           hil::fuzz::text_of(hil::fuzz::events_of(kept, grammar_)));
    KAZ_TRY(written);
    if (interrupted)
      return fail(
          Fault::interrupted,
          "interrupted while a failing case was shortened; the case is saved in " + arguments_.out);
    if (!verdict)
      return fail(verdict.error().fault,
                  broken_off_ + "; an earlier failing case is saved in " + arguments_.out);
    return false;
  }

  // A case without a byte does nothing: that nothing was wrong would be no result.
  Result<Genome> replayed_case() const {
    auto genome = KAZ_TRY(hil::fuzz::load_genome(arguments_.replay));
    if (genome.empty())
      return fail(Fault::usage, "--replay " + arguments_.replay +
                                    " is empty: give a case that kaz fuzz has written");
    return genome;
  }

  Result<bool> replay(const Genome& genome) {
    const hil::fuzz::Search none(1);
    const auto verdict = one(genome);
    if (!verdict) return ended(verdict.error(), none);
    report(none, verdict->violation, hil::fuzz::text_of(hil::fuzz::events_of(genome, grammar_)));
    return !verdict->violation;
  }

  void report(const hil::fuzz::Search& search, const std::optional<std::string>& violation,
              const std::string& text) const {
    const double seconds = std::chrono::duration<double>(WallTime::now() - began_).count();
    if (arguments_.json) {
      nlohmann::ordered_json json{{"target", arguments_.target},
                                  {"ok", !violation},
                                  {"cases", totals_.cases},
                                  {"cases_broken_off", totals_.broken_off},
                                  {"seconds", seconds},
                                  {"damaged_frames", totals_.damaged},
                                  {"board_s", totals_.board_s},
                                  {"requests", totals_.requests},
                                  {"replies", totals_.replies},
                                  {"refusals", totals_.refusals},
                                  {"corpus", search.corpus().size()},
                                  {"features", search.features()}};
      if (arguments_.replay.empty() || !port_) json["seed"] = arguments_.seed;
      if (totals_.shortening > 0) json["cases_to_shorten"] = totals_.shortening;
      if (totals_.cases == 0 && !violation) json["ok"] = nullptr;  // nothing is decided
      if (interrupt_.requested()) mark_interrupted(json);
      if (!broken_off_.empty()) {
        if (!violation) json["ok"] = nullptr;  // not known
        json["error"] = broken_off_;
      }
      if (!port_) json["ticks"] = totals_.ticks;
      if (engine_.mcu == sim::McuKind::h8) {
        json["worst_tick_8states"] = totals_.worst_busy_8states;
        json["emulator_engine"] = totals_.emulator_engine;
        json["instructions"] = totals_.instructions;
        json["translated_instructions"] = totals_.translated_instructions;
      }
      if (arguments_.body) json["worst_overshoot_rad"] = totals_.worst_overshoot_rad;
      if (violation) {
        json["violation"] = *violation;
        json["case"] = text;
        if (reproducer_written_) json["reproducer"] = arguments_.out;
      }
      json["provenance"] = provenance_json();
      print_json(json);
      return;
    }
    if (!text.empty()) std::printf("%s", text.c_str());
    const std::string part = totals_.broken_off > 0 ? " and part of another case" : "";
    const std::string shortening =
        totals_.shortening > 0
            ? " (" + std::to_string(totals_.shortening) + " to shorten the failing case)"
            : "";
    print_lines(
        "tried: %s%s%s in %.1f s (%.1f s on the board's clock); sent: %s and %lld damaged frames; "
        "received: %lld replies, including %lld refusals\n",
        counted(totals_.cases, "case").c_str(), shortening.c_str(), part.c_str(), seconds,
        totals_.board_s, counted(totals_.requests, "frame").c_str(), totals_.damaged,
        totals_.replies, totals_.refusals);
    if (arguments_.replay.empty())  // which collects none
      print_lines(
          "%s seen (distinct reactions of the board, such as a reply with another status)\n",
          counted(search.features(), "feature").c_str());
    if (engine_.mcu == sim::McuKind::h8 && totals_.instructions > 0)
      print_lines(
          "longest tick: %d of 18432 states; emulator's engine: %s, %.0f %% of instructions as "
          "translated code\n",
          8 * totals_.worst_busy_8states, totals_.emulator_engine.c_str(),
          100.0 * static_cast<double>(totals_.translated_instructions) /
              static_cast<double>(std::max(1LL, totals_.instructions)));
    if (arguments_.body && totals_.worst_overshoot_rad > 0)
      print_lines("largest overshoot past a soft limit: %.4f rad\n", totals_.worst_overshoot_rad);
    else if (arguments_.body)
      std::printf("no joint went past a soft limit\n");
    if (!violation) {
      std::printf("%s%s\n",
                  totals_.cases > 0        ? "no case failed"
                  : totals_.broken_off > 0 ? "no case was complete, so there is no result"
                                           : "no case was run",
                  totals_.cases == 0       ? ""
                  : !broken_off_.empty()   ? " until the run stopped early"
                  : interrupt_.requested() ? " until the run was interrupted"
                                           : "");
      return;
    }
    print_lines("wrong: %s\n", violation->c_str());
    if (arguments_.replay.empty())
      std::printf(
          "The case is in %s; repeat the case with:\n"
          "  kaz fuzz --target %s%s --replay %s\n",
          arguments_.out.c_str(), arguments_.target.c_str(), same_options().c_str(),
          arguments_.out.c_str());
  }

  // Of which the case's course depends, but for --target.
  std::string same_options() const {
    std::string options;
    if (port_) options += " --allow-motion";
    if (arguments_.address != KZ_ADDRESS_DEFAULT)
      options += " --address " + std::to_string(arguments_.address);
    if (arguments_.wear_flash) options += " --wear-flash";
    if (arguments_.body) options += " --body";
    if (!arguments_.image.empty()) options += " --image " + arguments_.image;
    // Of the chances of its faults, and of noise.
    if (!port_ && arguments_.seed != FuzzOptions().seed)
      options += " --seed " + std::to_string(arguments_.seed);
    return options;
  }

  const FuzzOptions& arguments_;
  host::Interrupt interrupt_;
  kaz::fuzz::EngineOptions engine_;
  hil::fuzz::GrammarOptions grammar_;
  std::unique_ptr<PortTarget> port_;
  std::optional<Genome> failing_;
  std::string
      first_violation_;  // of the case that is shortened, which may not fail again at a port
  std::optional<OutputFile> out_;  // of a failing case
  std::string broken_off_;         // why the machine ended the run; empty: it did not
  bool reproducer_written_ = false;
  Totals totals_;
  WallTime::time_point began_{};
};

}  // namespace

Result<bool> fuzz(const FuzzOptions& options) {
  return Fuzzing(options).run();
}

}  // namespace kaz::tools
