// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/app/flash/flash.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

void add_common(CLI::App& verb, FlashArguments& arguments) {
  verb.add_option("--port", arguments.port, "serial port or pty of the board")->type_name("PATH");
  add_address(verb, arguments.address);
  verb.add_option(
          "--reset", arguments.reset,
          "boot mode, entered by dtr-rts (DTR at RES, RTS at the mode pins), ctl:PATH (control "
          "socket of kaz sim) or manual; without it the resident loader")
      ->type_name("HOW");
  verb.add_option("--boot-baud", arguments.boot_baud, "of boot mode")
      ->check(CLI::IsMember({4800, 9600, 19200}))
      ->capture_default_str();
  verb.add_option("--writer", arguments.writer,
                  "the flash writer; that of this program if not given")
      ->type_name("FILE");
  verb.add_flag("--json", arguments.json,
                "one JSON object on standard output, of a failure too: `ok`, and `error`");
}

void add_image(CLI::App& verb, FlashArguments& arguments) {
  add_image_options(verb, arguments.image, arguments.load, host::kFlashBytes - 1);
}

}  // namespace

void add_flash(CLI::App& program, Action& action) {
  auto* all = program.add_subcommand(
      "flash", "puts a firmware into a servo board: boot mode or resident loader");
  all->require_subcommand(1);
  all->footer(
      "Examples:\n"
      "  kaz flash write build/release/firmware/kaz.mot --port /dev/ttyUSB0\n"
      "  kaz flash write kaz.mot --port board --reset ctl:board.ctl     (kaz sim --erased)\n"
      "  kaz flash write kaz.mot --port /dev/ttyUSB0 --reset manual\n"
      "  kaz flash info --port /dev/ttyUSB0\n"
      "Exit status: 0 done and verified, 1 it failed, 2 wrong usage or image, 3 port error.");
  const auto add = [&](const char* name, const char* text, const char* examples) {
    auto* verb = all->add_subcommand(name, text);
    verb->footer(std::string("Examples:\n") + examples +
                 "Exit status: 0 done and verified, 1 it failed, 2 wrong usage or image, 3 port "
                 "error.");
    auto arguments = std::make_shared<FlashArguments>();
    arguments->verb = name;
    add_common(*verb, *arguments);
    verb->callback(
        [&action, arguments] { action = [arguments] { return run_flash(*arguments); }; });
    return std::pair(verb, arguments);
  };
  add("info", "what the board says of itself",
      "  kaz flash info --port /dev/ttyUSB0\n"
      "  kaz flash info --port board --reset ctl:board.ctl --json     (boot mode)\n");
  add("run", "starts the firmware in the flash, and prints its identity",
      "  kaz flash run --port /dev/ttyUSB0     (after kaz flash write --no-start)\n");
  auto [write, to_write] =
      add("write", "erases what differs, writes, verifies and starts an image",
          "  kaz flash write build/release/firmware/kaz.mot --port /dev/ttyUSB0\n"
          "  kaz flash write kaz.mot --port board --reset ctl:board.ctl     (kaz sim --erased)\n"
          "  kaz flash write kaz.mot --port /dev/ttyUSB0 --reset manual\n");
  add_image(*write, *to_write);
  write->add_flag("--dry-run", to_write->dry_run, "look at the image and the port, send nothing");
  write->add_flag("--force", to_write->force,
                  "although the image is for another board or no Kaz's");
  write->add_flag("!--no-start", to_write->start, "do not start it");
  auto [verify, to_verify] = add("verify", "compares the flash with an image",
                                 "  kaz flash verify kaz.mot --port /dev/ttyUSB0\n");
  add_image(*verify, *to_verify);
  auto [erase, to_erase] = add("erase", "erases blocks; with --reset the whole flash",
                               "  kaz flash erase --port /dev/ttyUSB0 --blocks 7,8\n"
                               "  kaz flash erase --port /dev/ttyUSB0 --reset manual\n");
  erase->add_option("--blocks", to_erase->blocks, "1..5 and 7..9, through the resident loader")
      ->delimiter(',')
      ->check(CLI::Range(0, 9))
      ->type_name("N,N");
  auto [read, to_read] = add("read", "reads flash into a raw file",
                             "  kaz flash read --port /dev/ttyUSB0 --out flash.bin\n"
                             "  kaz flash read --port board --from 0x1000 --length 4096 --out "
                             "part.bin\n");
  read->add_option("--from", to_read->from, "first address")
      ->check(CLI::Range(0, 0x1ffff))
      ->capture_default_str();
  read->add_option("--length", to_read->length, "bytes")
      ->check(CLI::Range(1, 0x20000))
      ->capture_default_str();
  read->add_option("--out", to_read->out, "file")->required()->type_name("FILE");
}

}  // namespace kaz::tools
