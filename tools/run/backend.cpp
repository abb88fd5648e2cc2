// Backends of a run: the virtual robot in lockstep, boards at ports, or a servo bus.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/backend.h"
#include "sim/runtime/simulation/recording_tap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "host/bus/bus_port.h"
#include "host/link/faulty_link.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "shared/base/files.hpp"
#include "shared/base/hex_text.hpp"
#include "shared/base/number_text.hpp"
#include "shared/servo_bus/bus_file.h"
#include "sim/body/description/robot_model.h"
#include "sim/stand/stand_commands.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/paths.h"
#include "tools/base/version.h"
#include "tools/lockstep/lockstep.h"
#include "tools/run/line_recorder.h"
#include "tools/run/live_camera.h"
#include "tools/run/target.h"
#include "vision/calibration/calibration_file.h"

namespace kaz::tools {
namespace {

class LockstepBackend final : public SessionBackend {
 public:
  LockstepBackend(std::unique_ptr<sim::Simulation> simulation, const host::Interrupt& interrupt)
      : simulation_(std::move(simulation)),
        clock_(raw_clock_, interrupt),
        link_(raw_link_, raw_clock_, interrupt) {}
  std::vector<host::RobotBoard> boards() override {
    return {{&link_, KZ_ADDRESS_DEFAULT, host::kAllJoints}};
  }
  host::Clock& clock() override { return clock_; }
  Result<void> open_camera() override { return {}; }
  bool sees() const override { return simulation_->has_eyes(); }
  vision::Camera& camera() override { return camera_; }
  vision::Pace pace() const override { return vision::Pace::lockstep; }
  Time camera_latency() const override { return from_seconds(simulation_->camera().latency_s); }
  sim::Simulation* simulation() override { return simulation_.get(); }
  std::vector<faults::Fault> faults_not_begun() const override {
    return simulation_->faults().not_begun(simulation_->time());
  }
  void record_behavior(const std::string& json) override { simulation_->record_behavior(json); }
  void record_map(const sim::RecordedMap& map) override { simulation_->record_map(map); }
  Result<std::string> finish_recording(const std::string& interrupted_by) override {
    return simulation_->finish_recording(interrupted_by);
  }
  bool recording_failed() const override { return simulation_->recording_failed(); }

 private:
  std::unique_ptr<sim::Simulation> simulation_;
  lockstep::LockstepClock raw_clock_{*simulation_};
  InterruptibleClock clock_;
  lockstep::LockstepLink raw_link_{*simulation_};
  InterruptibleLink link_;
  lockstep::LockstepCamera camera_{*simulation_};
};

// A board at a port, and the faults of its line, if there are any.
struct RealLine {
  std::unique_ptr<host::PortLink> port;
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  std::uint32_t joints = host::kAllJoints;
  std::unique_ptr<host::FaultyLink> faulty = {};
  host::Link* recorded = nullptr;  // of the recorder; null without one

