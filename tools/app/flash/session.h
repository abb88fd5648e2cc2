// One board under `kaz flash`, from the port to its flash writer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/flash/flasher.h"
#include "host/link/lateness.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "shared/protocol/messages.h"
#include "tools/app/base/output.h"
#include "tools/app/flash/arguments.h"

namespace kaz::tools {

class FlashSession {
 public:
  FlashSession(const FlashArguments& arguments, host::Interrupt& interrupt)
      : arguments_(arguments),
        clock_(&interrupt),
        interrupt_(interrupt),
        progress_("kaz flash", arguments.json) {}

  Result<void> open();
  // Through boot mode where the reset line can be driven; a running firmware reports its board's id
  // first. Nothing is changed before the image has been checked against that.
  Result<void> enter(const host::FlashImage* image);
  // Leaves boot mode or loader, and gives the firmware time to start.
  Result<void> start();
  // Identity of the running firmware; asked again while this machine is late.
  Result<kz_identify_reply> identify();

  // The error of identify(), after a search of all addresses; nullopt: no board is at another one.
  std::optional<Error> at_another_address(const Error& error);

  // Why identify() may have failed although the board is healthy; empty: this machine was not so late.
  std::string excuse() const { return meter_->excuse(host::kIdentifyBears); }

  host::Flasher& flasher() { return *flasher_; }
  bool through_boot() const { return reset_ != nullptr; }
  // Without `serial:`. After open().
  const std::string& port() const { return port_; }
  void end_progress() { progress_.done(); }
  // After an interrupt: a board that waits in its loader, with nothing erased, is started. The error with
  // what became of it.
  Error start_again(const Error& error);
  // An error with what it leaves on the board.
  Error with_advice(const Error& error) const;

 private:
  Result<void> prompt_user(const std::string& prompt);
  Result<void> make_reset();
  Result<void> read_writer();
  tl::unexpected<Error> nobody() const;

  const FlashArguments& arguments_;
  std::string port_;
  host::WallClock clock_;
  host::Interrupt& interrupt_;
  Progress progress_;
  std::unique_ptr<host::PortLink> link_;
  std::unique_ptr<host::LatenessMeter> meter_;
  std::unique_ptr<host::BoardReset> reset_;
  std::vector<std::uint8_t> program_;
  std::unique_ptr<host::Flasher> flasher_;
};

}  // namespace kaz::tools
