// Help texts, in words instead of CLI11's notation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

// Columns of help on standard output: a terminal's, at least 60 and at most 100; 100 elsewhere.
std::size_t help_columns();

// "kaz mcu run".
std::string full_name(const CLI::App& app);
// "kaz mcu run [OPTIONS] IMAGE".
std::string usage(const CLI::App& app);
// "--mcu h8|native", "--trace[=FILE]", "IMAGE": an option as it is typed, by its long name if it has one.
std::string typed_form(const CLI::Option& option);
// What the option does, then its default and what it goes with: "... (default: h8; not with --port)".
std::string option_text(const CLI::Option& option);
// The parts of what a verb says after its options.
struct Footer {
  std::string notes;  // sentences; a line break inside of one is no more
  std::string
      exit_status;  // one line, complete: of the verb where it says "Exit status: ", else the usual
  std::string examples;  // the lines after "Examples:"
};
// From the text of app.footer(), in which "Exit status: 1 a limit failed." names what differs from the usual.
Footer footer_of(const CLI::App& app);
// Breaks lines longer than help_columns() at spaces. A broken line goes on at `indent`; without that, an
// indented one goes on four columns deeper than it begins.
std::string wrapped(const std::string& text, std::size_t indent = 0);

// For the program; its verbs inherit it.
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
