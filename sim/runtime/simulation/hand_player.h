// Applies manual actions to a simulated robot and its world during a run.
// SPDX-License-Identifier: Apache-2.0
//
// An action is one line of text, as in the topic `/hand` of recordings (docs/reference/recording.md):
//
//   `push LINK X Y Z`: impulse on a link of the robot at its center of mass, N s, world axes.
//   `hold OBJECT X Y Z`: a hand grips an object and pulls it to a position, m, world frame.
//   `release OBJECT`: the hand releases the object.
//   `[for TIME] FAULT ...`: a fault that begins now (shared/faults/faults.h).
//   `clear`: ends all faults.
//
// An action takes effect in the step in which its line is taken. Two runs that take the same lines in the
// same steps are equal.
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
  std::string name;                                  // name of a link or object
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  // impulse in N s, or position in m
  faults::Fault fault;  // the fault begins at the time `now` of parse_hand()

  static constexpr double kMaxImpulse = 5;  // maximum impulse along each axis, N s
  static constexpr double kMaxPlace = 20;   // largest coordinate of a position, m
};

// Parses a line. Returns Fault::usage with the expected syntax if the line is invalid. Does not check that
// the link or object exists; HandPlayer::begin() does.
Result<HandAct> parse_hand(std::string_view line, Time now);

// Source of action lines.
class HandSource {
 public:
  virtual ~HandSource() = default;
  // Returns the lines that take effect in the step that begins at `start` and in later steps. Called once in
  // each step that is recorded or tapped.
  virtual std::vector<std::string> take(Time start) = 0;
  // Called for a line that had no effect.
  virtual void refused(const std::string& /*line*/, const Error& /*error*/) {}
};

class HandPlayer {
 public:
  // Begins an action. Returns Fault::usage if the link or object is unknown or cannot move, or if an object
  // to be released is not held.
  Result<void> begin(const HandAct& act, World& world, FaultPlayer& faults);
  // Pulls the held objects; call this function before each step of the world. An object follows its hand like
  // a mass on a critically damped spring. The hand supports the object's weight and accelerates the object by
  // at most kMaxPull.
  void pull(World& world);
  bool holds() const { return !grips_.empty(); }

  static constexpr double kStiffness = 400;  // 1/s^2; natural frequency 20 rad/s
  static constexpr double kDamping = 40;     // 1/s
  static constexpr double kMaxPull = 60;     // m/s^2

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(grips_);
  }

 private:
  struct Grip {
    std::string object;
    std::array<double, 3> to{}, last{};  // target and last position, m, world frame
    bool moved = false;                  // true: `last` is the position one step ago
    template <class A>
    void transfer(A& a) {
      a(object, to, last, moved);
    }
  };
  std::vector<Grip> grips_;
};

}  // namespace kaz::sim
