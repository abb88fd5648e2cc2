// What the bench finds: values with unit, limits and verdict, and curves to look at.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/report/provenance.h"
#include "hil/report/verdict.h"
#include "host/link/lateness.h"
#include "shared/base/result.hpp"
#include "shared/plot/plot.h"

namespace kaz::hil {

enum class BenchGroup { motor, link, tick };
const char* text(BenchGroup group);  // "motor"

// A line of measurements.def. A side without limit is infinite.
struct MeasurementInfo {
  BenchGroup group;
  std::string name, unit;
  double low, high;
  std::string text;
};

// All, in the order of the file. Names are unique.
const std::vector<MeasurementInfo>& measurement_infos();
// Null: there is none of this name.
const MeasurementInfo* find_measurement(const std::string& name);

struct Measurement {
  const MeasurementInfo* of = nullptr;
  std::string subject;  // joint, "link" or "board"
  Verdict verdict = Verdict::left_out;
  double value = 0;          // in of->unit; NaN where nothing could be measured
  double error = 0;          // standard error of the value, 0: not known
  double low = 0, high = 0;  // the limits that were applied
  std::string message;       // why it failed, was skipped, or could not be judged
  // What makes it undecided; not read back from JSON.
  enum class Doubt { none, machine, line, motor } doubt = Doubt::none;
};

// A curve or a cloud of points.
struct Series {
  std::string name;
  using Style = plot::Series::Style;
  Style style = Style::line;
  std::vector<std::pair<double, double>> points;
};

struct Plot {
  std::string id;                       // "stall": unique within a report together with the subject
  std::string subject;                  // joint, "link" or "board"
  std::string title, x_label, y_label;  // labels with their unit: "motor voltage, V"
  bool x_logarithmic = false;
  std::vector<Series> series;
  std::string caption;  // what is to be seen, one sentence
};

// Limits other than those of measurements.def, by measurement.
using Limits = std::map<std::string, std::pair<double, double>>;
// From JSON: {"stall.torque_10v": {"low": 2.0, "high": 2.3}}, or the list of `kaz bench list --json`; a
// side that is missing or null has no limit. Errors (usage): no JSON, unknown name or key, low above high.
Result<Limits> parse_limits(const std::string& json, const std::string& file_name);

struct BenchReport {
  std::string board;    // "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d"
  std::string port;     // "/dev/ttyUSB0", "virtual board (h8)"
  std::string program;  // "kaz 0.1.0"
  std::optional<std::uint64_t> seed = {};  // of the emulated board and stand; none at a port
  Provenance from = {};                    // not read back from JSON
  // What the bench was: disc on the shaft, supplies. Name with unit, and value; for `bench fit`.
  std::vector<std::pair<std::string, double>> conditions;
  std::vector<Measurement> measurements;
  std::vector<Plot> plots;
  double seconds = 0;       // on the board's clock
  std::string interrupted;  // why it ended before its time; empty: it did not
  std::string signal;       // if a signal ended it: "SIGINT"

  int count(Verdict verdict) const;
  // A measurement is undecided because of this.
  bool doubts(Measurement::Doubt doubt) const;
};

// Collects what is measured and judges it: a value inside its limits passes, NaN fails.
class BenchJudge {
 public:
  // Called for each measurement as it is entered, those of timed() at its end.
  using Listener = std::function<void(const Measurement&)>;
  // `lateness`: the link and the clock of the measurements, where they are real; may be null.
  BenchJudge(BenchReport& report, const Limits& limits, Listener listener = nullptr,
             host::LatenessMeter* lateness = nullptr)
      : report_(report), limits_(limits), listener_(std::move(listener)), lateness_(lateness) {}

  // `name` of measurements.def; `note`: special conditions of it.
  void enter(const std::string& subject, const std::string& name, double value, double error = 0,
             const std::string& note = {});
  // Fails whatever the limits, with these words alone: what is wrong is known, not only that a value is.
  void enter_finding(const std::string& subject, const std::string& name, double value,
                     const std::string& finding);
  // Where the default limits are for another condition, which `note` names: only limits that were given
  // apply; without them it is left out, with its value.
  void enter_without_default_limits(const std::string& subject, const std::string& name,
                                    double value, double error, const std::string& note);
  void leave_out(const std::string& subject, const std::string& name, const std::string& why);
  // What befell the line since the last call, as "3 replies did not come"; empty: nothing.
  using LineTrouble = std::function<std::string()>;
  // Runs a part that measures times with this machine's clock. If one of them fails and the machine
  // was late, all that was entered is dropped and the part repeated; if it was late each time, they
  // are undecided. With `at_least` every measurement of the part bears lateness below that, and none above
  // it. Likewise where the line was disturbed, for what is no measurement of the line itself. Error
  // (environment): the program at the other end does not reply any more.
  Result<void> timed(const std::function<Result<void>()>& part, Time at_least = Time::zero(),
                     const LineTrouble& line_trouble = nullptr);
  // Of what has failed from the measurement `first` on: it is undecided, "but " + why.
  void leave_undecided(std::size_t first, const std::string& why, Measurement::Doubt doubt);
  // The motor's true values may be up to `factor` >= 1 times those entered from `first` on. Which of
  // them would be judged otherwise then is undecided.
  void doubt(std::size_t first, double factor, const std::string& why);
  // Those that enter() applies.
  std::pair<double, double> limits(const std::string& name) const;
  void add(Plot plot) { report_.plots.push_back(std::move(plot)); }
  BenchReport& report() { return report_; }
  host::LatenessMeter* lateness() const { return lateness_; }

 private:
  Measurement begin(const std::string& subject, const std::string& name) const;
  void finish(Measurement measurement);

  BenchReport& report_;
  const Limits& limits_;
  Listener listener_;
  host::LatenessMeter* lateness_;
  bool in_part_ = false;
};

}  // namespace kaz::hil
