// What somebody does by hand to a simulated robot and its world.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/hand_player.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "shared/base/number_text.hpp"

namespace kaz::sim {
namespace {

constexpr double kGravity = 9.81;  // m/s^2, of the weight that a hand carries

// By append(): GCC 12 warns of `"..." + std::string` where it inlines it.
std::string in_quotes(std::string_view word) {
  return std::string("`").append(word).append("`");
}

Error misread(const std::string& what) {
  return {Fault::usage,
          what +
              "; give `push LINK X Y Z` (N s), `hold OBJECT X Y Z` (m), `release OBJECT`, "
              "`clear`, or a fault such as `for 1 s pot_open joint l_knee`"};
}

}  // namespace

Result<HandAct> parse_hand(std::string_view line, Time now) {
  std::istringstream in{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  if (words.empty()) return tl::unexpected(misread("empty command"));
  HandAct act;
  const std::string& verb = words[0];
  const bool pushes = verb == "push", holds = verb == "hold";
  if (verb == "clear" && words.size() == 1) return act;
  if (verb == "release" && words.size() == 2) {
    act.kind = HandAct::Kind::release;
    act.name = words[1];
    return act;
  }
  if (pushes || holds) {
    act.kind = pushes ? HandAct::Kind::push : HandAct::Kind::hold;
    if (words.size() != 5)
      return tl::unexpected(misread(in_quotes(verb) + " takes a name and three numbers"));
    act.name = words[1];
    const double most = pushes ? HandAct::kMaxImpulse : HandAct::kMaxPlace;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string& word = words[static_cast<std::size_t>(2 + axis)];
      const auto number = parse_number<double>(word);
      if (!number || !(std::abs(*number) <= most))
        return tl::unexpected(misread(in_quotes(word) + " must be a number from " +
                                      std::to_string(static_cast<int>(-most)) + " to " +
                                      std::to_string(static_cast<int>(most))));
      act.vector[axis] = *number;
    }
    return act;
  }
  if (verb == "at") return tl::unexpected(misread("a command starts at once: leave `at` out"));
  const auto fault = faults::parse(line, now);
  if (!fault) return tl::unexpected(misread(in_quotes(line) + ": " + fault.error().message));
  act.kind = HandAct::Kind::fault;
  act.fault = *fault;
  return act;
}

Result<void> HandPlayer::begin(const HandAct& act, World& world, FaultPlayer& faults) {
  const auto held = std::ranges::find(grips_, act.name, &Grip::object);
  switch (act.kind) {
    case HandAct::Kind::push:
      return world.push(act.name, act.vector);
    case HandAct::Kind::hold: {
      // Whether it is there and moves, without a change.
      KAZ_TRY(world.accelerate(act.name, Eigen::Vector3d::Zero()));
      Grip& grip = held != grips_.end() ? *held : grips_.emplace_back();
      grip.object = act.name;
      std::ranges::copy(act.vector, grip.to.begin());
      return {};
    }
    case HandAct::Kind::release:
      if (held == grips_.end())
        return fail(Fault::usage, "no hand holds `" + act.name + "`, so it is not released");
      grips_.erase(held);
      return {};
    case HandAct::Kind::fault:
      faults.add(act.fault);
      return {};
    case HandAct::Kind::clear:
      faults.clear();
      return {};
  }
  return {};
}

void HandPlayer::pull(World& world) {
  const double step_s = world.step_s();
  for (Grip& grip : grips_) {
    const auto at = world.object_position(grip.object);
    if (!at) continue;
    const Eigen::Map<Eigen::Vector3d> to(grip.to.data());
    Eigen::Map<Eigen::Vector3d> last(grip.last.data());
    const Eigen::Vector3d velocity =
        grip.moved ? Eigen::Vector3d((*at - last) / step_s) : Eigen::Vector3d::Zero();
    last = *at;
    grip.moved = true;
    Eigen::Vector3d pull = kStiffness * (to - *at) - kDamping * velocity;
    if (const double size = pull.norm(); size > kMaxPull) pull *= kMaxPull / size;
    pull.z() += kGravity;
    (void)world.accelerate(grip.object, pull * step_s);
  }
}

}  // namespace kaz::sim
