// `kaz bench`: measures a board and fits the motor model to the measurements.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <regex>

#include <nlohmann/json.hpp>

#include "hil/bench/link_bench.h"
#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/report.h"
#include "hil/bench/report/numbers.h"
#include "hil/bench/tick_bench.h"
#include "host/link/requester.h"
#include "host/robot/connect.h"
#include "host/robot/find_boards.h"
#include "shared/base/files.hpp"
#include "shared/plot/svg.h"
#include "sim/board/sensor_file.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"
#include "tools/base/version.h"
#include "tools/bench/bench_target.h"
#include "tools/bench/fit_report.h"
#include "tools/drawing/figure.h"
#include "tools/kept/kept_run.h"

namespace kaz::tools {
namespace {

Result<std::string> read_file(const std::string& path) {
  constexpr std::size_t max_bytes = 64 << 20;
  return read_whole_file(path, max_bytes);
}

const OutputKind& bench_output() {
  static const OutputKind kind{
      "bench", {"report.html", "measurements.csv", "curves.csv", "junit.xml", "result.json"}};
  return kind;
}
const OutputKind& fit_output() {
  static const OutputKind kind{"bench fit", {"motor.xml", "report.html", "result.json"}};
  return kind;
}

// The folder of a bench, and that of its plots within.
struct BenchFolder {
  OutputFolder reports, plots;

