// `kaz bench`: measures a board's motors, link and tick, and fits the motor model to a motor.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "host/robot/posture.h"
#include "tools/bench/bench_run.h"
#include "tools/bench/pendulum_run.h"
#include "tools/bench/servo_run.h"
#include "tools/bench/servo_score_run.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"

namespace kaz::tools {
namespace {

void add_common(CLI::App& verb, BenchOptions& arguments) {
  auto* port = add_port(verb, arguments.target.port,
                        std::string(kPortText) +
                            "; without --robot, Kaz measures an emulated board on a virtual motor "
                            "stand, in simulated time");
  add_address(verb, arguments.target.address)->needs(port);
  add_choice(verb, "--mcu", sim::kMcuKinds, arguments.target.backend.mcu,
             "microcontroller of the emulated board: h8 executes the firmware image; native runs "
             "the firmware's C code, compiled for this machine")
      ->excludes(port);
  verb.add_option("--image", arguments.target.backend.image,
                  "firmware image for h8: an S-record or COFF file")
      ->type_name("FILE")
      ->excludes(port);
  add_choice(verb, "--sensors", sim::kSensorSets, arguments.target.backend.sensors,
             "sensors of the emulated board: nominal, ideal or as-built (kaz sim --help)")
      ->excludes(port);
  verb.add_option("--seed", arguments.target.backend.seed, "seed of the emulated board's noise")
      ->transform(whole_number())
      ->capture_default_str()
      ->type_name("N")
      ->excludes(port);
  verb.add_option(
          "--limits", arguments.limits,
          "JSON file with limits that replace the defaults, in the format of `kaz bench list "
          "--json`, such as " +
              std::string(arguments.motor  ? "{\"stall.torque_10v\": {\"low\": 2.0, \"high\": 2.3}}"
                          : arguments.link ? "{\"link.cycle_rate\": {\"low\": 110}}"
                                           : "{\"tick.median\": {\"high\": 55}}"))
      ->type_name("FILE");
  verb.add_option(
          "--out", arguments.out,
          "folder for report.html, result.json, measurements.csv, curves.csv, junit.xml and plots/")
      ->capture_default_str()
      ->type_name("DIR");
  verb.add_flag(
      "--json", arguments.json,
      "print result.json instead of the table and the progress. Kaz also writes all files to the "
      "folder of --out");
}

void add_motor_arguments(CLI::App& verb, BenchOptions& arguments) {
  verb.add_option("--joint", arguments.joints,
                  "joints whose motors are measured: names separated by commas, or 'all'")
      ->capture_default_str()
      ->type_name("NAME,NAME");
  verb.add_option("--stand", arguments.target.stand,
                  "motor stand, only for a board at a port. With --stand ctl:PATH, the stand is "
                  "simulated by kaz sim --stand, and PATH is the control socket of kaz sim. With "
                  "--stand manual, prompts tell you when to clamp the shaft, press on it and read "
                  "the scale. Without --stand, measurements that need a stand are left out")
      ->type_name("ctl:PATH|manual");
  verb.add_option("--supply", arguments.supply_volts,
                  "no-load supply voltage of the stand, V; some measurements set their own voltage")
      ->check(between(5.0, 12.0, "V"))
      ->type_name("VOLTS")
      ->capture_default_str();
  verb.add_option("--filter", arguments.filter,
                  "run only the measurements whose names match this regular expression. Some "
                  "measurements run only as a group. If one name in a group matches, the whole "
                  "group runs")
      ->type_name("REGEX");
  add_motor_options(verb, arguments.target.backend);
  for (const char* name : {"--motor-file", "--motor"})
    verb.get_option(name)->excludes(verb.get_option("--robot"));
  verb.get_option("--disc")->description(
      "inertia of the disc on the motor's shaft. With --stand manual, give the inertia of the disc "
      "that you have mounted");
}

using Chooser = void (*)(BenchOptions&);

CLI::App* add_measuring(CLI::App& bench_verb, Action& action, const char* name, const char* text,
                        Chooser choose, const char* footer) {
  auto* verb = bench_verb.add_subcommand(name, text);
  auto arguments = std::make_shared<BenchOptions>();
  choose(*arguments);
  arguments->out += std::string("-") + name;
  add_common(*verb, *arguments);
  if (arguments->motor) add_motor_arguments(*verb, *arguments);
  auto watch = std::make_shared<WatchArguments>();
  add_watch_options(*verb, *watch);
  auto* motion = verb->add_flag(
      "--allow-motion", arguments->allow_motion,
      arguments->motor && arguments->link
          ? "while Kaz measures the link or the tick, switch the joints on and hold the joints "
            "still, for a realistic load. If a board at a port has no stand, this option also lets "
            "the motor measurements move each joint at full speed through its range"
      : arguments->motor
          ? "at a port without a stand: let the joint move at full speed through its range"
          : "switch the joints on and hold the joints still, for a realistic load. Without "
            "--allow-motion, the joints stay off, and the board refuses the targets. A refusal is "
            "3 bytes longer than an acknowledgment");
  // Of motors alone it is a permission, which is asked for at such a port only.
  if (arguments->motor && !arguments->link)
    motion->needs(verb->get_option("--robot"))->excludes(verb->get_option("--stand"));
  std::string joints;
  for (const host::JointInfo& joint : host::joint_table())
    joints += (joints.empty() ? "" : ", ") + std::string(joint.name);
  verb->footer((arguments->motor ? "Measuring a motor takes 5.5 minutes at a port, and a few "
                                   "seconds on the emulated board. Joints: " +
                                       joints + ".\n"
                                 : std::string()) +
               "Exit status: 0 all measurements are within the limits; 1 a measurement is outside "
               "its limits; 2 wrong usage; 3 port error, or a measurement is undecided because "
               "this machine was too slow or a motor was too warm.\n"
               "Examples:\n" +
               footer);
  verb->callback([&action, arguments, watch, verb] {
    action = [arguments, watch, verb]() -> Result<ExitStatus> {
      const BenchTargetOptions& target = arguments->target;
      if (arguments->motor && verb->count("--disc") > 0 && !target.port.empty() &&
          target.stand != "manual")
        return fail(Fault::usage,
                    "--disc is only valid without --robot, or with --stand manual; leave --disc "
                    "out. If kaz sim simulates the stand, restart kaz sim with --disc");
      if (arguments->motor && verb->count("--supply") > 0 && !target.port.empty() &&
          target.stand.empty())
        return fail(Fault::usage,
                    "--supply needs --stand, because only a stand can set the supply; give --stand "
                    "too, or leave --supply out");
      if (arguments->motor) {
        for (const char* option :
             {"--joint", "--stand", "--supply", "--motor-file", "--motor", "--disc"})
          if (verb->count(option) > 0) arguments->of_motors = option;
      }
      return bench_watched(*watch, *arguments);
    };
  });
  return verb;
}

void add_servo(CLI::App& bench_verb, Action& action) {
  auto* verb = bench_verb.add_subcommand(
      "servo", "fit a motor and friction model to logs of a pendulum on the horn of a bus servo");
  auto arguments = std::make_shared<ServoFitArguments>();
  verb->add_option(
          "LOG", arguments->logs,
          "logs to fit, or folders of logs: CSV (format: docs/howto/bench.md) or BAM's JSON")
      ->required();
  verb->add_option(
          "--held-out", arguments->held_out,
          "logs on which the fitted models are tested. They do not affect the fit or the choice of "
          "the model")
      ->type_name("FILE");
  verb->add_option("--model", arguments->model,
                   "fit the friction models from M1 up to this number; for example, 4 selects M1 "
                   "to M4 (default: 6)")
      ->check(between(1, 6))
      ->type_name("N");
  verb->add_option(
          "--servo", arguments->servo,
          "model of the servo as in bus.json, such as sts3215, for servo.json. A motor.xml "
          "can name servo.json")
      ->type_name("MODEL");
  verb->add_option("--compare", arguments->compare,
                   "compare the parameters with a shipped servo (sts3215-12v, xl330-7v4) or with "
                   "another servo.json")
      ->type_name("NAME|FILE");
  verb->add_option("--out", arguments->out,
                   "folder for report.html, result.json, servo.json and held-out-*.svg")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--json", arguments->json, "print the result as JSON on standard output");
  verb->footer(
      "The fit takes half a minute for 16 logs of 6 s, and two minutes for 720 logs.\n"
      "Examples:\n"
      "  kaz bench servo fit-*.csv --held-out held-*.csv --out my-servo\n"
      "  kaz bench servo fit-*.csv --model 1 --json\n"
      "  kaz bench servo fit-*.csv --servo sts3215 --compare sts3215-12v");
  verb->callback(
      [&action, arguments] { action = [arguments] { return run_servo_fit(*arguments); }; });
}

void add_servo_score(CLI::App& bench_verb, Action& action) {
  auto* verb = bench_verb.add_subcommand(
      "servo-score", "fit a servo's model to a part of its logs, and score it on the other part");
  auto arguments = std::make_shared<ServoScoreArguments>();
  verb->add_option("LOG", arguments->logs, "logs, or folders of logs (kaz bench servo --help)")
      ->required();
  verb->add_option("--hold-out", arguments->splits,
                   "logs with these gains (duty per rad) or masses (kg) are not fitted. Without "
                   "values, each gain or mass is held out once")
      ->required()
      ->type_name("gain[=V,V]|mass[=V,V]");
  verb->add_option("--model", arguments->model,
                   "fit the friction models from M1 up to this number (default: 6)")
      ->check(between(1, 6))
      ->type_name("N");
  verb->add_option("--replay", arguments->replay,
                   "also write the goals of the held-out logs to a virtual servo of this model "
                   "(sts3215, xl330-m288), and compare its positions with the logs")
      ->type_name("MODEL");
  verb->add_option("--out", arguments->out,
                   "folder for scores.csv, tables.md, replay.csv and result.json")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--json", arguments->json, "print the result as JSON on standard output");
  verb->footer(
      "Examples:\n"
      "  kaz bench servo-score sts3215/ --hold-out gain=1.319,3.958 --hold-out mass=1.168\n"
      "  kaz bench servo-score xl330/ --hold-out gain");
  verb->callback(
      [&action, arguments] { action = [arguments] { return run_servo_score(*arguments); }; });
}

void add_pendulum(CLI::App& bench_verb, Action& action) {
  auto* verb = bench_verb.add_subcommand(
      "pendulum", "record logs of a pendulum on the horn of a bus servo, for kaz bench servo");
  auto arguments = std::make_shared<PendulumArguments>();
  hil::PendulumOptions& recorder = arguments->recorder;
  verb->add_option_function<std::string>(
          "--bus",
          [arguments](const std::string& protocol) {
            arguments->protocol = protocol == "feetech" ? servo_bus::Protocol::feetech
                                                        : servo_bus::Protocol::dynamixel;
          },
          "the servo's protocol, if --robot does not name the protocol")
      ->check(CLI::IsMember({"feetech", "dynamixel"}).description(""))
      ->type_name("feetech|dynamixel");
  add_port(*verb, arguments->robot, kBusText)->required();
  verb->add_option("--baud", arguments->baud,
                   "baud rate of the bus (default: factory setting of the servos)")
      ->check(between(1200L, 10000000L))
      ->type_name("BAUD");
  verb->add_option("--id", recorder.id, "id of the servo")
      ->check(between(0, 253))
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--mass", recorder.mass_kg, "mass at the end of the arm, kg")
      ->required()
      ->check(between(0.001, 20.0, "kg"))
      ->type_name("KG");
  verb->add_option("--length", recorder.length_m, "distance from the shaft to the mass, m")
      ->required()
      ->check(between(0.01, 2.0, "m"))
      ->type_name("M");
  verb->add_option("--arm", recorder.arm_kg,
                   "mass of the arm, kg; the arm must be a uniform rod of length --length")
      ->check(between(0.0, 20.0, "kg"))
      ->capture_default_str()
      ->type_name("KG");
  verb->add_option("--amplitude", arguments->amplitude_deg,
                   "amplitude of the swing to each side of the vertical")
      ->check(between(10.0, 150.0, "degrees"))
      ->capture_default_str()
      ->type_name("DEGREES");
  verb->add_option("--seconds", recorder.seconds,
                   "duration of each log. Each log contains one complete motion, so a shorter "
                   "duration makes the motion faster")
      ->check(between(2.0, 60.0, "s"))
      ->capture_default_str()
      ->type_name("S");
  verb->add_option("--max-celsius", recorder.max_celsius,
                   "temperature above which the torque is switched off")
      ->check(between(25.0, 100.0, "C"))
      ->capture_default_str()
      ->type_name("C");
  verb->add_option("--max-amps", recorder.max_amps,
                   "current above which the torque is switched off")
      ->check(between(0.05, 20.0, "A"))
      ->capture_default_str()
      ->type_name("A");
  verb->add_option("--out", arguments->out, "folder for the logs and record.json")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--yes", arguments->yes, "start without confirmation");
  verb->add_flag("--json", arguments->json,
                 "print record.json on standard output, without progress messages");
  verb->footer(
      "This verb takes two minutes. It records four motions, each with three gains, in twelve logs "
      "of 6 s. Give the logs with the middle gain (held-*.csv) to kaz bench servo as --held-out. "
      "During the recording, the D gain, I gain and minimum duty are 0. After the recording, Kaz "
      "restores their values. The recording ends early in three cases: you press Ctrl-C, a limit "
      "is exceeded, or the servo stops answering. Kaz then switches the torque off, restores the "
      "registers and writes no file.\n"
      "Examples:\n"
      "  kaz bench pendulum --robot feetech:/dev/ttyACM0 --mass 0.3 --length 0.15 --arm 0.02 \\\n"
      "      --out heavy\n"
      "  kaz bench servo heavy/fit-*.csv light/fit-*.csv --held-out heavy/held-*.csv \\\n"
      "      light/held-*.csv");
  verb->callback(
      [&action, arguments] { action = [arguments] { return record_pendulum_logs(*arguments); }; });
}

void add_fit(CLI::App& bench_verb, Action& action) {
  auto* verb = bench_verb.add_subcommand(
      "fit",
      "fit the motor model, so that the simulated bench reproduces the measurements in a report");
  auto arguments = std::make_shared<BenchFitOptions>();
  verb->add_option("REPORT", arguments->report,
                   "result.json of `kaz bench motor`, or the folder that contains result.json")
      ->required();
  verb->add_option(
          "--joint", arguments->joint,
          "name of a joint in the report. The motor model is fitted to the measurements of this "
          "joint's motor. The option is only needed if the report has several joints")
      ->type_name("NAME");
  verb->add_option("--motor-file", arguments->model.motor_file,
                   "motor file with the initial parameters (default: Kaz's motor.xml)")
      ->type_name("FILE");
  verb->add_option("--motor", arguments->model.motor,
                   "name of the motor in --motor-file (default: the file's default motor)")
      ->type_name("NAME");
  add_choice(*verb, "--mcu", sim::kMcuKinds, arguments->model.mcu,
             "microcontroller of the simulated board: h8 executes the firmware image; native is "
             "five times as fast, but does not simulate the firmware's delay of 0.1 ms when a "
             "motor starts");
  verb->add_option("--image", arguments->model.image,
                   "firmware image for h8: an S-record or COFF file")
      ->type_name("FILE");
  verb->add_option("--seed", arguments->model.seed, "seed of the noise of the simulated bench")
      ->transform(whole_number())
      ->capture_default_str()
      ->type_name("N");
  verb->add_option("--out", arguments->out,
                   "folder for motor.xml, report.html, result.json and plots/")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--json", arguments->json, "print the result as JSON on standard output");
  verb->footer(
      "Examples:\n"
      "  kaz bench motor --robot serial:/dev/ttyUSB0 --stand manual --disc 4e-4 --out my-motor\n"
      "  kaz bench fit my-motor --out my-fit\n"
      "  kaz bench motor --motor-file my-fit/motor.xml     # on the virtual stand");
  verb->callback([&action, arguments] { action = [arguments] { return run_fit(*arguments); }; });
}

}  // namespace

void add_bench(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("bench",
                                      "measure a board's motors, serial link and control tick, "
                                      "with limits and plots; fit the motor model");
  verb->require_subcommand(1);
  add_measuring(
      *verb, action, "motor",
      "measure a motor's torque, speed, friction, backlash, dead band, potentiometer, step "
      "response, frequency response and heating",
      [](BenchOptions& a) { a.motor = true; },
      "  kaz bench motor --out motor     # an emulated board: no hardware needed\n"
      "  kaz bench motor --joint l_knee,r_knee --filter 'stall|no_load'\n"
      "  kaz bench motor --robot serial:/dev/ttyUSB0 --joint l_sh_pitch --stand manual --disc "
      "4e-4\n"
      "  kaz bench motor --robot serial:board --stand ctl:board.ctl   # for kaz sim --serial board "
      "--stand");
  add_measuring(
      *verb, action, "link",
      "measure the link's round-trip times, cycles per second, errors and lost telemetry",
      [](BenchOptions& a) { a.link = true; },
      "  kaz bench link --robot serial:/dev/ttyUSB0\n  kaz bench link --json > link.json");
  add_measuring(
      *verb, action, "tick", "measure duration and jitter of the board's ticks",
      [](BenchOptions& a) { a.tick = true; },
      "  kaz bench tick --robot serial:/dev/ttyUSB0 --allow-motion\n  kaz bench tick");
  add_measuring(
      *verb, action, "all", "measure link, tick and motors, and write one report",
      [](BenchOptions& a) { a.motor = a.link = a.tick = true; },
      "  kaz bench all --out board-42\n  kaz bench all --robot serial:/dev/ttyUSB0 --stand manual");
  add_fit(*verb, action);
  add_servo(*verb, action);
  add_servo_score(*verb, action);
  add_pendulum(*verb, action);
  auto* names = verb->add_subcommand(
      "list", "print the names and limits of the measurements, and measure nothing");
  auto as_json = std::make_shared<bool>(false);
  names->add_flag("--json", *as_json,
                  "print the list as JSON. The option --limits of the other verbs reads this "
                  "format. null means that the measurement has no limit");
  names->footer("Examples:\n  kaz bench list\n  kaz bench list --json > limits.json");
  names->callback([&action, as_json] {
    action = [as_json] {
      print_measurements(*as_json);
      return true;
    };
  });
  verb->footer(
      "Examples:\n"
      "  kaz bench motor --out motor\n"
      "  kaz bench fit motor --out fit\n"
      "  kaz bench list");
}

}  // namespace kaz::tools
