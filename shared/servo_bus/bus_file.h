// Reads bus.json, which assigns servos on a bus to a robot's joints. The file is in the folder of the robot's
// URDF.
// SPDX-License-Identifier: Apache-2.0
//
// The virtual bus and hosts of real buses read this file. docs/reference/servo-bus.md specifies the format.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"

namespace kaz::servo_bus {

struct BusServo {
  std::string joint;
  int id = 0;
  const Model* model = nullptr;  // never null in a parsed file
  double zero = 0;               // reading of the position sensor at joint angle 0, steps
  bool reversed = false;         // true: the sensor reading falls as the joint angle rises
  // Voltage of the servo's own supply; empty: the bus's supply. Servos with equal values share one supply.
  std::optional<double> supply_volts = std::nullopt;

  // Convert between joint angle (rad) and sensor steps, without wrapping.
  double steps_at(double angle) const { return zero + sign() * angle * model->steps_per_rad(); }
  double angle_at(double steps) const { return sign() * (steps - zero) / model->steps_per_rad(); }
  double sign() const { return reversed ? -1 : 1; }
};

// Value of an EEPROM register in all servos, after the setup of the robot.
struct BusSetting {
  std::string name;
  int value = 0;
};

struct BusFile {
  Protocol protocol = Protocol::feetech;
  long baud = 0;  // a rate that servos of this protocol support
  double supply_volts = 0;
  double supply_ohm = 0;  // resistance of battery and wires, of each supply
  // Virtual Feetech servos answer a broadcast ping in the order of their ids; false: all at once.
  bool broadcast_ping_in_turn = false;
  std::vector<BusSetting> settings;
  std::vector<BusServo> servos;
};

// Parses the text of a bus.json. `path` appears in error messages only; the file is not opened. Returns
// Fault::usage for invalid text. Duplicate ids are valid, so that a virtual bus can simulate servos with
// equal ids.
Result<BusFile> parse_bus_file(const std::string& path, const std::string& text);
// Returns the path of bus.json in the folder of the URDF.
std::string bus_file_path(const std::string& urdf_path);
// Reads and parses bus.json in the folder of the URDF. If bus.json is missing or invalid, returns
// Fault::usage.
Result<BusFile> load_bus_file(const std::string& urdf_path);

// `zeros` maps the name of a joint to a new value of BusServo::zero. Returns a copy of `text` with the new
// values. All other values are the same as in `text`. Precondition: parse_bus_file accepts `text`.
std::string with_zeros(const std::string& text, const std::map<std::string, double>& zeros);

}  // namespace kaz::servo_bus