  static Result<BenchFolder> open(const std::string& path, const OutputKind& kind) {
    auto reports = KAZ_TRY(OutputFolder::open(path, kind));
    auto plots = KAZ_TRY(OutputFolder::open(reports.path("plots"), {kind.name, {"*-*.svg"}}));
    return BenchFolder{std::move(reports), std::move(plots)};
  }
  Result<void> clear() const {
    KAZ_TRY(reports.clear());
    return plots.clear();
  }
};

std::string all_joint_names() {
  std::string names;
  for (const host::JointInfo& joint : host::joint_table())
    names += (names.empty() ? "" : ", ") + std::string(joint.name);
  return names;
}

// As it was called: "kaz bench motor".
std::string verb_name(const BenchOptions& arguments) {
  const bool all = arguments.motor && arguments.link;
  return std::string("kaz bench ") + (all               ? "all"
                                      : arguments.motor ? "motor"
                                      : arguments.link  ? "link"
                                                        : "tick");
}

// After a bench that did not come to its end: lever, weight or hand may still be on a shaft.
Result<void> free_stand(const BenchOptions& arguments, const std::string& verb, BenchTarget& target,
                        host::Interrupt& interrupt) {
  if (arguments.target.port.empty() || target.stand() == nullptr) return {};
  if (arguments.target.stand == "manual") {
    std::fprintf(stderr, "%s: remove the lever, the weight and your hand from the shaft\n",
                 verb.c_str());
    return {};
  }
  const host::CleanUp clean_up(interrupt);
  const auto back = target.stand()->put_back(arguments.supply_volts);
  if (back) return {};
  return fail(Fault::environment, "the stand " + arguments.target.stand +
                                      " may still hold a shaft (" + back.error().message +
                                      "): send `stand free` to the stand's control socket, or run "
                                      "`kaz bench` with this stand again");
}

Result<hil::Limits> limits_of(const std::string& path) {
  if (path.empty()) return hil::Limits{};
  const auto text = KAZ_TRY(read_file(path));
  return hil::parse_limits(text, path);
}

void say(const hil::Measurement& one) {
  char columns[160], value[60] = " ";
  if (one.verdict != hil::Verdict::left_out && std::isnan(one.value)) {
    std::snprintf(value, sizeof value, " %9s %-7s  ", "-", "");
  } else if (one.verdict != hil::Verdict::left_out || std::isfinite(one.value)) {
    std::snprintf(value, sizeof value, " %9.4g %-7s  ", one.value, one.of->unit.c_str());
  }
  std::snprintf(columns, sizeof columns, "%-9s %-11s %-24s%s", hil::verdict_text(one.verdict),
                one.subject.c_str(), one.of->name.c_str(), value);
  std::fputs(list_row(columns, one.message, list_width()).c_str(), stdout);
  std::fflush(stdout);  // in a file, too, while the next part is measured
}

Result<void> measure_motors(const BenchOptions& arguments, const std::vector<int>& joints,
                            BenchTarget& target, hil::BenchJudge& judge,
                            const hil::BenchProgress& progress) {
  host::ConnectOptions connection = hil::bench_connection();
  connection.address = arguments.target.address;
  auto robot = KAZ_TRY(host::Robot::connect(target.link(), target.clock(), connection));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    hil::MotorBenchOptions options;
    options.joint = joints[i];
    options.filter = arguments.filter;
    options.supply_volts = arguments.supply_volts;
    options.progress = [&](double share, const std::string& what) {
      progress((static_cast<double>(i) + share) / static_cast<double>(joints.size()), what);
    };
    if (auto done = hil::bench_motor(robot, target.stand(), options, judge); !done) return done;
  }
  return {};
}

// Whether the filter leaves anything of a group.
bool chosen(const BenchOptions& arguments, hil::BenchGroup group) {
  if (arguments.filter.empty()) return true;
  const std::regex filter(arguments.filter);
  return std::ranges::any_of(hil::measurement_infos(), [&](const hil::MeasurementInfo& one) {
    return one.group == group && std::regex_search(one.name, filter);
  });
}

// `bench all`: a filter that fits measurements of link or tick alone is none of the motor's.
Result<BenchOptions> with_filter(BenchOptions arguments) {
  if (arguments.filter.empty() || !arguments.motor) return arguments;
  if (!(arguments.link || arguments.tick)) {
    KAZ_TRY(hil::check_motor_filter(arguments.filter));
    return arguments;
  }
  try {
    arguments.link = arguments.link && chosen(arguments, hil::BenchGroup::link);
    arguments.tick = arguments.tick && chosen(arguments, hil::BenchGroup::tick);
  } catch (const std::regex_error&) {
    KAZ_TRY(hil::check_motor_filter(arguments.filter));  // which says so
  }
  arguments.motor = chosen(arguments, hil::BenchGroup::motor);
  if (!arguments.motor && !arguments.of_motors.empty() && (arguments.link || arguments.tick))
    return fail(Fault::usage, arguments.of_motors +
                                  " is only valid with motor measurements, but --filter " +
                                  arguments.filter + " selects no motor measurement; leave out " +
                                  arguments.of_motors);
  if (!arguments.link && !arguments.tick) KAZ_TRY(hil::check_motor_filter(arguments.filter));
  return arguments;
}

Result<void> measure(const BenchOptions& arguments, const std::vector<int>& joints,
                     BenchTarget& target, hil::BenchJudge& judge,
                     const hil::BenchProgress& progress) {
  // Shares of the whole, roughly by how long they take.
  const double link = arguments.link ? 25 : 0, tick = arguments.tick ? 20 : 0;
  const double motor = arguments.motor ? 210 * static_cast<double>(joints.size()) : 0;
  double done = 0;
  const auto part = [&](double weight) {
    return [&, weight](double share, const std::string& what) {
      progress((done + share * weight) / (link + tick + motor), what);
    };
  };
  if (arguments.link) {
    hil::LinkBenchOptions options;
    options.address = arguments.target.address;
    options.allow_motion = arguments.allow_motion;
    options.progress = part(link);
    if (auto ran = hil::bench_link(target.link(), target.clock(), options, judge); !ran) return ran;
    done += link;
  }
  if (arguments.tick) {
    hil::TickBenchOptions options;
    options.address = arguments.target.address;
    options.allow_motion = arguments.allow_motion;
    options.one_clock = arguments.target.port.empty();
    options.progress = part(tick);
    if (auto ran = hil::bench_tick(target.link(), target.clock(), options, judge); !ran) return ran;
    done += tick;
  }
  if (!arguments.motor) return {};
  return measure_motors(arguments, joints, target, judge, part(motor));
}

// For pages and papers: each plot of the report as a file of its own.
bool has_points(const hil::Plot& plot) {
  return std::ranges::any_of(plot.series, [](const hil::Series& series) {
    return std::ranges::any_of(series.points, [](const auto& point) {
      return std::isfinite(point.first) && std::isfinite(point.second);
    });
  });
}

// Those without a point are not written.
Result<void> leave_plots(const BenchFolder& folder, const std::vector<hil::Plot>& plots) {
  for (const hil::Plot& plot : plots) {
    if (!has_points(plot)) continue;
    const std::string name = plot.subject + "-" + plot.id + ".svg";
    KAZ_TRY(folder.plots.write(name, plot::plot_svg(hil::plot_page(plot))));
  }
  return {};
}

Result<void> leave_reports(const BenchFolder& folder, const hil::BenchReport& report) {
  const std::pair<const char*, std::string> files[] = {
      {"report.html", hil::bench_html(report)},
      {"measurements.csv", hil::bench_csv(report)},
      {"curves.csv", hil::bench_curves_csv(report)},
      {"junit.xml", hil::bench_junit(report)},
      {"result.json", hil::bench_json(report)}};
  for (const auto& [name, text] : files) {
    KAZ_TRY(folder.reports.write(name, text));
  }
  return leave_plots(folder, report.plots);
}

Result<nlohmann::ordered_json> leave_fit(const BenchFolder& folder, const lockstep::MotorFit& fit,
                                         const std::string& path, const hil::BenchReport& report) {
  const hil::Provenance from = provenance();
  const std::string about = "Fitted " + from.date + " by kaz " + from.kaz +
                            ". Measurements: " + path + ". Board: " + report.board +
                            ". Port: " + report.port + ".";
  KAZ_TRY(folder.reports.write("motor.xml", sim::motor_file_text(fit.motor, about)));
  KAZ_TRY(folder.reports.write("report.html", fit_html(fit, path, from)));
  KAZ_TRY(leave_plots(folder, fit.plots));
  auto result = fit_json(fit);
  result["provenance"] = hil::provenance_json(from);
  KAZ_TRY(folder.reports.write_json("result.json", result));
  return result;
}

// Its motors are off: putting it back afterwards would switch them off.
Result<std::string> describe(BenchTarget& target, std::uint8_t address) {
  host::Requester requester(target.link(), target.clock(), {.address = address});
  const auto who = host::identify_board(requester);
  if (who && (who->status & (KZ_STATUS_ENABLED | KZ_STATUS_HOLDING)) != 0)
    return fail(Fault::environment, "the board at " + target.link().name() +
                                        " has motors that are on: switch the motors off first");
  if (who) return host::board_text(*who);
  if (!requester.timed_out()) return tl::unexpected(who.error());
  return tl::unexpected(
      with_earlier_notes(host::explain_silence(target.link(), target.clock(), address, who.error()),
                         target.link().name()));
}

// A motor is driven at full speed through nearly all of its joint's range.
Result<void> check_motion(const BenchOptions& arguments) {
  if (!arguments.motor || arguments.target.port.empty() || !arguments.target.stand.empty() ||
      arguments.allow_motion)
    return {};
  return fail(
      Fault::usage,
      "the bench moves each joint of --joint " + arguments.joints +
          " at full speed through its range: if the motor is on a motor stand, give --stand; "
          "if the joint is free to move and you watch it, give --allow-motion");
}

Result<lockstep::MotorFitOptions> fit_options(const BenchFitOptions& arguments) {
  if (!arguments.model.image.empty() && arguments.model.mcu != sim::McuKind::h8)
    return fail(Fault::usage, "--image is only valid with --mcu h8: native has no firmware image");
  lockstep::MotorFitOptions options;
  options.joint = arguments.joint;
  const auto standard = KAZ_TRY(data_file("robot/kaz/motor.xml"));
  const auto start = KAZ_TRY(sim::load_motor_file(
      arguments.model.motor_file.empty() ? standard : arguments.model.motor_file,
      arguments.model.motor));
  options.start = start;
  const auto sensors = KAZ_TRY(
      sim::load_sensor_file(std::filesystem::path(standard).replace_filename("sensors.xml")));
  options.board.sensor_params = sensors;
  options.board.mcu = arguments.model.mcu;
  if (options.board.mcu == sim::McuKind::h8) {
    const auto image = KAZ_TRY(firmware_image(arguments.model.image));
    options.board.image_path = image;
  }
  options.board.seed = arguments.model.seed;
  return options;
}

}  // namespace

