// `kaz mcu`: the servo board's chip by itself.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/mcu/compare.h"
#include "tools/mcu/run.h"

namespace kaz::tools {
namespace {

const std::map<std::string, h8s::Engine> kEngines{{"reference", h8s::Engine::reference},
                                                  {"interpreter", h8s::Engine::interpreter},
                                                  {"translator", h8s::Engine::translator}};

constexpr std::int64_t kMaxTicks = 1'000'000'000'000;  // 31 years

struct CompareArguments {
  sim::CompareOptions options;
  sim::WireOptions wire;
  bool on_wire = false;
  bool json = false;
};

void add_wire_options(CLI::App& verb, CompareArguments& arguments) {
  auto* wire = verb.add_flag(
      "--wire", arguments.on_wire,
      "compare the replies of two complete boards on the serial line, instead of the outputs of "
      "single ticks");
  verb.add_option("--conversations", arguments.wire.conversations,
                  "number of conversations of one second each")
      ->transform(whole_number_above_zero(1'000'000'000))
      ->capture_default_str()
      ->type_name("N")
      ->needs(wire);
  verb.add_option("--first", arguments.wire.first, "number of the first conversation")
      ->transform(whole_number())
      ->capture_default_str()
      ->type_name("N")
      ->needs(wire);
  // Of the comparison of ticks; the boards on the line run on the default engine.
  for (const char* name : {"--ticks", "--state-every", "--engine"})
    verb.get_option(name)->excludes(wire);
}

void add_mcu_compare(CLI::App& mcu, Action& action) {
  auto* verb = mcu.add_subcommand("compare",
                                  "check that the native build and the firmware on the emulated h8 "
                                  "give equal outputs in each tick, for equal inputs");
  auto arguments = std::make_shared<CompareArguments>();
  verb->add_option("--ticks", arguments->options.ticks, "number of ticks of 1 ms")
      ->transform(whole_number_above_zero(kMaxTicks))
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--seed", arguments->options.seed,
                   "seed of the host's requests and the potentiometer readings")
      ->transform(whole_number())
      ->capture_default_str()
      ->type_name("N");
  verb->add_option(
          "--state-every", arguments->options.state_every,
          "compare the complete state every N ticks; outputs and pins are compared in every tick")
      ->transform(whole_number_above_zero(kMaxTicks))
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--engine", arguments->options.engine,
                   "engine of the emulator: reference, interpreter or translator. The default in "
                   "all verbs is translator")
      ->transform(one_of(kEngines))
      ->type_name("interpreter|reference|translator");
  verb->add_option(
          "--image", arguments->options.image_path,
          "firmware image (default: the built image). For an S-record image, such as kaz.mot, the "
          "COFF file of the same name (kaz.coff) must be in the folder of the image")
      ->type_name("FILE");
  verb->add_flag("--json", arguments->json, "print the report as JSON, without progress messages");
  verb->footer(
      "The firmware runs in the emulator and receives random requests, valid and invalid. In each "
      "tick, the firmware and the native build get equal inputs, and their outputs and states must "
      "be equal. If the outputs or states differ, Kaz prints the first difference, with the values "
      "of the firmware and of the native build. With --wire, Kaz compares the replies of complete "
      "boards instead of ticks. The default settings take about five seconds; a million ticks with "
      "the translator take a minute.\n"
      "Exit status: 0 equal, 1 different.\n"
      "Examples:\n"
      "  kaz mcu compare\n"
      "  kaz mcu compare --ticks 1000000 --seed 7\n"
      "  kaz mcu compare --ticks 1000000 --engine interpreter\n"
      "  kaz mcu compare --wire --conversations 1000");
  add_wire_options(*verb, *arguments);
  verb->callback([&action, arguments] {
    action = [arguments] {
      if (!arguments->on_wire) return compare_ticks(arguments->options, arguments->json);
      arguments->wire.image_path = arguments->options.image_path;
      arguments->wire.seed = arguments->options.seed;
      return compare_on_wire(arguments->wire, arguments->json);
    };
  });
}

void add_machine_options(CLI::App& verb, McuRunOptions& options) {
  verb.add_flag("--flat", options.flat,
                "emulate only the CPU, with 16 MiB of RAM, and start at the image's entry point");
  verb.add_flag("--semihost", options.semihost,
                "with --flat: accept host calls from the program (docs/howto/h8s-program.md). With "
                "host calls, the program can write text and exit. kaz then exits with the "
                "program's status")
      ->needs("--flat");
  verb.add_flag(
      "--count", options.count,
      "print insns=N (instructions) and states=N (cycles of the chip's clock) at the end, on "
      "standard error");
  verb.add_option("--max-states", options.max_states,
                  "stop after N states; a state is one cycle of the chip's clock (default: one "
                  "second of simulated time, or no limit with --flat)")
      ->transform(whole_number_above_zero())
      ->type_name("N");
  verb.add_option("--max-insns", options.max_insns, "stop after N instructions")
      ->transform(whole_number_above_zero())
      ->type_name("N")
      ->needs("--flat");
  verb.add_option("--engine", options.engine,
                  "engine of the emulator: reference, interpreter or translator (the default)")
      ->transform(one_of(kEngines))
      ->type_name("interpreter|reference|translator");
  verb.add_option("--mode", options.mode,
                  "mode pins: 2 selects advanced mode (24-bit addresses), 3 selects normal mode "
                  "(16-bit addresses)")
      ->check(CLI::IsMember({"2", "3"}).description(""))
      ->type_name("2|3")
      ->capture_default_str()
      ->excludes("--flat");
  verb.add_option("--ram-fill", options.ram_fill, "initial value of each byte of RAM")
      ->check(between(0, 255))
      ->capture_default_str()
      ->excludes("--flat")
      ->type_name("BYTE");
  verb.add_option("--crystal", options.crystal_hz, "frequency of the crystal")
      ->check(between(1e5, 1e8, "Hz"))
      ->default_str(std::to_string(std::llround(options.crystal_hz)))
      ->excludes("--flat")
      ->type_name("HZ");
}

// All of them are for the chip, not for the flat machine.
void add_debug_options(CLI::App& verb, McuDebugOptions& debug) {
  verb.add_flag("--trace{-}", debug.trace,
                "print each instruction and its effects on standard error; --trace=FILE writes the "
                "trace to FILE")
      ->disable_flag_override(false)
      ->excludes("--flat")
      ->type_name("FILE");
  auto* profile =
      verb.add_flag(
              "--profile{-}", debug.profile,
              "at the end, print how many states (clock cycles) each function took, on standard "
              "error; --profile=FILE writes this profile to FILE. Function names need a COFF or "
              "ELF image")
          ->disable_flag_override(false)
          ->excludes("--flat")
          ->type_name("FILE");
  verb.add_option("--profile-format", debug.profile_format,
                  "format of the profile: text, json or callgrind (for KCachegrind)")
      ->check(CLI::IsMember({"text", "json", "callgrind"}).description(""))
      ->type_name("text|json|callgrind")
      ->capture_default_str()
      ->needs(profile);
  verb.add_option("--tick", debug.tick,
                  "two places in the program: the places where each tick begins and ends. Each "
                  "place is an address, or a label of a COFF or ELF image. With --tick, the "
                  "profile also shows the functions of the longest tick")
      ->needs(profile)
      ->type_name("BEGIN,END");
  verb.add_option("--coverage", debug.coverage,
                  "write coverage for lcov to FILE, and print a table per function on standard "
                  "error; needs a COFF or ELF image")
      ->excludes("--flat")
      ->type_name("FILE");
  verb.add_flag("--check-uninitialised", debug.check_uninitialised,
                "report reads of uninitialized RAM")
      ->excludes("--flat");
  verb.add_flag("--stack", debug.stack,
                "report the greatest stack depth and the calls that lead to this depth")
      ->excludes("--flat");
  verb.add_option("--gdb", debug.gdb,
                  "wait for GDB at a TCP port of this machine, a Unix socket (a path with /) or "
                  "standard input and output (-)")
      ->excludes("--flat")
      ->type_name("PORT|PATH|-");
}

void add_bare_run(CLI::App& mcu, Action& action) {
  auto* verb = mcu.add_subcommand("run", "run any image on the emulated chip, without a board");
  auto options = std::make_shared<McuRunOptions>();
  add_image_options(*verb, options->image, options->load, 0xffffff);
  add_machine_options(*verb, *options);
  verb->add_flag("--entry{image}", options->entry,
                 "start at the image's entry point, or at ADDRESS, instead of at the reset vector")
      ->disable_flag_override(false)
      ->type_name("ADDRESS");
  verb->add_option(
          "--input", options->input,
          "send the bytes of FILE to the pin RxD0, at the baud rate that the program sets. If FILE "
          "is '-', send the bytes of standard input")
      ->excludes("--flat")
      ->type_name("FILE");
  verb->add_option(
          "--netlist", options->netlist,
          "file that describes the parts connected to the chip (docs/howto/h8s-program.md)")
      ->excludes("--flat")
      ->type_name("FILE");
  auto* vcd = verb->add_option("--vcd", options->vcd,
                               "record signals in this VCD file, for GTKWave and similar viewers")
                  ->excludes("--flat")
                  ->type_name("FILE");
  verb->add_option("--signals", options->signals,
                   "signals to record: pins, registers, and memory with its width in bits, such as "
                   "P50,pc,FRC,0xffe100:16 (default: pins,pc). Names of variables need a COFF or "
                   "ELF image")
      ->delimiter(',')
      ->needs(vcd)
      ->type_name("NAMES");
  add_debug_options(*verb, options->debug);
  verb->add_flag("--json", options->json, "print the summary as JSON on standard output")
      ->excludes("--semihost");
  // GDB says how far the program runs, and there is no summary.
  for (const char* unused : {"--max-states", "--input", "--json", "--count"})
    verb->get_option("--gdb")->excludes(verb->get_option(unused));
  verb->footer(
      "The program starts at the reset vector. The program's output on SCI0 goes to standard "
      "output. If the chip stops on an error, a report is printed.\n"
      "Exit status: 1 the chip stopped on an error; with --semihost, the program's own status, or "
      "125 if the program does not end by itself.\n"
      "Examples:\n"
      "  kaz mcu run kaz.mot\n"
      "  kaz mcu run kaz.coff --max-states 2000 --trace\n"
      "  kaz mcu run --entry program.coff\n"
      "  kaz mcu run program.coff --netlist board.net --vcd run.vcd --signals P50,TMO0,pc\n"
      "  kaz mcu run kaz.coff --profile --tick kz_tick_begin,kz_tick_end --stack\n"
      "  kaz mcu run kaz.coff --profile=out.callgrind --profile-format callgrind\n"
      "  kaz mcu run kaz.coff --gdb 1234     # then in GDB: target remote localhost:1234\n"
      "  kaz mcu run --flat --semihost --count program.coff");
  verb->callback([&action, options] { action = [options] { return run_mcu(*options); }; });
}

}  // namespace

void add_mcu(CLI::App& program, Action& action) {
  auto* mcu = program.add_subcommand(
      "mcu",
      "emulate the Hitachi H8S/2128: run any image, or compare the firmware with its native build");
  mcu->require_subcommand(1);
  mcu->footer(
      "Examples:\n"
      "  kaz mcu run kaz.mot --max-states 2000000\n"
      "  kaz mcu run --flat --semihost --count program.coff\n"
      "  kaz mcu compare --ticks 100000 --seed 7");
  add_bare_run(*mcu, action);
  add_mcu_compare(*mcu, action);
}

}  // namespace kaz::tools
