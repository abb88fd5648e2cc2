// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>

#include "host/flash/flasher.h"
#include "host/flash/trouble.h"
#include "host/robot/connect.h"
#include "host/robot/requester.h"
#include "host/robot/wall_clock.h"
#include "tools/kaz/interrupt_signals.h"
#include "tools/kaz/output.h"
#include "tools/kaz/paths.h"
#include "tools/kaz/port_argument.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

struct Arguments {
  std::string verb, image, port, reset, writer, out;
  h8s::LoadOptions load;
  std::uint32_t from = 0, length = host::kFlashBytes;
  std::vector<int> blocks;
  int boot_baud = 9600;
  bool dry_run = false, force = false, start = true, json = false;
};

Result<std::vector<std::uint8_t>> writer_program(const std::string& given) {
  const auto path = given.empty() ? data_file("firmware/writer.bin") : Result<std::string>(given);
  if (!path) return tl::unexpected(path.error());
  std::ifstream file(*path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) return fail(Fault::usage, *path + ": cannot read the flash writer");
  return bytes;
}

Result<void> ask_user(const std::string& prompt) {
  std::fprintf(stderr, "%s, then press Enter: ", prompt.c_str());
  std::string line;
  if (!std::getline(std::cin, line))
    return fail(Fault::usage, "--reset manual needs somebody at the keyboard");
  return {};
}

Result<std::unique_ptr<host::BoardReset>> make_reset(const std::string& text, host::TtyLink& port,
                                                     host::Clock& clock) {
  std::unique_ptr<host::BoardReset> reset;
  if (text == "dtr-rts") reset = std::make_unique<host::ModemLineReset>(port, clock);
  if (text == "manual") reset = std::make_unique<host::ManualReset>(ask_user);
  if (text.starts_with("ctl:")) reset = std::make_unique<host::ControlSocketReset>(text.substr(4));
  if (!reset && !text.empty())
    return fail(Fault::usage, "--reset " + text + ": give dtr-rts, ctl:PATH or manual");
  return reset;
}

void describe(const host::FlashImage& image) {
  std::printf("%u bytes in", image.size());
  for (int block = 0; block < host::kFlashBlocks; ++block)
    if (image.touches(block)) std::printf(" EB%d", block);
  if (const auto identity = image.identity())
    std::printf("; Kaz application, board id %04x, version %u, build %08x, CRC %04x",
                identity->board_id, identity->version, identity->build_id, identity->crc);
  std::printf("\n");
}

// One board, from the port to its writer.
class Session {
 public:
  Session(const Arguments& arguments, host::Interrupt& interrupt)
      : arguments_(arguments),
        clock_(&interrupt),
        interrupt_(interrupt),
        progress_("kaz flash", arguments.json) {}

  Result<void> open();
  Result<void> enter(const host::FlashImage* image);
  host::Flasher& flasher() { return *flasher_; }
  host::BoardReset* reset() { return reset_.get(); }
  host::TtyLink& link() { return *link_; }
  host::Clock& clock() { return clock_; }
  void done() { progress_.done(); }
  // Whether the firmware that was started answers, with this CRC if it is known.
  Result<void> check_running(const std::optional<host::ImageIdentity>& identity);

 private:
  const Arguments& arguments_;
  host::WallClock clock_;
  host::Interrupt& interrupt_;
  Progress progress_;
  std::unique_ptr<host::TtyLink> link_;
  std::unique_ptr<host::BoardReset> reset_;
  std::vector<std::uint8_t> program_;
  std::unique_ptr<host::Flasher> flasher_;
};

