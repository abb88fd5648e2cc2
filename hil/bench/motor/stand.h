// What a workbench has besides the board: supply, clamp and scale, weight, protractor, a disc.
// SPDX-License-Identifier: Apache-2.0
//
// Angles and torques in the joint's own sense, rad and Nm at the output shaft. Errors: what the tools
// themselves say (no such stand, interrupted).
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/link/link.h"
#include "shared/base/result.hpp"

namespace kaz::hil {

class Stand {
 public:
  virtual ~Stand() = default;
  virtual std::string name() const = 0;
  // Inertia of the disc on the shaft, kg m2.
  virtual Result<double> disc_kgm2() = 0;
  // Volts of the supply without load.
  virtual Result<void> set_supply(double volts) = 0;
  // The shaft held by a lever against a scale, which is set to zero; or free again.
  virtual Result<void> clamp(int joint, bool on) = 0;
  // Before the motor presses, in the joint's positive sense or the negative one.
  virtual Result<void> prepare_press(int joint, bool positive) = 0;
  // What the motor has pressed with since then, at the end of its drive.
  virtual Result<double> scale_nm(int joint) = 0;
  // A weight laid on gently; 0: lifted off.
  virtual Result<void> press(int joint, double torque_nm) = 0;
  // A hand turns the shaft to about this angle; returns where the protractor shows it. The hand
  // keeps it until let_go().
  virtual Result<double> turn(int joint, double angle_rad) = 0;
  virtual Result<void> let_go(int joint) = 0;
  // As a bench begins: every shaft free, whatever an interrupted one has left there, and the supply.
  virtual Result<void> put_back(double supply_volts) = 0;
  // How long the motor has to press for the scale to be read.
  virtual double pressing_s() const = 0;
  // How long the shaft is left to come to rest after press().
  virtual double settling_s() const = 0;
};

// Whoever understands the words of docs/howto/bench.md: the simulator, in process or by its control socket.
class CommandStand final : public Stand {
 public:
  using Query = std::function<Result<nlohmann::ordered_json>(const std::string& line)>;
  // Parses the replies of `query`, as a control socket sends them. One that is not JSON has no readings.
  static Query parsed(std::function<Result<std::string>(const std::string& line)> query);
  // pressing_s: how long a press is to last; the virtual scale wants 0.05 s.
  CommandStand(std::string name, Query query, host::Clock& clock, double pressing_s = 0.1)
      : name_(std::move(name)), query_(std::move(query)), clock_(clock), pressing_s_(pressing_s) {}

  std::string name() const override { return name_; }
  Result<double> disc_kgm2() override;
  Result<void> set_supply(double volts) override;
  Result<void> clamp(int joint, bool on) override;
  Result<void> prepare_press(int joint, bool positive) override;
  Result<double> scale_nm(int joint) override;
  Result<void> press(int joint, double torque_nm) override;
  Result<double> turn(int joint, double angle_rad) override;
  Result<void> let_go(int joint) override;
  Result<void> put_back(double supply_volts) override;
  double pressing_s() const override { return pressing_s_; }
  double settling_s() const override { return 0.3; }

 private:
  Result<void> send(const std::string& line);
  Result<double> number(const std::string& line, const char* key);
  std::string name_;
  Query query_;
  host::Clock& clock_;
  double pressing_s_;
};

// A person at the bench: `prompt` receives the instruction or question and returns the typed reply.
class ManualStand final : public Stand {
 public:
  using Prompt = std::function<Result<std::string>(const std::string& text)>;
  // disc_kgm2: what they have put on the shaft.
  ManualStand(Prompt prompt, double disc_kgm2) : prompt_(std::move(prompt)), disc_(disc_kgm2) {}

  std::string name() const override { return "manual"; }
  Result<double> disc_kgm2() override { return disc_; }
  Result<void> set_supply(double volts) override;
  Result<void> clamp(int joint, bool on) override;
  Result<void> prepare_press(int joint, bool positive) override;
  Result<double> scale_nm(int joint) override;
  Result<void> press(int joint, double torque_nm) override;
  Result<double> turn(int joint, double angle_rad) override;
  Result<void> let_go(int joint) override;
  Result<void> put_back(double supply_volts) override { return set_supply(supply_volts); }
  // Below the second after which the board takes a press for a stall.
  double pressing_s() const override { return 0.7; }
  double settling_s() const override { return 0.1; }

 private:
  Result<void> done(const std::string& prompt);
  Result<double> read(const std::string& prompt);
  Prompt prompt_;
  double disc_;
};

}  // namespace kaz::hil
