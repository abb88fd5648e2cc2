// Robot and camera on which a behavior runs: virtual in lockstep, or boards at ports with a camera.
// SPDX-License-Identifier: Apache-2.0
//
// The camera of boards is published or real. A behavior uses the same interfaces for virtual and real robots.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/bus/bus_board.h"
#include "host/link/interrupt.h"
#include "host/link/link.h"
#include "host/link/port_link.h"
#include "host/robot/robot.h"
#include "shared/base/result.hpp"
#include "shared/faults/faults.h"
#include "sim/runtime/simulation/simulation.h"
#include "tools/app/session/backend_options.h"
#include "vision/image/frame.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

// Servo bus as described by the robot's files, before its port is open.
struct ServoBusOfFile {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  host::PortAddress address;
  std::vector<host::BusJoint> joints;  // in the order of the robot's joints
};
// `options.robot` must name a servo bus. Fails (usage) if the robot's files are not valid or describe another
// protocol.
Result<ServoBusOfFile> servo_bus_of(const BackendOptions& options);

// Open servo bus, for commands that communicate with the servos directly.
struct ServoBus {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  std::unique_ptr<host::PortLink> port;  // at the bus's baud rate
  std::vector<host::BusJoint> joints;    // in the order of the robot's joints
};
// Opens the port of the servo bus in `options.robot`, without any request to the servos. Errors as of
// SessionBackend::open().
Result<ServoBus> open_servo_bus(const BackendOptions& options, const host::Interrupt& interrupt);

// Returns the error for a servo that does not reply, with advice for the user.
Error silent_servo(const servo_bus::BusServo& servo, const std::string& port);
// Fails (environment) unless every servo confirms that its torque is off; the message lists the others. With
// `release` it first switches the torque off.
Result<void> require_limp(host::BusDriver& driver, std::span<const host::BusJoint> joints,
                          const std::string& port, bool release);

class SessionBackend {
 public:
  // Opens the robot, but not its camera. Fails with Fault::usage for wrong or missing files, and with
  // Fault::environment for missing ports. `interrupt` ends waits and must outlive the backend.
  static Result<std::unique_ptr<SessionBackend>> open(const BackendOptions& options,
                                                      host::Interrupt& interrupt);
  virtual ~SessionBackend() = default;

  // The robot's boards: several with --robot boards:FILE, else one with all joints.
  virtual std::vector<host::RobotBoard> boards() = 0;
  // Link of the first board.
  host::Link& link() { return *boards().front().link; }
  virtual host::Clock& clock() = 0;
  // Port of the first board; null if the robot is simulated in this process.
  virtual const host::PortLink* port() const { return nullptr; }
  // Lists the servos that have not confirmed that they are off (PortLink::still_on). Empty for boards.
  virtual std::string still_on() const { return ""; }
  // Call this once, before camera() and camera_latency(). It is separate from open() so that an unresponsive
  // board is reported before a missing camera.
  virtual Result<void> open_camera() = 0;
  // False if there is no camera, and camera() never has pictures. Valid after open_camera().
  virtual bool sees() const = 0;
  virtual vision::Camera& camera() = 0;
  // One sentence on a problem with the pictures so far; empty if they are good.
  virtual std::string camera_warning() const { return ""; }
  // Pace of the vision pipeline on this backend.
  virtual vision::Pace pace() const = 0;
  // Time from exposure to arrival at the host.
  virtual Time camera_latency() const = 0;
  // For recording, pictures and scoring; null if the robot is not simulated in this process. Behaviors have
  // no access to it.
  virtual sim::Simulation* simulation() = 0;
  // Faults of BackendOptions::faults that have not begun yet.
  virtual std::vector<faults::Fault> faults_not_begun() const { return {}; }
  // Records the state of the behavior, as one JSON object, if there is a recording.
  virtual void record_behavior(const std::string& /*json*/) {}
  virtual void record_map(const sim::RecordedMap& /*map*/) {}
  // Ends the recording and returns its SHA-256; empty without a recording. `interrupted_by`: name of a
  // signal, or empty.
  virtual Result<std::string> finish_recording(const std::string& interrupted_by = "") = 0;
  // Whether writing the recording has failed.
  virtual bool recording_failed() const = 0;
};

// Checks everything that does not require opening a device. Fails with Fault::usage.
Result<void> check(const BackendOptions& options);

// Creates the virtual robot of `kaz demo`, `kaz run` and `kaz sim` from its files. Fails (usage) if options
// exclude each other, or if files are wrong or missing.
Result<std::unique_ptr<sim::Simulation>> make_simulation(const BackendOptions& options,
                                                         sim::FramePolicy frames);

// Reads BackendOptions::memory from a file written by `kaz sim --memory` or `kaz calibrate joints`. Fails
// (usage) if the file is missing or has another size.
Result<std::string> read_memory(const std::string& path);

}  // namespace kaz::tools
