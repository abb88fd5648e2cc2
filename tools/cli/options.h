// Options that several verbs share, and validators of option values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <CLI/CLI.hpp>

#include "shared/base/enum_names.hpp"
#include "shared/base/number_text.hpp"
#include "shared/image/image.h"
#include "shared/protocol/messages.h"
#include "tools/run/backend.h"

namespace kaz::tools {

// Every numeric option must use one of the validators below (tests/system/command_line/numbers_test.cpp).
// Without these validators, CLI11 accepts nan (even in CLI::Range), infinity and hexadecimal fractions, and
// silently clamps values that are too large for the type.

// Accepts a text if `valid` returns true; `valid` may rewrite the text. Error messages name the `kind` and
// the `values`; help shows the `values` after the type: "--supply V: 1 to 20 V".
CLI::Validator accept_if(const std::function<bool(std::string&)>& valid, const std::string& values,
                         const std::string& kind = "");

// Accepts a finite decimal number.
CLI::Validator number();
// Accepts a number above 0. The error message of CLI11's own check would contain the largest double.
CLI::Validator positive();
// Accepts `min` to `max`, inclusive. The overload for integers also accepts hexadecimal numbers such as 0x10,
// and shows the limits of unsigned types, such as addresses, as hexadecimal numbers.
CLI::Validator between(double min, double max, const std::string& unit = "");
template <std::integral T>
CLI::Validator between(T min, T max);

// Accepts only digits, at most 18 digits. CLI11 would read 1e3 as 1, and 99999999999999999999 as the maximum
// of the type.
CLI::Validator whole_number();
// Accepts 1 to `max`, written with digits only.
CLI::Validator whole_number_above_zero(std::int64_t max = 999'999'999'999'999'999);

// Accepts the names of `values` and replaces each name by its number. CLI11's own transformer would also
// print the numbers in error messages.
template <class T>
CLI::Validator one_of(const std::map<std::string, T>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return CLI::Validator(
      [values, is_name = CLI::IsMember(names)](std::string& text) {
        std::string error = is_name(text);
        if (error.empty()) text = std::to_string(static_cast<int>(values.at(text)));
        return error;
      },
      "");
}
template <std::integral T>
CLI::Validator between(T min, T max) {
  std::ostringstream values;
  if (std::is_unsigned_v<T>) values << std::hex << std::showbase;
  values << min << " to " << max;
  return accept_if(
      [min, max](std::string& text) {
        const auto number = text.starts_with("0x")
                                ? parse_number<T>(std::string_view(text).substr(2), 16)
                                : parse_number<T>(text);
        if (!number || *number < min || *number > max) return false;
        text = std::to_string(*number);  // CLI11 would read 010 as an octal number
        return true;
      },
      values.str(), "a whole number from ");
}

// Adds an option whose values are the names of an enum. `to` is a T or a std::optional<T>. The value of a T
// is the default; a std::optional<T> has no default. `to` must outlive `verb`.
template <class T, std::size_t N, class To>
CLI::Option* add_choice(CLI::App& verb, const std::string& name, const std::array<T, N>& values,
                        To& to, const std::string& description) {
  auto* option = verb.add_option_function<std::string>(
      name, [&to, values](const std::string& text) { to = parse_enum(values, text).value(); },
      description);
  const auto names = enum_names(values);
  option->check(CLI::IsMember(names).description(""))->type_name(CLI::detail::join(names, "|"));
  if constexpr (std::is_same_v<T, To>) option->default_str(to_string(to));
  return option;
}

// Archive (robot_options.h) that adds options to `verb`. The defaults are the present values. The variables
// for the values must outlive `verb`.
class OptionAdder {
 public:
  explicit OptionAdder(CLI::App& verb) : verb_(verb) {}

  void operator()(const sim::OptionText& text, bool& value);
  void operator()(const sim::OptionText& text, std::uint64_t& value);
  void operator()(const sim::OptionText& text, std::string& value);
  void operator()(const sim::OptionText& text, double& value, const sim::OptionRange& range);
  template <class T, std::size_t N>
  void operator()(const sim::OptionText& text, T& value, const std::array<T, N>& values) {
    add_choice(verb_, text.option, values, value, text.help);
  }
  template <std::size_t N>
  void operator()(const sim::OptionText& text, int& value, const std::array<int, N>& sizes) {
    std::vector<std::string> valid;
    for (const int one : sizes) valid.push_back(std::to_string(one));
    verb_.add_option(text.option, value, text.help)
        ->check(CLI::IsMember(valid).description(""))
        ->type_name(text.metavar);
  }

 private:
  CLI::App& verb_;
};

// The functions below add options to `verb`. The variables for the values must outlive `verb`.

// Adds --faults, --strict, --verbose and the options of BackendOptions::visit(), except --suspended.
void add_sim_options(CLI::App& verb, BackendOptions& options);
// Adds --strict and --verbose, for verbs that read a robot or a world.
void add_unused_options(CLI::App& verb, bool& strict, bool& verbose);
// Adds --set NAME=VALUE. Users may repeat the option. `text`: description, without an example.
void add_settings(CLI::App& verb, std::vector<std::string>& settings, const std::string& text);
// Adds --motor-file, --motor and --disc, the options for the motors on a virtual motor stand.
void add_motor_options(CLI::App& verb, BackendOptions& options);
// Descriptions of the values of --robot (host/link/port_address.h).
inline constexpr const char* kPortText =
    "the board: serial:PATH[@BAUD] of a serial port or pty, can:INTERFACE, tcp:HOST:PORT or "
    "rfc2217:HOST:PORT[@BAUD]";
inline constexpr const char* kBusText =
    "the servo bus: feetech:PATH[@BAUD] or dynamixel:PATH[@BAUD]; PATH may also be "
    "rfc2217:HOST:PORT";
inline constexpr const char* kRobotText =
    "the virtual robot (sim); a board at a port (serial:PATH[@BAUD], can:INTERFACE, tcp:HOST:PORT "
    "or rfc2217:HOST:PORT[@BAUD]); several boards (boards:FILE, where FILE lists the joints of "
    "each board); or a servo bus (feetech:PATH[@BAUD] or dynamixel:PATH[@BAUD])";

// Adds --robot KIND:PATH, for verbs that need a port. --port is an alias for older scripts.
CLI::Option* add_port(CLI::App& verb, std::string& port, const std::string& text = kPortText);
// Like add_port(), but the option is required, and users may also give its value as a positional argument.
void add_required_port(CLI::App& verb, std::string& port, const std::string& text = kPortText);
// Adds --address N, for every verb that opens a port.
CLI::Option* add_address(CLI::App& verb, std::uint8_t& address);
// Adds --record-pictures, for verbs that record.
void add_record_pictures(CLI::App& verb, BackendOptions& options);
// Adds IMAGE, --format and --at. `max_address`: maximum address for the first byte of a raw image.
void add_image_options(CLI::App& verb, std::string& path, h8s::LoadOptions& load,
                       std::uint32_t max_address);

}  // namespace kaz::tools
