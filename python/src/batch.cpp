// Many simulated robots: reset, stepped by control periods, observed.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/batch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>

#include "host/robot/inertial.h"
#include "host/robot/robot.h"
#include "sim/board/sensor_file.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::python {
namespace {

constexpr std::size_t kJoints = KZ_JOINTS;
constexpr int kMaxPeriodsToPictures = 25;

template <class Message>
void send(sim::Simulation& simulation, u8 type, u8& sequence, const Message& message,
          u8 (*pack)(const Message*, u8*)) {
  std::array<u8, KZ_BODY_MAX> body{KZ_ADDRESS_DEFAULT, type, sequence++};
  const u8 size = pack(&message, body.data() + KZ_HEADER_SIZE);
  std::array<u8, KZ_FRAME_MAX> wire{};
  const u8 length =
      kz_frame_encode(body.data(), static_cast<u8>(KZ_HEADER_SIZE + size), wire.data());
  simulation.write({wire.data(), length});
}

s16 wire_angle(double angle_rad) {
  return static_cast<s16>(std::lround(std::clamp(angle_rad, -3.2767, 3.2767) * KZ_ANGLE_PER_RAD));
}

double angle_of(s16 angle) {
  return static_cast<double>(angle) / KZ_ANGLE_PER_RAD;
}

}  // namespace

// Runs a function for each robot, in threads that live as long as the batch.
class Batch::Workers {
 public:
  explicit Workers(int threads) {
    for (int i = 1; i < threads; ++i)
      threads_.emplace_back([this](std::stop_token stop) { work(stop); });
  }
  ~Workers() {
    for (std::jthread& thread : threads_) thread.request_stop();
    wake_.notify_all();
  }

  void run(std::size_t count, const std::function<void(std::size_t)>& job) {
    {
      const std::lock_guard lock(mutex_);
      job_ = &job;
      count_ = count;
      next_ = 0;
      left_ = count;
      ++round_;
    }
    wake_.notify_all();
    take_all(job, count);
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return left_ == 0 && busy_ == 0; });
    job_ = nullptr;
  }

 private:
  void take_all(const std::function<void(std::size_t)>& job, std::size_t count) {
    std::size_t finished = 0;
    for (std::size_t i = next_.fetch_add(1); i < count; i = next_.fetch_add(1), ++finished) job(i);
    const std::lock_guard lock(mutex_);
    left_ -= finished;
    if (left_ == 0) done_.notify_all();
  }

  void work(const std::stop_token& stop) {
    std::uint64_t seen = 0;
    while (true) {
      const std::function<void(std::size_t)>* job = nullptr;
      std::size_t count = 0;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, stop, [&] { return round_ != seen; });
        if (stop.stop_requested()) return;
        seen = round_;
        if (job_ == nullptr) continue;
        job = job_;
        count = count_;
        ++busy_;
      }
      take_all(*job, count);
      const std::lock_guard lock(mutex_);
      --busy_;
      done_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::condition_variable done_;
  const std::function<void(std::size_t)>* job_ = nullptr;
  std::size_t count_ = 0, left_ = 0;
  int busy_ = 0;
  std::uint64_t round_ = 0;
  std::atomic<std::size_t> next_{0};
  std::vector<std::jthread> threads_;
};

struct Batch::Robot {
  std::unique_ptr<sim::Simulation> simulation;  // null on the engine `none`
  std::unique_ptr<sim::World> bare;
  u8 sequence = 0;
  kz_receiver receiver{};
  std::array<double, kJoints> measured{};
  std::array<double, 3> inertial{};
  std::shared_ptr<const vision::StereoImages> pictures;
  Time exposed{};

  sim::World& world() { return simulation ? simulation->world() : *bare; }
};

Batch::Batch(BatchOptions options) : options_(std::move(options)) {}
Batch::~Batch() = default;

