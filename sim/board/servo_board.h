// The servo board: the circuit around the microcontroller.
// SPDX-License-Identifier: Apache-2.0
//
// The circuit consists of multiplexers and potentiometers at the inputs of the A/D converter, motor drivers
// at the PWM and direction pins, and the supply.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "sim/board/driver_heat.h"
#include "sim/board/imu.h"
#include "sim/board/potentiometer.h"
#include "sim/board/sensor_file.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

struct ServoBoardOptions {
  std::uint64_t seed = 1;
  SensorParams params = {};     // parameters from sensors.xml
  SensorSwitches sensors = {};  // determine which sensors have errors and noise
  // True: gyro and accelerometer on AN3..AN5; false: these inputs are grounded.
  bool imu = false;
  double supply_volts = 10.0;  // open-circuit voltage
  double supply_ohms = 0.15;   // resistance of battery, switch and wires
};

// Mean output of a motor driver over an interval.
struct MeanDrive {
  // Mean duty over the whole interval, -1..1. A positive duty drives in the joint's direction.
  double duty = 0;
  bool powered = false;  // true: the drivers were enabled for more than half of the interval
};

// Fault of a potentiometer. The default is no fault.
struct PotFault {
  std::optional<double> level;  // constant level of the input, as a fraction of AVCC
  double noise_codes = 0;       // sigma of additional noise
  bool stuck = false;           // true: the output no longer follows the angle
  template <class A>
  void transfer(A& a) {
    a(level, noise_codes, stuck);
  }
};

// Returns the duty at the pins, -1..1. A positive duty drives the joint toward larger angles. The enable
// signal of the drivers is ignored.
double duty_of(const PinLevels& pins, std::size_t joint);

class ServoBoard {
 public:
  ServoBoard(std::unique_ptr<Mcu> mcu, const ServoBoardOptions& options);
  ServoBoard(const ServoBoard&) = delete;
  ServoBoard& operator=(const ServoBoard&) = delete;

  Mcu& mcu() { return *mcu_; }
  const Mcu& mcu() const { return *mcu_; }

  // Returns the board time, which also advances while the power is off.
  States now() const { return now_; }
  // Runs until `now() >= until`. If an instruction begins before `until` and ends after `until`, the
  // run ends with this instruction. Returns the errors of Mcu::run_until().
  Result<void> run_until(States until);

  // Sets the angles of the output shafts, rad. A positive shaft angle has the direction of a positive joint
  // angle, even if the servo is mounted mirrored. `angles_rad` is indexed by joint number (joints.def). The
  // angles stay in effect until the next call.
  void set_joint_angles(std::span<const double, KZ_JOINTS> angles_rad);
  // Sets the sum of the motors' supply currents. This current makes the supply voltage sag. The value stays
  // in effect until the next call.
  void set_supply_current(double amperes) { supply_current_ = amperes; }
  // Sets the sum of the magnitudes of the motor currents. These currents heat the drivers. The value stays in
  // effect until the next call.
  void set_motor_current(double amperes);
  double driver_celsius() const { return heat_.celsius(); }
  // Sets the motion of the board in the last millisecond. Call once per millisecond if the option `imu` is
  // set.
  void set_motion(const ImuMotion& motion);
  const std::optional<Imu>& imu() const { return imu_; }
  double supply_volts() const;
  // Sets the open-circuit voltage of the supply, V.
  void set_supply(double volts) { options_.supply_volts = volts; }
  // Sets a voltage that is added to the open-circuit voltage, V. The value stays in effect until the next
  // call.
  void set_supply_change(double volts) { supply_change_ = volts; }
  // Sets the fault of a joint's potentiometer. The fault lasts until the next call for this joint.
  void set_pot_fault(int joint, const PotFault& fault) {
    pot_faults_[static_cast<std::size_t>(joint)] = fault;
  }

  // For each joint, returns the mean output of the motor driver since the previous call of take_drives(). The
  // means are exact: every change of a pin is taken into account.
  std::array<MeanDrive, KZ_JOINTS> take_drives();

  const PinLevels& pins() const { return pins_; }
  bool drivers_enabled() const { return (pins_.p4 & KZ_P4_ENABLE) != 0; }

  // Transfer the bytes of the chip's serial line. Times are in board time. Bytes that arrive while the power
  // is off are lost.
  void receive(const SerialByte& byte);
  std::vector<SerialByte> take_transmitted();

  // Switches the power of the whole board: chip, motors, potentiometers.
  void set_power(bool on);
  bool power() const { return power_; }
  void reset();  // resets the chip by its RES pin
  // Sets the mode pins. The pins take effect at the next reset. Fails if the microcontroller has no boot
  // mode.
  Result<void> set_boot_pins(bool boot) { return mcu_->set_boot_pins(boot); }

  // Save and restore the complete state, including the state of the chip.
  void save(StateWriter& to);
  void restore(StateReader& from);
  // keep() and take() are alternatives to save() and restore(). The comment of Mcu::Kept explains the
  // difference. After take(), the sensors have the errors and the noise that `seed` determines. Call
  // set_joint_angles() after take().
  std::unique_ptr<const Mcu::Kept> keep(StateWriter& to);
  void take(StateReader& from, const Mcu::Kept* kept, std::uint64_t seed);

 private:
  template <class A>
  void transfer(A& a);
  double analog(int channel, const PinLevels& levels, States mcu_time) const;
  double noise_free(unsigned input) const;
  double noise_codes(unsigned input) const;
  void pins_changed(States at, const PinLevels& levels);
  void integrate(States until);
  void make_sensors();

  std::unique_ptr<Mcu> mcu_;
  ServoBoardOptions options_;
  bool power_ = true;
  States now_ = 0;
  States off_time_ = 0;  // board time minus chip time

  std::array<Potentiometer, KZ_JOINTS> potentiometers_;
  std::array<double, KZ_JOINTS> pot_{};  // fractions of AVCC, without noise
  std::array<PotFault, KZ_JOINTS> pot_faults_{};
  double supply_current_ = 0, supply_change_ = 0;
  double motor_current_ = 0;
  States heated_to_ = 0;
  DriverHeat heat_;
  std::optional<Imu> imu_;

  PinLevels pins_;
  States integrated_from_ = 0, integrated_to_ = 0;
  States enabled_states_ = 0;
  // Time integral of the signed duty. The unit of the duty is 1/256. The unit of the time is one state.
  std::array<std::int64_t, KZ_JOINTS> duty_states_{};
};

}  // namespace kaz::sim
