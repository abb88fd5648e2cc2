// Ways to a board's reset and mode pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/link/link.h"
#include "host/link/modem_lines.h"
#include "shared/base/result.hpp"

namespace kaz::host {

class BoardReset {
 public:
  virtual ~BoardReset() = default;
  // Resets the board, into boot mode or into the program in its flash.
  virtual Result<void> reset(bool boot) = 0;
  virtual std::string name() const = 0;
};

// DTR is wired to RES (active: in reset), RTS to the mode pins (active: boot mode). Resets last 25 ms:
// RES needs 20 states while the oscillator runs. Opening a port makes both active: until the first reset()
// the board is held in reset.
class ModemLineReset final : public BoardReset {
 public:
  ModemLineReset(ModemLines& port, Clock& clock) : port_(port), clock_(clock) {}
  Result<void> reset(bool boot) override;
  std::string name() const override { return "dtr-rts"; }

 private:
  ModemLines& port_;
  Clock& clock_;
};

// The control socket of `kaz sim` (docs/reference/simulator.md): "mode boot", "reset".
class ControlSocketReset final : public BoardReset {
 public:
  explicit ControlSocketReset(std::string path) : path_(std::move(path)) {}
  Result<void> reset(bool boot) override;
  std::string name() const override { return "ctl:" + path_; }

 private:
  std::string path_;
};

// Manual: a person sets a switch and presses a button; `prompt_user` shows what to do and returns when done.
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
