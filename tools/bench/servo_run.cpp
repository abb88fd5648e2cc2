// Fits the friction models to a servo's logs, and reports.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_run.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "host/link/interrupt.h"
#include "shared/base/files.hpp"
#include "shared/plot/svg.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/bench/servo_identity.h"
#include "tools/bench/servo_report.h"

namespace kaz::tools {
namespace {

using hil::ServoLog;

// More plots would make the report too large for a browser.
constexpr std::size_t kMostPlots = 40;

const OutputKind& servo_output() {
  static const OutputKind kind{"bench servo",
                               {"report.html", "result.json", "servo.json", "held-out-*.svg"}};
  return kind;
}

// The logs of a folder, sorted by name; or the file itself.
Result<std::vector<std::string>> files_at(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return std::vector{path};
  std::vector<std::string> files;
  for (std::filesystem::directory_iterator at(path, error), end; !error && at != end;
       at.increment(error)) {
    const std::string name = at->path().extension().string();
    if (name == ".csv" || name == ".json") files.push_back(at->path().string());
  }
  if (error || files.empty())
    return fail(Fault::usage, path +
                                  ": the folder has no readable *.csv or *.json file; give a "
                                  "folder of servo logs (docs/howto/bench.md)");
  std::ranges::sort(files);
  return files;
}

}  // namespace

Result<std::vector<ServoLog>> read_servo_logs(const std::vector<std::string>& paths) {
  std::vector<ServoLog> logs;
  for (const std::string& path : paths) {
    for (const std::string& file : KAZ_TRY(files_at(path))) {
      const auto text =
          KAZ_TRY(read_whole_file(file, 64 << 20, "give a servo's log (docs/howto/bench.md)"));
      logs.push_back(KAZ_TRY(hil::parse_servo_log(text, file)));
    }
  }
  hil::drop_unsigned_currents(logs);
  return logs;
}

Result<bool> run_servo_fit(const ServoFitArguments& arguments) {
  std::optional<servo_model::IdentifiedServo> other;
  if (!arguments.compare.empty()) other = KAZ_TRY(named_servo(arguments.compare));
  ServoResult result;
  result.logs = KAZ_TRY(read_servo_logs(arguments.logs));
  result.held_out = KAZ_TRY(read_servo_logs(arguments.held_out));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto folder = KAZ_TRY(OutputFolder::open(arguments.out, servo_output()));
  Progress progress("kaz bench servo", arguments.json);
  hil::ServoFitOptions options;
  if (arguments.model > 0) options.models.resize(static_cast<std::size_t>(arguments.model));
  options.progress = [&](double share, const std::string& what) { progress.update(share, what); };
  options.stopped = [&] { return interrupt.requested(); };
  const auto fitted = hil::fit_servo(result.logs, result.held_out, options);
  progress.done();
  result.fits = KAZ_TRY(fitted);
  KAZ_TRY(judge_servo(result, options));
  const servo_model::IdentifiedServo own = identified_servo(result, arguments.servo);
  auto json = servo_json(result);
  std::vector<servo_model::ServoDifference> compared;
  if (other) {
    compared = servo_model::differences(*other, own);
    json["compared"] = differences_json(arguments.compare, compared);
  }
  std::vector<plot::PlotPage> plots;
  for (const ServoLog& log : result.held_out)
    if (plots.size() < kMostPlots) plots.push_back(servo_plot(result, log));
  const auto write = [&]() -> Result<void> {
    KAZ_TRY(folder.clear());
    for (std::size_t i = 0; i < plots.size(); ++i)
      KAZ_TRY(folder.write("held-out-" + std::to_string(i + 1) + ".svg", plot::plot_svg(plots[i])));
    KAZ_TRY(folder.write("report.html", servo_html(result, plots)));
    KAZ_TRY(folder.write("servo.json", servo_model::servo_file_text(own)));
    return folder.write_json("result.json", json);
  };
  const auto written = write();
  if (arguments.json)
    print_json(json);
  else
    std::printf("%s%sthe report is %s\n", servo_text(result).c_str(),
                other ? differences_text(arguments.compare, compared).c_str() : "",
                folder.path("report.html").c_str());
  KAZ_TRY(written);
  return true;
}

}  // namespace kaz::tools
