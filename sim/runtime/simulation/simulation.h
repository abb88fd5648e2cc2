// Simulates the robot on one clock: servo board, world, stereo camera, serial line, recorder.
// SPDX-License-Identifier: Apache-2.0
//
// Time advances only in step(), by one millisecond. The board first runs to the end of the step. Then the
// world moves. Each motor of the world is driven by the average output of the board during the step. The new
// joint angles are the inputs of the potentiometers in the next step. If the physics step is shorter than a
// millisecond, board and world alternate within the millisecond. A physics step may also be longer than a
// millisecond. The wall clock is never read: the same options and calls give the same recording, byte for
// byte (docs/explanation/time.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/faults/faults.h"
#include "sim/board/servo_board.h"
#include "sim/body/world/world.h"
#include "sim/mcu/mcu.h"
#include "sim/runtime/eyes/eyes.h"
#include "sim/runtime/eyes/render_thread.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "sim/runtime/simulation/fault_player.h"
#include "sim/runtime/simulation/hand_player.h"
#include "sim/runtime/simulation/robot_options.h"
#include "sim/runtime/simulation/serial_line.h"
#include "sim/runtime/simulation/step_ratio.h"
#include "sim/runtime/time.h"
#include "vision/image/frame.h"

namespace kaz::sim {

class Recorder;
class HandSource;
class RecordingTap;
struct RecordedMap;
struct RobotModel;

// Options of a simulation besides those of the robot.
struct SimulationSetup {
  std::string image_path;  // path of the firmware image for h8; empty: the flash is erased
  std::string world_path;  // path of an SDF file
  std::string robot_path;  // path of a URDF file
  // Robot that load_robot() has read from robot_path. create() reads the file if it is null.
  std::shared_ptr<const RobotModel> robot_model = nullptr;
  // Path of camera.json in the URDF's folder; not read for a robot without eyes.
  std::string camera_path;
  // Parameters of the sensors. create() reads these parameters from sensors.xml in the URDF's folder.
  SensorParams sensor_params = {};
  double supply_ohms = 0.15;  // resistance of battery, switch and wires
  FramePolicy frames = FramePolicy::wait;
  faults::Schedule faults;     // fault times count from the start of the simulation
  std::string recording_path;  // empty: no recording
  // Observer that receives each message of the recording. If the simulation writes no recording file, the
  // observer receives the messages that a recording file would contain. Must outlive the simulation.
  RecordingTap* tap = nullptr;
  // Source of manual actions. The simulation reads this source in each step in which messages are written to
  // a recording file or to `tap`. Must outlive the simulation.
  HandSource* hands = nullptr;
  // True: the recording contains the eyes' pictures and the digests of the pictures. False: only the digests.
  bool record_pictures = false;
  McapWriter::Metadata recording_facts;  // metadata of the recording, for example versions
  RendererFactory make_renderer;  // replaces the renderer of the robot's options, unless empty
  Drawing drawing = Drawing::own_thread;
  // For tests: time between calls of detour(). Zero: detour() is never called.
  Time detour_every{};
};

struct SimulationOptions : RobotOptions, SimulationSetup {
  SimulationOptions() { mcu = McuKind::native; }
  explicit SimulationOptions(const RobotOptions& robot) : RobotOptions(robot) {}
};

// Returns all inputs that determine the course of a simulation, as pairs of name and value. The inputs are
// the options, and digests of the files that the options name.
std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world);

// Makes the microcontroller that the options select. Returns Fault::usage for an invalid firmware image.
Result<std::unique_ptr<Mcu>> make_mcu(const SimulationOptions& options);

// Sets kind and picture size of the eyes in `camera` to those that the options select.
void set_eyes(CameraFile& camera, const RobotOptions& options);

class Simulation {
 public:
  // Loads the files. Starts the recording if the options contain a recording path. Fails if a file is missing
  // or invalid, or the physics step is invalid. Also fails if the servo board has too few channels for the
  // joints, or if a joint has wider limits than its channel.
  static Result<std::unique_ptr<Simulation>> create(const SimulationOptions& options);
  // Like create(), but with the given microcontroller, world and camera. For tests and other boards.
  static Result<std::unique_ptr<Simulation>> assemble(const SimulationOptions& options,
                                                      std::unique_ptr<Mcu> mcu,
                                                      std::unique_ptr<World> world,
                                                      const CameraFile& camera);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Advances by one millisecond. Fails if the chip has stopped or the disk is full. Also fails if physics or
  // rendering has failed. After an error, later calls return the same error.
  Result<void> step();
  const std::optional<Error>& error() const { return error_; }
  // Returns the time at the end of the last step. This time is a whole number of milliseconds.
  States now() const { return now_; }
  Time time() const { return time_of(now_); }

  // Writes bytes at the host's end of the serial line.
  void write(std::span<const std::uint8_t> bytes) { line_.write(bytes, now_); }
  std::size_t read(std::span<std::uint8_t> bytes) { return line_.read(bytes, now_); }
  SerialLine& line() { return line_; }

