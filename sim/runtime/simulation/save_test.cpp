// A restored simulation goes on exactly as the one that was saved.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>

#include "sim/runtime/simulation/snapshot.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

// The robot of the tree with the ball that rolls, and pictures without OpenGL.
SimulationOptions real_options(McuKind mcu) {
  SimulationOptions options;
  options.mcu = mcu;
  options.image_path = mcu == McuKind::h8 ? KAZ_FIRMWARE_IMAGE : "";
  options.world_path = KAZ_TREE "/sim/worlds/ball.sdf";
  options.robot_path = KAZ_TREE "/shared/robot/kaz/kaz.urdf";
  options.camera_path = KAZ_TREE "/shared/robot/kaz/camera.json";
  options.seed = 5;
  options.make_renderer = make_test_renderer;
  auto faults = faults::Schedule::parse(
      "at 0.300 s for 1.2 s link_drop 0.2\n"
      "at 0.400 s for 1 s pot_noisy joint 2 sigma 3 codes\n"
      "at 0.900 s for 0.05 s power_sag drop 1 V\n"
      "at 0.935 s for 0.1 s joint_slipping joint 4 torque 0.2 Nm\n",
      "test");
  EXPECT_TRUE(faults) << faults.error().message;
  if (faults) options.faults = *faults;
  return options;
}

// Host traffic that depends on time alone, and a host that takes its pairs.
void run(Simulation& simulation, int milliseconds) {
  for (int t = 0; t < milliseconds; ++t) {
    const auto ms = static_cast<std::uint8_t>(simulation.time().count() / 1'000'000 / 7);
    if (ms % 3 == 0) simulation.write(Bytes{0, 3, 1, 5, ms, 0});
    const auto done = simulation.step();
    ASSERT_TRUE(done) << done.error().message;
    std::array<std::uint8_t, 64> bytes;
    simulation.read(bytes);
    simulation.next_pair();
  }
}

std::unique_ptr<Simulation> make(const SimulationOptions& options) {
  auto simulation = Simulation::create(options);
  EXPECT_TRUE(simulation) << simulation.error().message;
  return simulation ? std::move(*simulation) : nullptr;
}

class Restored : public testing::TestWithParam<McuKind> {};

