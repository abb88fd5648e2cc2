// The simulated robot on one clock: servo board, world, stereo camera, serial line, recorder.
// SPDX-License-Identifier: Apache-2.0
//
// Time advances only in step(), by one millisecond: the board runs to the end of the step, its mean motor
// drives move the world, and the joint angles return to the potentiometers. With shorter physics steps board
// and world alternate within the millisecond; physics steps may also be longer. Nothing here reads the wall
// clock: the same options and calls give the same recording, byte for byte (docs/explanation/time.md).
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
  std::string image_path;   // firmware, for h8; empty: its flash is erased
  std::string world_path;   // SDF
  std::string robot_path;   // URDF
  std::string camera_path;  // camera.json beside the URDF; not read for a robot without eyes
  std::uint64_t seed = 1;
  std::string dynamics = "reduced";  // sim/body/world/world.h
  double physics_step_ms = 1;        // of the world: 0.125, 0.25, 0.5, 1, 2 or 4
  bool suspended = false;            // WorldOptions::hung
  SensorSwitches sensors = {};
  SensorParams sensor_params = {};  // create() reads them from sensors.xml beside the URDF
  bool imu = false;                 // the board has gyro and accelerometer
  EyeKind eyes = EyeKind::ideal;
  int eye_width = 0;  // px of 4:3 pictures; 0: as the camera file says
  double supply_volts = 10.0;
  double supply_ohms = 0.15;  // battery, switch and wires
  FramePolicy frames = FramePolicy::wait;
  faults::Schedule faults;      // times since the start
  std::string recording_path;   // none if empty
  RecordingTap* tap = nullptr;  // hears what is, or would be, recorded; must outlive this
  // What is done by hand, in each step that is recorded or heard by the tap; must outlive this.
  HandSource* hands = nullptr;
  bool record_pictures = false;          // the eyes' pictures too, not only their digests
  McapWriter::Metadata recording_facts;  // versions and the like, for the recording's header
  RendererFactory renderer = maker_of(kDefaultRenderer);
  Drawing drawing = Drawing::own_thread;
  // For tests: period of detour() calls. Zero: never.
  Time detour_every{};
};

// Everything that determines the course of a simulation: options and the contents of its files.
std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world);

// The microcontroller that the options name. Errors: invalid firmware image.
Result<std::unique_ptr<Mcu>> make_mcu(const SimulationOptions& options);

class Simulation {
 public:
  // Errors: missing or invalid files, more joints than the servo board has channels, invalid
  // physics step.
  static Result<std::unique_ptr<Simulation>> create(const SimulationOptions& options);
  // With the given microcontroller and world: for tests and other boards.
  static Result<std::unique_ptr<Simulation>> assemble(const SimulationOptions& options,
                                                      std::unique_ptr<Mcu> mcu,
                                                      std::unique_ptr<World> world,
                                                      const CameraFile& camera);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Advances by one millisecond. Errors (chip stopped, rendering failed, disk full) persist.
  Result<void> step();
  const std::optional<Error>& error() const { return error_; }
  // End of the last step. A whole number of milliseconds.
  States now() const { return now_; }
  Time time() const { return time_of(now_); }

  // The host's end of the serial line.
  void write(std::span<const std::uint8_t> bytes) { line_.write(bytes, now_); }
  std::size_t read(std::span<std::uint8_t> bytes) { return line_.read(bytes, now_); }
  SerialLine& line() { return line_; }

  // The eyes are closed initially, so nothing is rendered without a reader. A robot without eyes has no
  // pairs.
  bool has_eyes() const { return world_->head_frame() >= 0 && options_.eyes != EyeKind::none; }
  static Error no_eyes();  // the error for requests of pairs from such a robot
  void open_eyes();
  void close_eyes() { eyes_open_ = false; }
  const CameraFile& camera() const { return camera_; }
  // The next pair that has reached the host by now, oldest first.
  std::optional<vision::StereoPair> next_pair();
  // The same without the declared latency, for publishers whose readers apply it themselves.
  std::optional<vision::StereoPair> next_exposed_pair();
  std::uint64_t pairs_dropped() const;
  // Renders the world at `pose` (World::pose()) from an observer's camera. Blocks.
  Result<Picture> picture(const View& view, const ScenePose& pose);

  ServoBoard& board() { return board_; }
  const ServoBoard& board() const { return board_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }

  // Adds a fault to those of the options, or clears all. Times are on time()'s scale; past ones begin with
  // the next step.
  void add_fault(const faults::Fault& fault) { faults_.add(fault); }
  void clear_faults() { faults_.clear(); }
  const faults::Schedule& faults() const { return faults_.schedule(); }

  // Records the behaviour's internal state (one JSON object) at the present time.
  void record_behavior(std::string_view json);
  // Records the host's map at the present time.
  void record_map(const RecordedMap& map);
  // Starts recording, as `recording_path` does from the start. Errors: the file cannot be written; a
  // recording is in progress.
  Result<void> start_recording(const std::string& path);
  // A recording is in progress, but not all of it could be written. step() has failed then, too.
  bool recording_failed() const;
  // Finishes the recording and returns its SHA-256; empty if there is none. `interrupted_by`: the signal
  // before which the run would have gone on, empty if it has ended; the recording states it.
  Result<std::string> finish_recording(const std::string& interrupted_by = "");

  // Saves the whole state: bodies, motors, chip, board, line, faults, eyes with pairs in flight, all random
  // generators, time; not the recording, which continues. Waits for pictures being rendered. Errors: the
  // simulation has failed; a part cannot be saved (test doubles).
  Result<std::vector<std::uint8_t>> save();
  // Continues exactly like the saved simulation. This one must have the same options and build. The bytes may
  // be damaged or hostile: indices, lengths and ranges are checked. Errors: those of Snapshot; bytes of no
  // state. The simulation is then as before.
  Result<void> restore(std::span<const std::uint8_t> blob);
  // A state from which many episodes of one process begin.
  struct Start {
    std::unique_ptr<const World> world;
    std::unique_ptr<const Mcu::Kept> chip;
    std::vector<std::uint8_t> rest;
  };
  // As save(). Errors also: this kind of world cannot be cloned.
  Result<Start> keep();
  // Goes on from there as the simulation that it was kept of, but with the random numbers, and the constant
  // errors of the sensors, of `seed`. This one must have the same options but for seed and sensors. Takes
  // microseconds, where restore() takes milliseconds; several may begin from one start at once. Errors: a
  // recording is in progress; the start does not fit.
  Result<void> begin(const Start& start, std::uint64_t seed);
  // Saves, runs `steps` steps that are not recorded, and restores. Must have no visible effect: tests that
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
  std::vector<std::string> robot_frames_;  // of a recording; empty: none are recorded
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
