// Help texts: at most 100 columns, in words instead of CLI11's notation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kaz::tools {

inline constexpr std::size_t kHelpColumns = 100;

// "--mcu h8|native", "--trace[=FILE]", "IMAGE": an option as it is typed.
std::string typed_form(const CLI::Option& option);
// What the option does, then its default and what it goes with: "... (default: h8; not with --port)".
std::string option_text(const CLI::Option& option);
// Breaks lines longer than kHelpColumns at spaces. A broken line goes on at `indent`, or at its own
// indentation where that is deeper.
std::string wrapped(const std::string& text, std::size_t indent = 0);

// For the program; its verbs inherit it.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* verb) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_footer(const CLI::App* app) const override;
};

}  // namespace kaz::tools
