// Options that several verbs have, and checks of their values.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/options.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace kaz::tools {
namespace {

constexpr std::size_t kMaxDigits = 18;

// Without an exponent.
std::string decimal(double number) {
  char text[400];
  return {text, std::to_chars(text, std::end(text), number, std::chars_format::fixed).ptr};
}

// Without the zeros before it, which CLI11 would take for octal. Nothing if it is none.
std::optional<std::string> whole_number_of(const std::string& text) {
  if (text.empty() || text.size() > kMaxDigits ||
      text.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return text.substr(std::min(text.find_first_not_of('0'), text.size() - 1));
}

}  // namespace

CLI::Validator accept_if(const std::function<bool(std::string&)>& valid, const std::string& values,
                         const std::string& kind) {
  return CLI::Validator(
      [valid, error = "must be " + kind + values + ", not "](std::string& text) {
        const std::string given = text;
        return valid(text) ? std::string() : error + given;
      },
      " " + values);
}

CLI::Validator number() {
  return accept_if([](std::string& text) { return parse_number<double>(text).has_value(); },
                   "a number");
}

CLI::Validator positive() {
  return accept_if([](std::string& text) { return parse_number<double>(text).value_or(0) > 0; },
                   "above 0", "a number ");
}

CLI::Validator between(double min, double max, const std::string& unit) {
  return accept_if(
      [min, max](std::string& text) {
        const auto given = parse_number<double>(text);
        return given && *given >= min && *given <= max;
      },
      decimal(min) + " to " + decimal(max) + (unit.empty() ? "" : " " + unit));
}

CLI::Validator whole_number() {
  return accept_if(
      [](std::string& text) {
        const auto number = whole_number_of(text);
        if (number) text = *number;
        return number.has_value();
      },
      "0 to " + std::string(kMaxDigits, '9'), "a whole number from ");
}

CLI::Validator whole_number_above_zero(std::int64_t max) {
  return accept_if(
      [max](std::string& text) {
        const auto number = whole_number_of(text);
        const auto value = number ? parse_number<std::int64_t>(*number) : std::nullopt;
        if (!value || *value < 1 || *value > max) return false;
        text = *number;
        return true;
      },
      "1 to " + std::to_string(max), "a whole number from ");
}

void add_sim_options(CLI::App& verb, BackendOptions& options) {
  verb.add_option("--world", options.world, "name of a Kaz world, or an SDF file")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  verb.add_option("--robot-file", options.robot_file,
                  "URDF of another robot; motor.xml and sensors.xml must be in the same folder "
                  "(default: Kaz)")
      ->type_name("FILE");
  add_choice(verb, "--mcu", sim::kMcuKinds, options.mcu,
             "microcontroller of the servo board: h8 executes the firmware image; native runs the "
             "firmware's C code, compiled for this machine");
  verb.add_option("--image", options.image, "firmware image for h8: an S-record or COFF file")
      ->type_name("FILE");
  verb.add_option("--faults", options.faults,
                  "file that lists faults to inject and their times (docs/reference/simulator.md)")
      ->type_name("FILE");
  add_choice(verb, "--sensors", sim::kSensorSets, options.sensors,
             "nominal: sensors with noise; ideal: sensors without noise; as-built: like nominal, "
             "but each potentiometer has an uncalibrated curve and offset of its own");
  add_imu(verb, options.imu);
  verb.add_option("--dynamics", options.dynamics,
                  "reduced: Kaz's own physics engine; exact: the Open Dynamics Engine; quickN: the "
                  "Open Dynamics Engine with N iterations (1 to 1000)")
      ->type_name("reduced|exact|quickN")
      ->capture_default_str();
  verb.add_option(
          "--physics-step", options.physics_step_ms,
          "time step of the dynamics: 0.125, 0.25, 0.5, 1, 2 or 4 ms; the firmware's tick "
          "stays at 1 ms. For impacts, choose a step of at most 1 ms. If the robot's motors "
          "are on, choose a step of at most 2 ms (docs/explanation/dynamics.md)")
      ->check(number())
      ->type_name("MS")
      ->capture_default_str();
  verb.add_option("--supply", options.supply_volts, "supply voltage of the board")
      ->check(between(kMinSupply_v, kMaxSupply_v, "V"))
      ->type_name("V")
      ->capture_default_str();
  add_choice(verb, "--eyes", sim::kEyeKinds, options.eyes,
             "ideal: pinhole cameras without noise; real: rectified pictures from cameras that "
             "have lens errors, exposure and noise; none: no cameras, for behaviors that use no "
             "pictures");
  verb.add_option("--eye-width", options.eye_width,
                  "width of the eyes' pictures, px: 320 or 640 (default: the width in camera.json)")
      ->check(CLI::IsMember({"320", "640"}).description(""))
      ->type_name("320|640");
  add_choice(verb, "--renderer", sim::kRendererKinds, options.renderer,
             "raster: Kaz's own renderer of the pictures; opengl: the reference renderer, which "
             "uses Mesa and takes three times as long as raster");
  verb.add_option("--seed", options.seed,
                  "seed of all noise; the same seed gives identical results")
      ->transform(whole_number())
      ->type_name("N")
      ->capture_default_str();
}

void add_imu(CLI::App& verb, bool& imu) {
  const std::string by_default = " (default)";
  auto* with = verb.add_flag_callback(
      "--imu", [&imu] { imu = true; },
      "the board has a gyro and an accelerometer at its analog inputs AN3 to AN5" +
          (imu ? by_default : ""));
  verb.add_flag_callback(
          "--no-imu", [&imu] { imu = false; },
          "the board has no gyro or accelerometer" + (imu ? "" : by_default))
      ->excludes(with);
}

void add_settings(CLI::App& verb, std::vector<std::string>& settings, const std::string& text) {
  // One value each: CLI11 would take the words after it, too.
  verb.add_option("--set", settings, text + ", such as seconds=20; --set may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
}

void add_motor_options(CLI::App& verb, BackendOptions& options) {
  verb.add_option(
          "--motor-file", options.motor_file,
          "file with the motor parameters of the virtual motor stand (default: Kaz's motor.xml)")
      ->type_name("FILE");
  verb.add_option("--motor", options.motor,
                  "name of the motor in the motor file (default: the file's default motor)")
      ->type_name("NAME");
  verb.add_option("--disc", options.disc_kgm2, "inertia of the disc on the motor's shaft")
      ->check(between(1e-6, 2e-3, "kg m2"))
      ->capture_default_str()
      ->type_name("KGM2");
}

CLI::Option* add_port(CLI::App& verb, std::string& port, const std::string& text) {
  return verb.add_option("--robot,--port", port, text)->type_name("KIND:PATH");
}

void add_required_port(CLI::App& verb, std::string& port, const std::string& text) {
  verb.add_option("--robot,--port,PORT", port, text)->type_name("KIND:PATH")->required();
}

CLI::Option* add_address(CLI::App& verb, std::uint8_t& address) {
  return verb
      .add_option_function<int>(
          "--address", [&address](int number) { address = static_cast<std::uint8_t>(number); },
          "address of the board on a shared line; if no board answers at this address, the error "
          "lists the addresses that answer")
      ->check(between(1, KZ_ADDRESS_LAST))
      ->type_name("N")
      ->default_str(std::to_string(address));
}

void add_record_pictures(CLI::App& verb, BackendOptions& options) {
  verb.add_flag("--record-pictures", options.record_pictures,
                "also record the eyes' pictures; without this option, the recording contains only "
                "a hash (XXH3, 128 bits) of each stereo pair");
}

void add_image_options(CLI::App& verb, std::string& path, h8s::LoadOptions& load,
                       std::uint32_t max_address) {
  verb.add_option("IMAGE", path, "image file: COFF, ELF, S-record, Intel HEX or raw")
      ->required()
      ->type_name("");
  const std::map<std::string, h8s::Format> formats{{"coff", h8s::Format::coff},
                                                   {"elf", h8s::Format::elf},
                                                   {"srec", h8s::Format::srecord},
                                                   {"ihex", h8s::Format::intel_hex},
                                                   {"raw", h8s::Format::raw}};
  verb.add_option("--format", load.format,
                  "format of the image (default: detected from the file's contents)")
      ->transform(one_of(formats))
      ->type_name("coff|elf|ihex|raw|srec");
  verb.add_option("--at", load.address,
                  "address of a raw image's first byte; execution starts at this address")
      ->check(between(std::uint32_t{0}, max_address))
      ->type_name("ADDRESS");
}

}  // namespace kaz::tools
