// Injected faults: the kinds of faults, and schedules as text.
// SPDX-License-Identifier: Apache-2.0
//
// Simulator, tests and real ports share one list of fault kinds (faults.def). Real ports support only some
// kinds. A schedule is text with one fault per line (docs/reference/simulator.md):
//
//   at 1.250 s for 0.2 s pot_open joint 3
//   at 2 s for 500 ms link_drop 0.05 to board   # 5 % of the bytes from the host
//   at 4 s power_reset
//
// Times count from the start of the simulation. For a real port, times count from the opening of the port.
#pragma once

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

// Entry of faults.def.
struct Kind {
  Name id;
  std::string_view name;
  Target target;
  std::string_view parameter, unit;  // empty if the kind has no parameter or no unit
  double low, high, initial;         // bounds and default of the parameter
  Where where;
  std::string_view text;
};

// Returns all kinds of faults, in the order of Name.
std::span<const Kind> kinds();
const Kind& kind_of(Name name);

inline constexpr Time kForEver = Time::max();

struct Fault {
  Name name{};
  Time at{};  // time at which the fault begins
  Time length = kForEver;
  int joint = -1;       // index in joints.def; -1 if the target is not a joint
  Way way = Way::both;  // link faults only
  double value = 0;     // parameter, in the unit of the fault's kind
  bool operator==(const Fault&) const = default;

  // Returns whether joint and value are valid for the kind of fault.
  bool is_possible() const;
  // Returns whether the fault is active at time `t`. A fault is active from `at` on, for the duration
  // `length`.
  bool active(Time t) const { return t >= at && (length == kForEver || t - at < length); }
  template <class A>
  void transfer(A& a) {
    a(name, at, length, joint, way, value);
    a.require(is_possible(), "fault");
  }
};

// Parses one line of a schedule. The line must not have a comment. Without `at`, the fault begins at `now`.
// Returns Fault::usage with the expected and the found text if the line is invalid.
Result<Fault> parse(std::string_view line, Time now = Time::zero());
// Returns `fault` as one line of a schedule. parse() converts this line back to the same fault.
std::string text_of(const Fault& fault);

// List of faults in any order.
class Schedule {
 public:
  Schedule() = default;
  explicit Schedule(std::vector<Fault> faults) : faults_(std::move(faults)) {}
  // Read a schedule from a file or from text. Error messages of load() contain `path`. Error messages of
  // parse() contain `name`. A message about an invalid line also contains the number of the line. load() also
  // rejects a file without faults.
  static Result<Schedule> load(const std::string& path);
  static Result<Schedule> parse(std::string_view text, const std::string& name);

  void add(const Fault& fault) { faults_.push_back(fault); }
  void clear() { faults_.clear(); }
  std::span<const Fault> faults() const { return faults_; }
  bool empty() const { return faults_.empty(); }
  // Returns the schedule as text in the format of parse(), with one fault per line.
  std::string text() const;
  // Returns the faults that begin at `end` or later.
  std::vector<Fault> not_begun(Time end) const;
  // Returns the name of a fault that only the simulator can inject; nullopt if the schedule contains no such
  // fault.
  std::optional<std::string_view> only_simulated() const;

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(faults_);
  }

 private:
  std::vector<Fault> faults_;
};

// Returns a message which states that `faults` never began. If `faults` is empty, returns an empty text.
std::string not_begun_text(std::span<const Fault> faults);

}  // namespace kaz::faults
