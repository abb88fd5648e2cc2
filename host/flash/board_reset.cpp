// Resets by modem lines, by the simulator's control socket, or manually.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/board_reset.h"

#include "host/robot/control_socket.h"

namespace kaz::host {

Result<void> ModemLineReset::reset(bool boot) {
  static constexpr Time kStep = std::chrono::milliseconds(25);
  const auto wait = [this] { return clock_.sleep_until(clock_.now() + kStep); };
  if (auto set = port_.set_dtr_rts(true, boot); !set) return set;
  if (auto waited = wait(); !waited) return waited;
  // The chip samples the mode pins at the rising edge of RES.
  if (auto set = port_.set_dtr_rts(false, boot); !set) return set;
  return wait();
}

Result<void> ControlSocketReset::reset(bool boot) {
  for (const char* line : {boot ? "mode boot" : "mode run", "reset"}) {
    KAZ_TRY(query_control_socket(path_, line));
  }
  return {};
}

Result<void> ManualReset::reset(bool boot) {
  return prompt_user_(
      boot ? "Set the board's switch to boot mode (MD1, MD0 low) and press its reset button"
           : "Set the board's switch back to run (MD1 high) and press its reset button");
}

}  // namespace kaz::host
