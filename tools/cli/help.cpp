// Help texts as wide as the terminal.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

namespace kaz::tools {
namespace {

constexpr std::size_t kTextColumn = 34, kMinColumns = 60, kMaxColumns = 100;

std::string names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);  // the set is in the order of addresses
  return CLI::detail::join(names, ", ");
}

std::size_t help_columns() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col == 0)
    return kMaxColumns;
  return std::clamp<std::size_t>(size.ws_col, kMinColumns, kMaxColumns);
}

// A broken line continues at column `indent`. If that is 0, an indented line continues 4 columns deeper.
std::string wrapped(const std::string& text, std::size_t indent) {
  constexpr std::size_t kDeeper = 4;
  const std::size_t columns = help_columns();
  std::string out, line;
  std::istringstream lines(text);
  while (std::getline(lines, line)) {
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t deep = std::max(indent, first == 0 ? 0 : first + (indent == 0 ? kDeeper : 0));
    while (line.size() > columns) {
      const auto space = line.rfind(' ', columns);
      if (space == std::string::npos || space <= deep) break;  // one long word
      out += line.substr(0, space) + '\n';
      line = std::string(deep, ' ') + line.substr(space + 1);
    }
    out += line + '\n';
  }
  return out;
}

// The right column begins on the next line if the left one is long.
std::string two_columns(const std::string& left, const std::string& right) {
  std::string line = "  " + left;
  if (line.size() + 2 > kTextColumn) line += '\n';
  line += std::string(kTextColumn - (line.ends_with('\n') ? 0 : line.size()), ' ');
  return wrapped(line + right, kTextColumn);
}

}  // namespace

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name()
                                     : full_name(*app.get_parent()) + " " + app.get_name();
}

std::string typed_form(const CLI::Option& option) {
  // Several long names: the others are for older scripts.
  const std::string name = option.get_name(false, !option.get_snames().empty());
  const std::string type = option.get_type_name();
  if (type.empty()) return name;
  if (option.get_items_expected_max() == 0) return name + "[=" + type + "]";
  const bool many = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  return name + " " + type + (many ? " ..." : "");
}

std::string option_text(const CLI::Option& option) {
  std::vector<std::string> facts;
  if (option.get_required()) facts.emplace_back("required");
  if (option.get_type_size() != 0 && !option.get_default_str().empty())
    facts.push_back("default: " + option.get_default_str());
  if (!option.get_needs().empty()) facts.push_back("needs " + names_of(option.get_needs()));
  if (!option.get_excludes().empty())
    facts.push_back("not with " + names_of(option.get_excludes()));
  const std::string& text = option.get_description();
  return facts.empty() ? text : text + " (" + CLI::detail::join(facts, "; ") + ")";
}

Footer footer_of(const CLI::App& app) {
  static const std::string kTitle = "Examples:\n";
  const std::string text = app.get_footer();
  const auto at = std::min(text.find(kTitle), text.size());
  std::string examples = text.substr(std::min(at + kTitle.size(), text.size()));
  examples.resize(examples.find_last_not_of('\n') + 1);
  return {
      text.substr(0, at) +
          "Exit status of every verb: 0 done, 1 failed, 2 wrong usage, 3 the environment failed "
          "(port, disk), 128 + signal number if a signal ended the program.\n",
      examples};
}

HelpFormatter::HelpFormatter() {
  label("SUBCOMMAND", "VERB");
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name,
                                     CLI::AppFormatMode mode) const {
  // A hidden group leaves an empty line.
  return CLI::detail::find_and_replace(Formatter::make_help(app, name, mode), "\n\n\n", "\n\n");
}

std::string HelpFormatter::make_group(std::string group, bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
  return group == kHiddenGroup ? "" : Formatter::make_group(group, is_positional, options);
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool positional) const {
  return two_columns(positional ? option->get_name(true) : typed_form(*option),
                     option_text(*option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* verb) const {
  return two_columns(verb->get_name(), verb->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), 0);
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  const Footer footer = footer_of(*app);
  return wrapped(footer.notes, 0) + "Examples:\n" + footer.examples + "\n";
}

}  // namespace kaz::tools
