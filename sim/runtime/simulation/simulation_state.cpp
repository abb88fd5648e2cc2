// Saves and restores a whole simulation; options as metadata of recordings and saved states.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "shared/base/files.hpp"
#include "sim/runtime/formats/sha256.h"
#include "sim/runtime/simulation/recorder.h"
#include "sim/runtime/simulation/simulation.h"
#include "sim/runtime/simulation/snapshot.h"

namespace kaz::sim {
namespace {

// SHA-256 of a file's content; empty if there is no file.
std::string digest_of(const std::string& path) {
  constexpr std::size_t max_bytes = 256 << 20;
  const auto bytes = read_whole_file(path, max_bytes);
  if (!bytes) return "";
  return sha256_hex(std::vector<std::uint8_t>(bytes->begin(), bytes->end()));
}

std::string digest_beside(const std::string& path, const std::string& name) {
  if (path.empty()) return "";
  return digest_of(std::filesystem::path(path).replace_filename(name).string());
}

// All digits: different numbers give different texts.
std::string exact(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

// SHA-256 of the bytes: SensorParams has doubles only, without padding.
std::string digest_of(const SensorParams& params) {
  static_assert(std::is_trivially_copyable_v<SensorParams> && sizeof params == 26 * sizeof(double));
  std::array<std::uint8_t, sizeof params> bytes{};
  std::memcpy(bytes.data(), &params, sizeof params);
  return sha256_hex(bytes);
}

// Name of the renderer; factories other than ours cannot be distinguished.
const char* name_of(RendererKind renderer, const RendererFactory& make_renderer) {
  if (make_renderer) return "own";
  return renderer == RendererKind::opengl ? "Mesa" : to_string(renderer);
}

}  // namespace

// Binds every field of the options, so that a new field does not compile until it is listed here.
std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world) {
  const auto& [mcu, sensors, imu, dynamics, physics_step_ms, eyes, eye_width, renderer,
               supply_volts, seed, suspended, reading] = static_cast<const RobotOptions&>(options);
  const auto& [image_path, world_path, robot_path, robot_model, camera_path, sensor_params,
               supply_ohms, frames, faults, recording_path, tap, hands, record_pictures,
               recording_facts, make_renderer, drawing, detour_every] =
      static_cast<const SimulationSetup&>(options);
  static_cast<void>(robot_model);     // read from robot_path
  static_cast<void>(dynamics);        // the world returns it with the iterations
  static_cast<void>(recording_path);  // a recording changes nothing
  static_cast<void>(tap);             // nor does who hears of it
  static_cast<void>(hands);           // what they did is in the recording
  static_cast<void>(record_pictures);
  static_cast<void>(recording_facts);
  static_cast<void>(drawing);
  static_cast<void>(detour_every);  // nor does a detour
  std::vector<std::pair<std::string, std::string>> facts{
      {"mcu", to_string(mcu)},
      {"seed", std::to_string(seed)},
      {"dynamics", world.dynamics()},
      {"physics_step_ms", exact(physics_step_ms)},
      {"sensors", to_string(sensors)},
      {"sensor_params_sha256", digest_of(sensor_params)},
      {"imu", imu ? "true" : "false"},
      {"eyes", to_string(eyes)},
      {"eye_width", std::to_string(eye_width)},
      {"frames", frames == FramePolicy::wait ? "wait" : "drop"},
      {"renderer", name_of(renderer, make_renderer)},
      {"supply_volts", exact(supply_volts)},
      {"supply_ohms", exact(supply_ohms)},
      {"world_sha256", digest_of(world_path)},
      {"robot_sha256", digest_of(robot_path)},
      {"sensors_sha256", digest_beside(robot_path, "sensors.xml")},
      {"motor_sha256", digest_beside(robot_path, "motor.xml")},
      {"camera_sha256", digest_of(camera_path)},
      {"image_sha256", digest_of(image_path)},
      {"faults", faults.text()}};
  if (suspended) facts.emplace_back("suspended", "true");
  if (reading.mesh_collision != MeshCollision::hull)
    facts.emplace_back("mesh_collision", to_string(reading.mesh_collision));
  if (reading.skip_missing_meshes) facts.emplace_back("skip_missing_meshes", "true");
  return facts;
}

template <class A>
void Simulation::transfer(A& a) {
  a(now_, faults_, hands_, line_, eyes_open_);
  a.require(now_ >= 0 && std::abs(board_.now() - now_) <= KZ_STATES_PER_TICK, "time");
  bool has_eyes = eyes_ != nullptr;
  a(has_eyes);
  a.require(has_eyes || !eyes_open_, "eyes");
  if constexpr (A::reading) {
    if (!a.good()) return;
    if (has_eyes && !this->has_eyes())
      return a.refuse("it contains cameras, but the robot has no head");
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
  if (!to.good()) return fail(Fault::failed, "the simulation cannot be saved: " + to.error());
  return Snapshot::pack(facts_of(options_, *world_), to.bytes());
}

// Parts that follow a refused one are not read: they would be set to zero.
void Simulation::read_state(StateReader& from) {
  world_->restore(from);
  if (from.good()) board_.restore(from);
  if (from.good()) transfer(from);
  if (from.good() && from.left() != 0) from.refuse("it is too long");
}

Result<void> Simulation::restore(std::span<const std::uint8_t> blob) {
  const auto state = KAZ_TRY(Snapshot::unpack(blob, facts_of(options_, *world_)));
  StateWriter before;
  world_->save(before);
  board_.save(before);
  transfer(before);
  StateReader from(state);
  read_state(from);
  if (from.good()) {
    error_.reset();
    return {};
  }
  const Error refusal{Fault::usage,
                      "this saved state cannot be restored: " + from.error() + "; save it again"};
  // A state that is refused may have been read in part. The present one is put back; if it cannot be, nothing
  // runs until a whole one is restored.
  StateReader back(before.bytes());
  read_state(back);
  if (!before.good() || !back.good()) error_ = refusal;
  return tl::unexpected(refusal);
}

Result<Simulation::Start> Simulation::keep() {
  if (error_) return tl::unexpected(*error_);
  Start start;
  start.world = KAZ_TRY(world_->clone());
  StateWriter to;
  start.chip = board_.keep(to);
  transfer(to);
  if (!to.good()) return fail(Fault::failed, "the simulation cannot be copied: " + to.error());
  start.rest = std::move(to.bytes());
  return start;
}

Result<void> Simulation::begin(const Start& start, std::uint64_t seed) {
  if (recorder_)
    return fail(Fault::usage,
                "the simulation cannot start from another state while it is recorded: finish the "
                "recording first");
  world_ = KAZ_TRY(start.world->clone());
  options_.seed = seed;
  StateReader from(start.rest);
  if (eyes_) eyes_->reseed(seed);
  board_.take(from, start.chip.get(), seed);
  transfer(from);
  if (from.good() && from.left() != 0) from.refuse("it is too long");
  if (!from.good()) {
    error_ = Error{Fault::usage, "the simulation cannot start from this state: " + from.error()};
    return tl::unexpected(*error_);
  }
  line_.reseed(seed);
  set_sensors(0);
  error_.reset();
  return {};
}

Result<void> Simulation::detour(int steps) {
  const auto blob = KAZ_TRY(save());
  auto recorder = std::exchange(recorder_, nullptr);
  Result<void> went;
  for (int k = 0; k < steps && went; ++k) went = advance();
  recorder_ = std::move(recorder);
  if (!went) return went;
  return restore(blob);
}

}  // namespace kaz::sim
