// Formats help texts for users, because CLI11 would print its own notation of types and checks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Returns the width of help texts in columns: the width of the terminal on standard output, clamped to
// 60..100. Without a terminal: 100.
std::size_t help_columns();

// Returns the full name of a verb, which includes the names of its parents: "kaz mcu run".
std::string full_name(const CLI::App& app);
// Returns the usage line: "kaz mcu run [OPTIONS] IMAGE".
std::string usage(const CLI::App& app);
// Returns an option as a user types it. Uses the long name if the option has one: "--mcu h8|native",
// "--trace[=FILE]", "IMAGE".
std::string typed_form(const CLI::Option& option);
// Returns the description of an option with range, default and dependencies: "... (default: h8; not with
// --port)".
std::string option_text(const CLI::Option& option);
// Parts of a verb's help text that follow the options.
struct Footer {
  std::string notes;  // has no line breaks inside sentences
  // One line with all exit statuses: the default statuses, and the statuses that the verb redefines. Empty
  // for a verb that only groups other verbs.
  std::string exit_status;
  std::string examples;  // the lines after "Examples:"
};
// Parses app.footer(). The text "Exit status: 1 a limit failed." in the footer lists only the statuses that
// differ from the default statuses.
Footer footer_of(const CLI::App& app);
// Breaks lines longer than help_columns() at spaces. A broken line continues at column `indent`. If `indent`
// is 0, the continuation of an indented line is indented by four more columns than the line.
std::string wrapped(const std::string& text, std::size_t indent = 0);

// Set this formatter for the program; the verbs inherit it from the program.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override;
  std::string make_subcommand(const CLI::App* verb) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_footer(const CLI::App* app) const override;
};

}  // namespace kaz::tools
