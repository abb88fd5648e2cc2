// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "host/flash/diagnostic.h"
#include "tools/kaz/flash/answer.h"
#include "tools/kaz/flash/arguments.h"
#include "tools/kaz/flash/session.h"
#include "tools/kaz/image_options.h"
#include "tools/kaz/interrupt_signals.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

using Image = std::optional<host::FlashImage>;

// Whether the firmware that was started answers, with this CRC.
Result<void> check_running(FlashSession& session, Answer& answer,
                           const host::ImageIdentity& identity) {
  const auto board = session.identify();
  if (board && board->image_crc == identity.crc) {
    answer.runs(*board);
    return {};
  }
  return fail(
      Fault::failed,
      host::text_of(
          {"the firmware was written and verified, but does not run",
           "its answer to `identify`, with image CRC " + host::hex_word(identity.crc),
           board ? "image CRC " + host::hex_word(board->image_crc) : "nothing",
           {"the mode switch still stands at boot mode", "reset is not wired as --reset says"},
           "set the switch, press reset, then `kaz status --port " + session.port() + "`"}));
}

Result<void> write_image(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                         const host::FlashImage& image) {
  const auto report = session.flasher().write(image);
  session.end_progress();
  if (!report) return tl::unexpected(report.error());
  answer.written(*report);
  if (!arguments.start) return {};
  if (auto started = session.start(); !started) return started;
  if (const auto identity = image.identity()) return check_running(session, answer, *identity);
  return {};
}

Result<void> verify_image(FlashSession& session, Answer& answer, const host::FlashImage& image) {
  const auto report = session.flasher().verify(image);
  session.end_progress();
  if (!report) return tl::unexpected(report.error());
  answer.put("bytes", report->bytes);
  answer.put("verified", true);
  answer.say("verified: " + std::to_string(report->bytes) + " bytes stand in the flash");
  return {};
}

Result<void> read_flash(FlashSession& session, const FlashArguments& arguments, Answer& answer) {
  const auto bytes = session.flasher().read({arguments.from, arguments.from + arguments.length});
  session.end_progress();
  if (!bytes) return tl::unexpected(bytes.error());
  std::ofstream file(arguments.out, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes->data()),
             static_cast<std::streamsize>(bytes->size()));
  file.close();
  if (!file) return fail(Fault::environment, "cannot write " + arguments.out);
  answer.put("bytes", bytes->size());
  answer.put("from", arguments.from);
  answer.put("out", arguments.out);
  answer.say(std::to_string(bytes->size()) + " bytes from " + host::hex_address(arguments.from) +
             " in " + arguments.out);
  return {};
}

Result<void> show_info(FlashSession& session, Answer& answer) {
  const auto& found = session.flasher().found();
  const auto id = session.flasher().board_id();
  const std::string id_text = id ? host::hex_word(*id) : "unknown";
  answer.put("writer", found->protocol);
  answer.put("board_id", id_text);
  answer.say("flash writer " + std::to_string(found->protocol) +
             ", started by the resident loader; board id " + id_text);
  const auto header = session.flasher().read({KZ_APPLICATION_HEADER, KZ_APPLICATION_HEADER + 32});
  session.end_progress();
  if (!header) return tl::unexpected(header.error());
  host::FlashImage image;
  image.put(KZ_APPLICATION_HEADER, *header);
  answer.application(image.identity());
  return {};
}

// Through boot mode everything is erased by now.
Result<void> erase(FlashSession& session, const FlashArguments& arguments, Answer& answer) {
  if (session.through_boot()) {
    answer.put("erased", "all");
    answer.say("erased: the whole flash; the board has no firmware now, give `kaz flash write`");
    return {};
  }
  auto erased = session.flasher().erase(arguments.blocks);
  session.end_progress();
  if (!erased) return erased;
  answer.put("erased", arguments.blocks);
  std::string line = "erased:";
  for (const int block : arguments.blocks) line += " EB" + std::to_string(block);
  answer.say(line +
             "; after 10 s, or by `kaz flash run`, the loader starts the application if it is "
             "whole");
  return {};
}

Result<void> run(FlashSession& session, Answer& answer) {
  if (auto started = session.start(); !started) return started;
  if (const auto board = session.identify()) {
    answer.runs(*board);
    return {};
  }
  return fail(Fault::failed,
              host::text_of({"the board was started, and no firmware of Kaz answers",
                             "its answer to `identify`",
                             "nothing sound",
                             {"there is no whole application: the loader waits for one",
                              "what stands in the flash is another program"},
                             "kaz flash info --port " + session.port()}));
}

