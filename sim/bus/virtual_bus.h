// A servo bus in simulated time: host, wire and servos, whose motors drive a robot's joints in a world.
// SPDX-License-Identifier: Apache-2.0
//
// What happens on the wire happens at its own time, to the nanosecond; the servos' control loops and the
// world step each millisecond. Same calls, same bytes.
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
  // Errors: a servo's joint is none of the world's; a joint of the world has no servo.
  static Result<std::unique_ptr<VirtualBus>> create(std::unique_ptr<World> world,
                                                    const servo_bus::BusFile& file);
  // World, robot and the bus.json beside it.
  static Result<std::unique_ptr<VirtualBus>> load(const std::string& world_path,
                                                  const std::string& robot_path,
                                                  const WorldOptions& options);

  Time time() const { return time_; }
  // Sends bytes of the host from time() on, or when its earlier ones are out. Returns when the last is.
  Time write(std::span<const std::uint8_t> bytes);
  void set_host_baud(long baud);
  // Runs until then.
  void advance(Time until);

  // Bytes that the host's UART received, with the end of their stop bits. Those without a stop bit, which a
  // serial port drops, are counted.
  struct HostByte {
    std::uint8_t byte;
    Time at;
  };
  std::deque<HostByte>& received() { return received_; }
  // The end of the host's last byte that is still to be sent or is being sent; in the past if there is none.
  Time host_sends_until() const { return host_sends_until_; }
  std::uint64_t host_framing_errors() const { return host_framing_errors_; }

  HalfDuplexLine& line() { return line_; }
  World& world() { return *world_; }
  std::size_t servos() const { return servos_.size(); }
  VirtualServo& servo(std::size_t i) { return *servos_[i].servo; }
  const VirtualServo& servo(std::size_t i) const { return *servos_[i].servo; }
  const servo_bus::BusServo& mount(std::size_t i) const { return servos_[i].mount; }

  void set_supply_volts(double volts) { supply_volts_ = volts; }
  // The supply of all servos: off loses their RAM.
  void set_power(bool on);
  double volts() const;  // at the servos, as of the last step

  // A hand turns the joint to this angle, rad, and holds it there, as long as its servo has no torque. Past a
  // stop it presses.
  void turn_by_hand(std::size_t i, double angle);
  void take_hands_off();
  double angle(std::size_t i) const { return world_->joints()[servos_[i].joint].angle; }

 private:
  struct Mounted {
    servo_bus::BusServo mount;
    std::unique_ptr<VirtualServo> servo;
    std::size_t joint;  // of the world
    // Where a hand takes it, and where it is by now.
    std::optional<double> hand_goal = std::nullopt;
    double hand = 0;
  };
  VirtualBus(std::unique_ptr<World> world, const servo_bus::BusFile& file,
             std::vector<Mounted> servos);
  ServoReading reading_of(const Mounted& one) const;
  void receive(const HalfDuplexLine::Received& received);
  void step();
  MotorDrive hand_on(Mounted& one) const;

  std::unique_ptr<World> world_;
  std::vector<Mounted> servos_;
  HalfDuplexLine line_;  // node 0 is the host, node i + 1 the servo i
  double supply_volts_, supply_ohm_;
  bool power_ = true;
  Time time_{}, next_step_, step_length_, host_sends_until_{};
  std::deque<HostByte> received_;
  std::uint64_t host_framing_errors_ = 0;
};

}  // namespace kaz::sim
