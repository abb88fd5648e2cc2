// The whole simulation to bytes and back; what a recording and a saved state say of its options.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <type_traits>
#include <utility>

#include "sim/runtime/recorder.h"
#include "sim/runtime/sha256.h"
#include "sim/runtime/simulation.h"
#include "sim/runtime/snapshot.h"

namespace kaz::sim {
namespace {

// Of a file's content; empty if there is none.
std::string digest_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (path.empty() || !file) return "";
  const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(file), {});
  return sha256_hex(bytes);
}

std::string digest_beside(const std::string& path, const std::string& name) {
  if (path.empty()) return "";
  return digest_of(std::filesystem::path(path).replace_filename(name).string());
}

// With all its digits: two numbers that differ are written differently.
std::string exact(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

// Numbers only, without gaps between them: their bytes are their value.
std::string digest_of(const SensorFigures& figures) {
  static_assert(std::is_trivially_copyable_v<SensorFigures> &&
                sizeof figures == 26 * sizeof(double));
  std::array<std::uint8_t, sizeof figures> bytes{};
  std::memcpy(bytes.data(), &figures, sizeof figures);
  return sha256_hex(bytes);
}

// A set that has no name is told switch by switch.
std::string switches_of(const SensorSwitches& sensors) {
  std::string name = name_of(sensors);
  if (name != "mixed") return name;
  const auto& [potentiometer, as_built, supply, reference, temperature, gyro, accelerometer] =
      sensors;
  for (const bool on :
       {potentiometer, as_built, supply, reference, temperature, gyro, accelerometer})
    name += on ? " 1" : " 0";
  return name;
}

// Which program draws. The library's own one has a name; two others cannot be told apart.
std::string name_of(const RendererFactory& renderer) {
  const auto* function = renderer.target<Result<std::unique_ptr<Renderer>> (*)()>();
  return function != nullptr && *function == &make_default_renderer ? "Mesa" : "own";
}

}  // namespace

// Takes every field of the options by name: a new field does not compile before it stands here.
std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world) {
  const auto& [engine, image_path, world_path, robot_path, camera_path, seed, stepper,
               physics_step_ms, sensors, sensor_figures, imu, ideal_eyes, eye_width, supply_volts,
               supply_ohms, frames, faults, recording_path, record_pictures, recording_facts,
               renderer, detour_every] = options;
  static_cast<void>(stepper);         // the world says it with all figures
  static_cast<void>(recording_path);  // a recording changes nothing
  static_cast<void>(record_pictures);
  static_cast<void>(recording_facts);
  static_cast<void>(detour_every);  // nor does a detour
  return {{"engine", engine},
          {"seed", std::to_string(seed)},
          {"stepper", world.stepper()},
          {"physics_step_ms", exact(physics_step_ms)},
          {"sensors", switches_of(sensors)},
          {"sensor_figures_sha256", digest_of(sensor_figures)},
          {"imu", imu ? "true" : "false"},
          {"eyes", ideal_eyes ? "ideal" : "real"},
          {"eye_width", std::to_string(eye_width)},
          {"frames", frames == FramePolicy::wait ? "wait" : "drop"},
          {"renderer", name_of(renderer)},
          {"supply_volts", exact(supply_volts)},
          {"supply_ohms", exact(supply_ohms)},
          {"world_sha256", digest_of(world_path)},
          {"robot_sha256", digest_of(robot_path)},
          {"sensors_sha256", digest_beside(robot_path, "sensors.xml")},
          {"motor_sha256", digest_beside(robot_path, "motor.xml")},
          {"camera_sha256", digest_of(camera_path)},
          {"image_sha256", digest_of(image_path)},
          {"faults", faults.text()}};
}

template <class A>
void Simulation::transfer(A& a) {
  a(now_, faults_, line_, eyes_open_);
  bool has_eyes = eyes_ != nullptr;
  a(has_eyes);
  if constexpr (A::reading) {
    if (!a.good()) return;
    if (has_eyes && world_->head_frame() < 0)
      return a.refuse("it has eyes, but the robot has no head");
    if (has_eyes && !eyes_) make_eyes();
    if (!has_eyes) eyes_ = nullptr;
  }
  if (eyes_) eyes_->transfer(a);
}

Result<std::vector<std::uint8_t>> Simulation::save() {
  if (error_) return tl::unexpected(*error_);
  StateWriter to;
  world_->save(to);
  board_.save(to);
  transfer(to);
  if (!to.good()) return fail(Fault::failed, "the simulation cannot be saved: " + to.trouble());
  return Snapshot::pack(facts_of(options_, *world_), to.bytes());
}

Result<void> Simulation::restore(std::span<const std::uint8_t> blob) {
  const auto state = Snapshot::unpack(blob, facts_of(options_, *world_));
  if (!state) return tl::unexpected(state.error());
  StateReader from(*state);
  world_->restore(from);
  board_.restore(from);
  transfer(from);
  if (from.good() && from.left() != 0) from.refuse("it is longer than it should be");
  if (!from.good()) {
    error_ = Error{Fault::usage,
                   "this saved state cannot be restored: " + from.trouble() + "; save it again"};
    return tl::unexpected(*error_);
  }
  error_.reset();
  return {};
}

Result<void> Simulation::detour(int steps) {
  const auto blob = save();
  if (!blob) return tl::unexpected(blob.error());
  auto recorder = std::exchange(recorder_, nullptr);
  Result<void> went;
  for (int k = 0; k < steps && went; ++k) went = advance();
  recorder_ = std::move(recorder);
  if (!went) return went;
  return restore(*blob);
}

}  // namespace kaz::sim