Result<std::vector<int>> joints_of(const std::string& text) {
  std::vector<int> joints;
  if (text == "all") {
    for (int joint = 0; joint < KZ_JOINTS; ++joint) joints.push_back(joint);
    return joints;
  }
  std::size_t from = 0;
  while (from <= text.size()) {
    const auto comma = std::min(text.find(',', from), text.size());
    std::string name = text.substr(from, comma - from);
    name.erase(0, name.find_first_not_of(' '));
    name.erase(name.find_last_not_of(' ') + 1);
    const auto joint = host::joint_index(name);
    if (!joint)
      return fail(Fault::usage,
                  "--joint " + text + ": there is no joint `" + name +
                      "`; give `all`, or some of these, separated by commas: " + all_joint_names());
    if (std::ranges::find(joints, *joint) != joints.end())
      return fail(Fault::usage, "--joint " + text + " names `" + name + "` twice");
    joints.push_back(*joint);
    from = comma + 1;
  }
  return joints;
}

Result<ExitStatus> run_bench(const BenchOptions& given) {
  const std::string verb = verb_name(given);
  const auto arguments = KAZ_TRY(with_filter(given));
  KAZ_TRY(check_motion(arguments));
  const auto joints = KAZ_TRY(joints_of(arguments.joints));
  const auto limits = KAZ_TRY(limits_of(arguments.limits));
  const auto folder = KAZ_TRY(BenchFolder::open(arguments.out, bench_output()));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto target = KAZ_TRY(BenchTarget::open(arguments.target, interrupt));

  hil::BenchReport report;
  report.port = target->name();
  report.program = std::string("kaz ") + kVersion;
  if (arguments.target.port.empty()) report.seed = arguments.target.backend.seed;
  report.from = provenance();
  const auto board = KAZ_TRY(describe(*target, arguments.target.address));
  report.board = board;
  std::unique_ptr<KeptRun> kept;
  if (!arguments.target.port.empty()) {
    auto begun = KAZ_TRY(KeptRun::begin(
        target->link(), target->clock(), interrupt,
        {.verb = verb, .port = target->name(), .address = arguments.target.address}));
    kept = std::move(begun);
  }
  Progress progress(verb, arguments.json);
  const auto listener = [&](const hil::Measurement& one) {
    progress.done();
    if (!arguments.json) say(one);
  };
  hil::BenchJudge judge(report, limits, listener, target->lateness());
  KAZ_TRY(folder.clear());
  const Time begin = target->clock().now();
  const auto ran =
      measure(arguments, joints, *target, judge,
              [&](double share, const std::string& what) { progress.update(share, what); });
  if (ran) progress.update(1, "done");
  progress.done();
  report.seconds = seconds(target->clock().now() - begin);
  const bool interrupted = !ran && ran.error().fault == Fault::interrupted;
  const auto freed = ran ? Result<void>() : free_stand(arguments, verb, *target, interrupt);
  const Result<void> left = together(kept ? kept->end() : Result<void>(), freed);
  if (!ran) report.interrupted = ran.error().message;
  if (interrupted) report.signal = received_signal_name();
  const auto reported = leave_reports(folder, report);
  // Also where the disk is full, or the run did not come to its end.
  if (arguments.json) std::fputs(hil::bench_json(report).c_str(), stdout);
  KAZ_TRY(reported);
  if (!ran || !left) {
    Error error = together(ran, left).error();
    error.message += report.measurements.empty()
                         ? "; no measurement was completed"
                         : "; completed measurements are in " + folder.reports.path("report.html");
    return tl::unexpected(error);
  }
  const int failed = report.count(hil::Verdict::failed);
  const int undecided = report.count(hil::Verdict::undecided);
  if (!arguments.json) {
    print_lines("%s on %s: %d passed, %d failed, %d left out, %d undecided; the report is %s\n",
                report.board.c_str(), report.port.c_str(), report.count(hil::Verdict::passed),
                failed, report.count(hil::Verdict::left_out), undecided,
                folder.reports.path("report.html").c_str());
  }
  if (failed == 0 && undecided > 0) {
    using Doubt = hil::Measurement::Doubt;
    if (report.doubts(Doubt::motor))
      std::fprintf(
          stderr,
          "%s: a motor was too warm to judge all measurements: let it cool for 20 minutes, then "
          "run the bench again\n",
          verb.c_str());
    if (report.doubts(Doubt::line))
      std::fprintf(stderr,
                   "%s: the serial line was too noisy to judge all measurements: check cable and "
                   "adapter with `kaz bench link`, then run the bench again\n",
                   verb.c_str());
    if (report.doubts(Doubt::machine))
      std::fprintf(stderr,
                   "%s: this machine was too slow to judge all measurements: end other programs, "
                   "then run the bench again\n",
                   verb.c_str());
    return ExitStatus::with_status(static_cast<int>(Fault::environment));
  }
  if (!arguments.json && std::ranges::none_of(report.plots, has_points))
    std::printf("no plots, because none of the completed measurements has a curve\n");
  if (failed == 0 && report.count(hil::Verdict::passed) == 0)
    std::fprintf(stderr, "%s: no measurement was made, so the bench did not pass\n", verb.c_str());
  return ExitStatus(failed == 0 && report.count(hil::Verdict::passed) > 0);
}

