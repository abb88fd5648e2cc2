// Robot and camera on which a behavior runs: a virtual robot in lockstep, or boards at ports with a camera.
// SPDX-License-Identifier: Apache-2.0
//
// With boards at ports, the pictures come from another program or from real cameras. A behavior uses the same
// interfaces for virtual and real robots.
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
#include "tools/run/backend_options.h"
#include "vision/image/frame.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {

// Servo bus as described by the robot's files. The port is not open yet.
struct ServoBusOfFile {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  host::PortAddress address;
  std::vector<host::BusJoint> joints;  // in the order of the robot's joints
};
// Reads the robot's files. `options.robot` must name a servo bus. Fails (usage) if the robot's files are not
// valid or describe another protocol.
Result<ServoBusOfFile> servo_bus_of(const BackendOptions& options);

// Open servo bus, for commands that communicate with the servos directly.
struct ServoBus {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  std::unique_ptr<host::PortLink> port;  // open port, set to the bus's baud rate
  std::vector<host::BusJoint> joints;    // in the order of the robot's joints
};
// Opens the port of the servo bus in `options.robot`, without sending a request to the servos. Fails like
// SessionBackend::open().
Result<ServoBus> open_servo_bus(const BackendOptions& options, const host::Interrupt& interrupt);

// Returns the error for a servo that does not reply, with advice for the user.
Error silent_servo(const servo_bus::BusServo& servo, const std::string& port);
// Fails (environment) if a servo does not confirm that its torque is off. The message lists the servos that
// did not confirm. With `release`, first switches the torque of all servos off.
Result<void> require_limp(host::BusDriver& driver, std::span<const host::BusJoint> joints,
                          const std::string& port, bool release);

class SessionBackend {
 public:
  // Opens the robot, but not its camera. Fails with Fault::usage for wrong or missing files, and with
  // Fault::environment for missing ports. `interrupt` ends waits and must outlive the backend.
  static Result<std::unique_ptr<SessionBackend>> open(const BackendOptions& options,
                                                      host::Interrupt& interrupt);
  virtual ~SessionBackend() = default;

  // Returns the robot's boards: several boards with --robot boards:FILE, else one board with all joints.
  virtual std::vector<host::RobotBoard> boards() = 0;
  // Returns the link of the first board.
  host::Link& link() { return *boards().front().link; }
  virtual host::Clock& clock() = 0;
  // Returns the port of the first board; null if the robot is simulated in this process.
  virtual const host::PortLink* port() const { return nullptr; }
  // Returns a list of the servos that have not confirmed that their torque is off (PortLink::still_on). Empty
  // for boards.
  virtual std::string still_on() const { return ""; }
  // Opens the camera. Call open_camera() once, before camera() and camera_latency(). This function is
  // separate from open(), so that an unresponsive board is reported before a missing camera.
  virtual Result<void> open_camera() = 0;
  // Returns false if there is no camera: camera() then never returns pictures. Valid after open_camera().
  virtual bool sees() const = 0;
  virtual vision::Camera& camera() = 0;
  // Returns one sentence about a problem with the pictures so far; empty if the pictures are good.
  virtual std::string camera_warning() const { return ""; }
  // Returns the pace of the vision pipeline on this backend.
  virtual vision::Pace pace() const = 0;
  // Returns the time from the exposure of a picture to its arrival at the host.
  virtual Time camera_latency() const = 0;
  // Returns the simulation, for recording, pictures and scoring; null if the robot is not simulated in this
  // process. Behaviors have no access to the simulation.
  virtual sim::Simulation* simulation() = 0;
  // Returns the faults of the schedule BackendOptions::faults that have not begun yet.
  virtual std::vector<faults::Fault> faults_not_begun() const { return {}; }
  // If there is a recording, records the state of the behavior as one JSON object.
  virtual void record_behavior(const std::string& /*json*/) {}
  virtual void record_map(const sim::RecordedMap& /*map*/) {}
  // Ends the recording and returns its SHA-256; empty if there is no recording. `interrupted_by`: name of the
  // signal that ended the run; empty if no signal did.
  virtual Result<std::string> finish_recording(const std::string& interrupted_by = "") = 0;
  // Returns whether writing the recording has failed.
  virtual bool recording_failed() const = 0;
};

// Checks all options that can be checked without opening a device. Fails with Fault::usage.
Result<void> check(const BackendOptions& options);

// Creates the virtual robot of `kaz demo`, `kaz run` and `kaz sim` from the robot's files. Fails (usage) if
// options exclude each other, or if files are wrong or missing.
Result<std::unique_ptr<sim::Simulation>> make_simulation(const BackendOptions& options,
                                                         sim::FramePolicy frames);

// Reads a value for BackendOptions::memory from a file that `kaz sim --memory` or `kaz calibrate joints` has
// written. Fails (usage) if the file is missing or has another size.
Result<std::string> read_memory(const std::string& path);

}  // namespace kaz::tools
