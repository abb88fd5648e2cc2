// Simulates the robot on one clock: servo board, world, stereo camera, serial line, recorder.
// SPDX-License-Identifier: Apache-2.0
//
// Time advances only in step(), by one millisecond. The board runs to the end of the step, its mean motor
// drives move the world, and the joint angles return to the potentiometers. With shorter physics steps, board
// and world alternate within the millisecond; physics steps may also be longer. The wall clock is never read:
// the same options and calls give the same recording, byte for byte (docs/explanation/time.md).
#pragma once

#include <cstdint>
#include <functional>
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
#include "sim/runtime/eyes/eye_kind.h"
#include "sim/runtime/eyes/eyes.h"
#include "sim/runtime/eyes/render_thread.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "sim/runtime/simulation/fault_player.h"
#include "sim/runtime/simulation/hand_player.h"
#include "sim/runtime/simulation/serial_line.h"
#include "sim/runtime/simulation/step_ratio.h"
#include "sim/runtime/time.h"
#include "sim/view/renderer_kind.h"
#include "vision/image/frame.h"

namespace kaz::sim {

class Recorder;
class HandSource;
class RecordingTap;
struct RecordedMap;

struct SimulationOptions {
  McuKind mcu = McuKind::native;
  std::string image_path;   // firmware for h8; empty: erased flash
  std::string world_path;   // SDF
  std::string robot_path;   // URDF
  std::string camera_path;  // camera.json beside the URDF; not read for a robot without eyes
  std::uint64_t seed = 1;
  std::string dynamics = "reduced";  // sim/body/world/world.h
  double physics_step_ms = 1;        // step of the world: 0.125, 0.25, 0.5, 1, 2 or 4
  bool suspended = false;            // WorldOptions::hung
  SensorSwitches sensors = {};
  SensorParams sensor_params = {};  // create() reads them from sensors.xml beside the URDF
  bool imu = false;                 // the board has gyro and accelerometer
  EyeKind eyes = EyeKind::ideal;
  int eye_width = 0;  // width of 4:3 pictures, px; 0: size from the camera file
  double supply_volts = 10.0;
  double supply_ohms = 0.15;  // resistance of battery, switch and wires
  FramePolicy frames = FramePolicy::wait;
  faults::Schedule faults;     // times since the start
  std::string recording_path;  // no recording if empty
  // Observes the messages of the recording, even without a file. Must outlive the simulation.
  RecordingTap* tap = nullptr;
  // Source of actions by hand, used in each step that is recorded or tapped. Must outlive the simulation.
  HandSource* hands = nullptr;
  bool record_pictures = false;          // records pictures of the eyes, not only their digests
  McapWriter::Metadata recording_facts;  // for the recording's metadata, such as versions
  RendererFactory renderer = maker_of(kDefaultRenderer);
  Drawing drawing = Drawing::own_thread;
  // For tests: period of detour() calls. Zero: never.
  Time detour_every{};
};

// Returns all inputs that determine the course of a simulation: options, and digests of its files.
std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world);

// Makes the microcontroller that the options select. Returns Fault::usage for an invalid firmware image.
Result<std::unique_ptr<Mcu>> make_mcu(const SimulationOptions& options);

class Simulation {
 public:
  // Loads the files and starts the recording, if there is one. Fails for missing or invalid files and an
  // invalid physics step. Also fails if the joints exceed the servo board's channels in number or limits.
  static Result<std::unique_ptr<Simulation>> create(const SimulationOptions& options);
  // As create(), with the given microcontroller, world and camera, for tests and other boards.
  static Result<std::unique_ptr<Simulation>> assemble(const SimulationOptions& options,
                                                      std::unique_ptr<Mcu> mcu,
                                                      std::unique_ptr<World> world,
                                                      const CameraFile& camera);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Advances by one millisecond. After an error (chip stopped, physics or rendering failed, disk full), later
  // calls return the same error.
  Result<void> step();
  const std::optional<Error>& error() const { return error_; }
  // Returns the end of the last step, a whole number of milliseconds.
  States now() const { return now_; }
  Time time() const { return time_of(now_); }

