// `kaz calibrate`: cameras from pictures of a chessboard, joints against stops, gravity and symmetry.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/base/arguments.h"
#include "tools/calibrate/calibrate_bus.h"
#include "tools/calibrate/calibrate_joints.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/vision/calibrate_stereo.h"

namespace kaz::tools {
namespace {

void add_stereo(CLI::App& calibrate, Action& action) {
  auto* stereo = calibrate.add_subcommand("stereo",
                                          "calibrate the lenses and the relative position of two "
                                          "cameras from pictures of a chessboard");
  auto arguments = std::make_shared<StereoCalibrationOptions>();
  stereo
      ->add_option("--left", arguments->left,
                   "pictures of the left eye: a file name pattern in quotes")
      ->required()
      ->type_name("PATTERN");
  stereo
      ->add_option(
          "--right", arguments->right,
          "pictures of the right eye, taken at the same times: a file name pattern in quotes")
      ->required()
      ->type_name("PATTERN");
  stereo
      ->add_option("--board", arguments->board,
                   "number of the chessboard's inner corners, 3 to 100 along each side; a board "
                   "with 10 x 7 squares has 9x6 inner corners")
      ->required()
      ->type_name("COLUMNSxROWS");
  stereo
      ->add_option("--square", arguments->square_m,
                   "side length of a square, 0.001 to 0.5 m; give 0.025 for 25 mm")
      ->required()
      ->check(positive())
      ->type_name("M");
  stereo
      ->add_option("--out", arguments->out,
                   "calibration file to write, in OpenCV's format (.yml, .json or .xml), or two "
                   "camera_info files of ROS: LEFT.yaml,RIGHT.yaml")
      ->required()
      ->type_name("FILE");
  stereo
      ->add_option("--coverage", arguments->coverage,
                   "file for a picture that shows where the chessboard was seen (default: "
                   "FILE.coverage.png)")
      ->type_name("PNG");
  stereo
      ->add_option("--max-rms", arguments->max_rms_px,
                   "largest valid reprojection error (RMS), px; if the error is larger, no "
                   "calibration is written")
      ->check(between(0.01, 5.0, "px"))
      ->capture_default_str()
      ->type_name("PX");
  stereo->add_flag("--json", arguments->json,
                   "print the report as JSON, without progress messages");
  stereo->footer(
      "Two pictures are a pair if the last numbers in their names are equal, as in left07.jpg and "
      "right07.jpg. Pictures that do not show the whole board are listed and left out; at least " +
      std::to_string(vision::kLeastPairs) +
      " pairs must remain. Move and tilt the board until the coverage picture is full, including "
      "its corners.\n"
      "Exit status: 0 done, 1 the pictures give no good calibration, 2 wrong usage.\n"
      "Examples:\n"
      "  kaz calibrate stereo --left 'eyes/left*.png' --right 'eyes/right*.png' \\\n"
      "      --board 9x6 --square 0.025 --out stereo.yml\n"
      "  kaz calibrate stereo --left 'l*.jpg' --right 'r*.jpg' --board 7x5 --square 0.03 \\\n"
      "      --out stereo.json --json");
  stereo->callback(
      [&action, arguments] { action = [arguments] { return calibrate_stereo(*arguments); }; });
}

// Of the virtual robot; at a port they have no effect.
constexpr const char* kVirtualOnly[] = {"--world",    "--mcu",          "--image",  "--sensors",
                                        "--imu",      "--no-imu",       "--supply", "--seed",
                                        "--dynamics", "--physics-step", "--memory"};

// Of a robot with a servo board; on a bus they have no effect.
constexpr const char* kBoardOnly[] = {"--address", "--only", "--gauge", "--gauge-error",
                                      "--dry-run"};

// Errors: an option that has no effect beside the others.
Result<void> check_joint_options(const CLI::App& verb, const JointCalibrationOptions& options) {
  const bool gauge = options.only == "gauge" || !options.gauge.empty();
  const bool sim = !options.backend.at_port();
  const struct {
    const char* option;
    bool idle;
    const char* why;
  } rows[] = {
      {"--gauge-error", !gauge, "is only valid with --gauge NAME=DEGREES or --only gauge"},
      {"--yes", sim,
       "is only valid with a robot at a port: the virtual robot always moves without "
       "confirmation"},
      {"--yes", gauge, "is not valid with a gauge, because no joint moves"},
      {"--json", options.dry_run, "is not valid with --dry-run, which prints its plan as text"},
      {"--out", options.dry_run, "is not valid with --dry-run, which has no results"},
      {"--no-store", options.dry_run, "is not valid with --dry-run, which makes no calibration"}};
  for (const auto& [option, idle, why] : rows) {
    if (idle && verb.count(option) > 0)
      return fail(Fault::usage, std::string(option) + " " + why + "; leave " + option + " out");
  }
  return {};
}

void add_joint_options(CLI::App& verb, JointCalibrationOptions& options) {
  options.backend.world = "empty";
  options.backend.imu = true;
  options.backend.sensors = sim::SensorSet::as_built;
  verb.add_option("--robot", options.backend.robot, kRobotText)
      ->type_name("sim|PORT")
      ->capture_default_str();
  add_address(verb, options.backend.address);
  verb.add_option("--only", options.only,
                  "run only one part of the calibration. With 'stops', the suspended robot presses "
                  "its joints against the mechanical stops. With 'floor', the robot stands on the "
                  "floor, and the board must already have a stored calibration. With 'gauge', no "
                  "joint moves, and you enter the angles")
      ->check(CLI::IsMember({"stops", "floor", "gauge"}).description(""))
      ->type_name("stops|floor|gauge");
  verb.add_option(
          "--gauge", options.gauge,
          "present angle of the joint NAME. Measure this angle with a gauge or a jig. If all "
          "joints have the same angle, give all=DEGREES. --gauge may be repeated")
      ->type_name("NAME=DEGREES")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  verb.add_option("--gauge-error", options.gauge_error_deg,
                  "uncertainty of the gauge angles, one standard deviation in degrees")
      ->check(between(0.01, 5.0, "degrees"))
      ->capture_default_str()
      ->type_name("DEGREES");
  verb.add_flag("--yes", options.yes,
                "at a port: start each group of motions without confirmation");
  verb.add_flag("--dry-run", options.dry_run,
                "only print the planned motions, without connecting to a board");
  verb.add_flag_callback(
      "--no-store", [&options] { options.store = false; },
      "only report the result, and leave the board unchanged");
  verb.add_option("--out", options.out,
                  "folder for result.json and joints.svg; without --out, no file is written")
      ->type_name("DIR");
  verb.add_flag("--json", options.json,
                "print result.json on standard output, without progress messages");
  verb.add_option("--memory", options.memory,
                  "file that keeps the virtual board's calibration, for kaz run and kaz sim")
      ->type_name("FILE");
  add_sim_options(verb, options.backend);
  for (const char* absent : {"--robot-file", "--mesh-collision", "--skip-missing-meshes",
                             "--strict", "--verbose", "--eyes", "--eye-width", "--renderer"})
    verb.remove_option(verb.get_option(absent));
  verb.add_option("--robot-file", options.backend.robot_file,
                  "URDF of a robot on a servo bus; the zero positions are written to bus.json in "
                  "the same folder")
      ->type_name("FILE");
}

void add_bus_options(CLI::App& verb, BusCalibrationOptions& options) {
  verb.add_option("--seconds", options.seconds,
                  "on a servo bus: time limit for turning the joints by hand")
      ->check(between(1.0, 3600.0, "s"))
      ->capture_default_str()
      ->type_name("S");
  verb.add_flag("--release", options.release,
                "on a servo bus: switch off the servos' torque before the calibration starts; hold "
                "the robot, because it goes limp");
}

Result<ExitStatus> calibrate_on_bus(const CLI::App& verb, const JointCalibrationOptions& arguments,
                                    BusCalibrationOptions options) {
  for (const char* option : kBoardOnly) {
    if (verb.count(option) > 0)
      return fail(Fault::usage, std::string(option) + " is for a robot with a servo board; leave " +
                                    option + " out with --robot " + arguments.backend.robot);
  }
  options.backend = arguments.backend;
  options.out = arguments.out;
  options.yes = arguments.yes;
  options.store = arguments.store;
  options.json = arguments.json;
  return calibrate_bus_joints(options);
}

void add_joints(CLI::App& calibrate, Action& action) {
  auto* verb = calibrate.add_subcommand("joints",
                                        "calibrate the joints' potentiometers by mechanical stops, "
                                        "gravity and symmetry, or by a gauge");
  auto arguments = std::make_shared<JointCalibrationOptions>();
  auto bus = std::make_shared<BusCalibrationOptions>();
  add_joint_options(*verb, *arguments);
  add_bus_options(*verb, *bus);
  verb->footer(
      "First the robot hangs by its trunk. Kaz presses each joint gently against the joint's "
      "two stops, in this order: head and hands, arms, legs. Then the robot stands on a level "
      "floor, crouches and leans, with both soles flat on the floor. An accelerometer on the board "
      "measures the vertical. At a port, each group of motions starts when you press Enter; the "
      "virtual robot is suspended and set down automatically. If all joints have good readings, "
      "the calibration is stored in the board. After Ctrl-C or an error, the board is unchanged.\n"
      "On a servo bus (--robot feetech:PORT or dynamixel:PORT), the servos do not drive the "
      "joints: turn each joint by hand from one stop to the other. Once in each full rotation, a "
      "servo's position value jumps from its maximum to zero. Kaz sets position offsets that move "
      "this jump out of the joint's range. Kaz shows the EEPROM values, writes the values, and "
      "reads the values back. The zero positions are written to bus.json.\n"
      "Exit status: 1 a joint has no good reading; then no calibration is stored.\n"
      "Examples:\n"
      "  kaz calibrate joints --dry-run\n"
      "  kaz calibrate joints --seed 3 --mcu native --memory three.mem\n"
      "  kaz run go-forward --sensors as-built --seed 3 --imu --memory three.mem\n"
      "  kaz calibrate joints --robot serial:/dev/ttyUSB0 --out joints\n"
      "  kaz calibrate joints --robot serial:/dev/ttyUSB0 --only floor --yes --json\n"
      "  kaz calibrate joints --robot serial:/dev/ttyUSB0 --gauge neck_pan=0 --gauge-error 0.3\n"
      "  kaz calibrate joints --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  verb->callback([&action, arguments, bus, verb] {
    action = [arguments, bus, verb]() -> Result<ExitStatus> {
      for (const char* option : kVirtualOnly) {
        if (arguments->backend.at_port() && verb->count(option) > 0)
          return fail(Fault::usage, std::string(option) + " is for the virtual robot; leave " +
                                        option + " out with --robot " + arguments->backend.robot);
      }
      if (names_servo_bus(arguments->backend.robot))
        return calibrate_on_bus(*verb, *arguments, *bus);
      for (const char* option : {"--robot-file", "--seconds", "--release"}) {
        if (verb->count(option) > 0)
          return fail(Fault::usage, std::string(option) +
                                        " is for a robot on a servo bus, such as --robot "
                                        "feetech:/dev/ttyACM0; leave it out");
      }
      KAZ_TRY(check_joint_options(*verb, *arguments));
      return calibrate_joints(*arguments);
    };
  });
}

}  // namespace

void add_calibrate(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "calibrate", "calibrate cameras from pictures of a chessboard, or the robot's joints");
  verb->require_subcommand(1);
  verb->footer(
      "Examples:\n"
      "  kaz calibrate stereo --left 'eyes/left*.png' --right 'eyes/right*.png' \\\n"
      "      --board 9x6 --square 0.025 --out stereo.yml\n"
      "  kaz calibrate joints --robot serial:/dev/ttyUSB0");
  add_stereo(*verb, action);
  add_joints(*verb, action);
}

}  // namespace kaz::tools
