// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#include "tools/flash/flash.h"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "host/flash/diagnostic.h"
#include "host/link/port_address.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output_file.h"
#include "tools/flash/answer.h"
#include "tools/flash/arguments.h"
#include "tools/flash/session.h"
#include "tools/kept/write_notes.h"

namespace kaz::tools {
namespace {

using Image = std::optional<host::FlashImage>;

// Whether the firmware that was started answers, with this CRC.
Result<void> check_running(FlashSession& session, Answer& answer,
                           const host::ImageIdentity& identity) {
  const auto board = session.identify();
  if (!board && board.error().fault == Fault::interrupted) return tl::unexpected(board.error());
  const std::string excuse = board ? "" : session.excuse();
  if (!board) {
    if (const auto elsewhere = session.at_another_address(board.error()))
      return fail(elsewhere->fault, "the firmware was written and verified; " + elsewhere->message);
  }
  if (!excuse.empty())
    return fail(
        Fault::environment,
        "the firmware was written and verified, but it is undecided whether the firmware runs: " +
            excuse + ": end other programs, then `kaz status " +
            host::robot_option(session.port()) + "`");
  if (board && board->image_crc == identity.crc) {
    answer.runs(*board);
    return {};
  }
  return host::fail(
      Fault::failed,
      host::Diagnostic{"the firmware was written and verified, but does not run",
                       "an answer to `identify` with image CRC " + host::hex_word(identity.crc),
                       board ? "image CRC " + host::hex_word(board->image_crc) : "nothing",
                       {"the mode switch is still at boot mode",
                        "the reset line is not connected as --reset describes"},
                       "set the mode switch to its run position (MD1 high), press reset, then give "
                       "`kaz status " +
                           host::robot_option(session.port()) + "`"});
}

Result<void> write_image(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                         const host::FlashImage& image) {
  const auto report = session.flasher().write(image);
  session.end_progress();
  if (!report) return tl::unexpected(report.error());
  answer.written(*report, session.through_boot());
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
  answer.say("verified: " + std::to_string(report->bytes) +
             " bytes in the flash agree with the image");
  return {};
}

Result<void> read_flash(FlashSession& session, const FlashArguments& arguments, OutputFile& out,
                        Answer& answer) {
  const auto bytes = session.flasher().read({arguments.from, arguments.from + arguments.length});
  session.end_progress();
  if (!bytes) return tl::unexpected(bytes.error());
  KAZ_TRY(out.write({reinterpret_cast<const char*>(bytes->data()), bytes->size()}));
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
  answer.put("started_by", found->by_loader ? "loader" : "boot mode");
  answer.say("flash writer " + std::to_string(found->protocol) + ", started " +
             (found->by_loader ? "by the resident loader" : "through boot mode") + "; board id " +
             id_text);
  const auto interrupted = interrupted_writes(session.port());
  answer.put("interrupted", interrupted);
  for (const std::string& sentence : interrupted) answer.say(sentence);
  if (!found->by_loader && interrupted.empty())
    answer.say("a write through boot mode was interrupted: give `kaz flash write IMAGE " +
               host::robot_option(session.port()) + " --reset HOW`");
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
    answer.say("erased: the whole flash; the board has no firmware now; give `kaz flash write`");
    return {};
  }
  auto erased = session.flasher().erase(arguments.blocks);
  session.end_progress();
  if (!erased) return erased;
  answer.put("erased", arguments.blocks);
  std::string line = "erased:";
  for (const int block : arguments.blocks) line += " EB" + std::to_string(block);
  // EB1 and EB2 hold the two copies of the calibration, EB3 the address (docs/reference/firmware.md).
  const auto has = [&](int block) { return std::ranges::count(arguments.blocks, block) > 0; };
  if (has(1) || has(2))
    line += std::string("; the erased data include ") +
            (has(1) && has(2) ? "both copies" : "a copy") +
            " of the calibration (`kaz calibrate joints` makes a new one)";
  if (has(3)) line += "; the board's address was erased too, and is now 1";
  answer.say(
      line +
      "; if the application is complete, the loader starts it after 10 s or by `kaz flash run`");
  return {};
}

Result<void> run(FlashSession& session, Answer& answer) {
  if (auto started = session.start(); !started) return started;
  const auto board = session.identify();
  if (board) {
    answer.runs(*board);
    return {};
  }
  if (board.error().fault == Fault::interrupted) return tl::unexpected(board.error());
  const std::string excuse = session.excuse();
  if (const auto elsewhere = session.at_another_address(board.error()))
    return fail(elsewhere->fault, "the board was started; " + elsewhere->message);
  if (!excuse.empty())
    return fail(Fault::environment,
                "the board was started, but it is undecided whether the firmware runs: " + excuse +
                    ": end other programs, then `kaz status " + host::robot_option(session.port()) +
                    "`");
  return host::fail(
      Fault::failed,
      host::Diagnostic{
          "the board was started, but no Kaz firmware answers",
          "an answer to `identify`",
          "no valid reply",
          {"the application is missing or incomplete: the loader waits for an application",
           "the flash contains another program"},
          "kaz flash info " + host::robot_option(session.port())});
}

Result<void> look(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                  const host::FlashImage& image) {
  answer.put("dry_run", true);
  answer.image(image);
  if (auto valid = session.flasher().check(image, !arguments.reset.empty()); !valid) return valid;
  answer.say("port " + arguments.port + " can be opened; nothing was sent (--dry-run)");
  return {};
}

// With notes until the flash is whole. Without them it writes as well, since the same command completes an
// interrupted write.
Result<void> write_with_notes(FlashSession& session, const FlashArguments& arguments,
                              Answer& answer, const host::FlashImage& image) {
  const auto notes = WriteNotes::begin(session.port());
  if (!notes)
    std::fprintf(stderr, "kaz flash: notes of this write cannot be saved: %s\n",
                 notes.error().message.c_str());
  auto done = session.enter(&image);
  if (done) done = write_image(session, arguments, answer, image);
  if (!notes) return done;
  if (answer.has_written())
    notes->done();
  else if (session.flasher().left_behind().empty())
    notes->drop();
  return done;
}

Result<void> act(FlashSession& session, const FlashArguments& arguments, Answer& answer,
                 const Image& image) {
  std::optional<OutputFile> out;
  if (arguments.verb == "read") {
    out = KAZ_TRY(OutputFile::open(arguments.out, "--out", Existing::keep));
    KAZ_TRY(out->check_room(arguments.length));
  }
  if (auto opened = session.open(); !opened) return opened;
  const bool writes = arguments.verb == "write";
  if (arguments.dry_run) return look(session, arguments, answer, *image);
  if (writes) {
    if (auto valid = session.flasher().check(*image, session.through_boot()); !valid) return valid;
  }
  if (arguments.verb == "run" && session.through_boot()) return run(session, answer);
  if (writes) return write_with_notes(session, arguments, answer, *image);
  if (auto entered = session.enter(nullptr); !entered) return entered;
  if (arguments.verb == "erase") return erase(session, arguments, answer);
  if (arguments.verb == "run") return run(session, answer);
  const bool by_loader = session.flasher().found()->by_loader;
  Result<void> done;
  if (arguments.verb == "read") done = read_flash(session, arguments, *out, answer);
  if (arguments.verb == "info") done = show_info(session, answer);
  if (arguments.verb == "verify") done = verify_image(session, answer, *image);
  if (!done) return done;
  // The loader starts the firmware; without a valid firmware it stays in control. A writer that was loaded
  // through boot mode belongs to another run, which was interrupted: it stays as it is.
  if (!by_loader) return {};
  return session.flasher().run(nullptr);
}

Result<void> flash(const FlashArguments& arguments, Answer& answer) {
  Image image;
  if (!arguments.image.empty()) {
    auto loaded = KAZ_TRY(host::FlashImage::load(arguments.image, arguments.load));
    image = std::move(loaded);
    if (image->size() == 0)
      return fail(Fault::usage,
                  arguments.image +
                      ": all its bytes are ff, as in erased flash, so there is nothing to write or "
                      "to compare; to erase, give `kaz flash erase`");
  }
  if (auto valid = check(arguments); !valid) return valid;
  if (arguments.port.empty()) {
    answer.put("dry_run", true);
    answer.image(*image);
    if (arguments.verb != "write") return {};
    return host::check_image(*image, !arguments.reset.empty(), arguments.force);
  }
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  FlashSession session(arguments, interrupt);
  const auto done = act(session, arguments, answer, image);
  session.end_progress();
  if (!done) return tl::unexpected(session.with_advice(session.start_again(done.error())));
  return {};
}

}  // namespace

Result<bool> run_flash(const FlashArguments& arguments) {
  Answer answer(arguments.json);
  const auto done = flash(arguments, answer);
  answer.finish(arguments.verb, done);
  if (!done) return tl::unexpected(done.error());
  return true;
}

}  // namespace kaz::tools
