// Applies manual actions to a simulated robot and its world during a run.
// SPDX-License-Identifier: Apache-2.0
//
// An action is one line of text, as in the topic `/hand` of recordings (docs/reference/recording.md):
//
//   `push LINK X Y Z`: impulse on a link of the robot at the link's center of mass, N s, world axes.
//   `hold OBJECT X Y Z`: a hand grips an object and pulls it to a position, m, world frame.
//   `release OBJECT`: the hand releases the object.
//   `[for TIME] FAULT ...`: a fault that begins now (shared/faults/faults.h).
//   `clear`: ends all faults.
//
// An action takes effect in the step in which HandSource::take() returns the action's line. If two runs have
// the same options, and take() returns the same lines in the same steps, the runs are identical.
#pragma once

#include <string>
#include <string_view>
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
  faults::Fault fault;  // the fault begins at the time `now` that was passed to parse_hand()

  static constexpr double kMaxImpulse = 5;  // maximum impulse along each axis, N s
  static constexpr double kMaxPlace = 20;   // largest coordinate of a position, m
};

// Parses a line. Returns Fault::usage with the expected syntax if the line is invalid. Only
// HandPlayer::begin() checks that the link or object exists.
Result<HandAct> parse_hand(std::string_view line, Time now);

// Source of action lines.
class HandSource {
 public:
  virtual ~HandSource() = default;
  // Returns the lines of all actions of the step that begins at the time `start`. The simulation calls take()
  // once in each step in which the simulation writes messages to a recording file or to a RecordingTap.
  virtual std::vector<std::string> take(Time start) = 0;
  // Called for a line that had no effect.
  virtual void refused(const std::string& /*line*/, const Error& /*error*/) {}
};

class HandPlayer {
 public:
  // Begins an action. Returns Fault::usage if the link or object is unknown or cannot move. Also returns
  // Fault::usage if the action releases an object that no hand holds.
  Result<void> begin(const HandAct& act, World& world, FaultPlayer& faults);
  // Pulls the held objects toward the hands. Call this function before each step of the world. An object
  // follows the hand like a mass on a critically damped spring. The hand supports the object's weight and
  // accelerates the object by at most kMaxPull.
  void pull(World& world);
  bool holds() const { return !grips_.empty(); }

  // Stiffness per mass, 1/s^2; the natural frequency is 20 rad/s.
  static constexpr double kStiffness = 400;
  static constexpr double kDamping = 40;  // damping per mass, 1/s
  static constexpr double kMaxPull = 60;  // maximum acceleration by a hand, m/s^2

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(grips_);
  }

 private:
  struct Grip {
    std::string object;
    // Target position and last position of the object, m, world frame.
    std::array<double, 3> to{}, last{};
    bool moved = false;  // false: pull() has not yet set `last`
    template <class A>
    void transfer(A& a) {
      a(object, to, last, moved);
    }
  };
  std::vector<Grip> grips_;
};

}  // namespace kaz::sim
