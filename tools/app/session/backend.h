// What a behaviour runs on: the virtual robot in lockstep, or a board on a serial port with a
// published camera or real ones. Both have the same three interfaces; callers cannot distinguish them.
// SPDX-License-Identifier: Apache-2.0
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

// A servo bus by the robot's files, before its port is open. Errors (usage): the files, another protocol.
struct ServoBusOfFile {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  host::PortAddress address;
  std::vector<host::BusJoint> joints;  // in the robot's order
};
Result<ServoBusOfFile> servo_bus_of(const BackendOptions& options);

// Such a bus for verbs that speak to its servos themselves.
struct ServoBus {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  std::unique_ptr<host::PortLink> port;  // at the bus's rate
  std::vector<host::BusJoint> joints;    // in the robot's order
};
// Of --robot, which must name one, and --robot-file. Errors: as of SessionBackend::open(); no servo is heard.
Result<ServoBus> open_servo_bus(const BackendOptions& options, const host::Interrupt& interrupt);

// That a servo at a port does not answer, with what to do.
Error silent_servo(const servo_bus::BusServo& servo, const std::string& port);
// Fails (environment) unless each servo says that its torque is off, naming those that do not. `release`:
// switches it off first.
Result<void> require_limp(host::BusDriver& driver, std::span<const host::BusJoint> joints,
                          const std::string& port, bool release);

class SessionBackend {
 public:
  // Errors: wrong or missing files (usage), ports that are not there (environment).
  // `interrupt` ends waiting and must outlive the backend.
  static Result<std::unique_ptr<SessionBackend>> open(const BackendOptions& options,
                                                      host::Interrupt& interrupt);
  virtual ~SessionBackend() = default;

  // Of the robot's boards: one with all joints, but for --robot boards:FILE.
  virtual std::vector<host::RobotBoard> boards() = 0;
  // That of the first board.
  host::Link& link() { return *boards().front().link; }
  virtual host::Clock& clock() = 0;
  // The port of the first board; null where the robot is simulated in this process.
  virtual const host::PortLink* port() const { return nullptr; }
  // Of buses of servos, those that have not confirmed that they are off (PortLink::still_on).
  virtual std::string still_on() const { return ""; }
  // To be called once, before camera() and camera_latency(): apart from open(), so that a board that does
  // not answer is reported before a camera that is not there.
  virtual Result<void> open_camera() = 0;
  // False: there is no camera, and camera() has no pictures. Valid after open_camera().
  virtual bool sees() const = 0;
  virtual vision::Camera& camera() = 0;
  // What is wrong with the pictures so far, one sentence; empty if nothing is.
  virtual std::string camera_warning() const { return ""; }
  // Of the vision that runs on it.
  virtual vision::Pace pace() const = 0;
  // From exposure to arrival at the host.
  virtual Time camera_latency() const = 0;
  // For recording, pictures and scoring; null where the robot is not simulated in this process.
  // Behaviours never see it.
  virtual sim::Simulation* simulation() = 0;
  // Faults of BackendOptions::faults that begin later than now.
  virtual std::vector<faults::Fault> faults_not_begun() const { return {}; }
  // The state of the behaviour, as one JSON object, for a recording where there is one.
  virtual void record_behavior(const std::string& /*json*/) {}
  virtual void record_map(const sim::RecordedMap& /*map*/) {}
  // Ends the recording, if there is one, and returns its SHA-256: of a virtual robot, or of a port.
  // `interrupted_by`: a signal's name, or empty.
  virtual Result<std::string> finish_recording(const std::string& interrupted_by = "") = 0;
  // Something of it could not be written.
  virtual bool recording_failed() const = 0;
};

// Checks what can be checked without opening anything.
Result<void> check(const BackendOptions& options);

// The virtual robot of `kaz demo`, `kaz run` and `kaz sim`: finds its files and loads them. Errors (usage):
// options that exclude each other; wrong or missing files.
Result<std::unique_ptr<sim::Simulation>> make_simulation(const BackendOptions& options,
                                                         sim::FramePolicy frames);

// BackendOptions::memory of a file that `kaz sim --memory` or `kaz calibrate joints` has written. Errors
// (usage): no such file, or another one.
Result<std::string> read_memory(const std::string& path);

}  // namespace kaz::tools
