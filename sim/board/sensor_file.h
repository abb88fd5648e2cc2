// The sensor file (parameters of the board's sensors), and switches that make each sensor real or ideal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Noise is given as one sigma, in codes of the A/D converter. By default sensors have no errors and no noise.
struct PotentiometerParams {
  double noise_codes = 0;
  double linearity = 0;     // maximum deviation, fraction of the range
  double mounting_rad = 0;  // maximum offset
  double terminal_rad = 0;  // how far the contact extends beyond each end of the track
  double open_level = 1;    // fraction of AVCC read with an open wiper
};

struct InputParams {
  double noise_codes = 0;
};

// Parameters of the first-order heating of the motor drivers. Each bridge dissipates `drop_volts` times its
// motor's current.
struct DriverParams {
  double noise_codes = 0;
  double ambient_celsius = 25;
  double drop_volts = 0;
  double kelvin_per_watt = 0;
  double time_constant_s = 1;
};

// One axis of the gyro (unit: rad/s) or of the accelerometer (unit: m/s^2).
struct ImuAxisParams {
  double share_per_unit = 0;  // fraction of AVCC per unit; zero is at half of AVCC
  double zero_offset = 0;     // maximum offset, in units
  double wander = 0;          // drift of the zero about its offset, one sigma, in units
  double wander_time_s = 1;   // correlation time of the drift (1/e)
  double bandwidth_hz = 40;   // bandwidth of the first-order low-pass, -3 dB
  double noise_density = 0;   // one-sided, units per root Hz
  double range = 0;           // in units; the output saturates beyond it
};

struct SensorParams {
  PotentiometerParams potentiometer;
  InputParams supply, reference;
  DriverParams driver;
  ImuAxisParams gyro, accelerometer;
};

// If true, the sensor has errors and noise. If false, the sensor's output is the nominal output exactly.
struct SensorSwitches {
  bool potentiometer = true;  // noise and open wiper beyond the track
  bool pot_as_built = false;  // individual linearity errors and mounting offsets
  bool supply = true;         // noise; the sag of the supply is always simulated
  bool reference = true;      // noise
  bool temperature = true;    // noise; the heating of the drivers is always simulated
  bool gyro = true;           // offset, bandwidth, noise, saturation
  bool accelerometer = true;

  bool operator==(const SensorSwitches&) const = default;
  static SensorSwitches ideal() { return {false, false, false, false, false, false, false}; }
  static SensorSwitches as_built() { return {true, true, true, true, true, true, true}; }
};

// Names of sets of switches, used in options and recordings.
enum class SensorSet { nominal, ideal, as_built };
inline constexpr std::array kSensorSets{SensorSet::nominal, SensorSet::ideal, SensorSet::as_built};

constexpr const char* to_string(SensorSet set) {
  return set == SensorSet::nominal ? "nominal" : set == SensorSet::ideal ? "ideal" : "as-built";
}

SensorSwitches sensor_switches(SensorSet set);
// Returns the name of the set with these switches, or "mixed".
std::string name_of(const SensorSwitches& sensors);

// Loads a sensor file, which must have every parameter. Errors name file and line.
Result<SensorParams> load_sensor_file(const std::string& path);

}  // namespace kaz::sim
