// `kaz calibrate joints`: connects, asks, measures, reports, stores.
// SPDX-License-Identifier: Apache-2.0
#include "tools/calibrate/calibrate_joints.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/robot/connect.h"
#include "shared/base/number_text.hpp"
#include "sim/mcu/memory_file.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/prompt.h"
#include "tools/calibrate/joint_report.h"
#include "tools/kept/kept_run.h"
#include "tools/run/backend.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Lines = std::array<host::JointCalibration, KZ_JOINTS>;

constexpr const char* kVerb = "kaz calibrate joints";
constexpr std::uint32_t kLegs = 0x3fc00;  // joints 10 to 17
constexpr const char* kNobody =
    "moving a robot at a port needs somebody at the keyboard, or --yes for a script; nothing was "
    "moved";

const OutputKind& joints_output() {
  static const OutputKind kind{"calibrate joints", {"result.json", "joints.svg"}};
  return kind;
}

const char* name_of(int joint) {
  return host::joint_table()[static_cast<std::size_t>(joint)].name;
}

// A gauge's angle for one joint.
struct Gauge {
  int joint;
  double angle_rad;
};

Result<double> gauge_angle(const std::string& text, int joint) {
  const auto angle = parse_number<double>(text);
  const auto& info = host::joint_table()[static_cast<std::size_t>(joint)];
  if (!angle || *angle * kDegree < info.lower_rad - 2 * kDegree ||
      *angle * kDegree > info.upper_rad + 2 * kDegree) {
    char range[64];
    std::snprintf(range, sizeof range, "%.0f to %.0f", info.lower_rad / kDegree,
                  info.upper_rad / kDegree);
    return fail(Fault::usage, std::string("angle of ") + name_of(joint) + " `" + text +
                                  "`: must be " + range + " degrees");
  }
  return *angle * kDegree;
}

Result<std::vector<Gauge>> parse_gauges(const std::vector<std::string>& texts) {
  std::vector<Gauge> all;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const auto joint = host::joint_index(name);
    if (equals == std::string::npos || (!joint && name != "all"))
      return fail(Fault::usage,
                  "--gauge " + text +
                      ": give NAME=DEGREES with the name of a joint, or all=DEGREES, for example "
                      "--gauge l_knee=0");
    for (int j = 0; j < KZ_JOINTS; ++j) {
      if (joint && *joint != j) continue;
      const auto angle = gauge_angle(text.substr(equals + 1), j);
      if (!angle) return fail(Fault::usage, "--gauge " + text + ": " + angle.error().message);
      if (std::ranges::find(all, j, &Gauge::joint) != all.end())
        return fail(Fault::usage, std::string("--gauge names ") + name_of(j) + " twice");
      all.push_back({j, *angle});
    }
  }
  return all;
}

void print_plan(bool stops, bool floor) {
  if (stops) {
    std::printf("The robot hangs by its trunk. Its arms and legs are free.\n");
    for (const auto& group : calibration::stop_groups()) {
      print_lines("%s: %s\n", group.name, group.text);
      for (const auto& step : group.steps) {
        std::string presses;
        for (const auto& press : step.presses) {
          char one[64];
          std::snprintf(one, sizeof one, "%s%s to %.0f", presses.empty() ? "" : ", ",
                        name_of(press.joint),
                        calibration::stop_angle(press.joint, press.stop) / kDegree);
          presses += one;
        }
        if (!presses.empty())
          print_lines("  joints pressed against their stops, degrees: %s\n", presses.c_str());
      }
    }
  }
  if (floor) {
    std::printf(
        "The robot stands on both soles on a level floor.\n"
        "standing: the robot crouches, leans and shifts its weight to each side\n");
    for (const auto& stance : calibration::floor_stances())
      std::printf("  hips %.0f mm high, trunk %+.0f degrees forward, %+.0f to the right\n",
                  1e3 * stance.z, stance.pitch / kDegree, stance.roll / kDegree);
  }
}

class Calibration {
 public:
  explicit Calibration(const JointCalibrationOptions& options) : options_(options) {}