Result<bool> run_fit(const BenchFitOptions& arguments) {
  std::error_code none;
  const std::string path = std::filesystem::is_directory(arguments.report, none)
                               ? arguments.report + "/result.json"
                               : arguments.report;
  const auto text = KAZ_TRY(read_file(path));
  const auto report = KAZ_TRY(hil::parse_bench_json(text, path));
  if (std::filesystem::equivalent(arguments.model.motor_file, arguments.out + "/motor.xml", none))
    return fail(
        Fault::usage,
        "--out: the fit writes '" + arguments.out +
            "/motor.xml', but --motor-file names the same file; give another folder for --out");
  auto options = KAZ_TRY(fit_options(arguments));
  Progress progress("kaz bench fit", arguments.json);
  options.progress = [&](double share, const std::string& what) { progress.update(share, what); };
  const auto folder = KAZ_TRY(BenchFolder::open(arguments.out, fit_output()));
  const auto fitted = lockstep::fit_motor(report, options);
  progress.done();
  if (!fitted) return tl::unexpected(fitted.error());
  KAZ_TRY(folder.clear());
  const auto result = KAZ_TRY(leave_fit(folder, *fitted, path, report));
  if (arguments.json) {
    print_json(result);
  } else {
    std::printf("%s\nthe motor file is %s, the curves are in %s\n", fit_text(*fitted).c_str(),
                folder.reports.path("motor.xml").c_str(),
                folder.reports.path("report.html").c_str());
  }
  return true;
}

void print_measurements(bool json) {
  if (json) {
    auto all = nlohmann::ordered_json::array();
    for (const hil::MeasurementInfo& info : hil::measurement_infos()) {
      nlohmann::ordered_json one{{"name", info.name}, {"group", hil::text(info.group)},
                                 {"unit", info.unit}, {"low", nullptr},
                                 {"high", nullptr},   {"text", info.text}};
      if (std::isfinite(info.low)) one["low"] = info.low;
      if (std::isfinite(info.high)) one["high"] = info.high;
      all.push_back(std::move(one));
    }
    print_json(all);
    return;
  }
  for (const hil::MeasurementInfo& info : hil::measurement_infos()) {
    char columns[200];
    std::snprintf(columns, sizeof columns, "%-6s %-24s %-8s %-17s ", hil::text(info.group),
                  info.name.c_str(), info.unit.c_str(),
                  hil::limits_text(info.low, info.high).c_str());
    std::fputs(list_row(columns, info.text, list_width()).c_str(), stdout);
  }
}

}  // namespace kaz::tools
