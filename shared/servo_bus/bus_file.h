// bus.json, beside a robot's URDF: which servo drives which joint.
// SPDX-License-Identifier: Apache-2.0
//
// Read by the virtual bus and by a host at a real one. docs/reference/servo-bus.md describes it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"

namespace kaz::servo_bus {

struct BusServo {
  std::string joint;
  int id = 0;
  const Model* model = nullptr;
  double zero = 0;        // the sensor's step at the joint's angle 0
  bool reversed = false;  // steps fall as the angle grows

  // Step of the sensor at an angle (rad), and back; not wrapped.
  double steps_at(double angle) const { return zero + sign() * angle * model->steps_per_rad(); }
  double angle_at(double steps) const { return sign() * (steps - zero) / model->steps_per_rad(); }
  double sign() const { return reversed ? -1 : 1; }
};

// A register of every servo, as it was written when the robot was set up.
struct BusSetting {
  std::string name;
  int value = 0;
};

struct BusFile {
  Protocol protocol = Protocol::feetech;
  long baud = 0;
  double supply_volts = 0;
  double supply_ohm = 0;  // of battery and wires together
  std::vector<BusSetting> settings;
  std::vector<BusServo> servos;
};

// `path`: for errors, which name it. Ids may occur twice: a virtual bus with such a fault is worth having.
Result<BusFile> parse_bus_file(const std::string& path, const std::string& text);
// bus.json beside the URDF.
std::string bus_file_path(const std::string& urdf_path);
Result<BusFile> load_bus_file(const std::string& urdf_path);

// The text of such a file, which must be one, with other zeros, by joint; all else stays as it is.
std::string with_zeros(const std::string& text, const std::map<std::string, double>& zeros);

}  // namespace kaz::servo_bus