Result<void> Session::open() {
  const auto port = parse_port(arguments_.port);
  if (!port) return tl::unexpected(port.error());
  auto link = host::TtyLink::open(port->first, 115200, &interrupt_);
  if (!link) return tl::unexpected(link.error());
  link_ = std::move(*link);
  auto reset = make_reset(arguments_.reset, *link_, clock_);
  if (!reset) return tl::unexpected(reset.error());
  reset_ = std::move(*reset);
  auto program = writer_program(arguments_.writer);
  if (!program) return tl::unexpected(program.error());
  program_ = std::move(*program);
  host::FlasherOptions options;
  options.boot.baud = arguments_.boot_baud;
  options.force = arguments_.force;
  options.note = [this](const std::string& line) {
    progress_.done();
    std::fprintf(stderr, "kaz flash: %s\n", line.c_str());
  };
  options.progress = [this](const host::FlashProgress& p) {
    char rate[64];
    std::snprintf(rate, sizeof rate, "%s %u of %u%s, %.1f KB/s", p.phase.c_str(), p.done, p.total,
                  p.phase == "erase" ? " blocks" : " bytes", p.bytes_per_s / 1000);
    progress_.update(p.total > 0 ? static_cast<double>(p.done) / p.total : 0, rate);
  };
  flasher_ = std::make_unique<host::Flasher>(*link_, clock_, program_, options);
  return {};
}

// With a way to the reset, through boot mode; the firmware that may run tells its board's id first.
// Nothing is changed before the image has been checked against that.
Result<void> Session::enter(const host::FlashImage* image) {
  const auto there = flasher_->enter_loader();
  if (!there && (!reset_ || there.error().fault == Fault::failed))
    return tl::unexpected(there.error());
  if (image != nullptr) {
    if (auto allowed = flasher_->check(*image); !allowed) return allowed;
  }
  if (!reset_) {
    if (*there) return {};
    return fail(Fault::environment,
                host::text_of({"no firmware and no loader answers on " + link_->name(),
                               "a Kaz board at 115200 baud",
                               "nothing sound",
                               {"the board's flash is blank: that takes boot mode",
                                "the port is another one", "the board has no power"},
                               "kaz flash " + arguments_.verb +
                                   " … --reset dtr-rts (or ctl:PATH, or manual)"}));
  }
  if (image != nullptr && !flasher_->board_id())
    std::fprintf(stderr,
                 "kaz flash: the board does not say its id; it is taken to be that of the "
                 "image\n");
  return flasher_->enter_boot(*reset_);
}

Result<void> Session::check_running(const std::optional<host::ImageIdentity>& identity) {
  if (!identity) return {};
  if (auto waited = clock_.sleep_until(clock_.now() + std::chrono::milliseconds(300)); !waited)
    return waited;
  host::Requester requester(*link_, clock_, {});
  const auto board = host::identify_board(requester);
  const bool right = board && board->image_crc == identity->crc;
  if (right) {
    std::printf("runs: firmware %u, build %08x, CRC %04x\n", board->firmware_version,
                board->build_id, board->image_crc);
    return {};
  }
  char crc[8];
  std::snprintf(crc, sizeof crc, "%04x", board ? board->image_crc : 0);
  return fail(
      Fault::failed,
      host::text_of(
          {"the firmware was written and verified, but does not run",
           "its answer to `identify`",
           board ? "image CRC " + std::string(crc) : "nothing",
           {"the mode switch still stands at boot mode", "reset is not wired as --reset says"},
           "set the switch, press reset, then `kaz status --port " + link_->name() + "`"}));
}

