// A servo bus in simulated time: host, wire, and servos whose motors drive a robot's joints in a world.
// SPDX-License-Identifier: Apache-2.0
//
// Events on the wire have a resolution of 1 ns. The world and the servos' control loops advance in steps of
// World::step_s(), by default 1 ms. The simulation is deterministic: if two buses are created from the same
// files and receive the same calls, the bytes on both wires are the same.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "shared/servo_bus/bus_file.h"
#include "sim/body/world/world.h"
#include "sim/bus/half_duplex_line.h"
#include "sim/bus/virtual_servo.h"

namespace kaz::sim {

class VirtualBus {
 public:
  // Fails if the world lacks the joint of a servo, or if a joint of the world has no servo. If the motors of
  // the world are identified servos, bus servos of the same model use their control law.
  static Result<std::unique_ptr<VirtualBus>> create(std::unique_ptr<World> world,
                                                    const servo_bus::BusFile& file);
  // Loads the world file, the robot file, and bus.json in the folder of the robot file.
  static Result<std::unique_ptr<VirtualBus>> load(const std::string& world_path,
                                                  const std::string& robot_path,
                                                  const WorldOptions& options);

  Time time() const { return time_; }
  // Sends bytes from the host. The first byte begins at time() or after the host's earlier bytes, whichever
  // is later. Returns the time at which the last byte ends.
  Time write(std::span<const std::uint8_t> bytes);
  void set_host_baud(long baud);
  // Runs until time() is `until`.
  void advance(Time until);

  // A byte that the host's UART received. A byte with a framing error is only counted, because a serial port
  // drops the byte.
  struct HostByte {
    std::uint8_t byte;
    Time at;  // end of the stop bit
  };
  // The received bytes, oldest first. The caller removes the bytes that it has read.
  std::deque<HostByte>& received() { return received_; }
  // Returns the time at which the transmission of the last byte passed to write() ends. If the host is not
  // sending at time(), this end is not later than time().
  Time host_sends_until() const { return host_sends_until_; }

  // Sets a fault of the host's USB adapter: the adapter holds received bytes until its timer ends, or until
  // it holds kAdapterPacket bytes. The timer of FTDI's adapters has 16 ms; 0: no fault.
  void set_adapter_latency(Time latency);
  static constexpr std::size_t kAdapterPacket = 62;
  // Sets a fault of the host's adapter: the host receives the bytes that it sends.
  void set_adapter_echo(bool on) { line_.set_echo(0, on); }

  HalfDuplexLine& line() { return line_; }
  World& world() { return *world_; }
  std::size_t servos() const { return servos_.size(); }
  VirtualServo& servo(std::size_t i) { return *servos_[i].servo; }
  const VirtualServo& servo(std::size_t i) const { return *servos_[i].servo; }
  const servo_bus::BusServo& mount(std::size_t i) const { return servos_[i].mount; }

  // Sets the open-circuit voltage of the bus's supply.
  void set_supply_volts(double volts) { supplies_[0].volts = volts; }
  // Switches the supply of all servos on or off. Switching the supply off clears the RAM of the servos.
  void set_power(bool on);
  // Return the voltage at the servos of the bus's supply, or at servo i. The result is 0 if the supply is
  // off. The voltage drop is computed from the current in the preceding step of the world.
  double volts() const { return volts_of(supplies_[0]); }
  double volts(std::size_t i) const { return volts_of(supplies_[servos_[i].supply]); }

  // While the servo of joint i has no torque, a hand turns the joint to an angle (rad) and holds the joint
  // there. If the angle is beyond a stop, the hand presses against the stop.
  void turn_by_hand(std::size_t i, double angle);
  void take_hands_off();  // releases all joints
  // Present angle of joint i, rad.
  double angle(std::size_t i) const { return world_->joints()[servos_[i].joint].angle; }

 private:
  struct Mounted {
    servo_bus::BusServo mount;
    std::unique_ptr<VirtualServo> servo;
    std::size_t joint;       // index in the world's joint order
    std::size_t supply = 0;  // index in supplies_
    // Goal and present position of the hand that turns the joint, rad.
    std::optional<double> hand_goal = std::nullopt;
    double hand = 0;
  };
  struct Supply {
    double volts = 0;      // open-circuit voltage
    double current_a = 0;  // in the preceding step of the world
  };
  VirtualBus(std::unique_ptr<World> world, const servo_bus::BusFile& file,
             std::vector<Mounted> servos);
  ServoReading reading_of(const Mounted& one) const;
  void receive(const HalfDuplexLine::Received& received);
  double volts_of(const Supply& supply) const;
  void measure_supplies(const std::vector<MotorDrive>& drives);
  void hand_over();
  void step();
  MotorDrive hand_on(Mounted& one) const;

  std::unique_ptr<World> world_;
  std::vector<Mounted> servos_;
  HalfDuplexLine line_;           // node 0 is the host, node i + 1 is servo i
  std::vector<Supply> supplies_;  // the bus's first
  double supply_ohm_;
  bool power_ = true;
  Time time_{}, next_step_, step_length_, host_sends_until_{};
  Time adapter_latency_{};
  std::deque<HostByte> received_, held_;  // held_: not yet passed on by the adapter
};

}  // namespace kaz::sim
