// One step: board, motors, bodies, potentiometers, eyes, recording.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>

#include "shared/base/profile.hpp"
#include "shared/board/table.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_writer.h"
#include "sim/runtime/simulation/recorder.h"
#include "sim/runtime/simulation/recording_tap.h"

namespace kaz::sim {
namespace {

Eyes::Mounting eye_mounting(const World& world) {
  const ScenePose pose = world.pose();
  const int frame = world.head_frame();
  const Eigen::Isometry3d world_from_head = pose.frames[static_cast<std::size_t>(frame)];
  const Eigen::Isometry3d head_from_world = world_from_head.inverse();
  return {frame, head_from_world * world.link_pose("left_eye"),
          head_from_world * world.link_pose("right_eye"), world.scene().light};
}

// Channel of the servo board for each joint: the n-th joint has the n-th channel. Kaz's joints are in the
// order of joints.def.
std::vector<std::size_t> channels_of(const World& world) {
  std::vector<std::size_t> channels(world.joint_order().size());
  std::iota(channels.begin(), channels.end(), std::size_t{0});
  return channels;
}

constexpr double kLimitRounding = 2e-4;  // rad; the table's unit is 100 microradians

std::string range_text(double min, double max) {
  char text[48];  // both within half a turn
  std::snprintf(text, sizeof text, "%.3f to %.3f", min, max);
  return text;
}

Result<void> read_robot(SimulationOptions& options, const ReadOptions& reading) {
  if (options.robot_model) return {};
  auto robot = KAZ_TRY(load_robot(options.robot_path, reading));
  options.robot_model = std::make_shared<const RobotModel>(std::move(robot));
  return {};
}

// The firmware enforces the limits of its channels: another robot's joints must not exceed them.
Result<void> check_limits(const std::string& robot_path, const RobotModel& robot) {
  if (robot.is_kaz()) return {};
  const std::size_t count = std::min<std::size_t>(KZ_JOINTS, robot.motors());
  for (std::size_t j = 0; j < count; ++j) {
    const RobotJoint& joint = robot.joints[j];
    const double min_rad = 1e-4 * kz_board_joints[j].lower,
                 max_rad = 1e-4 * kz_board_joints[j].upper;
    if (joint.lower >= min_rad - kLimitRounding && joint.upper <= max_rad + kLimitRounding)
      continue;
    if (const auto bus = std::filesystem::path(robot_path).replace_filename("bus.json");
        std::filesystem::exists(bus))
      return fail(
          Fault::usage,
          robot_path +
              " is a robot with bus servos (bus.json): start `kaz sim --bus feetech --robot-file " +
              robot_path +
              " --serial PORT`, or give --robot feetech:PORT (dynamixel for ROBOTIS servos); for a "
              "servo board, give the file NAME.board.urdf that `kaz robot check FILE --write` "
              "writes");
    return fail(Fault::usage,
                robot_path + ": joint `" + joint.name + "`: limits " +
                    range_text(joint.lower, joint.upper) + " rad: must be within " +
                    range_text(min_rad, max_rad) + ", the limits of channel " + std::to_string(j) +
                    " of the servo board (Kaz's " + joint_names()[j] +
                    "); make the joint's limits narrower, or move the joint in the file: the first "
                    "joint has channel 0, the second joint has channel 1");
  }
  return {};
}

// Contacts are recorded less often: they are many and change slowly.
constexpr States kContactInterval_ms = 10, kTransformInterval_ms = 33;

constexpr int kDetourSteps = 100;

}  // namespace

Result<std::unique_ptr<Mcu>> make_mcu(const SimulationOptions& options) {
  if (options.mcu == McuKind::native) return make_native();
  return options.image_path.empty() ? make_erased_h8() : make_h8(options.image_path);
}

void set_eyes(CameraFile& camera, const RobotOptions& options) {
  camera.ideal = options.eyes == EyeKind::ideal;
  if (options.eye_width <= 0) return;
  camera.eye.width = options.eye_width;
  camera.eye.height = options.eye_width * 3 / 4;
}

Result<std::unique_ptr<Simulation>> Simulation::create(const SimulationOptions& options) {
  KAZ_TRY(step_ratio(options.physics_step_ms));
  auto mcu = KAZ_TRY(make_mcu(options));
  WorldOptions world_options;
  world_options.seed = options.seed;
  world_options.dynamics = options.dynamics;
  world_options.step_s = options.physics_step_ms / 1000;
  world_options.hung = options.suspended;
  world_options.reading = options.reading;
  SimulationOptions completed = options;
  KAZ_TRY(read_robot(completed, options.reading));
  auto world = KAZ_TRY(World::load_with(*completed.robot_model, options.world_path,
                                        options.robot_path, world_options));
  KAZ_TRY(check_limits(options.robot_path, *completed.robot_model));
  Result<CameraFile> camera;
  if (world->head_frame() >= 0) camera = CameraFile::load(options.camera_path);
  if (!camera) return tl::unexpected(camera.error());
  set_eyes(*camera, options);
  const auto params = KAZ_TRY(
      load_sensor_file(std::filesystem::path(options.robot_path).replace_filename("sensors.xml")));
  completed.sensor_params = params;
  return assemble(completed, std::move(mcu), std::move(world), *camera);
}

Result<std::unique_ptr<Simulation>> Simulation::assemble(const SimulationOptions& options,
                                                         std::unique_ptr<Mcu> mcu,
                                                         std::unique_ptr<World> world,
                                                         const CameraFile& camera) {
  if (world->joint_order().size() > KZ_JOINTS) {
    return fail(Fault::usage, options.robot_path + ": the robot has " +
                                  std::to_string(world->joint_order().size()) +
                                  " joints: must be at most " + std::to_string(KZ_JOINTS) +
                                  ", the channels of the servo board");
  }
  const auto ratio = KAZ_TRY(step_ratio(1000 * world->step_s()));
  std::unique_ptr<Simulation> simulation(
      new Simulation(options, std::move(mcu), std::move(world), camera, ratio));
  if (!options.recording_path.empty() || options.tap != nullptr) {
    KAZ_TRY(simulation->start_recording(options.recording_path));
  }
  return simulation;
}

Simulation::Simulation(const SimulationOptions& options, std::unique_ptr<Mcu> mcu,
                       std::unique_ptr<World> world, const CameraFile& camera, StepRatio ratio)
    : options_(options),
      camera_(camera),
      world_(std::move(world)),
      ratio_(ratio),
      board_(std::move(mcu), {.seed = options.seed,
                              .params = options.sensor_params,
                              .sensors = sensor_switches(options.sensors),
                              .imu = options.imu,
                              .supply_volts = options.supply_volts,
                              .supply_ohms = options.supply_ohms}),
      channels_(channels_of(*world_)),
      drives_(channels_.size()),
      faults_(options.faults),
      line_(options.seed),
      draws_(world_->scene(),
             options.make_renderer ? options.make_renderer : maker_of(options.renderer),
             options.drawing) {
  if (has_eyes()) {
    const Eyes::Mounting eyes = eye_mounting(*world_);
    camera_.baseline_m = (eyes.left.translation() - eyes.right.translation()).norm();
  }
  line_.set_faults(&faults_.schedule());
  set_sensors(0);
  set_motion(world_->imu().specific_force);
}

Simulation::~Simulation() = default;

// Potentiometers of channels without a joint read zero. `since_s`: time since the end of the world's last
// step; joint angles are extrapolated linearly over it.
void Simulation::set_sensors(double since_s) {
  std::array<double, KZ_JOINTS> angles{};
  double motor_current = 0;
  const auto joints = world_->joints();
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    angles[channels_[j]] = joints[j].angle + since_s * joints[j].velocity;
    motor_current += std::abs(joints[j].current);
  }
  board_.set_joint_angles(angles);
  board_.set_supply_current(world_->supply_current_a());
  board_.set_motor_current(motor_current);
}