Result<std::unique_ptr<Batch>> Batch::create(BatchOptions options) {
  if (options.robots < 1 || options.robots > 4096)
    return fail(Fault::usage, "num_envs " + std::to_string(options.robots) + ": must be 1 to 4096");
  if (options.threads < 1 || options.threads > 256)
    return fail(Fault::usage, "threads " + std::to_string(options.threads) + ": must be 1 to 256");
  if (options.period_ms < 20 || options.period_ms > 200)
    return fail(Fault::usage, "period_s: must be 0.02 to 0.2 s");
  std::unique_ptr<Batch> batch(new Batch(std::move(options)));
  sim::SimulationOptions& files = batch->options_.simulation;
  files.mcu = batch->options_.engine == Engine::h8 ? sim::McuKind::h8 : sim::McuKind::native;
  files.sensor_params = KAZ_TRY(sim::load_sensor_file(
      std::filesystem::path(files.robot_path).replace_filename("sensors.xml").string()));
  sim::WorldOptions world;
  world.dynamics = files.dynamics;
  world.step_s = 1e-3 * files.physics_step_ms;
  batch->prototype_ = KAZ_TRY(sim::World::load(files.world_path, files.robot_path, world));
  if (batch->prototype_->joint_order().size() != kJoints)
    return fail(Fault::usage,
                "VectorEnv: the robot must have " + std::to_string(kJoints) + " joints");
  batch->has_ball_ = batch->prototype_->object_position("ball").has_value();
  batch->camera_ = KAZ_TRY(sim::CameraFile::load(files.camera_path));
  sim::set_eyes(batch->camera_, files);
  if (batch->options_.pictures) {
    if (batch->options_.engine == Engine::none)
      return fail(Fault::usage, "pictures: the engine must be native or h8");
    if (batch->prototype_->head_frame() < 0 || files.eyes == sim::EyeKind::none)
      return tl::unexpected(sim::Simulation::no_eyes());
    batch->renderers_ =
        std::make_unique<Renderers>(batch->prototype_->scene(), sim::maker_of(files.renderer));
    files.make_renderer = batch->renderers_->shared();
    files.drawing = sim::Drawing::caller;
  }
  const auto count = static_cast<std::size_t>(batch->options_.robots);
  batch->robots_.resize(count);
  batch->state_.measured.resize(count * kJoints);
  batch->state_.inertial.resize(count * 3);
  batch->state_.trunk.resize(count * 7);
  batch->state_.ball.resize(count * 3);
  batch->state_.off.resize(count);
  if (batch->options_.pictures) batch->state_.picture_age.resize(count);
  batch->workers_ = std::make_unique<Workers>(batch->options_.threads);
  KAZ_TRY(batch->prepare());
  return batch;
}

Result<void> Batch::reset(std::span<const std::optional<std::uint64_t>> seeds) {
  std::vector<Result<void>> done(robots_.size());
  workers_->run(robots_.size(), [&](std::size_t i) {
    if (seeds[i]) done[i] = reset_one(i, *seeds[i]);
  });
  for (const Result<void>& one : done) {
    if (!one) return one;
  }
  return {};
}

Result<std::unique_ptr<sim::Simulation>> Batch::assemble(
    const sim::SimulationOptions& options) const {
  auto mcu = KAZ_TRY(sim::make_mcu(options));
  auto world = KAZ_TRY(prototype_->clone());
  return sim::Simulation::assemble(options, std::move(mcu), std::move(world), camera_);
}

// What all episodes have in common, done once: 12 ms.
Result<void> Batch::prepare() {
  if (options_.engine == Engine::none) {
    settled_ = std::make_unique<Robot>();
    settled_->bare = KAZ_TRY(prototype_->clone());
    run_bare(*settled_, options_.posture, options_.settle_ms);
    return {};
  }
  sim::SimulationOptions options = options_.simulation;
  if (options.sensors == sim::SensorSet::as_built)
    options.sensors = sim::SensorSet::nominal;  // without the errors of an individual robot
  const auto simulation = KAZ_TRY(assemble(options));
  lockstep::LockstepClock clock(*simulation);
  lockstep::LockstepLink link(*simulation);
  host::ConnectOptions connect;
  connect.reaction = host::Reaction::hold;
  auto host = KAZ_TRY(host::Robot::connect(link, clock, connect));
  KAZ_TRY(host.set_gains(host::kAllJoints, {options_.kp_per_rad, options_.kd_s_per_rad, 0, 0}));
  KAZ_TRY(host.enable(host::kAllJoints));
  std::vector<host::JointTarget> targets;
  for (std::size_t j = 0; j < kJoints; ++j)
    targets.push_back({static_cast<int>(j), options_.posture[j]});
  KAZ_TRY(host.set_targets(targets, std::chrono::milliseconds(options_.settle_ms / 2)));
  KAZ_TRY(host.clock().sleep_until(clock.now() + std::chrono::milliseconds(options_.settle_ms)));
  if (options_.pictures) {
    // Just before an exposure, so that its pair arrives in the period of the reset.
    simulation->open_eyes();
    model_ = simulation->camera().model();
    const double interval_s = 1 / camera_.rate_hz;
    while (std::fmod(seconds(simulation->time()) + 2e-3, interval_s) > 1e-3)
      KAZ_TRY(simulation->step());
    while (simulation->next_pair()) {
    }
  }
  start_ = KAZ_TRY(simulation->keep());
  return {};
}