Result<void> look(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                  const host::FlashImage& image) {
  answer.put("dry_run", true);
  answer.image(image);
  if (auto sound = session.flasher().check(image, !arguments.reset.empty()); !sound) return sound;
  answer.say("port " + arguments.port + " can be opened; nothing was sent (--dry-run)");
  return {};
}

Result<void> act(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                 const Image& image) {
  if (auto opened = session.open(); !opened) return opened;
  const bool writes = arguments.verb == "write";
  if (arguments.dry_run) return look(session, arguments, answer, *image);
  if (writes) {
    if (auto sound = session.flasher().check(*image, session.through_boot()); !sound) return sound;
  }
  if (arguments.verb == "run" && session.through_boot()) return run(session, answer);
  if (auto entered = session.enter(writes ? &*image : nullptr); !entered) return entered;
  if (writes) return write_image(session, arguments, answer, *image);
  if (arguments.verb == "erase") return erase(session, arguments, answer);
  if (arguments.verb == "run") return run(session, answer);
  Result<void> done;
  if (arguments.verb == "read") done = read_flash(session, arguments, answer);
  if (arguments.verb == "info") done = show_info(session, answer);
  if (arguments.verb == "verify") done = verify_image(session, answer, *image);
  if (!done) return done;
  // Nobody is left in the loader; where there is nothing to start it stays there.
  return session.flasher().run(nullptr);
}

Result<void> flash(const FlashArguments& arguments, Answer& answer) {
  Image image;
  if (!arguments.image.empty()) {
    auto loaded = host::FlashImage::load(arguments.image, arguments.load);
    if (!loaded) return tl::unexpected(loaded.error());
    image = std::move(*loaded);
  }
  if (auto sound = check(arguments); !sound) return sound;
  if (arguments.port.empty()) {
    answer.put("dry_run", true);
    answer.image(*image);
    return {};
  }
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  FlashSession session(arguments, interrupt);
  const auto done = act(session, arguments, answer, image);
  session.end_progress();
  if (!done) return tl::unexpected(session.with_advice(done.error()));
  return {};
}

Result<Outcome> flash_verb(const FlashArguments& arguments) {
  Answer answer(arguments.json);
  const auto done = flash(arguments, answer);
  answer.finish(arguments.verb, done);
  if (!done) return tl::unexpected(done.error());
  return true;
}

void add_common(CLI::App& verb, FlashArguments& arguments) {
  verb.add_option("--port", arguments.port, "serial port or pty of the board")->type_name("PATH");
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
      "Exit status: 0 done and verified, 1 it failed, 2 wrong usage or image, 3 port trouble.");
  const auto add = [&](const char* name, const char* text) {
    auto* verb = all->add_subcommand(name, text);
    auto arguments = std::make_shared<FlashArguments>();
    arguments->verb = name;
    add_common(*verb, *arguments);
    verb->callback(
        [&action, arguments] { action = [arguments] { return flash_verb(*arguments); }; });
    return std::pair(verb, arguments);
  };
  add("info", "what the board says of itself");
  add("run", "starts what is in the flash, and asks the firmware who it is");
  auto [write, to_write] =
      add("write", "erases what differs, writes, verifies and starts an image");
  add_image(*write, *to_write);
  write->add_flag("--dry-run", to_write->dry_run, "look at the image and the port, send nothing");
  write->add_flag("--force", to_write->force,
                  "although the image is for another board or no Kaz's");
  write->add_flag("!--no-start", to_write->start, "do not start it");
  auto [verify, to_verify] = add("verify", "compares the flash with an image");
  add_image(*verify, *to_verify);
  auto [erase, to_erase] = add("erase", "erases blocks; with --reset the whole flash");
  erase->add_option("--blocks", to_erase->blocks, "1..5 and 7..9, through the resident loader")
      ->delimiter(',')
      ->check(CLI::Range(0, 9))
      ->type_name("N,N");
  auto [read, to_read] = add("read", "reads flash into a raw file");
  read->add_option("--from", to_read->from, "first address")
      ->check(CLI::Range(0, 0x1ffff))
      ->capture_default_str();
  read->add_option("--length", to_read->length, "bytes")
      ->check(CLI::Range(1, 0x20000))
      ->capture_default_str();
  read->add_option("--out", to_read->out, "file")->required()->type_name("FILE");
}

}  // namespace kaz::tools