void Simulation::set_motion(const Eigen::Vector3d& specific_force) {
  board_.set_motion({world_->imu().angular_velocity.z(), specific_force.x(), specific_force.y()});
}

Result<void> Simulation::step() {
  if (!error_) {
    Result<void> done = advance();
    if (done && options_.detour_every > Time::zero() && recorder_ &&
        time() % options_.detour_every == Time::zero())
      done = detour(kDetourSteps);
    if (!done) error_ = done.error();
  }
  if (error_) return tl::unexpected(*error_);
  return {};
}

Result<void> Simulation::advance() {
  const ProfileScope rest("board, line, sensors");
  const States start = now_;
  const States end = start + KZ_STATES_PER_TICK;

  if (options_.hands != nullptr && recorder_) use_hands();
  faults_.begin_step(time(), board_, [this](const faults::Fault& fault) {
    if (recorder_) recorder_->fault(now_, faults::text_of(fault));
  });
  const auto to_board = line_.take_for_board(end);
  for (const SerialByte& byte : to_board) board_.receive(byte);
  const States tick = end / KZ_STATES_PER_TICK;
  // For the step that will be the last one before the next recording of loads.
  world_->watch_loads(recorder_ && (tick + ratio_.ticks_a_step - 1) / kContactInterval_ms !=
                                       (tick - 1) / kContactInterval_ms);
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();
  for (int part = 1; part <= ratio_.steps_a_tick; ++part) {
    const States to = start + part * KZ_STATES_PER_TICK / ratio_.steps_a_tick;
    if (auto ran = board_.run_until(to); !ran) return ran;
    const States late = tick % ratio_.ticks_a_step;
    if (late == 0) move_world();
    if (const std::string& broken = world_->diagnostics().failure; !broken.empty())
      return fail(Fault::failed, broken);
    set_sensors(1e-3 * static_cast<double>(late));
    felt += world_->imu().specific_force / ratio_.steps_a_tick;
  }
  set_motion(felt);
  const auto from_board = board_.take_transmitted();
  line_.from_board(from_board);
  now_ = end;

  if (eyes_open_) {
    if (auto looked = eyes_->look(time(), [this] { return world_->pose(); }); !looked)
      return looked;
  }
  if (!recorder_) return {};
  record(start, to_board, from_board);
  return recorder_->written();
}