  // The host's end of the serial line.
  void write(std::span<const std::uint8_t> bytes) { line_.write(bytes, now_); }
  std::size_t read(std::span<std::uint8_t> bytes) { return line_.read(bytes, now_); }
  SerialLine& line() { return line_; }

  // The eyes are closed initially, so that a simulation without a reader renders nothing. For a robot without
  // eyes, open_eyes() has no effect.
  bool has_eyes() const { return world_->head_frame() >= 0 && options_.eyes != EyeKind::none; }
  static Error no_eyes();  // error for requests of pairs from a robot without eyes
  void open_eyes();
  void close_eyes() { eyes_open_ = false; }
  const CameraFile& camera() const { return camera_; }
  // Removes and returns the next pair that has reached the host by now, oldest first.
  std::optional<vision::StereoPair> next_pair();
  // As next_pair(), without latency and jitter, for publishers whose readers apply the latency.
  std::optional<vision::StereoPair> next_exposed_pair();
  std::uint64_t pairs_dropped() const;
  // Renders the world at `pose` (World::pose()) from an observer's camera. Blocks.
  Result<Picture> picture(const View& view, const ScenePose& pose);

  ServoBoard& board() { return board_; }
  const ServoBoard& board() const { return board_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }

  // Adds a fault to those of the options, or clears all. Times are on the scale of time(). A fault with a
  // past start begins in the next step.
  void add_fault(const faults::Fault& fault) { faults_.add(fault); }
  void clear_faults() { faults_.clear(); }
  const faults::Schedule& faults() const { return faults_.schedule(); }

  // Records the internal state of the behavior (one JSON object) at the present time.
  void record_behavior(std::string_view json);
  // Records the host's map at the present time.
  void record_map(const RecordedMap& map);
  // Starts a recording, as `recording_path` does from the start. Fails if the file cannot be written or a
  // recording is in progress.
  Result<void> start_recording(const std::string& path);
  // Returns whether a recording is in progress and a write has failed. step() has then failed, too.
  bool recording_failed() const;
  // Finishes the recording and returns its SHA-256, empty without a recording or without a file.
  // `interrupted_by` is the signal that ended the run early, else empty; the recording contains it.
  Result<std::string> finish_recording(const std::string& interrupted_by = "");

  // Returns the whole state: bodies, motors, chip, board, line, faults, eyes with pairs in flight, all random
  // generators and time. The recording is not part of it and continues. Waits for pictures being rendered.
  // Fails if the simulation has failed or a part cannot be saved (test doubles).
  Result<std::vector<std::uint8_t>> save();
  // Continues exactly like the saved simulation. This one must have the same options and build. The bytes may
  // be damaged or hostile: indices, lengths and ranges are checked. Returns Fault::usage, as
  // Snapshot::unpack() or for invalid bytes, and leaves the simulation unchanged.
  Result<void> restore(std::span<const std::uint8_t> blob);
  // State from which many episodes of one process begin.
  struct Start {
    std::unique_ptr<const World> world;
    std::unique_ptr<const Mcu::Kept> chip;
    std::vector<std::uint8_t> rest;
  };
  // As save(). Also fails if the world cannot be cloned.
  Result<Start> keep();
  // Continues from `start`, but with the random numbers and constant sensor errors of `seed`. This simulation
  // must have the same options except seed and sensors. Takes microseconds, while restore() takes
  // milliseconds. Several simulations may begin from one start concurrently. Fails if a recording is in
  // progress or the start does not fit.
  Result<void> begin(const Start& start, std::uint64_t seed);
  // Saves, runs `steps` steps without recording, and restores. Must have no visible effect, which tests that
  // save() is complete.
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
  std::vector<std::string> robot_frames_;  // frames to record; empty: no transforms are recorded
  CameraFile camera_;
  std::unique_ptr<World> world_;
  StepRatio ratio_;
  ServoBoard board_;
  std::vector<std::size_t> channels_;  // channel of the servo board, by joint of the world
  std::vector<MotorDrive> drives_;     // by joint of the world
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
