// Port, reset and flash writer of one board.
// SPDX-License-Identifier: Apache-2.0
#include "tools/flash/session.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iterator>

#include "host/flash/diagnostic.h"
#include "host/link/port_address.h"
#include "host/link/requester.h"
#include "host/robot/connect.h"
#include "host/robot/find_boards.h"
#include "shared/base/files.hpp"
#include "tools/base/arguments.h"
#include "tools/base/paths.h"
#include "tools/base/time_lost.h"
#include "tools/kept/kept_run.h"
#include "tools/monitor/monitor.h"

namespace kaz::tools {
namespace {

using std::chrono::milliseconds;

// From reset to the first answer: the loader's sum over the application, then the self-test.
constexpr Time kStart = milliseconds(300);

}  // namespace

// Not by std::cin: Ctrl-C has to end the wait.
Result<void> FlashSession::prompt_user(const std::string& prompt) {
  progress_.done();
  std::fprintf(stderr, "%s, then press Enter: ", prompt.c_str());
  char letter = 0;
  while (letter != '\n') {
    pollfd watched[2] = {{STDIN_FILENO, POLLIN, 0}, {interrupt_.descriptor(), POLLIN, 0}};
    const int ready = poll(watched, 2, -1);
    if (interrupt_.requested()) return tl::unexpected(host::Interrupt::error());
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || ::read(STDIN_FILENO, &letter, 1) != 1)
      return fail(Fault::usage, "--reset manual needs somebody at the keyboard");
  }
  return {};
}

Result<void> FlashSession::make_reset() {
  const std::string& how = arguments_.reset;
  if (how.empty()) return {};
  if (how == "manual") {
    reset_ = std::make_unique<host::ManualReset>(
        [this](const std::string& prompt) { return prompt_user(prompt); });
  } else if (how.starts_with("ctl:")) {
    reset_ = std::make_unique<host::ControlSocketReset>(how.substr(4));
  } else if (how == "dtr-rts") {
    reset_ = std::make_unique<host::ModemLineReset>(*link_, clock_);
    if (arguments_.dry_run) return {};
    // Opening the port has made both lines active: the board is let go, so that its firmware can say
    // which board it is.
    if (auto released = reset_->reset(false); !released)
      return fail(released.error().fault, released.error().message +
                                              "; give --reset manual, or with `kaz sim` --reset "
                                              "ctl:" +
                                              port() + ".ctl");
    return clock_.sleep_until(clock_.now() + kStart);
  } else {
    return fail(Fault::usage, "--reset " + how + ": give dtr-rts, ctl:PATH or manual");
  }
  return {};
}

Result<void> FlashSession::read_writer() {
  const auto path = arguments_.writer.empty() ? data_file("firmware/writer.bin")
                                              : Result<std::string>(arguments_.writer);
  if (!path) return tl::unexpected(path.error());
  constexpr std::size_t max_bytes = 64 << 10;
  const auto bytes =
      KAZ_TRY(read_whole_file(*path, max_bytes, "give the flash writer, firmware/writer.bin"));
  program_.assign(bytes.begin(), bytes.end());
  if (program_.empty()) return fail(Fault::usage, *path + ": is empty; give the flash writer");
  return {};
}

Result<void> FlashSession::open() {
  if (auto read = read_writer(); !read) return read;
  const auto address = KAZ_TRY(parse_port(arguments_.port));
  port_ = address.name();
  auto link = KAZ_TRY(host::open_port(address, &interrupt_));
  link_ = std::move(link);
  if (simulated_mcu(port(), interrupt_) == "native")
    return fail(Fault::usage, "the simulator at " + port() +
                                  " runs --mcu native, which has no loader and no boot mode: start "
                                  "the simulator with --mcu h8");
  meter_ =
      std::make_unique<host::LatenessMeter>(*link_, clock_, time_lost_behind(port(), interrupt_));
  if (auto made = make_reset(); !made) return made;
  host::FlasherOptions options;
  options.boot.baud = arguments_.boot_baud;
  options.address = arguments_.address;
  options.force = arguments_.force;
  options.lateness = meter_.get();
  options.note = [this](const std::string& line) {
    progress_.done();
    std::fprintf(stderr, "kaz flash: %s\n", line.c_str());
  };
  options.progress = [this](const host::FlashProgress& p) {
    progress_.update(p.total > 0 ? static_cast<double>(p.done) / p.total : 0,
                     host::progress_text(p));
  };
  flasher_ = std::make_unique<host::Flasher>(*meter_, *meter_, program_, options);
  return {};
}