void Simulation::use_hands() {
  for (const std::string& line : options_.hands->take(time())) {
    const auto act = parse_hand(line, time());
    const auto begun = act ? hands_.begin(*act, *world_, faults_) : tl::unexpected(act.error());
    if (begun) {
      recorder_->hand(now_, line);
    } else {
      options_.hands->refused(line, begun.error());
    }
  }
}

// Steps the world with the drivers' means over its step, which ends now.
void Simulation::move_world() {
  std::array<MotorDrive, KZ_JOINTS> drives{};
  const auto means = board_.take_drives();
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) drives[j] = {means[j].duty, means[j].powered};
  faults_.apply(time(), drives);
  for (std::size_t j = 0; j < channels_.size(); ++j) drives_[j] = drives[channels_[j]];
  const ProfileScope body("body");
  if (hands_.holds()) hands_.pull(*world_);
  world_->step(drives_, board_.supply_volts());
}

void Simulation::record(States start, std::span<const SerialByte> to_board,
                        std::span<const SerialByte> from_board) {
  const ProfileScope recording("recording");
  recorder_->wire(Recorder::Direction::to_board, start, to_board);
  recorder_->wire(Recorder::Direction::to_host, start, from_board);
  recorder_->pins(now_, board_.pins());
  std::array<JointState, KZ_JOINTS> joints{};
  for (std::size_t j = 0; j < channels_.size(); ++j) joints[channels_[j]] = world_->joints()[j];
  if (!robot_frames_.empty() && (now_ / KZ_STATES_PER_TICK) % kTransformInterval_ms == 1) {
    record_transforms();
    recorder_->contact_markers(now_, world_->contacts());
  }
  recorder_->joints(now_, joints);
  recorder_->supply(now_, board_.supply_volts(), world_->supply_current_a());
  recorder_->link_forces(now_, world_->link_order(), world_->link_forces());
  if (now_ / KZ_STATES_PER_TICK % kContactInterval_ms == 0) {
    recorder_->contacts(now_, world_->contacts());
    if (const auto loads = world_->joint_loads(); !loads.empty()) {
      std::array<JointLoad, KZ_JOINTS> by_channel{};
      for (std::size_t j = 0; j < channels_.size(); ++j) by_channel[channels_[j]] = loads[j];
      recorder_->joint_loads(now_, by_channel);
    }
  }
  if (const auto ball = world_->object_position("ball")) recorder_->ball(now_, *ball);
  if (eyes_) {
    for (const auto& digest : eyes_->take_digests(false)) recorder_->eyes(digest);
  }
  if (options_.tap != nullptr) options_.tap->stepped(time());
}

// The world's things, then the robot's frames.
void Simulation::record_transforms() {
  std::vector<ros::NamedPose> poses;
  const ScenePose scene = world_->pose();
  const auto& names = world_->scene().frames;
  for (std::size_t i = 1; i < names.size() && i < scene.frames.size(); ++i) {
    if (std::ranges::find(robot_frames_, names[i]) == robot_frames_.end())
      poses.emplace_back(names[i], scene.frames[i]);
  }
  for (const std::string& name : robot_frames_) poses.emplace_back(name, world_->link_pose(name));
  recorder_->transforms(now_, poses);
}

