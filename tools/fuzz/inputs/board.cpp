// What a board or a simulation is started from: memories, saved states; and arguments.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "hil/fuzz/choices.h"
#include "host/behavior/navigation_goal.h"
#include "host/behavior/options.h"
#include "host/camera/v4l2_camera.h"
#include "shared/protocol/crc16.h"
#include "shared/servo/store.h"
#include "sim/mcu/mcu.h"
#include "sim/mcu/memory_file.h"
#include "sim/runtime/formats/sha256.h"
#include "sim/runtime/simulation/simulation.h"
#include "sim/runtime/simulation/snapshot.h"
#include "sim/stand/stand_commands.h"
#include "tools/base/arguments.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/vision/modules.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;
constexpr std::size_t kMemory = sim::Mcu::kMemorySize;

// Erased flash with lines of a log, whose check sums are right for the most part.
std::vector<std::uint8_t> memory_of(Bytes bytes) {
  std::vector<std::uint8_t> memory(kMemory, 0xff);
  Choices choices(bytes);
  while (!choices.ended()) {
    const std::size_t at = choices.below(kMemory / KZ_STORE_LINE) * KZ_STORE_LINE;
    const bool checked = choices.below(8) != 7;
    for (std::size_t k = 0; k < KZ_STORE_LINE - 2; ++k) memory[at + k] = choices.byte();
    std::uint16_t crc = 0xffff;
    for (std::size_t k = 0; k < KZ_STORE_LINE - 2; ++k) crc = kz_crc16_step(crc, memory[at + k]);
    if (!checked) crc = static_cast<std::uint16_t>(choices.word());
    memory[at + KZ_STORE_LINE - 2] = static_cast<std::uint8_t>(crc >> 8);
    memory[at + KZ_STORE_LINE - 1] = static_cast<std::uint8_t>(crc);
  }
  return memory;
}

// The board on it: it runs, drives nothing without a request, and loses no state.
Complaint run_on(std::span<const std::uint8_t> memory) {
  const std::string path = input_file(memory, "memory");
  const auto mcu = sim::make_native();
  if (auto loaded = sim::load_memory(*mcu, path); !loaded) return judge_error(loaded.error(), path);
  bool driven = false;
  mcu->on_tick([&](const sim::TickRecord& tick) {
    driven = driven || (tick.output.p4 & KZ_P4_ENABLE) != 0 ||
             std::any_of(std::begin(tick.output.pw), std::end(tick.output.pw),
                         [](std::uint8_t duty) { return duty != 0; });
  });
  mcu->set_analog([](int, const sim::PinLevels&, sim::States) { return 0.5; });
  mcu->power_cycle();
  if (auto ran = mcu->run_until(mcu->now() + 30 * KZ_STATES_PER_TICK); !ran)
    return "the board does not run: " + ran.error().message;
  if (driven) return "a motor is driven";
  const auto kept = mcu->memory();
  if (!std::equal(kept.begin(), kept.end(), memory.begin(), memory.end()))
    return "the board has changed its memory";
  const std::string again = input_folder() + "/memory-again";
  if (auto saved = sim::save_memory(*mcu, again); !saved) return saved.error().message;
  const auto other = sim::make_native();
  if (auto loaded = sim::load_memory(*other, again); !loaded) return loaded.error().message;
  if (other->memory() != kept) return "the memory changes when it is written and read back";
  return std::nullopt;
}

// A simulation whose saved states are damaged: the valid one, and the one a step later. The latter is empty
// for the emulated chip: it also has the last jumps, which translated code notes more rarely.
struct Saved {
  std::unique_ptr<sim::Simulation> simulation;
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::uint8_t> valid, next;
};