  host::Link& link() const { return faulty ? static_cast<host::Link&>(*faulty) : *port; }
};

class RealBackend final : public SessionBackend {
 public:
  RealBackend(std::vector<RealLine> lines, const BackendOptions& options,
              const faults::Schedule& faults, const host::Interrupt& interrupt)
      : lines_(std::move(lines)),
        camera_path_(options.camera),
        calibration_(options.calibration),
        clock_(&interrupt) {
    std::uint64_t seed = options.seed;
    for (RealLine& line : lines_) {
      if (!faults.empty())
        line.faulty = std::make_unique<host::FaultyLink>(*line.port, clock_, faults, seed++);
    }
  }
  Result<void> begin_recording(const BackendOptions& options) {
    if (options.recording.empty() && options.tap == nullptr) return {};
    sim::McapWriter::Metadata facts{{"kaz", kVersion}};
    facts.insert(facts.end(), options.facts.begin(), options.facts.end());
    recorder_ =
        KAZ_TRY(LineRecorder::create(options.recording, std::move(facts), clock_, options.tap));
    for (std::size_t i = 0; i < lines_.size(); ++i)
      lines_[i].recorded = recorder_->record(lines_[i].link(), i);
    return {};
  }
  ~RealBackend() override {
    if (const std::string summary = camera_.summary(); !summary.empty())
      std::fprintf(stderr, "%s: cameras: %s\n", named_verb().c_str(), summary.c_str());
    for (const RealLine& line : lines_) {
      if (const std::string counts = line.port->counts(); !counts.empty())
        std::fprintf(stderr, "%s: %s: %s\n", named_verb().c_str(), line.port->name().c_str(),
                     counts.c_str());
    }
  }
  std::vector<host::RobotBoard> boards() override {
    std::vector<host::RobotBoard> all;
    for (const RealLine& line : lines_) {
      host::Link& link = line.recorded != nullptr ? *line.recorded : line.link();
      all.push_back({&link, line.address, line.joints});
    }
    return all;
  }
  const host::PortLink* port() const override { return lines_.front().port.get(); }
  std::string still_on() const override {
    std::string text;
    for (const RealLine& line : lines_) {
      if (const std::string on = line.port->still_on(); !on.empty())
        text += (text.empty() ? "" : "; ") + on;
    }
    return text;
  }
  host::Clock& clock() override { return clock_; }
  Result<void> open_camera() override {
    if (camera_path_ == "sim") return {};  // left out
    auto camera = KAZ_TRY(open_live_camera(camera_path_, calibration_));
    if (is_real_camera(camera_path_))
      camera.camera = std::make_unique<ReturningCamera>(
          std::move(camera.camera),
          [path = camera_path_, file = calibration_]() -> Result<std::unique_ptr<vision::Camera>> {
            auto again = KAZ_TRY(open_live_camera(path, file));
            return std::move(again.camera);
          },
          kCameraPatience,
          [](const std::string& line) {
            std::fprintf(stderr, "\n%s: %s\n", named_verb().c_str(), line.c_str());
          });
    camera_ = std::move(camera);
    judged_.emplace(*camera_.camera);
    return {};
  }
  bool sees() const override { return judged_.has_value(); }
  vision::Camera& camera() override {
    return judged_ ? static_cast<vision::Camera&>(*judged_) : no_camera_;
  }
  std::string camera_warning() const override { return judged_ ? judged_->warning() : ""; }
  vision::Pace pace() const override { return vision::Pace::realtime; }
  Time camera_latency() const override { return camera_.latency; }
  sim::Simulation* simulation() override { return nullptr; }
  std::vector<faults::Fault> faults_not_begun() const override {
    const auto& faulty = lines_.front().faulty;
    return faulty ? faulty->schedule().not_begun(faulty->age()) : std::vector<faults::Fault>();
  }
  void record_behavior(const std::string& json) override {
    if (recorder_) recorder_->behavior(json);
  }
  void record_map(const sim::RecordedMap& map) override {
    if (recorder_) recorder_->map(map);
  }
  Result<std::string> finish_recording(const std::string& interrupted_by) override {
    if (!recorder_) return std::string();
    return recorder_->finish(interrupted_by);
  }
  bool recording_failed() const override { return recorder_ && recorder_->failed(); }

 private:
  std::vector<RealLine> lines_;
  std::string camera_path_, calibration_;
  LiveCamera camera_;
  std::optional<JudgedCamera> judged_;
  NoCamera no_camera_;
  host::WallClock clock_;
  std::unique_ptr<LineRecorder> recorder_;  // refers to lines and clock
};

struct BusOfFile {
  std::vector<host::BusJoint> joints;  // in the order of a board's numbers
  int baud = 0;

