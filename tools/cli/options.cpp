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

void OptionAdder::operator()(const sim::OptionText& text, bool& value) {
  if (text.opposite == nullptr) {
    verb_.add_flag(text.option, value, text.help);
    return;
  }
  const std::string by_default = " (default)";
  auto* with = verb_.add_flag_callback(
      text.option, [&value] { value = true; }, text.help + (value ? by_default : ""));
  verb_
      .add_flag_callback(
          "--no-" + std::string(text.option).substr(2), [&value] { value = false; },
          text.opposite + (value ? "" : by_default))
      ->excludes(with);
}

void OptionAdder::operator()(const sim::OptionText& text, std::uint64_t& value) {
  verb_.add_option(text.option, value, text.help)
      ->transform(whole_number())
      ->type_name(text.metavar)
      ->capture_default_str();
}

void OptionAdder::operator()(const sim::OptionText& text, std::string& value) {
  auto* option = verb_.add_option(text.option, value, text.help)->type_name(text.metavar);
  if (!value.empty()) option->capture_default_str();
}

void OptionAdder::operator()(const sim::OptionText& text, double& value,
                             const sim::OptionRange& range) {
  verb_.add_option(text.option, value, text.help)
      ->check(range.limited() ? between(range.min, range.max, range.unit) : number())
      ->type_name(text.metavar)
      ->capture_default_str();
}

void add_sim_options(CLI::App& verb, BackendOptions& options) {
  OptionAdder adder(verb);
  options.visit_world(adder);
  for (const char* option : {"--mesh-collision", "--skip-missing-meshes"})
    verb.get_option(option)->needs(verb.get_option("--robot-file"));
  add_unused_options(verb, options.reading.strict, options.verbose);
  options.visit_mcu(adder);
  options.visit_image(adder);
  verb.add_option("--faults", options.faults,
                  "file that lists faults to inject and their times (docs/reference/simulator.md)")
      ->type_name("FILE");
  options.visit_sensors(adder);
  options.visit_dynamics(adder);
  options.visit_supply(adder);
  options.visit_eyes(adder);
  options.visit_seed(adder);
}

void add_unused_options(CLI::App& verb, bool& strict, bool& verbose) {
  verb.add_flag("--strict", strict,
                "unused elements and attributes of robot and world files are errors");
  verb.add_flag("--verbose", verbose,
                "list these elements and attributes with their lines");
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
                "also record the eyes' pictures, and not only a hash of each stereo pair");
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
