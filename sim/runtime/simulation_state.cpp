// The whole simulation to bytes and back; what a recording and a saved state say of its options.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <iterator>

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

}  // namespace

std::vector<std::pair<std::string, std::string>> facts_of(const SimulationOptions& options,
                                                          const World& world) {
  return {{"engine", options.engine},
          {"seed", std::to_string(options.seed)},
          {"stepper", world.stepper()},
          {"sensors", name_of(options.sensors)},
          {"imu", options.imu ? "true" : "false"},
          {"eyes", options.ideal_eyes ? "ideal" : "real"},
          {"supply_volts", std::to_string(options.supply_volts)},
          {"world_sha256", digest_of(options.world_path)},
          {"robot_sha256", digest_of(options.robot_path)},
          {"sensors_sha256", digest_beside(options.robot_path, "sensors.xml")},
          {"motor_sha256", digest_beside(options.robot_path, "motor.xml")},
          {"camera_sha256", digest_of(options.camera_path)},
          {"image_sha256", digest_of(options.image_path)},
          {"faults", options.faults.text()}};
}

template <class A>
void Simulation::transfer(A& a) {
  a(now_, faults_, line_, eyes_open_);
  bool has_eyes = eyes_ != nullptr;
  a(has_eyes);
  if constexpr (A::reading) {
    if (!a.good()) return;
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

}  // namespace kaz::sim