tl::unexpected<Error> FlashSession::nobody() const {
  return host::fail(Fault::environment,
                    host::Diagnostic{"no firmware and no loader answers on " + link_->name(),
                                     "a Kaz board at 115200 baud",
                                     "no valid reply",
                                     {"the board's flash is blank and needs boot mode",
                                      "this is the wrong port", "the board has no power"},
                                     "kaz flash write IMAGE " + host::robot_option(link_->name()) +
                                         " --reset dtr-rts (or ctl:PATH, or manual)"});
}

Result<void> FlashSession::enter(const host::FlashImage* image) {
  const auto there = flasher_->enter_loader();
  if (!there && (!reset_ || there.error().fault == Fault::failed ||
                 there.error().fault == Fault::interrupted))
    return tl::unexpected(there.error());
  if (image != nullptr) {
    if (auto allowed = flasher_->check(*image, through_boot()); !allowed) return allowed;
  }
  if (!reset_) {
    if (*there) return {};
    return tl::unexpected(with_earlier_notes(
        host::explain_silence(*link_, clock_, arguments_.address, nobody().value()),
        link_->name()));
  }
  if (image != nullptr && !flasher_->board_id())
    std::fprintf(
        stderr,
        "kaz flash: the board reports no id, so kaz cannot check that the image is for this "
        "board\n");
  return flasher_->enter_boot(*reset_);
}

Result<void> FlashSession::start() {
  if (auto left = flasher_->run(reset_.get()); !left) return left;
  return clock_.sleep_until(clock_.now() + kStart);
}

Result<kz_identify_reply> FlashSession::identify() {
  host::Requester requester(*meter_, *meter_, {.address = arguments_.address});
  auto board = host::repeat_if_late(
      meter_.get(), [&] { return host::identify_board(requester); }, host::kIdentifyBears);
  if (board || !through_boot()) return board;
  // Boot mode has erased the board's address.
  host::Requester at_default(*meter_, *meter_, {});
  return host::repeat_if_late(
      meter_.get(), [&] { return host::identify_board(at_default); }, host::kIdentifyBears);
}

std::optional<Error> FlashSession::at_another_address(const Error& error) {
  Error searched = host::explain_silence(*meter_, *meter_, arguments_.address, error);
  if (searched.message == error.message) return std::nullopt;
  return with_earlier_notes(std::move(searched), link_->name());
}

Error FlashSession::start_again(const Error& error) {
  const bool given_up = error.fault == Fault::interrupted || error.fault == Fault::usage;
  if (!given_up || !flasher_ || !flasher_->found() || !flasher_->found()->by_loader ||
      !flasher_->left_behind().empty())
    return error;
  const host::CleanUp clean_up(interrupt_);
  const auto started = flasher_->run(nullptr);
  const auto with = [&error](const std::string& state) {
    Error all = error;
    all.message += "; " + state;
    return all;
  };
  if (started) return with("the board was started again");
  if (started.error().fault == Fault::failed) return error;  // it has no application
  return with(
      "the board waits in its loader, which starts the application after 10 s; `kaz flash run " +
      host::robot_option(port()) + "` starts the application immediately");
}

Error FlashSession::with_advice(Error error) const {
  const std::string left = flasher_ ? flasher_->left_behind() : "";
  if (!left.empty()) error.details.push_back("left: " + left);
  return error;
}

}  // namespace kaz::tools
