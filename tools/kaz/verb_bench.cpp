// `kaz bench`: measures a board's motors, link and tick, and fits the motor model to a motor.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "hil/bench/link_bench.h"
#include "hil/bench/motor/motor_bench.h"
#include "hil/bench/report.h"
#include "hil/bench/report/numbers.h"
#include "hil/bench/tick_bench.h"
#include "host/robot/connect.h"
#include "shared/base/files.hpp"
#include "sim/board/sensor_file.h"
#include "tools/figure/figure.h"
#include "tools/kaz/bench/bench_target.h"
#include "tools/kaz/bench/fit_report.h"
#include "tools/kaz/interrupt_signals.h"
#include "tools/kaz/output.h"
#include "tools/kaz/paths.h"
#include "tools/kaz/sim_options.h"
#include "tools/kaz/verbs.h"
#include "tools/kaz/version.h"

namespace kaz::tools {
namespace {

struct Arguments {
  BenchTargetOptions target;
  bool motor = false, link = false, tick = false;  // what to measure
  std::string joints = "l_sh_pitch", filter, limits, out = "kaz-bench";
  double supply_volts = 10;
  bool allow_motion = false, json = false;
};

struct FitArguments {
  std::string report, joint, out = "kaz-fit";
  RigOptions model;
  bool json = false;
};

Result<std::string> read_file(const std::string& path) {
  constexpr std::size_t max_bytes = 64 << 20;
  return read_whole_file(path, max_bytes);
}

Result<void> write(const OutputFolder& folder, const std::string& name, const std::string& text) {
  return figure::write_file(folder.path(name),
                            {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string all_joint_names() {
  std::string names;
  for (const host::JointInfo& joint : host::joint_table())
    names += (names.empty() ? "" : ", ") + std::string(joint.name);
  return names;
}

Result<std::vector<int>> joints_of(const std::string& text) {
  std::vector<int> joints;
  if (text == "all") {
    for (int joint = 0; joint < KZ_JOINTS; ++joint) joints.push_back(joint);
    return joints;
  }
  std::size_t from = 0;
  while (from <= text.size()) {
    const auto comma = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, comma - from);
    const auto joint = host::joint_index(name);
    if (!joint)
      return fail(Fault::usage,
                  "--joint " + text + ": there is no joint `" + name +
                      "`; give all, or of these, with commas between: " + all_joint_names());
    if (std::ranges::find(joints, *joint) == joints.end()) joints.push_back(*joint);
    from = comma + 1;
  }
  return joints;
}

Result<hil::Limits> limits_of(const std::string& path) {
  if (path.empty()) return hil::Limits{};
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return hil::parse_limits(*text, path);
}

void say(const hil::Measurement& one) {
  std::printf("%-9s %-11s %-24s", hil::verdict_text(one.verdict), one.subject.c_str(),
              one.of->name.c_str());
  if (one.verdict == hil::Verdict::left_out) {
    std::printf(" %s\n", one.message.c_str());
  } else {
    std::printf(" %9.4g %-7s  %s\n", one.value, one.of->unit.c_str(), one.message.c_str());
  }
}

Result<void> measure_motors(const Arguments& arguments, const std::vector<int>& joints,
                            BenchTarget& target, hil::BenchJudge& judge,
                            const hil::BenchProgress& progress) {
  auto robot = host::Robot::connect(target.link(), target.clock(), hil::bench_connection());
  if (!robot) return tl::unexpected(robot.error());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    hil::MotorBenchOptions options;
    options.joint = joints[i];
    options.filter = arguments.filter;
    options.supply_volts = arguments.supply_volts;
    options.progress = [&](double share, const std::string& what) {
      progress((static_cast<double>(i) + share) / static_cast<double>(joints.size()), what);
    };
    if (auto done = hil::bench_motor(*robot, target.stand(), options, judge); !done) return done;
  }
  return {};
}

Result<void> measure(const Arguments& arguments, const std::vector<int>& joints,
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
    options.allow_motion = arguments.allow_motion;
    options.progress = part(link);
    if (auto ran = hil::bench_link(target.link(), target.clock(), options, judge); !ran) return ran;
    done += link;
  }
  if (arguments.tick) {
    hil::TickBenchOptions options;
    options.allow_motion = arguments.allow_motion;
    options.progress = part(tick);
    if (auto ran = hil::bench_tick(target.link(), target.clock(), options, judge); !ran) return ran;
    done += tick;
  }
  if (!arguments.motor) return {};
  return measure_motors(arguments, joints, target, judge, part(motor));
}

// For pages and papers: each plot of the report as a file of its own.
Result<void> leave_plots(const OutputFolder& folder, const std::vector<hil::Plot>& plots) {
  const auto into = OutputFolder::open(folder.path("plots"));
  if (!into) return tl::unexpected(into.error());
  for (const hil::Plot& plot : plots) {
    if (auto written = write(*into, plot.subject + "-" + plot.id + ".svg", hil::plot_svg(plot));
        !written)
      return written;
  }
  return {};
}

Result<void> leave_reports(const OutputFolder& folder, const hil::BenchReport& report) {
  const std::pair<const char*, std::string> files[] = {
      {"report.html", hil::bench_html(report)},
      {"measurements.csv", hil::bench_csv(report)},
      {"curves.csv", hil::bench_curves_csv(report)},
      {"junit.xml", hil::bench_junit(report)},
      {"result.json", hil::bench_json(report)}};
  for (const auto& [name, text] : files) {
    if (auto written = write(folder, name, text); !written) return written;
  }
  return leave_plots(folder, report.plots);
}

Result<std::string> describe(BenchTarget& target) {
  host::Requester requester(target.link(), target.clock(), {});
  const auto who = host::identify_board(requester);
  if (!who) return tl::unexpected(who.error());
  return host::board_text(*who);
}

// A motor is driven at full speed through nearly all of its joint's range.
Result<void> check_motion(const Arguments& arguments) {
  if (!arguments.motor || arguments.target.port.empty() || !arguments.target.stand.empty() ||
      arguments.allow_motion)
    return {};
  return fail(Fault::usage,
              "this drives " + arguments.joints +
                  " at full speed through its range: give --stand if the motor is on a bench, or "
                  "--allow-motion if the joint may move so and you stand by");
}

Result<Outcome> bench(const Arguments& arguments) {
  const RigOptions& rig = arguments.target.rig;
  if (!arguments.target.port.empty() && !(rig.motor_file.empty() && rig.motor.empty()))
    return fail(
        Fault::usage,
        "--motor-file and --motor are of the emulated board; at a port the motor is the one "
        "that is there");
  if (auto allowed = check_motion(arguments); !allowed) return tl::unexpected(allowed.error());
  if (auto sound = hil::check_motor_filter(arguments.filter); !sound)
    return tl::unexpected(sound.error());
  const auto joints = joints_of(arguments.joints);
  if (!joints) return tl::unexpected(joints.error());
  const auto limits = limits_of(arguments.limits);
  if (!limits) return tl::unexpected(limits.error());
  if (auto usable = OutputFolder::check(arguments.out); !usable)
    return tl::unexpected(usable.error());
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto target = BenchTarget::open(arguments.target, interrupt);
  if (!target) return tl::unexpected(target.error());

  hil::BenchReport report;
  report.port = (*target)->name();
  report.program = std::string("kaz ") + kVersion;
  report.seed = arguments.target.rig.seed;
  const auto board = describe(**target);
  if (!board) return tl::unexpected(board.error());
  report.board = *board;
  Progress progress("kaz bench", arguments.json);
  hil::BenchJudge judge(report, *limits, [&](const hil::Measurement& one) {
    progress.done();
    if (!arguments.json) say(one);
  });
  auto folder = OutputFolder::open(arguments.out);
  if (!folder) return tl::unexpected(folder.error());
  const Time begin = (*target)->clock().now();
  const auto ran =
      measure(arguments, *joints, **target, judge,
              [&](double share, const std::string& what) { progress.update(share, what); });
  progress.done();
  report.seconds = seconds((*target)->clock().now() - begin);
  if (!ran) report.interrupted = ran.error().message;
  if (auto left = leave_reports(*folder, report); !left) return tl::unexpected(left.error());
  if (!ran)
    return tl::unexpected(Error{ran.error().fault, ran.error().message +
                                                       "; what was measured until then is in " +
                                                       folder->path("report.html")});
  const int failed = report.count(hil::Verdict::failed);
  if (arguments.json) {
    std::fputs(hil::bench_json(report).c_str(), stdout);
  } else {
    std::printf("%s on %s: %d passed, %d failed, %d left out; the report is %s\n",
                report.board.c_str(), report.port.c_str(), report.count(hil::Verdict::passed),
                failed, report.count(hil::Verdict::left_out), folder->path("report.html").c_str());
  }
  if (failed == 0 && report.count(hil::Verdict::passed) == 0)
    std::fprintf(stderr, "kaz bench: nothing was measured, so nothing has passed\n");
  return failed == 0 && report.count(hil::Verdict::passed) > 0;
}

Result<lockstep::MotorFitOptions> fit_options(const FitArguments& arguments) {
  lockstep::MotorFitOptions options;
  options.joint = arguments.joint;
  const auto standard = data_file("robot/kaz/motor.xml");
  if (!standard) return tl::unexpected(standard.error());
  const auto start = sim::load_motor_file(
      arguments.model.motor_file.empty() ? *standard : arguments.model.motor_file,
      arguments.model.motor);
  if (!start) return tl::unexpected(start.error());
  options.start = *start;
  const auto sensors =
      sim::load_sensor_file(std::filesystem::path(*standard).replace_filename("sensors.xml"));
  if (!sensors) return tl::unexpected(sensors.error());
  options.board.sensor_figures = *sensors;
  options.board.engine = arguments.model.engine;
  if (options.board.engine == "h8") {
    const auto image = firmware_image(arguments.model.image);
    if (!image) return tl::unexpected(image.error());
    options.board.image_path = *image;
  }
  options.board.sensors = *sim::sensors_by_name("nominal");
  options.board.seed = arguments.model.seed;
  return options;
}

Result<Outcome> fit(const FitArguments& arguments) {
  std::error_code none;
  const std::string path = std::filesystem::is_directory(arguments.report, none)
                               ? arguments.report + "/result.json"
                               : arguments.report;
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  const auto report = hil::parse_bench_json(*text, path);
  if (!report) return tl::unexpected(report.error());
  if (auto usable = OutputFolder::check(arguments.out); !usable)
    return tl::unexpected(usable.error());
  auto options = fit_options(arguments);
  if (!options) return tl::unexpected(options.error());
  Progress progress("kaz bench fit", arguments.json);
  options->progress = [&](double share, const std::string& what) { progress.update(share, what); };
  auto folder = OutputFolder::open(arguments.out);
  if (!folder) return tl::unexpected(folder.error());
  const auto fitted = lockstep::fit_motor(*report, *options);
  progress.done();
  if (!fitted) return tl::unexpected(fitted.error());
  const std::string about = "Fitted by kaz " + std::string(kVersion) + " to " + path + ", " +
                            report->board + " on " + report->port + ".";
  for (const auto& [name, content] : {std::pair<std::string, std::string>(
                                          "motor.xml", sim::motor_file_text(fitted->motor, about)),
                                      {"report.html", fit_html(*fitted, path)}}) {
    if (auto written = write(*folder, name, content); !written)
      return tl::unexpected(written.error());
  }
  if (auto left = leave_plots(*folder, fitted->plots); !left) return tl::unexpected(left.error());
  if (auto written = folder->write_json("result.json", fit_json(*fitted)); !written)
    return tl::unexpected(written.error());
  if (arguments.json) {
    std::printf("%s\n", fit_json(*fitted).dump(2).c_str());
  } else {
    std::printf("%s\nthe motor is %s, the curves are in %s\n", fit_text(*fitted).c_str(),
                folder->path("motor.xml").c_str(), folder->path("report.html").c_str());
  }
  return true;
}

Result<Outcome> list(bool json) {
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
    std::printf("%s\n", all.dump(2).c_str());
    return true;
  }
  for (const hil::MeasurementInfo& info : hil::measurement_infos()) {
    std::printf("%-6s %-24s %-8s %-17s %s\n", hil::text(info.group), info.name.c_str(),
                info.unit.c_str(), hil::limits_text(info.low, info.high).c_str(),
                info.text.c_str());
  }
  return true;
}

void add_common(CLI::App& verb, Arguments& arguments) {
  auto* port = verb.add_option("--port", arguments.target.port,
                               "serial port or pty of a board; without it an emulated one on a "
                               "virtual motor stand, in simulated time")
                   ->type_name("PATH[@BAUD]");
  verb.add_option("--mcu", arguments.target.rig.engine,
                  "of the emulated board: h8 executes the firmware image, native runs the same C "
                  "compiled for this machine")
      ->check(CLI::IsMember({"h8", "native"}))
      ->capture_default_str()
      ->excludes(port);
  verb.add_option("--image", arguments.target.rig.image, "firmware image for h8: S-record or COFF")
      ->excludes(port);
  verb.add_option("--sensors", arguments.target.rig.sensors,
                  "of the emulated board: nominal, ideal or as-built (kaz sim --help)")
      ->check(CLI::IsMember({"nominal", "ideal", "as-built"}))
      ->capture_default_str()
      ->excludes(port);
  verb.add_option("--seed", arguments.target.rig.seed, "of the emulated board's noise")
      ->capture_default_str()
      ->excludes(port);
  verb.add_option("--limits", arguments.limits,
                  "JSON file with limits other than those of `kaz bench list`: "
                  "{\"stall.torque_10v\": {\"low\": 2.0, \"high\": 2.3}}")
      ->type_name("FILE");
  verb.add_option(
          "--out", arguments.out,
          "folder for report.html, result.json, measurements.csv, curves.csv, junit.xml, plots/")
      ->capture_default_str()
      ->type_name("DIR");
  verb.add_flag("--json", arguments.json, "the report as JSON on standard output, nothing else");
}

void add_motor_arguments(CLI::App& verb, Arguments& arguments) {
  verb.add_option("--joint", arguments.joints, "whose motor: names with commas between, or all")
      ->capture_default_str();
  verb.add_option("--stand", arguments.target.stand,
                  "what stands around the board at the port: ctl:PATH is the control socket of kaz "
                  "sim --stand, manual asks you to clamp, press and read. Without it, what needs a "
                  "stand is left out")
      ->type_name("ctl:PATH|manual");
  verb.add_option("--supply", arguments.supply_volts,
                  "the supply without load, V, where a measurement does not ask for another")
      ->check(CLI::Range(5.0, 12.0))
      ->capture_default_str();
  verb.add_option(
          "--filter", arguments.filter,
          "only measurements in whose names this regular expression is found, and those made "
          "together with them")
      ->type_name("REGEX");
  add_motor_options(verb, arguments.target.rig);
}

using Chooser = void (*)(Arguments&);

CLI::App* add_measuring(CLI::App& bench_verb, Action& action, const char* name, const char* text,
                        Chooser choose, const char* footer) {
  auto* verb = bench_verb.add_subcommand(name, text);
  auto arguments = std::make_shared<Arguments>();
  choose(*arguments);
  add_common(*verb, *arguments);
  if (arguments->motor) add_motor_arguments(*verb, *arguments);
  verb->add_flag(
      "--allow-motion", arguments->allow_motion,
      arguments->motor
          ? "at a port without a stand: the joint may move at full speed through its range"
          : "the joints are switched on for the load and held where they are; else the "
            "board refuses targets that are as long");
  verb->footer(
      std::string("Exit status: 0 all within its limits, 1 a limit failed, 2 wrong usage, 3 "
                  "port trouble.\nExamples:\n") +
      footer);
  verb->callback([&action, arguments] { action = [arguments] { return bench(*arguments); }; });
  return verb;
}

void add_fit(CLI::App& bench_verb, Action& action) {
  auto* verb = bench_verb.add_subcommand(
      "fit",
      "finds the figures of the motor model with which the simulator's bench reads the same");
  auto arguments = std::make_shared<FitArguments>();
  verb->add_option("REPORT", arguments->report,
                   "result.json of `kaz bench motor`, or the folder it is in")
      ->required();
  verb->add_option("--joint", arguments->joint, "which motor, where the report is of several");
  verb->add_option("--motor-file", arguments->model.motor_file,
                   "where to begin; without it Kaz's motor.xml")
      ->type_name("FILE");
  verb->add_option("--motor", arguments->model.motor,
                   "the motor of that file; without it the file's default")
      ->type_name("NAME");
  verb->add_option(
          "--mcu", arguments->model.engine,
          "of the model's board: h8 executes the firmware image, native is five times as fast "
          "and 0.1 ms off in a start")
      ->check(CLI::IsMember({"h8", "native"}))
      ->capture_default_str();
  verb->add_option("--image", arguments->model.image, "firmware image for h8: S-record or COFF");
  verb->add_option("--seed", arguments->model.seed, "of the noise on the model's bench")
      ->capture_default_str();
  verb->add_option("--out", arguments->out,
                   "folder for motor.xml, report.html, result.json, plots/")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--json", arguments->json, "the result as JSON on standard output");
  verb->footer(
      "Examples:\n"
      "  kaz bench motor --port /dev/ttyUSB0 --stand manual --disc 4e-4 --out my-motor\n"
      "  kaz bench fit my-motor --out my-fit\n"
      "  kaz bench motor --motor-file my-fit/motor.xml   (the fitted motor on the virtual stand)");
  verb->callback([&action, arguments] { action = [arguments] { return fit(*arguments); }; });
}

}  // namespace

