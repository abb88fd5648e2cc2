// The sensor file (parameters of the board's sensors), and switches that make each sensor real or ideal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// The noise of a sensor is given as a standard deviation (sigma), in codes of the A/D converter. By default,
// sensors have no errors and no noise.
struct PotentiometerParams {
  double noise_codes = 0;
  double linearity = 0;     // maximum deviation from linearity, as a fraction of the range
  double mounting_rad = 0;  // maximum offset of the mounted potentiometer, rad
  double terminal_rad = 0;  // length of the terminal contact beyond each end of the track, rad
  double open_level = 1;    // level of the input while the wiper is open, as a fraction of AVCC
};

struct InputParams {
  double noise_codes = 0;
};

// Parameters of the first-order heating of the motor drivers. Each bridge dissipates `drop_volts` times the
// current of the connected motor.
struct DriverParams {
  double noise_codes = 0;
  double ambient_celsius = 25;
  double drop_volts = 0;
  double kelvin_per_watt = 0;
  double time_constant_s = 1;
};

// One axis of the gyro (unit: rad/s) or of the accelerometer (unit: m/s^2).
struct ImuAxisParams {
  // Slope of the output, as a fraction of AVCC per rad/s or per m/s^2. If the measured quantity is 0, the
  // output is half of AVCC.
  double share_per_unit = 0;
  double zero_offset = 0;    // maximum offset of the zero point, rad/s or m/s^2
  double wander = 0;         // standard deviation of the zero point's drift, rad/s or m/s^2
  double wander_time_s = 1;  // time in which the correlation of the drift falls to 1/e
  double bandwidth_hz = 40;  // bandwidth of the first-order low-pass, -3 dB
  double noise_density = 0;  // one-sided noise density, units per root Hz
  double range = 0;          // maximum, rad/s or m/s^2; beyond this value, the output saturates
};

struct SensorParams {
  PotentiometerParams potentiometer;
  InputParams supply, reference;
  DriverParams driver;
  ImuAxisParams gyro, accelerometer;
};

// Switches for the errors of the sensors. True: the sensor has errors and noise. False: the output of the
// sensor is exactly the nominal output.
struct SensorSwitches {
  // True: the reading has noise, and the wiper is open beyond the terminal contacts.
  bool potentiometer = true;
  bool pot_as_built = false;  // individual linearity errors and mounting offsets
  // Noise of the measured supply voltage. The supply sags for both values of this switch.
  bool supply = true;
  bool reference = true;  // noise
  // Noise of the measured temperature. The drivers heat up for both values of this switch.
  bool temperature = true;
  bool gyro = true;  // offset, bandwidth, noise, saturation
  bool accelerometer = true;

  bool operator==(const SensorSwitches&) const = default;
  static SensorSwitches ideal() { return {false, false, false, false, false, false, false}; }
  static SensorSwitches as_built() { return {true, true, true, true, true, true, true}; }
};

// A SensorSet is a combination of sensor switches. Options and recordings use the name of the SensorSet.
enum class SensorSet { nominal, ideal, as_built };
inline constexpr std::array kSensorSets{SensorSet::nominal, SensorSet::ideal, SensorSet::as_built};

constexpr const char* to_string(SensorSet set) {
  return set == SensorSet::nominal ? "nominal" : set == SensorSet::ideal ? "ideal" : "as-built";
}

SensorSwitches sensor_switches(SensorSet set);

// Loads a sensor file, which must contain every parameter. An error message names file and line.
Result<SensorParams> load_sensor_file(const std::string& path);

}  // namespace kaz::sim