Result<void> Batch::reset_one(std::size_t i, std::uint64_t seed) {
  auto& robot = robots_[i];
  if (!robot) robot = std::make_unique<Robot>();
  kz_receiver_init(&robot->receiver);
  robot->sequence = 128;  // the host's own, in prepare(), are far below
  if (options_.engine == Engine::none) {
    robot->bare = KAZ_TRY(settled_->bare->clone());
    robot->measured = settled_->measured;
    robot->inertial = settled_->inertial;
    observe(i);
    return {};
  }
  robot->measured = options_.posture;
  robot->inertial = {};
  if (!robot->simulation) robot->simulation = KAZ_TRY(assemble(options_.simulation));
  KAZ_TRY(robot->simulation->begin(start_, seed));
  if (options_.simulation.sensors == sim::SensorSet::as_built)
    KAZ_TRY(period(*robot, options_.posture, options_.settle_ms));
  robot->pictures = nullptr;
  KAZ_TRY(period(*robot, options_.posture, options_.period_ms));
  // A camera file may have a longer latency than a period.
  for (int k = 0; options_.pictures && !robot->pictures && k < kMaxPeriodsToPictures; ++k)
    KAZ_TRY(period(*robot, options_.posture, options_.period_ms));
  observe(i);
  return {};
}

Result<void> Batch::step(std::span<const double> targets, std::span<const std::uint8_t> resting) {
  for (const auto& robot : robots_) {
    if (!robot) return fail(Fault::usage, "step: call reset() first");
  }
  std::vector<Result<void>> done(robots_.size());
  workers_->run(robots_.size(), [&](std::size_t i) {
    if (resting[i] != 0) return;
    done[i] = period(*robots_[i], targets.subspan(i * kJoints, kJoints), options_.period_ms);
    observe(i);
  });
  for (const Result<void>& one : done) {
    if (!one) return one;
  }
  return {};
}

Result<void> Batch::period(Robot& robot, std::span<const double> targets, int ms) {
  if (!robot.simulation) {
    run_bare(robot, targets, ms);
    return {};
  }
  return run_simulated(robot, targets, ms);
}

// The board's law without the board: duty = kp (target - angle) - kd speed, of true angles.
void Batch::run_bare(Robot& robot, std::span<const double> targets, int ms) {
  sim::World& world = *robot.bare;
  const auto limits = host::joint_table();
  std::array<sim::MotorDrive, kJoints> drives{};
  const auto order = world.joint_order();
  const int steps = static_cast<int>(std::lround(1e-3 * ms / world.step_s()));
  for (int i = 0; i < steps; ++i) {
    const auto joints = world.joints();
    for (std::size_t k = 0; k < kJoints; ++k) {
      const auto j =
          static_cast<std::size_t>(host::joint_index(order[k]).value_or(static_cast<int>(k)));
      const double target = std::clamp(targets[j], limits[j].lower_rad, limits[j].upper_rad);
      const double duty = options_.kp_per_rad * (target - joints[k].angle) -
                          options_.kd_s_per_rad * joints[k].velocity;
      drives[k] = {std::clamp(duty, -1.0, 1.0), true};
    }
    world.step(drives, options_.simulation.supply_volts);
  }
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto j =
        static_cast<std::size_t>(host::joint_index(order[k]).value_or(static_cast<int>(k)));
    robot.measured[j] = world.joints()[k].angle;
  }
  const sim::ImuState& imu = world.imu();
  robot.inertial = {imu.angular_velocity.z(), imu.specific_force.x(), imu.specific_force.y()};
}