Saved saved(Result<std::unique_ptr<sim::Simulation>> made, const sim::SimulationOptions& options) {
  Saved saved{std::move(made).value(), {}, {}, {}};
  sim::Simulation& simulation = *saved.simulation;
  saved.facts = facts_of(options, simulation.world());
  for (int k = 0; k < 20; ++k) (void)simulation.step();
  // Amid a frame, and a reply.
  const std::uint8_t bytes[] = {0, 3, 1, KZ_TYPE_state, 7, 0};
  simulation.write(bytes);
  for (int k = 0; k < 3; ++k) (void)simulation.step();
  saved.valid = simulation.save().value();
  (void)simulation.step();
  if (options.mcu == sim::McuKind::native) saved.next = simulation.save().value();
  return saved;
}

Saved stand(const sim::SimulationOptions& chosen) {
  sim::StandOptions stand;
  stand.motor = {.name = "case",
                 .stall_slope_nm_per_v = 0.2,
                 .friction_nm = 0.1,
                 .back_emf_nms_per_rad = 0.3,
                 .rotor_inertia_kgm2 = 1e-3,
                 .max_supply_v = 12};
  sim::SimulationOptions options = chosen;
  auto made = sim::make_stand(options, stand);
  options.supply_ohms = 0.02;  // as make_stand() has it
  return saved(std::move(made), options);
}

Saved robot(const std::string& dynamics) {
  sim::SimulationOptions options;
  options.mcu = sim::McuKind::native;
  options.world_path = KAZ_TREE "/sim/worlds/ball.sdf";
  options.robot_path = KAZ_TREE "/shared/robot/kaz/kaz.urdf";
  options.camera_path = KAZ_TREE "/shared/robot/kaz/camera.json";
  options.sensor_params = sim::load_sensor_file(KAZ_TREE "/shared/robot/kaz/sensors.xml").value();
  options.dynamics = dynamics;
  options.faults = faults::Schedule::parse(
                       "at 0.01 s for 1 s pot_noisy joint 2 sigma 3 codes\n"
                       "at 0.015 s for 1 s link_drop 0.5\n",
                       "case")
                       .value();
  return saved(sim::Simulation::create(options), options);
}

// Each kind of part that a state may have: both engines, a stand and a robot, both dynamics.
std::vector<Saved>& saved_states() {
  static std::vector<Saved> all = [] {
    std::vector<Saved> made;
    sim::SimulationOptions options;
    options.mcu = sim::McuKind::native;
    made.push_back(stand(options));
    made.push_back(robot("reduced"));
    made.push_back(robot("quick20"));
#ifdef KAZ_FIRMWARE_IMAGE
    options.mcu = sim::McuKind::h8;
    options.image_path = KAZ_FIRMWARE_IMAGE;
    made.push_back(stand(options));
#endif
    return made;
  }();
  return all;
}

// The input replaces bytes of the valid state: position from its end (2 bytes), value.
Complaint run_damaged(Saved& saved, Bytes bytes) {
  sim::Simulation& simulation = *saved.simulation;
  const auto valid = sim::Snapshot::unpack(saved.valid, saved.facts);
  if (!valid) return "cannot be read back: " + valid.error().message;
  std::vector<std::uint8_t> parts(valid->begin(), valid->end());
  Choices choices(bytes);
  while (!choices.ended()) {
    const std::size_t at = static_cast<std::size_t>(choices.byte()) << 8 | choices.byte();
    if (at >= parts.size()) {
      parts.resize(parts.size() - std::min<std::size_t>(parts.size(), choices.byte()));
      if (parts.empty()) break;
    } else {
      parts[parts.size() - 1 - at] = choices.byte();
    }
  }
  if (auto before = simulation.restore(saved.valid); !before)
    return "a valid state is refused: " + before.error().message;
  const auto restored = simulation.restore(sim::Snapshot::pack(saved.facts, parts));
  if (!restored) {
    if (auto wrong = judge_error(restored.error(), "saved state")) return wrong;
    if (const auto now = simulation.save(); !now || *now != saved.valid)
      return "a refused state has changed the simulation";
  }
  // A chip may stop, and bodies break down, with a sentence.
  for (int k = 0; restored && k < 5; ++k) (void)simulation.step();
  if (auto again = simulation.restore(saved.valid); !again)
    return "a valid state is refused afterwards: " + again.error().message;
  if (auto stepped = simulation.step(); !stepped)
    return "the restored simulation does not run: " + stepped.error().message;
  if (!saved.next.empty() && simulation.save().value() != saved.next)
    return "the restored simulation continues differently";
  return std::nullopt;
}

}  // namespace