void print(const host::FlashReport& report, const Arguments& arguments) {
  if (arguments.json) {
    const nlohmann::ordered_json json{{"bytes", report.bytes},
                                      {"written", report.written},
                                      {"blocks_erased", report.erased},
                                      {"blocks_unchanged", report.unchanged},
                                      {"repeated", report.repeated},
                                      {"verified", report.verified},
                                      {"seconds", report.seconds},
                                      {"least_seconds", report.least_seconds},
                                      {"efficiency", report.efficiency()}};
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  std::printf(
      "written and verified: %u bytes, %d blocks erased, %d unchanged, %d requests repeated\n",
      report.written, report.erased, report.unchanged, report.repeated);
  if (report.written > 0)
    std::printf("%.2f s, of which line and cells take %.2f: efficiency %.1f %%\n", report.seconds,
                report.least_seconds, 100 * report.efficiency());
}

Result<void> write_image(Session& session, const Arguments& arguments,
                         const host::FlashImage& image) {
  const auto report = session.flasher().write(image);
  session.done();
  if (!report) return tl::unexpected(report.error());
  print(*report, arguments);
  if (!arguments.start) return {};
  if (auto left = session.flasher().run(session.reset()); !left) return left;
  return session.check_running(image.identity());
}

Result<void> read_flash(Session& session, const Arguments& arguments) {
  const auto bytes = session.flasher().read({arguments.from, arguments.from + arguments.length});
  session.done();
  if (!bytes) return tl::unexpected(bytes.error());
  std::ofstream file(arguments.out, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes->data()),
             static_cast<std::streamsize>(bytes->size()));
  file.close();
  if (!file) return fail(Fault::environment, "cannot write " + arguments.out);
  std::printf("%zu bytes from %s in %s\n", bytes->size(), host::hex_address(arguments.from).c_str(),
              arguments.out.c_str());
  return {};
}

Result<void> show_info(Session& session) {
  const auto& found = session.flasher().found();
  session.done();
  const auto id = session.flasher().board_id();
  char id_text[8] = "unknown";
  if (id) std::snprintf(id_text, sizeof id_text, "%04x", *id);
  std::printf("flash writer %d, started by %s; board id %s\n", found->protocol,
              found->by_loader ? "the resident loader" : "boot mode", id_text);
  const auto header = session.flasher().read({KZ_APPLICATION_HEADER, KZ_APPLICATION_HEADER + 32});
  session.done();
  if (!header) return tl::unexpected(header.error());
  host::FlashImage image;
  image.put(KZ_APPLICATION_HEADER, *header);
  if (const auto identity = image.identity()) {
    std::printf("application: board id %04x, version %u, build %08x, %u bytes, CRC %04x\n",
                identity->board_id, identity->version, identity->build_id, identity->length,
                identity->crc);
  } else {
    std::printf("application: none\n");
  }
  return {};
}

Result<Outcome> flash(const Arguments& arguments) {
  std::optional<host::FlashImage> image;
  if (!arguments.image.empty()) {
    auto loaded = host::FlashImage::load(arguments.image, arguments.load);
    if (!loaded) return tl::unexpected(loaded.error());
    image = std::move(*loaded);
  }
  const bool changes = arguments.verb == "write";
  if (arguments.from + arguments.length > host::kFlashBytes)
    return fail(Fault::usage, "the flash ends at 0x01ffff; give --from and --length within it");
  if (arguments.port.empty() && !arguments.dry_run)
    return fail(Fault::usage, "--port is missing: the board's serial port");
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  Session session(arguments, interrupt);
  if (arguments.dry_run) {
    if (image) describe(*image);
    if (arguments.port.empty()) return true;
  }
  if (auto opened = session.open(); !opened) return tl::unexpected(opened.error());
  if (image && changes) {
    if (auto allowed = session.flasher().check(*image); !allowed)
      return tl::unexpected(allowed.error());
  }
  if (arguments.dry_run) {
    std::printf("port %s can be opened; nothing was sent (--dry-run)\n", arguments.port.c_str());
    return true;
  }
  if (!changes && arguments.verb != "erase" && !arguments.reset.empty() && arguments.verb != "run")
    return fail(Fault::usage, "boot mode erases the flash: `kaz flash " + arguments.verb +
                                  "` goes through the resident loader, without --reset");
  if (arguments.verb == "run" && session.reset() != nullptr) {
    if (auto left = session.flasher().run(session.reset()); !left)
      return tl::unexpected(left.error());
    return true;
  }
  if (auto entered = session.enter(changes ? &*image : nullptr); !entered)
    return tl::unexpected(entered.error());
  Result<void> done;
  if (arguments.verb == "write") done = write_image(session, arguments, *image);
  if (arguments.verb == "read") done = read_flash(session, arguments);
  if (arguments.verb == "info") done = show_info(session);
  if (arguments.verb == "erase") {
    done = session.flasher().erase(arguments.blocks);
    session.done();
  }
  if (arguments.verb == "verify") {
    const auto report = session.flasher().verify(*image);
    session.done();
    if (!report) return tl::unexpected(report.error());
    std::printf("verified: %u bytes stand in the flash\n", report->bytes);
  }
  if (!done) return tl::unexpected(done.error());
  // Nobody is left in the loader.
  if (arguments.verb != "write" && session.reset() == nullptr && arguments.verb != "erase") {
    if (auto left = session.flasher().run(nullptr); !left) return tl::unexpected(left.error());
  }
  return true;
}