Result<void> Batch::run_simulated(Robot& robot, std::span<const double> targets, int ms) {
  sim::Simulation& simulation = *robot.simulation;
  kz_targets message{};
  message.mask = host::kAllJoints;
  message.duration_ms = static_cast<u16>(ms);
  const auto limits = host::joint_table();
  for (std::size_t j = 0; j < kJoints; ++j)
    message.angle[j] = wire_angle(std::clamp(targets[j], limits[j].lower_rad, limits[j].upper_rad));
  send(simulation, KZ_TYPE_targets, robot.sequence, message, &kz_pack_targets);
  send(simulation, KZ_TYPE_state, robot.sequence, kz_state{}, &kz_pack_state);
  for (int i = 0; i < ms; ++i) {
    // The board refuses a third request while two wait; by now it has answered the first.
    if (i == ms / 2 && options_.simulation.imu)
      send(simulation, KZ_TYPE_inertial, robot.sequence, kz_inertial{}, &kz_pack_inertial);
    KAZ_TRY(simulation.step());
  }
  while (auto pair = simulation.next_pair()) {
    robot.pictures = pair->images.get();
    robot.exposed = pair->info.exposure;
  }

  std::array<std::uint8_t, 512> bytes{};
  const std::size_t count = simulation.read(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (kz_receive(&robot.receiver, bytes[i], 0) != KZ_RECEIVE_FRAME) continue;
    const u8 type = robot.receiver.body[KZ_BODY_TYPE];
    const u8* fields = robot.receiver.body + KZ_HEADER_SIZE;
    const u8 size = static_cast<u8>(robot.receiver.length - KZ_HEADER_SIZE);
    kz_state_reply reply{};
    kz_inertial_reply inertial{};
    if (type == KZ_TYPE_state_reply && kz_unpack_state_reply(&reply, fields, size)) {
      for (std::size_t j = 0; j < kJoints; ++j) robot.measured[j] = angle_of(reply.angle[j]);
    } else if (type == KZ_TYPE_inertial_reply &&
               kz_unpack_inertial_reply(&inertial, fields, size)) {
      const auto about_middle = [](u16 code) {
        return static_cast<double>(code) - KZ_POT_CODES / 2.0;
      };
      robot.inertial = {about_middle(inertial.yaw_rate) * host::kYawRatePerCode,
                        about_middle(inertial.forward) * host::kForcePerCode,
                        about_middle(inertial.left) * host::kForcePerCode};
    }
  }
  return {};
}

void Batch::observe(std::size_t i) {
  Robot& robot = *robots_[i];
  std::ranges::copy(robot.measured,
                    state_.measured.begin() + static_cast<std::ptrdiff_t>(i * kJoints));
  std::ranges::copy(robot.inertial, state_.inertial.begin() + static_cast<std::ptrdiff_t>(3 * i));
  const Eigen::Isometry3d trunk = robot.world().link_pose("trunk");
  const Eigen::Quaterniond turn(trunk.rotation());
  double* const to = state_.trunk.data() + 7 * i;
  const Eigen::Vector3d place = trunk.translation();
  std::copy_n(place.data(), 3, to);
  to[3] = turn.x(), to[4] = turn.y(), to[5] = turn.z(), to[6] = turn.w();
  if (has_ball_) {
    if (const auto ball = robot.world().object_position("ball"))
      std::copy_n(ball->data(), 3, state_.ball.data() + 3 * i);
  }
  if (options_.pictures) state_.picture_age[i] = seconds(robot.simulation->time() - robot.exposed);
  state_.off[i] = robot.simulation && !robot.simulation->board().drivers_enabled() ? 1 : 0;
}

const vision::StereoImages* Batch::pictures(std::size_t i) const {
  return robots_[i] ? robots_[i]->pictures.get() : nullptr;
}

Result<Batch::Robot*> Batch::robot_at(int robot) const {
  if (robot < 0 || robot >= options_.robots)
    return fail(Fault::usage, "robot " + std::to_string(robot) + ": must be 0 to " +
                                  std::to_string(options_.robots - 1));
  Robot* const found = robots_[static_cast<std::size_t>(robot)].get();
  if (found == nullptr) return fail(Fault::usage, "call reset() first");
  return found;
}

Result<void> Batch::push(int robot, const std::string& link, const Eigen::Vector3d& impulse) {
  return KAZ_TRY(robot_at(robot))->world().push(link, impulse);
}

Result<void> Batch::accelerate(int robot, const std::string& model, const Eigen::Vector3d& change) {
  return KAZ_TRY(robot_at(robot))->world().accelerate(model, change);
}

Result<Eigen::Isometry3d> Batch::link_pose(int robot, const std::string& link) const {
  return KAZ_TRY(robot_at(robot))->world().link_pose(link);
}

}  // namespace kaz::python
