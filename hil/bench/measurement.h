// Results of the bench: plots, and values with unit, limits and verdict.
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

// A line of measurements.def. A missing limit is infinite.
struct MeasurementInfo {
  BenchGroup group;
  std::string name, unit;
  double low, high;
  std::string text;
};

// Returns all lines in the order of the file. Names are unique.
const std::vector<MeasurementInfo>& measurement_infos();
// Returns the line with this name, or null.
const MeasurementInfo* find_measurement(const std::string& name);

struct Measurement {
  const MeasurementInfo* of = nullptr;
  std::string subject;  // name of a joint, "link" or "board"
  Verdict verdict = Verdict::left_out;
  double value = 0;  // value in the unit of the measurement; NaN if nothing could be measured
  double error = 0;  // standard error of the value; 0: unknown
  double low = 0, high = 0;  // applied limits
  // Reason why the measurement failed, was left out or is undecided. If the measurement passed, the message
  // is a note or empty.
  std::string message;
  // Cause of an undecided verdict. parse_bench_json() does not set this member.
  enum class Doubt { none, machine, line, motor } doubt = Doubt::none;
};

// A curve or a scatter plot.
struct Series {
  std::string name;
  using Style = plot::Series::Style;
  Style style = Style::line;
  std::vector<std::pair<double, double>> points;
};

struct Plot {
  std::string id;                       // name such as "stall"; unique per subject in a report
  std::string subject;                  // name of a joint, "link" or "board"
  std::string title, x_label, y_label;  // axis labels with units, such as "motor voltage, V"
  bool x_logarithmic = false;
  std::vector<Series> series;
  std::string caption;  // description of the plot, one sentence
};

// Limits that replace the limits of measurements.def. Key: name of the measurement; value: (low, high).
using Limits = std::map<std::string, std::pair<double, double>>;
// Parses limits from JSON. The JSON text is either an object, such as {"stall.torque_10v": {"low": 2.0,
// "high": 2.3}}, or the list that `kaz bench list --json` prints. If "low" or "high" is missing or null,
// there is no limit on that side. Errors (usage): the text is not JSON; the JSON object or list is empty;
// unknown name or key; repeated name; low above high.
Result<Limits> parse_limits(const std::string& json, const std::string& file_name);

struct BenchReport {
  // Description of the board, such as "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d".
  std::string board;
  std::string port;     // name of the port, such as "/dev/ttyUSB0" or "virtual board (h8)"
  std::string program;  // program and version, such as "kaz 0.1.0"
  // Seed of the emulated board and the emulated stand; nullopt if the board is at a port.
  std::optional<std::uint64_t> seed = {};
  Provenance from = {};  // not set by parse_bench_json()
  // Conditions of the bench, such as the disc on the shaft and the supply. The command `kaz bench fit` uses
  // these conditions. Each condition has a name with unit, and a value.
  std::vector<std::pair<std::string, double>> conditions;
  std::vector<Measurement> measurements;
  std::vector<Plot> plots;
  double seconds = 0;       // duration on the board's clock
  std::string interrupted;  // reason of an early end; empty: the bench finished
  std::string signal;       // signal that ended the bench, such as "SIGINT"

  int count(Verdict verdict) const;
  // Returns whether any measurement is undecided for the reason `doubt`.
  bool doubts(Measurement::Doubt doubt) const;
};

// Collects and judges measurements: a value inside its limits passes, NaN fails. The objects that are passed
// by reference must outlive this object.
class BenchJudge {
 public:
  // Called for each measurement that is entered. For a measurement that is entered during timed(), the
  // listener is called at the end of timed().
  using Listener = std::function<void(const Measurement&)>;
  // `lateness` measures how long this process was delayed on a busy machine. In simulated time, `lateness` is
  // null.
  BenchJudge(BenchReport& report, const Limits& limits, Listener listener = nullptr,
             host::LatenessMeter* lateness = nullptr)
      : report_(report), limits_(limits), listener_(std::move(listener)), lateness_(lateness) {}

  // Enters a value. `name` is a name in measurements.def. `note` describes special conditions of the
  // measurement.
  void enter(const std::string& subject, const std::string& name, double value, double error = 0,
             const std::string& note = {});
  // Enters a measurement with the verdict `failed`, whether or not the value is inside its limits. The
  // message of the measurement is `finding`. Use this function for a defect that was found, not for a value
  // that is only out of range.
  void enter_finding(const std::string& subject, const std::string& name, double value,
                     const std::string& finding);
  // Enters a value that was measured under a special condition. `note` describes the condition. The default
  // limits do not apply to such a value. Only explicit limits apply. Without explicit limits, the value is
  // reported with the verdict left_out.
  void enter_without_default_limits(const std::string& subject, const std::string& name,
                                    double value, double error, const std::string& note);
  void leave_out(const std::string& subject, const std::string& name, const std::string& why);
  // Returns a text about the line errors since the previous call. The text is empty if there were no line
  // errors.
  using LineTrouble = std::function<std::string()>;
  // Runs a part that measures times with this machine's clock. If a measurement fails in a run in which the
  // machine was late, the lateness may be the cause. All results of such a run are dropped, and the part is
  // repeated. If the machine was late in each run, the failed measurements become undecided. `at_least`
  // selects the delays that count as lateness, and the measurements to which this rule applies:
  // - 0: the thresholds of LatenessMeter select the delays. The rule applies only to measurements that depend
  //   on this machine's clock.
  // - above 0: only delays of this length or more count. The rule applies to every failed measurement of the
  //   part.
  //
  // The same rule applies to line errors, for failed measurements that line errors can distort. Line errors
  // never make a measurement of the group `link` undecided. Errors: the errors of `part`; the program at the
  // other end no longer replies (environment).
  Result<void> timed(const std::function<Result<void>()>& part, Time at_least = Time::zero(),
                     const LineTrouble& line_trouble = nullptr);
  // Changes the verdict of each failed measurement with index `first` or higher to undecided. If `doubt` is
  // Doubt::line, measurements that line errors cannot distort stay failed. Appends "; but " and `why` to the
  // message of each measurement that becomes undecided.
  void leave_undecided(std::size_t first, const std::string& why, Measurement::Doubt doubt);
  // Declares that the true value of each measurement with index `first` or higher lies between the entered
  // value and `factor` times the entered value. If a true value in this range would change the verdict of a
  // measurement, the measurement becomes undecided.
  void doubt(std::size_t first, double factor, const std::string& why);
  // Returns the limits that enter() applies.
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