  // Returns the port, with this bus's rate if the port has none.
  host::PortAddress at(host::PortAddress port) const {
    if (port.baud == 0) port.baud = baud;
    return port;
  }
};

// The robot's joints with their servos, which must speak `protocol`.
Result<BusOfFile> load_bus(const std::string& robot_file, servo_bus::Protocol protocol) {
  const auto robot = KAZ_TRY(sim::load_robot(robot_file, {.body = false}));
  const auto file = KAZ_TRY(servo_bus::load_bus_file(robot_file));
  if (file.protocol != protocol)
    return fail(Fault::usage, "bus.json in the folder of " + robot_file + " describes a " +
                                  std::string(servo_bus::name_of(file.protocol)) +
                                  " bus; give --robot " +
                                  std::string(servo_bus::name_of(file.protocol)) +
                                  ":PATH, or another robot file");
  BusOfFile bus;
  bus.baud = static_cast<int>(file.baud);
  for (const sim::RobotJoint& joint : robot.joints) {
    if (joint.follows) continue;
    const auto servo = std::ranges::find(file.servos, joint.name, &servo_bus::BusServo::joint);
    if (servo == file.servos.end())
      return fail(Fault::usage, "bus.json in the folder of " + robot_file +
                                    " has no servo for the joint " + joint.name);
    // A servo turns by one turn at most; a joint without limits gets the turn that the servo measures.
    host::BusJoint& added = bus.joints.emplace_back();
    added.servo = *servo;
    const auto [first, last] =
        std::minmax({servo->angle_at(0), servo->angle_at(servo->model->steps - 1)});
    added.lower_rad = std::isinf(joint.lower) ? first : std::max(joint.lower, -std::numbers::pi);
    added.upper_rad = std::isinf(joint.upper) ? last : std::min(joint.upper, std::numbers::pi);
    added.max_rad_per_s = std::min(added.max_rad_per_s, joint.velocity);
  }
  return bus;
}

Result<RealLine> open_board(const BoardOfFile& board, const host::Interrupt& interrupt) {
  return RealLine{KAZ_TRY(host::open_port(board.port, &interrupt)), board.address, board.joints};
}

Result<RealLine> open_bus(const BusTarget& target, const std::string& robot_file,
                          const host::Interrupt& interrupt) {
  // A robot file that is wrong is known before the port is opened.
  const BusOfFile bus = KAZ_TRY(load_bus(robot_file, target.protocol));
  auto port = KAZ_TRY(host::open_port(bus.at(target.port), &interrupt));
  return RealLine{KAZ_TRY(host::BusPort::open(std::move(port), bus.joints, &interrupt))};
}

Result<std::vector<RealLine>> open_lines(const Target& target, const std::string& robot_file,
                                         const host::Interrupt& interrupt) {
  std::vector<RealLine> lines;
  if (const auto* bus = std::get_if<BusTarget>(&target)) {
    lines.push_back(KAZ_TRY(open_bus(*bus, robot_file, interrupt)));
  } else if (const auto* one = std::get_if<PortTarget>(&target)) {
    lines.push_back(KAZ_TRY(open_board({one->port, one->address, host::kAllJoints}, interrupt)));
  } else {
    for (const BoardOfFile& board : std::get<BoardsTarget>(target).boards)
      lines.push_back(KAZ_TRY(open_board(board, interrupt)));
  }
  return lines;
}

// For a port: no other faults can be made there.
Result<faults::Schedule> line_faults(const BackendOptions& options) {
  if (options.faults.empty()) return faults::Schedule{};
  auto schedule = faults::Schedule::load(options.faults);
  if (!schedule) return schedule;
  if (const auto name = schedule->only_simulated())
    return fail(
        Fault::usage,
        options.faults + ": the fault `" + std::string(*name) +
            "` is only possible in the simulator; for a robot at a port, give only line faults");
  return schedule;
}

}  // namespace

Result<ServoBusOfFile> servo_bus_of(const BackendOptions& options) {
  const auto target = KAZ_TRY(target_of(options));
  const auto& bus = std::get<BusTarget>(target);
  auto file = KAZ_TRY(load_bus(options.robot_file, bus.protocol));
  return ServoBusOfFile{bus.protocol, file.at(bus.port), std::move(file.joints)};
}

Result<ServoBus> open_servo_bus(const BackendOptions& options, const host::Interrupt& interrupt) {
  auto bus = KAZ_TRY(servo_bus_of(options));
  auto port = KAZ_TRY(host::open_port(bus.address, &interrupt));
  return ServoBus{bus.protocol, std::move(port), std::move(bus.joints)};
}

Error silent_servo(const servo_bus::BusServo& servo, const std::string& port) {
  return {Fault::environment, host::named(servo) + " does not answer on " + port +
                                  ": check power, cable, id and rate; `kaz bus scan " +
                                  host::bus_option(servo.model->protocol, port) + "` finds servos"};
}

Result<void> require_limp(host::BusDriver& driver, std::span<const host::BusJoint> joints,
                          const std::string& port, bool release) {
  std::vector<const servo_bus::BusServo*> held;
  std::string names;
  for (const host::BusJoint& joint : joints) {
    const auto torque = KAZ_TRY(driver.read(joint.servo, "torque_enable"));
    if (!torque) return tl::unexpected(silent_servo(joint.servo, port));
    if (*torque == 0) continue;
    held.push_back(&joint.servo);
    names += (names.empty() ? "" : ", ") + host::named(joint.servo);
  }
  if (held.empty()) return {};
  if (!release)
    return fail(Fault::environment, names + " on " + port +
                                        ": the torque is on. Hold the robot, and give --release, "
                                        "which switches the torque off");
  const auto torque = KAZ_TRY(driver.release(held));
  const std::string on = host::still_on(held, torque);
  return on.empty() ? Result<void>() : fail(Fault::environment, port + ": " + on);
}

Result<void> check(const BackendOptions& options) {
  const bool sim_robot = !options.at_port();
  KAZ_TRY(target_of(options));
  const bool blind = !sim_robot && options.camera == "sim" && !options.needs_camera;
  if (!blind && sim_robot != (options.camera == "sim")) {
    return fail(Fault::usage,
                sim_robot ? "--camera is not valid with --robot sim, which has its own cameras: "
                            "leave --camera out"
                          : "a robot at a port needs --camera: give the path of a camera socket "
                            "(`kaz sim --cameras PATH` makes one), or real cameras "
                            "(v4l2:/dev/video0,/dev/video2)");
  }
  if (!sim_robot && options.camera != "sim") {
    KAZ_TRY(check_live_camera(options.camera, options.calibration));
    // A file that cannot be used is to be known before the board is connected and altered.
    if (is_real_camera(options.camera)) KAZ_TRY(vision::read_calibration(options.calibration));
    return {};
  }
  if (!options.calibration.empty())
    return fail(
        Fault::usage,
        "--calibration is only valid with real cameras (v4l2:...); leave out --calibration");
  return {};
}

namespace {

// In force as after a reset.
Result<void> put_memory(sim::Simulation& simulation, const std::string& hex) {
  if (hex.empty()) return {};
  std::array<std::uint8_t, sim::Mcu::kMemorySize> bytes{};
  bool valid = hex.size() == 2 * bytes.size();
  for (std::size_t i = 0; valid && i < bytes.size(); ++i) {
    const auto byte = parse_number<std::uint8_t>(std::string_view(hex).substr(2 * i, 2), 16);
    valid = byte.has_value();
    if (valid) bytes[i] = *byte;
  }
  if (!valid)
    return fail(Fault::usage, "the contents of a board's flash memory must be " +
                                  std::to_string(bytes.size()) +
                                  " bytes, written as hexadecimal digits");
  simulation.board().mcu().set_memory(bytes);
  simulation.board().mcu().reset();
  return {};
}

Result<std::unique_ptr<sim::Simulation>> make_stand(const BackendOptions& options,
                                                    sim::SimulationOptions sim) {
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const std::filesystem::path beside(robot);
  const auto sensors =
      KAZ_TRY(sim::load_sensor_file(std::filesystem::path(beside).replace_filename("sensors.xml")));
  sim.sensor_params = sensors;
  const std::string file =
      options.motor_file.empty()
          ? std::filesystem::path(beside).replace_filename("motor.xml").string()
          : options.motor_file;
  const auto motor = KAZ_TRY(sim::load_motor_file(file, options.motor));
  return sim::make_stand(sim,
                         {.motor = motor, .disc_kgm2 = options.disc_kgm2, .seed = options.seed});
}

}  // namespace

Result<std::unique_ptr<sim::Simulation>> make_simulation(const BackendOptions& options,
                                                         sim::FramePolicy frames) {
  if (!options.image.empty() && options.mcu != sim::McuKind::h8)
    return fail(Fault::usage, "--image is only valid with --mcu h8: native has no firmware image");
  sim::SimulationOptions sim(options);
  sim.frames = frames;
  sim.recording_path = options.recording;
  sim.tap = options.tap;
  sim.hands = options.hands;
  sim.detour_every = std::chrono::milliseconds(std::llround(1000 * options.restore_every_s));
  sim.record_pictures = options.record_pictures;
  if (!options.faults.empty()) {
    auto schedule = KAZ_TRY(faults::Schedule::load(options.faults));
    sim.faults = std::move(schedule);
  }
  sim.recording_facts = {{"kaz", kVersion},
                         {"mcu", to_string(options.mcu)},
                         {"world", options.world},
                         {"seed", std::to_string(options.seed)}};
  for (const auto& fact : options.facts) sim.recording_facts.push_back(fact);
  const auto find = [](Result<std::string> path, std::string& to) -> Result<void> {
    if (!path) return tl::unexpected(path.error());
    to = *path;
    return {};
  };
  Result<void> found;
  if (!options.stand) {
    found = find(world_file(options.world), sim.world_path);
    if (options.robot_file.empty()) {
      if (found) found = find(data_file("robot/kaz/kaz.urdf"), sim.robot_path);
      if (found) found = find(data_file("robot/kaz/camera.json"), sim.camera_path);
    } else {
      sim.robot_path = options.robot_file;
      sim.robot_model = options.robot_model;
      sim.camera_path =
          std::filesystem::path(options.robot_file).replace_filename("camera.json").string();
    }
  }
  if (found && options.mcu == sim::McuKind::h8 && !options.erased)
    found = find(firmware_image(options.image), sim.image_path);
  if (!found) return tl::unexpected(found.error());
  auto simulation =
      KAZ_TRY(options.stand ? make_stand(options, sim) : sim::Simulation::create(sim));
  KAZ_TRY(put_memory(*simulation, options.memory));
  return simulation;
}

Result<std::string> read_memory(const std::string& path) {
  const auto bytes = KAZ_TRY(read_whole_file(path, 2 * sim::Mcu::kMemorySize));
  if (bytes.size() != sim::Mcu::kMemorySize)
    return fail(Fault::usage, path +
                                  ": the memory of a board, from `kaz sim --memory` or `kaz "
                                  "calibrate joints --memory`, must have " +
                                  std::to_string(sim::Mcu::kMemorySize) + " bytes");
  return hex_text({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

Result<std::unique_ptr<SessionBackend>> SessionBackend::open(const BackendOptions& options,
                                                             host::Interrupt& interrupt) {
  KAZ_TRY(check(options));
  const Target target = KAZ_TRY(target_of(options));
  if (std::holds_alternative<SimulatedTarget>(target)) {
    auto simulation = KAZ_TRY(make_simulation(options, sim::FramePolicy::wait));
    return std::make_unique<LockstepBackend>(std::move(simulation), interrupt);
  }
  const auto faults = KAZ_TRY(line_faults(options));
  auto lines = KAZ_TRY(open_lines(target, options.robot_file, interrupt));
  auto backend = std::make_unique<RealBackend>(std::move(lines), options, faults, interrupt);
  KAZ_TRY(backend->begin_recording(options));
  return backend;
}

}  // namespace kaz::tools