Complaint try_memory(Bytes bytes) {
  if (bytes.size() >= kMemory) {
    const std::string path = input_file(bytes, "memory");
    if (bytes.size() > kMemory) {
      const auto loaded = sim::load_memory(*sim::make_native(), path);
      if (loaded) return "a memory of the wrong size was accepted";
      return judge_error(loaded.error(), path);
    }
    return run_on(bytes);
  }
  return run_on(memory_of(bytes));
}

Complaint try_state(Bytes bytes) {
  // As a file, with the check sum that belongs to it: only the content is wrong.
  std::vector<std::uint8_t> blob(bytes.begin(), bytes.end());
  const std::string digest = sim::sha256_hex(blob);
  blob.insert(blob.end(), digest.begin(), digest.end());
  if (const auto state = sim::Snapshot::unpack(blob, {{"seed", "1"}}); !state) {
    if (auto wrong = judge_error(state.error(), "saved state")) return wrong;
  } else if (state->data() < blob.data() ||
             state->data() + state->size() > blob.data() + blob.size()) {
    return "a state that extends beyond its file";
  }
  if (sim::Snapshot::unpack(bytes, {})) return "a state without its checksum was accepted";

  // As the parts of a simulation, with the check sum that belongs to them.
  auto& states = saved_states();
  return run_damaged(states[bytes.size() % states.size()], bytes);
}

Complaint try_arguments(Bytes bytes) {
  std::string text = text_of(bytes);
  // A command line holds no NUL; a newline in an argument comes back in the sentence about it.
  text.resize(std::min(text.size(), text.find('\0')));
  if (text.find('\n') != std::string::npos) return std::nullopt;
  if (const auto port = tools::parse_port(text); !port) {
    if (auto wrong = judge_error(port.error(), "--robot")) return wrong;
  } else if (port->baud <= 0 || port->place.empty()) {
    return "an invalid port";
  } else if (const auto again = tools::parse_port(port->name());
             !again || again->name() != port->name()) {
    return "a port's name is parsed as a different port";
  }
  if (const auto source = host::parse_v4l2_source(text); !source) {
    if (auto wrong = judge_error(source.error(), "v4l2:")) return wrong;
  } else if (source->left.empty() || source->right.empty() || !(source->rate_hz >= 0)) {
    return "an invalid pair of cameras";
  }
  if (const auto modules = tools::parse_modules(text); !modules) {
    if (auto wrong = judge_error(modules.error(), "--modules")) return wrong;
  } else if (modules->empty()) {
    return "the list of modules is empty";
  }
  constexpr behavior::Option kOptions[] = {{"seconds", "10", "", 0, 100, "duration, s"},
                                           {"end", "keep", "keep|home", 0, 0, "posture at the end"},
                                           {"goal", "1,0", "X,Y or ball", 0, 0, "goal of the walk",
                                            false, behavior::is_navigation_goal}};
  const std::size_t equals = text.find('=');
  const auto values = behavior::OptionValues::parse(
      kOptions,
      {{text.substr(0, equals), equals == std::string::npos ? "" : text.substr(equals + 1)}});
  if (!values) return judge_error(values.error(), "`");
  if (!(values->number("seconds") >= 0 && values->number("seconds") <= 100))
    return "an option is out of range";
  const auto goal = behavior::navigation_goal(values->choice("goal"));
  if (!goal) return "an invalid goal";
  if (!(goal->position.norm() <= 3)) return "a goal out of reach";
  return std::nullopt;
}

}  // namespace kaz::fuzz
