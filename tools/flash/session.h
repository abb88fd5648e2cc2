// Connection of `kaz flash` to one board: port, reset line and flash writer.
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
#include "tools/base/output.h"
#include "tools/flash/arguments.h"

namespace kaz::tools {

class FlashSession {
 public:
  FlashSession(const FlashArguments& arguments, host::Interrupt& interrupt)
      : arguments_(arguments),
        clock_(&interrupt),
        interrupt_(interrupt),
        progress_("kaz flash", arguments.json) {}

  // Opens the port, and loads the flash writer.
  Result<void> open();
  // Enters boot mode if the reset line can be driven, else the loader. If firmware is running, the board's id
  // is first read from the firmware. `image` is checked against this id before the board is changed; null: no
  // check.
  Result<void> enter(const host::FlashImage* image);
  // Leaves boot mode or the loader, and waits until the firmware has started.
  Result<void> start();
  // Returns the identity of the running firmware. Repeats the request while this machine is late.
  Result<kz_identify_reply> identify();

  // Call this function after identify() returned `error`. Searches for a board at all addresses. If there is
  // a board at another address, returns the error to report; nullopt if no board is found.
  std::optional<Error> at_another_address(const Error& error);

  // Returns the reason why identify() may have failed although the board is healthy; empty if this machine
  // was on time.
  std::string excuse() const { return meter_->excuse(host::kIdentifyBears); }

  host::Flasher& flasher() { return *flasher_; }
  bool through_boot() const { return reset_ != nullptr; }
  // Returns the name of the port without the prefix `serial:`. Valid after open().
  const std::string& port() const { return port_; }
  void end_progress() { progress_.done(); }
  // After an interrupt or a usage error, starts the firmware of a board that waits in its loader, if no flash
  // was erased. Returns `error` with a note on the result.
  Error start_again(const Error& error);
  // Appends the resulting state of the board to the error.
  Error with_advice(Error error) const;

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
