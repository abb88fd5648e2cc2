// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <string_view>

#include "tools/base/paths.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/flash/flash.h"

namespace kaz::tools {
namespace {

constexpr const char* kWriteExamples =
    "  kaz flash write kaz.mot --robot serial:/dev/ttyUSB0\n"
    "  kaz flash write kaz.mot --robot serial:board --reset ctl:board.ctl     # for kaz sim "
    "--erased\n"
    "  kaz flash write kaz.mot --robot serial:/dev/ttyUSB0 --reset manual\n";
constexpr const char* kExitStatus = "Exit status: 2 wrong usage or image, 3 port error.\n";

// Of the verbs that can do without the loader.
void add_boot_mode(CLI::App& verb, FlashArguments& arguments) {
  auto* reset =
      verb.add_option("--reset", arguments.reset,
                      "use boot mode. With 'dtr-rts', the port's lines DTR and RTS start boot "
                      "mode. DTR must be wired to RES, and RTS must be wired to the mode pins. "
                      "With 'ctl:PATH', the control socket of kaz sim starts boot mode. With "
                      "'manual', you start boot mode by hand. Boot mode erases the whole flash, "
                      "including the stored calibration and address. Without --reset, the resident "
                      "loader is used")
          ->type_name("HOW");
  verb.add_option("--boot-baud", arguments.boot_baud, "baud rate in boot mode")
      ->check(CLI::IsMember({"4800", "9600", "19200"}).description(""))
      ->type_name("4800|9600|19200")
      ->capture_default_str()
      ->needs(reset);
  verb.add_option("--writer", arguments.writer,
                  "flash writer to load into the board's RAM in boot mode (default: the writer in "
                  "this program)")
      ->type_name("FILE")
      ->needs(reset);
}

void add_reset_to_run(CLI::App& verb, FlashArguments& arguments) {
  verb.add_option("--reset", arguments.reset,
                  "start the firmware by a reset, for example after boot mode. With 'dtr-rts', the "
                  "port's lines DTR and RTS reset the board. DTR must be wired to RES, and RTS "
                  "must be wired to the mode pins. With 'ctl:PATH', the control socket of kaz sim "
                  "resets the board. With 'manual', you reset the board. Without --reset, the "
                  "resident loader starts the firmware")
      ->type_name("HOW");
}

void add_common(CLI::App& verb, FlashArguments& arguments, bool dry_run) {
  auto* port =
      add_port(verb, arguments.port,
               std::string("the board: serial:PATH of a serial port or pty, at 115,200 baud") +
                   (dry_run ? " (required except with --dry-run)" : ""));
  if (!dry_run) port->required();
  add_address(verb, arguments.address);
  verb.add_flag(
      "--json", arguments.json,
      "print one JSON object with `ok` and `error` on standard output, also after a failure");
}

// The message on a block that the loader keeps says more (flash/arguments.cpp).
CLI::Validator erasable_block() {
  return accept_if(
      [](std::string& text) { return between(0, host::kFlashBlocks - 1)(text).empty(); },
      "1 to 5 or 7 to 9", "block numbers ");
}

void add_image(CLI::App& verb, FlashArguments& arguments) {
  add_image_options(verb, arguments.image, arguments.load, host::kFlashBytes - 1);
  verb.get_option("--at")->description("address of a raw image's first byte");
}

}  // namespace

void add_flash(CLI::App& program, Action& action) {
  auto* all = program.add_subcommand(
      "flash",
      "write, read and verify the board's firmware, through boot mode or the resident loader");
  all->require_subcommand(1);
  all->footer(std::string(kExitStatus) + "Examples:\n" + kWriteExamples +
              "  kaz flash info --robot serial:/dev/ttyUSB0");
  const auto add = [&](const char* name, const char* text, const char* examples) {
    auto* verb = all->add_subcommand(name, text);
    const std::string_view which = name;
    const bool starts = which == "run", by_boot_mode = which == "write" || which == "erase";
    const auto image = firmware_image("");
    const bool takes_image = which == "write" || which == "verify";
    verb->footer(std::string(by_boot_mode || starts ? ""
                                                    : "This verb uses the resident loader, because "
                                                      "boot mode would erase the flash.\n") +
                 (takes_image && image ? "The firmware of this kaz: " + *image + "\n" : "") +
                 kExitStatus + "Examples:\n" + examples);
    auto arguments = std::make_shared<FlashArguments>();
    arguments->verb = name;
    add_common(*verb, *arguments, which == "write");
    if (by_boot_mode) add_boot_mode(*verb, *arguments);
    if (starts) add_reset_to_run(*verb, *arguments);
    verb->callback(
        [&action, arguments] { action = [arguments] { return run_flash(*arguments); }; });
    return std::pair(verb, arguments);
  };
  add("info",
      "describe the contents of the board's flash; the board restarts, so the motors go off",
      "  kaz flash info --robot serial:/dev/ttyUSB0\n"
      "  kaz flash info --robot serial:board --json\n");
  add("run", "start the firmware in the flash, and print its identity",
      "  kaz flash run --robot serial:/dev/ttyUSB0     # after kaz flash write --no-start\n"
      "  kaz flash run --robot serial:board --reset ctl:board.ctl\n");
  auto [write, to_write] =
      add("write", "erase changed blocks, and write, verify and start an image", kWriteExamples);
  add_image(*write, *to_write);
  write->add_flag(
      "--dry-run", to_write->dry_run,
      "check the image, and also check the port if a port is given, but send nothing to the board");
  write->add_flag("--force", to_write->force,
                  "write the image even if the image is for another board or is not Kaz firmware");
  write->add_flag("!--no-start", to_write->start,
                  "do not start the image: leave the board in the loader or in boot mode");
  auto [verify, to_verify] =
      add("verify", "compare the flash with an image; the board restarts, so the motors go off",
          "  kaz flash verify kaz.mot --robot serial:/dev/ttyUSB0\n");
  add_image(*verify, *to_verify);
  auto [erase, to_erase] =
      add("erase", "erase blocks of the flash, or with --reset the whole flash",
          "  kaz flash erase --robot serial:/dev/ttyUSB0 --blocks 7,8\n"
          "  kaz flash erase --robot serial:/dev/ttyUSB0 --reset manual\n");
  erase
      ->add_option(
          "--blocks", to_erase->blocks,
          "blocks to erase through the resident loader, separated by commas: 1 to 5 and 7 to 9. "
          "EB0 (vectors) and EB6 (loader) cannot be erased. EB1 and EB2 hold the calibration, EB3 "
          "holds the board's address, and the other blocks hold the application")
      ->delimiter(',')
      ->check(erasable_block())
      ->type_name("N,N");
  auto [read, to_read] =
      add("read", "copy the flash to a raw file; the board restarts, so the motors go off",
          "  kaz flash read --robot serial:/dev/ttyUSB0 --out flash.bin\n"
          "  kaz flash read --robot serial:board --from 0x1000 --length 4096 --out part.bin\n");
  read->add_option("--from", to_read->from, "first address to read")
      ->check(between(0U, 0x1ffffU))
      ->type_name("ADDRESS")
      ->capture_default_str();
  read->add_option("--length", to_read->length, "number of bytes to read")
      ->check(between(1, 0x20000))
      ->type_name("N")
      ->capture_default_str();
  read->add_option("--out", to_read->out, "file to write")->required()->type_name("FILE");
}

}  // namespace kaz::tools