void add_common(CLI::App& verb, Arguments& arguments) {
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
}

void add_image(CLI::App& verb, Arguments& arguments) {
  verb.add_option("IMAGE", arguments.image, "S-record, Intel HEX, COFF, ELF or raw")
      ->required()
      ->type_name("");
  const std::map<std::string, h8s::Format> formats{{"coff", h8s::Format::coff},
                                                   {"elf", h8s::Format::elf},
                                                   {"srec", h8s::Format::srecord},
                                                   {"ihex", h8s::Format::intel_hex},
                                                   {"raw", h8s::Format::raw}};
  verb.add_option("--format", arguments.load.format, "told by the contents if not given")
      ->transform(CLI::CheckedTransformer(formats, CLI::ignore_case).description(""))
      ->type_name("coff|elf|srec|ihex|raw");
  verb.add_option("--address", arguments.load.address, "of a raw image's first byte")
      ->check(CLI::Range(0, 0x1ffff))
      ->type_name("A");
}

}  // namespace

void add_flash(CLI::App& program, Action& action) {
  auto* flash_verb = program.add_subcommand(
      "flash", "puts a firmware into a servo board: boot mode or resident loader");
  flash_verb->require_subcommand(1);
  flash_verb->footer(
      "Examples:\n"
      "  kaz flash write build/release/firmware/kaz.mot --port /dev/ttyUSB0\n"
      "  kaz flash write kaz.mot --port board --reset ctl:board.ctl     (kaz sim --erased)\n"
      "  kaz flash write kaz.mot --port /dev/ttyUSB0 --reset manual\n"
      "  kaz flash info --port /dev/ttyUSB0\n"
      "Exit status: 0 done and verified, 1 it failed, 2 wrong usage or image, 3 port trouble.");
  const auto add = [&](const char* name, const char* text) {
    auto* verb = flash_verb->add_subcommand(name, text);
    auto arguments = std::make_shared<Arguments>();
    arguments->verb = name;
    add_common(*verb, *arguments);
    verb->callback([&action, arguments] { action = [arguments] { return flash(*arguments); }; });
    return std::pair(verb, arguments);
  };
  add("info", "what the board says of itself");
  add("run", "starts what is in the flash");
  auto [write, to_write] =
      add("write", "erases what differs, writes, verifies and starts an image");
  add_image(*write, *to_write);
  write->add_flag("--dry-run", to_write->dry_run, "look at the image and the port, send nothing");
  write->add_flag("--force", to_write->force,
                  "although the image is for another board or no Kaz's");
  write->add_flag("!--no-start", to_write->start, "do not start it");
  write->add_flag("--json", to_write->json, "the report as JSON on standard output");
  auto [verify, to_verify] = add("verify", "compares the flash with an image");
  add_image(*verify, *to_verify);
  auto [erase, to_erase] = add("erase", "erases blocks; with --reset all of them");
  erase->add_option("--blocks", to_erase->blocks, "0..9; boot mode has erased all anyway")
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
