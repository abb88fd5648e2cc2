// Faults by name, schedules of them as text, and schedules at random.
// SPDX-License-Identifier: Apache-2.0
//
// One vocabulary (faults.def) for simulator, tests and, where it can be, a real port. A schedule is
// text, one fault a line; docs/reference/faults.md:
//
//   at 1.250 s for 0.2 s pot_open joint 3
//   at 2 s for 500 ms link_drop 0.05 to board   # 5 % of the bytes from the host
//   at 4 s power_reset
//
// Times count from the start of the simulation or of the port that the schedule is passed to.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::faults {

enum class Name {
#define KZ_FAULT(name, target, parameter, unit, low, high, initial, where, text) name,
#include "shared/faults/faults.def"
};

constexpr Name last_value(Name) {
  constexpr int count = 0
#define KZ_FAULT(name, target, parameter, unit, low, high, initial, where, text) +1
#include "shared/faults/faults.def"
      ;
  return static_cast<Name>(count - 1);
}

enum class Target { line, joint, board };
enum class Where { simulation, everywhere };
enum class Way { both, to_board, to_host };  // direction of a link fault
constexpr Way last_value(Way) {
  return Way::to_host;
}

struct Kind {
  Name id;
  std::string_view name;
  Target target;
  std::string_view parameter, unit;  // parameter "": none
  double low, high, initial;
  Where where;
  std::string_view text;
};

std::span<const Kind> kinds();
const Kind& kind_of(Name name);

inline constexpr Time kForEver = Time::max();

struct Fault {
  Name name{};
  Time at{};
  Time length = kForEver;
  int joint = -1;       // number of joints.def; -1 where the target is none
  Way way = Way::both;  // of link faults
  double value = 0;     // in the unit of its kind
  bool operator==(const Fault&) const = default;

  // Whether joint and value are in the range of its kind.
  bool is_possible() const;
  bool active(Time t) const { return t >= at && (length == kForEver || t - at < length); }
  template <class A>
  void transfer(A& a) {
    a(name, at, length, joint, way, value);
    a.require(is_possible(), "fault");
  }
};

// Parses one line of a schedule without its comment. Without `at` the fault begins at `now`. Errors name
// what was expected and what was found instead.
Result<Fault> parse(std::string_view line, Time now = Time::zero());
// Inverse of parse().
std::string text_of(const Fault& fault);

class Schedule {
 public:
  Schedule() = default;
  explicit Schedule(std::vector<Fault> faults) : faults_(std::move(faults)) {}
  // Errors name file and line.
  static Result<Schedule> load(const std::string& path);
  static Result<Schedule> parse(std::string_view text, const std::string& name);

  void add(const Fault& fault) { faults_.push_back(fault); }
  void clear() { faults_.clear(); }
  std::span<const Fault> faults() const { return faults_; }
  bool empty() const { return faults_.empty(); }
  std::string text() const;
  // Those that begin at `end` or later.
  std::vector<Fault> not_begun(Time end) const;
  // The name of the first fault that only the simulator can do; nothing if there is none.
  std::optional<std::string_view> only_simulated() const;

  // Complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(faults_);
  }

 private:
  std::vector<Fault> faults_;
};

struct RandomOptions {
  Time length = std::chrono::seconds(10);  // faults begin within it
  double per_second = 1;                   // mean rate of faults
  Time longest = std::chrono::milliseconds(500);
  bool line = true, joints = true, power = true;
};
// "1 fault never began, as the run ended before it: at 100 s power_reset"; "" of none.
std::string not_begun_text(std::span<const Fault> faults);
// The same seed and options give the same schedule.
Schedule random_schedule(std::uint64_t seed, const RandomOptions& options);

}  // namespace kaz::faults
