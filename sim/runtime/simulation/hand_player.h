// What somebody does by hand to a simulated robot and its world while a run goes on.
// SPDX-License-Identifier: Apache-2.0
//
// One line for each act, as recordings have it in `/hand` (docs/reference/recording.md):
//
//   push LINK X Y Z        impulse on a link of the robot, at its centre of mass: N s, world axes
//   hold OBJECT X Y Z      a hand takes an object of the world, and draws it to that place: m, world frame
//   release OBJECT
//   [for TIME] FAULT ...   a fault that begins now (shared/faults/faults.h)
//   clear                  all faults end
//
// It acts from the step on that begins when it is taken. A run in which the same lines are taken in the same
// steps is the same run.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "shared/faults/faults.h"
#include "sim/body/world/world.h"
#include "sim/runtime/simulation/fault_player.h"

namespace kaz::sim {

struct HandAct {
  enum class Kind { push, hold, release, fault, clear };
  Kind kind = Kind::clear;
  std::string name;                                  // of link or object
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  // impulse, N s; place, m
  faults::Fault fault;                               // begins at the time that parse_hand() had

  static constexpr double kMaxImpulse = 5;  // N s, along each axis
  static constexpr double kMaxPlace = 20;   // m, along each axis
};

// Errors (usage) state what was expected. Whether there is such a link or object only the world can tell.
Result<HandAct> parse_hand(std::string_view line, Time now);

// Where such lines come from.
class HandSource {
 public:
  virtual ~HandSource() = default;
  // Those that act from the step on that begins at `start`. Called once for each step.
  virtual std::vector<std::string> take(Time start) = 0;
  // One of them did nothing.
  virtual void refused(const std::string& /*line*/, const Error& /*error*/) {}
};

class HandPlayer {
 public:
  // Begins an act. Errors (usage): no such link or object, or one that does not move.
  Result<void> begin(const HandAct& act, World& world, FaultPlayer& faults);
  // To be called before each step of the world: draws what is held. An object follows its hand as a mass on
  // a critically damped spring of kStiffness does, with its weight carried, and no faster than kMaxPull.
  void pull(World& world);
  bool holds() const { return !grips_.empty(); }

  static constexpr double kStiffness = 400;  // 1/s^2: 20 rad/s
  static constexpr double kDamping = 40;     // 1/s
  static constexpr double kMaxPull = 60;     // m/s^2

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(grips_);
  }

 private:
  struct Grip {
    std::string object;
    std::array<double, 3> to{}, last{};  // m, world frame
    bool moved = false;                  // `last` is its place one step ago
    template <class A>
    void transfer(A& a) {
      a(object, to, last, moved);
    }
  };
  std::vector<Grip> grips_;
};

}  // namespace kaz::sim