  Result<ExitStatus> run() {
    gauges_ = KAZ_TRY(parse_gauges(options_.gauge));
    report_.gauge_error_rad = options_.gauge_error_deg * kDegree;
    report_.gauge = options_.only == "gauge" || !gauges_.empty();
    if (report_.gauge && !options_.only.empty() && options_.only != "gauge")
      return fail(Fault::usage,
                  "--gauge is only valid with --only gauge; leave out --only " + options_.only);
    report_.stops = !report_.gauge && options_.only != "floor";
    report_.floor = !report_.gauge && options_.only != "stops";
    report_.joints = report_.stops ? host::kAllJoints : report_.floor ? kLegs : 0;
    if (options_.dry_run) {
      print_plan(report_.stops, report_.floor);
      if (report_.gauge) std::printf("With a gauge, the motors stay off.\n");
      return ExitStatus();
    }
    if (!options_.memory.empty() && port())
      return fail(
          Fault::usage,
          "--memory is only valid for the virtual robot; a board at a port has its own memory");
    if (options_.backend.robot.starts_with("boards:"))
      return fail(
          Fault::usage,
          "--robot " + options_.backend.robot +
              ": boards are calibrated one by one; give the port and --address of one board");
    if (!options_.backend.at_port() && options_.backend.address != KZ_ADDRESS_DEFAULT)
      return fail(
          Fault::usage,
          "--address is only valid with a port, such as --robot serial:PATH; the virtual board has "
          "address 1");
    const InterruptSignals signals(interrupt_);
    if (!options_.out.empty()) folder_ = KAZ_TRY(OutputFolder::open(options_.out, joints_output()));
    if (!options_.memory.empty()) {
      std::error_code none;
      if (fs::exists(options_.memory, none) && fs::file_size(options_.memory, none) > 0)
        memory_.before = KAZ_TRY(read_memory(options_.memory));
      memory_.out = KAZ_TRY(OutputFile::open(options_.memory, "--memory"));
    }
    KAZ_TRY(open(report_.stops));
    if (folder_) KAZ_TRY(folder_->clear());
    auto measured = measure();
    if (measured) measured = estimate();
    return finish(measured);
  }

 private:
  bool port() const { return options_.backend.at_port(); }

  // A virtual robot is another one when it is set down: with the same potentiometers, by its seed.
  Result<void> open(bool suspended) {
    BackendOptions backend = options_.backend;
    backend.needs_camera = false;
    backend.suspended = suspended;
    backend.memory = memory_.before;
    count_time();
    robot_.reset();
    backend_.reset();
    backend_ = KAZ_TRY(SessionBackend::open(backend, interrupt_));
    report_.port = port() ? backend_->port()->name() : "sim";
    begin_ = backend_->clock().now();
    if (port())
      kept_ = KAZ_TRY(KeptRun::begin(
          backend_->link(), backend_->clock(), interrupt_,
          {.verb = kVerb, .port = report_.port, .address = options_.backend.address}));
    return connect();
  }

  void count_time() {
    if (backend_) report_.seconds += seconds(backend_->clock().now() - begin_);
  }

  Result<void> connect() {
    auto robot = KAZ_TRY(host::Robot::connect(backend_->link(), backend_->clock(),
                                              {.address = options_.backend.address}));
    robot_.emplace(std::move(robot));
    report_.board = host::board_text(robot_->identity());
    const auto posture = KAZ_TRY(robot_->state());
    if ((posture.status & (KZ_STATUS_ENABLED | KZ_STATUS_HOLDING)) != 0)
      return fail(Fault::environment,
                  "the board at " + report_.port +
                      " has motors that are on: first end the program that moves them");
    const auto calibration = KAZ_TRY(robot_->calibration());
    report_.before = calibration.joints;
    has_stored_ = calibration.sequence != 0;
    return {};
  }

  // Asks before the motors go on at a port; says it in any case.
  Result<void> confirm(const std::string& what) {
    if (!options_.json) std::fprintf(stderr, "%s: %s\n", kVerb, what.c_str());
    if (!port() || options_.yes) return {};
    const auto reply =
        KAZ_TRY(prompt_user("Press Enter to continue, n to stop", interrupt_, kNobody));
    if (reply.empty() || reply == "y" || reply == "yes") return {};
    return fail(Fault::failed, "stopped; nothing is stored");
  }

  Result<void> measure() {
    progress_.emplace(kVerb, options_.json);
    auto measured = report_.gauge ? measure_gauge() : measure_moving();
    progress_->done();
    return measured;
  }