TEST_P(Restored, RecordsTheSameBytesFromThere) {
  const TestFolder folder;
  const auto options = real_options(GetParam());
  Bytes saved;
  {
    auto first = make(options);
    ASSERT_NE(first, nullptr);
    first->open_eyes();
    run(*first, 941);  // amid faults, with bytes on the wire and a pair on its way
    auto blob = first->save();
    ASSERT_TRUE(blob) << blob.error().message;
    saved = *blob;
    ASSERT_TRUE(first->start_recording(folder.file("a.mcap")));
    run(*first, 700);
    ASSERT_TRUE(first->finish_recording());
  }
  auto second = make(options);
  ASSERT_NE(second, nullptr);
  const auto restored = second->restore(saved);
  ASSERT_TRUE(restored) << restored.error().message;
  EXPECT_EQ(second->time(), std::chrono::milliseconds(941));
  EXPECT_TRUE(*second->save() == saved);
  ASSERT_TRUE(second->start_recording(folder.file("b.mcap")));
  run(*second, 700);
  ASSERT_TRUE(second->finish_recording());
  const Bytes a = contents(folder.file("a.mcap")), b = contents(folder.file("b.mcap"));
  EXPECT_GT(a.size(), 100'000u);
  EXPECT_TRUE(a == b);
}

// Saved, run on, taken back: the recording knows nothing of it.
TEST_P(Restored, DetoursChangeNothing) {
  const TestFolder folder;
  const auto record = [&](const std::string& name, bool with_restore) {
    auto options = real_options(GetParam());
    options.recording_path = folder.file(name);
    if (with_restore) options.detour_every = std::chrono::milliseconds(310);
    auto simulation = make(options);
    simulation->open_eyes();
    run(*simulation, 1000);
    ASSERT_TRUE(simulation->finish_recording());
  };
  record("a.mcap", false);
  record("b.mcap", true);
  EXPECT_TRUE(contents(folder.file("a.mcap")) == contents(folder.file("b.mcap")));
}

// Whatever it has done before; with another seed it is another episode. By recordings: saved bytes have the
// last jumps too, for error reports, which translated code notes more rarely.
TEST_P(Restored, BeginsAgainFromAStart) {
  const TestFolder folder;
  auto options = real_options(GetParam());
  options.faults = {};
  options.imu = true;
  options.sensors = SensorSet::as_built;
  auto first = make(options);
  run(*first, 200);
  auto start = first->keep();
  ASSERT_TRUE(start) << start.error().message;
  auto second = make(options);
  run(*second, 77);
  const auto episode = [&](Simulation& simulation, std::uint64_t seed) {
    const auto begun = simulation.begin(*start, seed);
    EXPECT_TRUE(begun) << begun.error().message;
    EXPECT_EQ(simulation.time(), std::chrono::milliseconds(200));
    EXPECT_TRUE(simulation.start_recording(folder.file("episode.mcap")));
    run(simulation, 300);
    EXPECT_TRUE(simulation.finish_recording());
    return contents(folder.file("episode.mcap"));
  };
  const Bytes a = episode(*first, 7);
  EXPECT_GT(a.size(), 20'000u);
  EXPECT_TRUE(episode(*second, 8) != a);
  EXPECT_TRUE(episode(*second, 7) == a);
  EXPECT_TRUE(episode(*first, 7) == a);
}

TEST(Start, IsRefusedAmidARecordingAndByAnotherEngine) {
  const TestFolder folder;
  auto native = make(real_options(McuKind::native)), h8 = make(real_options(McuKind::h8));
  const auto start = native->keep();
  ASSERT_TRUE(start);
  EXPECT_FALSE(h8->begin(*start, 1));
  EXPECT_FALSE(h8->step());
  ASSERT_TRUE(native->start_recording(folder.file("a.mcap")));
  EXPECT_FALSE(native->begin(*start, 1));
  EXPECT_TRUE(native->step());
}

INSTANTIATE_TEST_SUITE_P(Engines, Restored, testing::ValuesIn(kMcuKinds),
                         [](const auto& mcu) { return to_string(mcu.param); });

std::string refusal(Simulation& simulation, const Bytes& blob) {
  const auto restored = simulation.restore(blob);
  EXPECT_FALSE(restored);
  return restored ? "" : restored.error().message;
}

TEST(Snapshot, SaysWhyItDoesNotFit) {
  auto options = real_options(McuKind::native);
  auto simulation = make(options);
  ASSERT_NE(simulation, nullptr);
  const Bytes blob = *simulation->save();
  EXPECT_NE(refusal(*simulation, {1, 2, 3}).find("is not a saved state"), std::string::npos);
  Bytes damaged = blob;
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_NE(refusal(*simulation, damaged).find("checksum is wrong"), std::string::npos);
  const Bytes cut(blob.begin(), blob.end() - 10);
  EXPECT_NE(refusal(*simulation, cut).find("checksum is wrong"), std::string::npos);
  Bytes other_version = blob;
  other_version[8] = 77;
  EXPECT_NE(refusal(*simulation, other_version).find("version 77"), std::string::npos);
  ASSERT_TRUE(simulation->step());  // nothing of this has touched it
  options.seed = 6;
  auto other = make(options);
  EXPECT_NE(refusal(*other, blob).find("saved with seed 5, this simulation has 6"),
            std::string::npos);
}

// A check sum is no signature: whoever changes a byte can compute it anew.
TEST(Snapshot, WhateverByteIsChangedItIsRefusedOrRuns) {
  for (const char* dynamics : {"reduced", "quick20"}) {
    auto options = real_options(McuKind::native);
    options.dynamics = dynamics;
    options.imu = true;
    options.sensor_params = load_sensor_file(KAZ_TREE "/shared/robot/kaz/sensors.xml").value();
    const auto simulation = make(options);
    ASSERT_NE(simulation, nullptr);
    run(*simulation, 320);  // amid faults
    ASSERT_TRUE(simulation->world().push("trunk", {0.1, 0, 0}));
    const auto saved = simulation->save();
    ASSERT_TRUE(saved) << saved.error().message;
    const Bytes& valid = *saved;
    const auto facts = facts_of(options, simulation->world());
    const auto payload = Snapshot::unpack(valid, facts);
    ASSERT_TRUE(payload) << payload.error().message;
    const Bytes parts(payload->begin(), payload->end());
    std::size_t refused = 0, ran = 0;
    for (std::size_t at = 0; at < parts.size(); at += 97) {
      Bytes damaged = parts;
      damaged[at] = static_cast<std::uint8_t>(at % 3 == 0   ? 0xff
                                              : at % 3 == 1 ? 0x7f
                                                            : parts[at] ^ 1);
      const bool taken = simulation->restore(Snapshot::pack(facts, damaged)).has_value();
      ++(taken ? ran : refused);
      if (!taken) {
        const auto now = simulation->save();
        ASSERT_TRUE(now) << at << ": " << now.error().message;
        EXPECT_TRUE(*now == valid) << at << ": a refused state has left a trace";
      }
      for (int k = 0; taken && k < 3; ++k) (void)simulation->step();  // bodies may break down
      ASSERT_TRUE(simulation->restore(valid)) << at;
    }
    EXPECT_GT(refused, 0u);
    EXPECT_GT(ran, refused);
    run(*simulation, 20);
  }
}

// Each option that decides about the run, changed alone.
TEST(Snapshot, RefusesEachOtherOption) {
  const auto options = real_options(McuKind::native);
  const auto simulation = make(options);
  ASSERT_NE(simulation, nullptr);
  const Bytes blob = *simulation->save();
  const std::pair<const char*, std::function<void(SimulationOptions&)>> changes[] = {
      {"mcu", [](auto& o) { o.mcu = McuKind::h8, o.image_path = KAZ_FIRMWARE_IMAGE; }},
      {"world", [](auto& o) { o.world_path = KAZ_TREE "/sim/worlds/empty.sdf"; }},
      {"seed", [](auto& o) { o.seed = 6; }},
      {"dynamics", [](auto& o) { o.dynamics = "quick20"; }},
      {"physics_step_ms", [](auto& o) { o.physics_step_ms = 0.5; }},
      {"sensors", [](auto& o) { o.sensors = SensorSet::ideal; }},
      {"imu", [](auto& o) { o.imu = true; }},
      {"eyes", [](auto& o) { o.eyes = EyeKind::real; }},
      {"eye_width", [](auto& o) { o.eye_width = 640; }},
      {"frames", [](auto& o) { o.frames = FramePolicy::drop; }},
      {"renderer", [](auto& o) { o.make_renderer = nullptr; }},
      {"supply_volts", [](auto& o) { o.supply_volts = 10.0 + 1e-12; }},
      {"faults", [](auto& o) { o.faults = {}; }},
  };
  for (const auto& [name, change] : changes) {
    auto changed = options;
    change(changed);
    const auto other = make(changed);
    ASSERT_NE(other, nullptr) << name;
    EXPECT_NE(refusal(*other, blob).find(name), std::string::npos) << name;
  }
  auto same = options;
  same.recording_facts = {{"note", "another"}};
  EXPECT_TRUE(make(same)->restore(blob));
}

}  // namespace
}  // namespace kaz::sim
