// Interface to the tools of a motor test stand: supply, clamp with scale, weight, protractor and disc.
// SPDX-License-Identifier: Apache-2.0
//
// Angles and torques are positive in the joint's positive direction, rad and Nm at the output shaft. All
// errors come from the tools, for example because there is no stand or the user interrupted the operation.
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
  // Sets the no-load voltage of the supply.
  virtual Result<void> set_supply(double volts) = 0;
  // If `on`, holds the shaft by a lever against a scale and sets the scale to zero. Otherwise frees the
  // shaft.
  virtual Result<void> clamp(int joint, bool on) = 0;
  // Call this function before the motor presses against the scale. `positive`: the motor presses in the
  // joint's positive direction.
  virtual Result<void> prepare_press(int joint, bool positive) = 0;
  // Returns the torque on the scale at the end of the last drive. Precondition: prepare_press() was called
  // before this drive.
  virtual Result<double> scale_nm(int joint) = 0;
  // Loads the shaft gently with this torque, for example with a weight. A torque of 0 removes the load.
  virtual Result<void> press(int joint, double torque_nm) = 0;
  // Turns the shaft by hand to about this angle and holds the shaft until let_go(). Returns the angle that
  // the protractor shows.
  virtual Result<double> turn(int joint, double angle_rad) = 0;
  virtual Result<void> let_go(int joint) = 0;
  // Prepares the stand for a bench and sets the supply. A CommandStand also removes all tools, because an
  // interrupted bench may have left a shaft clamped.
  virtual Result<void> put_back(double supply_volts) = 0;
  // Duration of a press against the scale, s. A press of this duration is long enough for reading the scale.
  virtual double pressing_s() const = 0;
  // Time in which the shaft comes to rest after press(), s.
  virtual double settling_s() const = 0;
};

// A stand that executes the commands of docs/howto/bench.md: the simulator, in this process or through the
// control socket.
class CommandStand final : public Stand {
 public:
  using Query = std::function<Result<nlohmann::ordered_json>(const std::string& line)>;
  // Returns a Query that calls `query` and parses the reply. `query` should return replies in the JSON format
  // of a control socket. A reply that is not JSON is treated as a reply without readings.
  static Query parsed(std::function<Result<std::string>(const std::string& line)> query);
  // `pressing_s`: duration of a press, s; the virtual scale needs 0.05 s. `clock` must outlive this object.
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

// A stand that a person operates: `prompt` shows an instruction or question and returns the typed reply.
class ManualStand final : public Stand {
 public:
  using Prompt = std::function<Result<std::string>(const std::string& text)>;
  // `disc_kgm2`: inertia of the disc that the person has mounted.
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
  // A press must be shorter than 1 s, because the board detects a stall after 1 s.
  double pressing_s() const override { return 0.7; }
  double settling_s() const override { return 0.1; }

 private:
  Result<void> done(const std::string& prompt);
  Result<double> read(const std::string& prompt);
  Prompt prompt_;
  double disc_;
};

}  // namespace kaz::hil