void add_bench(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "bench", "measures motors, link and tick of a board, with limits and plots; fits the model");
  verb->require_subcommand(1);
  add_measuring(
      *verb, action, "motor",
      "torque, speed, friction, backlash, dead band, potentiometer, step, frequency response, heat",
      [](Arguments& a) { a.motor = true; },
      "  kaz bench motor --out motor      (an emulated board: no hardware needed)\n"
      "  kaz bench motor --joint l_knee,r_knee --filter 'stall|no_load'\n"
      "  kaz bench motor --port /dev/ttyUSB0 --joint l_sh_pitch --stand manual --disc 4e-4\n"
      "  kaz bench motor --port board --stand ctl:board.ctl     (kaz sim --serial board --stand)");
  add_measuring(
      *verb, action, "link", "round trips, cycles a second, errors, lost telemetry",
      [](Arguments& a) { a.link = true; },
      "  kaz bench link --port /dev/ttyUSB0\n  kaz bench link --json > link.json");
  add_measuring(
      *verb, action, "tick", "how long and how even the board's ticks are",
      [](Arguments& a) { a.tick = true; },
      "  kaz bench tick --port /dev/ttyUSB0 --allow-motion\n  kaz bench tick");
  add_measuring(
      *verb, action, "all", "link, tick and motor in one report",
      [](Arguments& a) { a.motor = a.link = a.tick = true; },
      "  kaz bench all --out board-42\n  kaz bench all --port /dev/ttyUSB0 --stand manual");
  add_fit(*verb, action);
  auto* names = verb->add_subcommand("list", "the measurements with their limits, and runs none");
  auto as_json = std::make_shared<bool>(false);
  names->add_flag("--json", *as_json, "as JSON; a side without limit is null");
  names->callback([&action, as_json] { action = [as_json] { return list(*as_json); }; });
  verb->footer(
      "Examples:\n  kaz bench motor --out motor\n  kaz bench fit motor --out fit\n  kaz bench "
      "list");
}

}  // namespace kaz::tools