  Result<void> measure_moving() {
    if (report_.stops) KAZ_TRY(measure_stops());
    // What a stop has not given, the floor cannot.
    const bool bad_stop = std::ranges::any_of(
        report_.stop_readings, [](const auto& reading) { return !reading.fault.empty(); });
    if (!report_.floor || bad_stop) return {};
    if (!report_.stops && !has_stored_)
      return fail(
          Fault::failed,
          "the board has no calibration, and floor readings alone are not enough: first calibrate "
          "with the robot suspended (--only stops)");
    if (report_.stops && !port()) KAZ_TRY(open(false));
    return measure_floor();
  }

  Result<void> measure_stops() {
    bool first = true;
    double done = 0;
    const auto groups = calibration::stop_groups();
    for (const auto& group : groups) {
      progress_->done();
      KAZ_TRY(confirm(std::string(first ? "hang the robot by its trunk, with arms and legs free, "
                                          "and stand clear. "
                                        : "") +
                      "Next, " + group.name + ": " + group.text));
      if (first) KAZ_TRY(calibration::prepare_for_stops(*robot_));
      first = false;
      const auto on = [&](double share, const std::string& what) {
        progress_->update(
            (done + share) / (static_cast<double>(groups.size()) + 1.5 * report_.floor), what);
      };
      KAZ_TRY(calibration::read_stops(*robot_, group, on, report_.stop_readings));
      ++done;
    }
    return {};
  }

  Result<void> measure_floor() {
    const auto lines = report_.stops ? lines_by_stops() : report_.before;
    progress_->done();
    KAZ_TRY(confirm(
        "set the robot on a level floor with straight legs, and hold the robot until it stands by "
        "itself. Next, the standing robot crouches, leans and shifts its weight to each side"));
    KAZ_TRY(calibration::use_lines(*robot_, lines));
    const auto on = [&](double share, const std::string& what) {
      progress_->update(report_.stops ? (3 + 1.5 * share) / 4.5 : share, what);
    };
    return calibration::read_floor(*robot_, lines, on, report_.floor_readings);
  }

  Result<void> measure_gauge() {
    if (!gauges_.empty()) {
      const auto here = KAZ_TRY(calibration::read_here(*robot_, report_.before));
      for (const Gauge& gauge : gauges_) add_gauge(gauge, here);
      return {};
    }
    std::fprintf(stderr,
                 "%s: the motors are off; turn each joint by hand, hold the joint, and type the "
                 "angle that the gauge shows\n",
                 kVerb);
    for (int j = 0; j < KZ_JOINTS; ++j) {
      while (true) {
        const auto text = KAZ_TRY(
            prompt_user(std::string(name_of(j)) + ", degrees (Enter: next joint)", interrupt_,
                        "a gauge needs somebody at the keyboard, or --gauge NAME=DEGREES; nothing "
                        "was moved or stored"));
        if (text.empty()) break;
        const auto angle = gauge_angle(text, j);
        if (!angle) {
          std::fprintf(stderr, "%s\n", angle.error().message.c_str());
          continue;
        }
        const auto here = KAZ_TRY(calibration::read_here(*robot_, report_.before));
        add_gauge({j, *angle}, here);
      }
    }
    if (report_.joints == 0) return fail(Fault::failed, "no angle was given; nothing is stored");
    return {};
  }

  void add_gauge(const Gauge& gauge, const calibration::FloorReading& here) {
    report_.gauge_readings.push_back(
        {gauge.joint, here.codes[static_cast<std::size_t>(gauge.joint)], gauge.angle_rad});
    report_.joints |= 1u << gauge.joint;
  }

  // ---- The estimate

  Lines lines_by_stops() const {
    calibration::JointEstimator estimator;
    calibration::add_stops(estimator, report_.stop_readings);
    const auto solution = estimator.solve();
    Lines lines;
    for (std::size_t j = 0; j < lines.size(); ++j) lines[j] = solution.joints[j].line;
    return lines;
  }

  // Joints that are not calibrated now count as calibrated against their stops, if anything is stored.
  void add_known(calibration::JointEstimator& to) {
    if (report_.stops)
      calibration::add_stops(to, report_.stop_readings);
    else if (has_stored_)
      for (int j = 0; j < KZ_JOINTS; ++j)
        calibration::add_stops(to, j, report_.before[static_cast<std::size_t>(j)]);
    for (const GaugeReading& gauge : report_.gauge_readings)
      to.add_angle(gauge.joint, gauge.code, gauge.angle_rad, report_.gauge_error_rad);
  }