  // The eyes are closed initially, and a simulation with closed eyes renders no picture pairs. Call
  // open_eyes() before reading picture pairs. If the robot has no eyes, open_eyes() has no effect.
  bool has_eyes() const { return world_->head_frame() >= 0 && options_.eyes != EyeKind::none; }
  // Returns the error for a picture pair that is requested from a robot without eyes.
  static Error no_eyes();
  void open_eyes();
  void close_eyes() { eyes_open_ = false; }
  const CameraFile& camera() const { return camera_; }
  // Removes and returns the oldest pair that has reached the host by now.
  std::optional<vision::StereoPair> next_pair();
  // Like next_pair(), but without latency and jitter. Use this function to publish pairs to other processes
  // that apply the latency themselves.
  std::optional<vision::StereoPair> next_exposed_pair();
  std::uint64_t pairs_dropped() const;
  // Renders the world at `pose` (from World::pose()) with an observer's camera. Blocks until the picture is
  // complete.
  Result<vision::Image> picture(const View& view, const ScenePose& pose);

  ServoBoard& board() { return board_; }
  const ServoBoard& board() const { return board_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }

  // add_fault() adds a fault to the faults of the options; clear_faults() removes all faults. Fault times use
  // the same time scale as time(). A fault whose start is in the past begins in the next step.
  void add_fault(const faults::Fault& fault) { faults_.add(fault); }
  void clear_faults() { faults_.clear(); }
  const faults::Schedule& faults() const { return faults_.schedule(); }

  // Records the behavior's internal state (one JSON object) at the present time.
  void record_behavior(std::string_view json);
  // Records the host's map at the present time.
  void record_map(const RecordedMap& map);
  // Starts a recording now. To record from the beginning of the simulation, set
  // SimulationOptions::recording_path instead. Fails if the file cannot be written or a recording is in
  // progress.
  Result<void> start_recording(const std::string& path);
  // Returns true if a write to the recording in progress has failed. In this case, step() has also returned
  // an error.
  bool recording_failed() const;
  // Finishes the recording and returns the SHA-256 of the file. Returns an empty string if there is no
  // recording or the recording has no file. `interrupted_by` is the name of the signal that ended the run
  // early; the name is written to the recording. If `interrupted_by` is empty, no signal ended the run.
  Result<std::string> finish_recording(const std::string& interrupted_by = "");

  // Returns the whole state. The state contains the time, all random generators, and the states of bodies,
  // motors, chip, board, serial line, faults and eyes. The state of the eyes includes the picture pairs that
  // have not yet reached the host. The state does not contain the recording. A recording in progress
  // continues after save(). save() waits for pictures that are being rendered. Fails if the simulation has
  // failed, or if a part of the simulation, such as a test double, cannot be saved.
  Result<std::vector<std::uint8_t>> save();
  // Restores a saved state. This simulation then continues exactly like the saved simulation. Both
  // simulations must have the same options and the same build. `blob` may be damaged or hostile: indices,
  // lengths and ranges are checked. For invalid bytes, returns Fault::usage or the error of
  // Snapshot::unpack() and leaves this simulation unchanged.
  Result<void> restore(std::span<const std::uint8_t> blob);
  // A saved state for use within one process. Many episodes can begin from the same state.
  struct Start {
    std::unique_ptr<const World> world;
    std::unique_ptr<const Mcu::Kept> chip;
    std::vector<std::uint8_t> rest;
  };
  // Like save(), but returns a state for begin() in the same process. Also fails if the world cannot be
  // cloned.
  Result<Start> keep();
  // Continues from the state `start`. The random numbers and the constant sensor errors are determined by
  // `seed`. This simulation may differ from the simulation that returned `start` in the seed and in the
  // sensor options. All other options must be equal in the two simulations. A call of begin() lasts
  // microseconds, and a call of restore() lasts milliseconds. Several simulations may begin from the same
  // start concurrently. Fails if a recording is in progress or `start` does not fit this simulation.
  Result<void> begin(const Start& start, std::uint64_t seed);
  // Saves the state, runs `steps` steps without recording, and restores the state. If save() saves the
  // complete state, a detour has no visible effect. Tests use detours to check save().
  Result<void> detour(int steps);

 private:
  Simulation(const SimulationOptions& options, std::unique_ptr<Mcu> mcu,
             std::unique_ptr<World> world, const CameraFile& camera, StepRatio ratio);
  Result<void> advance();
  void move_world();
  void use_hands();
  void set_sensors(double since_s);
  void set_motion(const Eigen::Vector3d& specific_force);
  Eyes::Keep kept_of_pairs() const;
  void make_eyes();
  template <class A>
  void transfer(A& a);
  void read_state(StateReader& from);
  void record(States start, std::span<const SerialByte> to_board,
              std::span<const SerialByte> from_board);

  void record_transforms();
  Result<void> describe_robot();

  SimulationOptions options_;
  // Names of the frames to record; empty: no transforms are recorded.
  std::vector<std::string> robot_frames_;
  CameraFile camera_;
  std::unique_ptr<World> world_;
  StepRatio ratio_;
  ServoBoard board_;
  std::vector<std::size_t> channels_;  // servo board channel of each joint of the world
  std::vector<MotorDrive> drives_;     // drive of each joint of the world
  FaultPlayer faults_;
  HandPlayer hands_;
  SerialLine line_;
  std::unique_ptr<Recorder> recorder_;
  RenderThread draws_;
  std::unique_ptr<Eyes> eyes_;
  bool eyes_open_ = false;
  States now_ = 0;
  std::optional<Error> error_;
};

}  // namespace kaz::sim