// The robot as viewers draw it. A motor stand has none.
Result<void> Simulation::describe_robot() {
  if (world_->link_order().empty() || options_.robot_path.empty()) return {};
  KAZ_TRY(read_robot(options_, {.body = false}));
  robot_frames_.clear();
  for (const auto& [name, frame] : options_.robot_model->frames) robot_frames_.push_back(name);
  recorder_->description(now_, KAZ_TRY(robot_urdf(options_.robot_path)));
  recorder_->scene(now_, world_->scene(), robot_frames_);
  return {};
}

Error Simulation::no_eyes() {
  return {Fault::usage,
          "this robot has no eyes: its file must have `left_eye` and `right_eye` on one link, "
          "and the option `eyes` must not be `none`"};
}

void Simulation::open_eyes() {
  if (!has_eyes()) return;
  eyes_open_ = true;
  if (!eyes_) make_eyes();
}

Eyes::Keep Simulation::kept_of_pairs() const {
  if (!recorder_) return Eyes::Keep::nothing;
  return options_.record_pictures ? Eyes::Keep::pictures : Eyes::Keep::digests;
}

void Simulation::make_eyes() {
  eyes_ = std::make_unique<Eyes>(draws_, camera_, eye_mounting(*world_), options_.frames,
                                 kept_of_pairs(), options_.seed);
  if (recorder_) recorder_->camera(camera_.model());
}

std::optional<vision::StereoPair> Simulation::next_pair() {
  return eyes_ ? eyes_->next_pair(time()) : std::nullopt;
}

std::optional<vision::StereoPair> Simulation::next_exposed_pair() {
  return eyes_ ? eyes_->next_pair(Time::max()) : std::nullopt;
}

std::uint64_t Simulation::pairs_dropped() const {
  return eyes_ ? eyes_->left_out() : 0;
}

Result<vision::Image> Simulation::picture(const View& view, const ScenePose& pose) {
  std::promise<Result<vision::Image>> promise;
  auto future = promise.get_future();
  View lit = view;
  lit.light = world_->scene().light;
  draws_.submit([&promise, &lit, &pose](const Result<Renderer*>& renderer) {
    vision::Image picture;
    if (!renderer) return promise.set_value(tl::unexpected(renderer.error()));
    if (auto drawn = (*renderer)->render(pose, lit, picture); !drawn)
      return promise.set_value(tl::unexpected(drawn.error()));
    promise.set_value(std::move(picture));
  });
  return future.get();
}

void Simulation::record_behavior(std::string_view json) {
  const ProfileScope recording("recording");
  if (recorder_) recorder_->behavior(now_, json);
}

void Simulation::record_map(const RecordedMap& map) {
  const ProfileScope recording("recording");
  if (!recorder_) return;
  recorder_->map(now_, map);
  const std::array frame{ros::NamedPose{"map", world_->scene().robot_start}};
  recorder_->transforms(now_, frame);
}

Result<void> Simulation::start_recording(const std::string& path) {
  if (recorder_)
    return fail(Fault::usage, "cannot record into " + path +
                                  ": a recording is in progress; finish that recording first");
  McapWriter::Metadata facts = options_.recording_facts;
  for (auto& fact : facts_of(options_, *world_)) {
    // MCAP readers reject duplicate keys.
    if (std::ranges::find(facts, fact.first, &McapWriter::Metadata::value_type::first) ==
        facts.end())
      facts.push_back(std::move(fact));
  }
  if (options_.record_pictures && has_eyes()) facts.push_back({"camera", text_of(camera_)});
  auto recorder = KAZ_TRY(Recorder::create(path, facts, options_.tap));
  recorder_ = std::move(recorder);
  KAZ_TRY(describe_robot());
  if (eyes_) recorder_->camera(camera_.model());
  world_->watch_contacts(true);
  if (eyes_) eyes_->keep(kept_of_pairs());
  board_.mcu().on_tick([this](const TickRecord& tick) {
    if (recorder_) recorder_->analog(now_ + KZ_STATES_PER_TICK, tick.input);
  });
  return {};
}

bool Simulation::recording_failed() const {
  return recorder_ && !recorder_->written();
}

Result<std::string> Simulation::finish_recording(const std::string& interrupted_by) {
  if (!recorder_) return std::string();
  if (!interrupted_by.empty()) {
    // What is there is the beginning of the run, message by message: pairs under way would come later.
    recorder_->interrupted(interrupted_by);
  } else if (eyes_) {
    for (const auto& digest : eyes_->take_digests(true)) recorder_->eyes(digest);
  }
  board_.mcu().on_tick(nullptr);
  world_->watch_contacts(false);
  const auto recorder = std::exchange(recorder_, nullptr);
  if (eyes_) eyes_->keep(kept_of_pairs());
  return recorder->finish();
}

}  // namespace kaz::sim