  Result<void> estimate() {
    calibration::JointEstimator about,
        estimator(calibration::floor_unknowns(report_.floor_readings));
    add_known(about);
    add_known(estimator);
    if (report_.floor) calibration::add_floor(estimator, report_.floor_readings, about.solve());
    report_.solution = estimator.solve();
    return {};
  }

  // ---- The end

  // Motors off, everything as it was; also after an interrupt.
  Result<void> leave() {
    count_time();
    if (kept_) return kept_->end();
    return {};
  }

  Result<void> write_report() {
    if (!folder_) return {};
    KAZ_TRY(folder_->write_json("result.json", joint_report_json(report_)));
    if (!report_.solution) return {};
    return folder_->write("joints.svg", joint_report_svg(report_));
  }

  Result<ExitStatus> finish(const Result<void>& measured) {
    auto ended = together(measured, leave());
    if (!measured) {
      report_.error = measured.error();
      if (interrupt_.requested()) report_.signal = received_signal_name();
    }
    const std::vector<int> bad = ended ? faulty(report_) : std::vector<int>();
    ended = together(ended, write_report());
    if (ended && bad.empty() && options_.store) {
      ended = store();
      if (ended) ended = write_report();
    }
    if (options_.json) print_json(joint_report_json(report_));
    if (!ended) {
      Error error = ended.error();
      if (!report_.stored) error.message += "; nothing is stored";
      if (folder_ && !measured)
        error.message += "; completed readings are in " + folder_->path("result.json");
      return tl::unexpected(std::move(error));
    }
    if (!options_.json) std::printf("%s", joint_table_text(report_).c_str());
    return judge(bad);
  }

  ExitStatus judge(const std::vector<int>& bad) const {
    if (!bad.empty()) {
      std::string names;
      for (const int j : bad) names += (names.empty() ? "" : ", ") + std::string(name_of(j));
      std::fprintf(stderr, "%s: no good reading of %s; nothing is stored\n", kVerb, names.c_str());
      return ExitStatus(false);
    }
    if (options_.json) return ExitStatus();
    if (!report_.stored)
      std::printf("not stored because of --no-store\n");
    else if (memory_.out)
      std::printf("stored in %s\n", options_.memory.c_str());
    else if (port())
      std::printf("stored in the flash of the board on %s, as copy number %d\n",
                  report_.port.c_str(), static_cast<int>(report_.stored->sequence));
    else
      std::printf(
          "the virtual board's calibration is lost after this run; to keep the calibration, give "
          "--memory FILE\n");
    return ExitStatus();
  }

  // As a whole: an interrupt waits for it.
  Result<void> store() {
    const host::CleanUp whole(interrupt_, std::chrono::seconds(12));
    if (port()) {
      // Watchdog and reaction have been put back, and stay.
      auto robot = KAZ_TRY(
          host::Robot::connect(backend_->link(), backend_->clock(),
                               {.address = options_.backend.address, .watchdog = Time::zero()}));
      robot_.emplace(std::move(robot));
    }
    Lines lines = report_.before;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto i = static_cast<std::size_t>(j);
      if (report_.joints >> j & 1) lines[i] = report_.solution->joints[i].line;
    }
    KAZ_TRY(robot_->set_calibration(host::kAllJoints, lines));
    const auto stored = robot_->store_calibration();
    if (!stored) {
      (void)robot_->set_calibration(host::kAllJoints, report_.before);
      return tl::unexpected(stored.error());
    }
    if (memory_.out) {
      KAZ_TRY(sim::save_memory(backend_->simulation()->board().mcu(), memory_.out->part()));
      KAZ_TRY(memory_.out->commit());
    }
    report_.stored = *stored;
    return {};
  }

  const JointCalibrationOptions& options_;
  host::Interrupt interrupt_;
  std::vector<Gauge> gauges_;
  JointReport report_;
  std::optional<OutputFolder> folder_;
  struct Memory {
    std::string before;  // BackendOptions::memory
    std::optional<OutputFile> out;
  };
  Memory memory_;  // of the virtual board, option --memory
  std::optional<Progress> progress_;
  std::unique_ptr<SessionBackend> backend_;
  std::unique_ptr<KeptRun> kept_;  // refers to the backend
  std::optional<host::Robot> robot_;
  Time begin_{};
  bool has_stored_ = false;
};

}  // namespace

Result<ExitStatus> calibrate_joints(const JointCalibrationOptions& options) {
  return Calibration(options).run();
}

}  // namespace kaz::tools
