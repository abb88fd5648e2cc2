// Formats help texts. CLI11 does not break lines, and its notation of options is hard to read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the full name of a verb, which includes the names of its parents: "kaz mcu run".
std::string full_name(const CLI::App& app);
// Returns an option as a user types it, with its valid values: "--mcu h8|native", "--supply V: 1 to 20 V",
// "--trace[=FILE]". Uses the long name if the option has one.
std::string typed_form(const CLI::Option& option);
// Returns the description of an option with default and dependencies: "... (default: h8; not with --port)".
std::string option_text(const CLI::Option& option);
// Parts of a verb's help text that follow the options.
struct Footer {
  std::string notes;     // one paragraph per line; last paragraph: exit statuses of every verb
  std::string examples;  // lines after "Examples:", unchanged
};
Footer footer_of(const CLI::App& app);

// Group of the options that a help does not show. CLI11's errors do not name options of the group "".
inline constexpr const char* kHiddenGroup = "hidden";

// Set this formatter for the program; the verbs inherit it from the program.
class HelpFormatter final : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* verb) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

}  // namespace kaz::tools
