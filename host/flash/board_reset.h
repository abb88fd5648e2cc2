// Ways to reset a board and to set its mode pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "host/link/link.h"
#include "host/link/modem_lines.h"
#include "shared/base/result.hpp"

namespace kaz::host {

class BoardReset {
 public:
  virtual ~BoardReset() = default;
  // Resets the board into boot mode, or into the program in its flash.
  virtual Result<void> reset(bool boot) = 0;
  virtual std::string name() const = 0;
};

// Resets a board by modem lines. DTR is wired to RES; while DTR is active, the board is in reset. RTS is
// wired to the mode pins; an active RTS selects boot mode. A reset lasts 25 ms. If the chip's oscillator
// already runs, a reset of 20 clock cycles is enough. Opening a port activates both lines, so the board is
// held in reset until the first reset(). `port` and `clock` must outlive this object.
class ModemLineReset final : public BoardReset {
 public:
  ModemLineReset(ModemLines& port, Clock& clock) : port_(port), clock_(clock) {}
  Result<void> reset(bool boot) override;
  std::string name() const override { return "dtr-rts"; }

 private:
  ModemLines& port_;
  Clock& clock_;
};

// Resets through the control socket of `kaz sim` (docs/reference/simulator.md): "mode boot" or "mode run",
// then "reset".
class ControlSocketReset final : public BoardReset {
 public:
  explicit ControlSocketReset(std::string path) : path_(std::move(path)) {}
  Result<void> reset(bool boot) override;
  std::string name() const override { return "ctl:" + path_; }

 private:
  std::string path_;
};

// Manual reset: the user sets a switch and presses a button. `prompt_user` shows instructions and returns
// after the user has followed them.
class ManualReset final : public BoardReset {
 public:
  explicit ManualReset(std::function<Result<void>(const std::string& prompt)> prompt_user)
      : prompt_user_(std::move(prompt_user)) {}
  Result<void> reset(bool boot) override;
  std::string name() const override { return "manual"; }

 private:
  std::function<Result<void>(const std::string&)> prompt_user_;
};

}  // namespace kaz::host
