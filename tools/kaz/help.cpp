// Help texts, as wide as the terminal, in words instead of CLI11's notation.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <regex>
#include <sstream>
#include <utility>

#include "tools/kaz/values.h"

namespace kaz::tools {
namespace {

constexpr std::size_t kTextColumn = 34, kMinColumns = 60, kMaxColumns = 100;

// CLI11 writes the value of a flag into its name: "--no-start{false}", "--trace{-}".
std::string flag_names(const CLI::Option& option) {
  std::string names = option.get_name(false, true);
  while (true) {
    const auto brace = names.find('{');
    const auto end = brace == std::string::npos ? brace : names.find('}', brace);
    if (end == std::string::npos) return names;
    const std::string value = names.substr(brace + 1, end - brace - 1);
    const std::string type = option.get_type_name();
    const std::string given = value == "false" || value == "true"
                                  ? ""
                                  : "[=" + (type.empty() ? std::string("VALUE") : type) + "]";
    names.replace(brace, end - brace + 1, given);
  }
}

// "--allow-motion", "-h,--help". Of several long names the first: the others are for older scripts.
std::string long_names(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ",-") + name;
  if (!option.get_lnames().empty())
    names += (names.empty() ? "--" : ",--") + option.get_lnames()[0];
  return names;
}

bool takes_many(const CLI::Option& option) {
  return option.get_expected_max() == CLI::detail::expected_max_vector_size;
}

std::string names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);  // the set is in the order of addresses
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// Two columns; the right one on a line of its own where the left one is long.
std::string two_columns(const std::string& left, const std::string& right) {
  std::string line = "  " + left;
  if (right.empty()) return line + "\n";
  if (line.size() + 1 >= kTextColumn) {
    line += "\n" + std::string(kTextColumn, ' ');
  } else {
    line.resize(kTextColumn, ' ');
  }
  return wrapped(line + right, kTextColumn) + "\n";
}

// Without the line breaks inside of sentences. Lists are indented.
std::string filled(const std::string& text) {
  std::string out, line, last;
  std::istringstream lines(text);
  while (std::getline(lines, line)) {
    const bool goes_on = !last.empty() && last.front() != ' ' && last.back() != '.' &&
                         !line.empty() && line.front() != ' ';
    if (!out.empty()) out += goes_on ? ' ' : '\n';
    out += line;
    last = line;
  }
  return out;
}

// `differing`: "1 a limit failed, 3 port error." Verbs that only have verbs of their own say nothing.
std::string exit_status(const CLI::App& app, const std::string& differing) {
  const bool runs = app.get_subcommands(nullptr).empty() || app.get_require_subcommand_min() == 0;
  if (differing.empty() && !runs) return "";
  std::map<int, std::string> statuses{{0, "done"},
                                      {1, "failed"},
                                      {2, "wrong usage"},
                                      {3, "the environment failed (port, disk)"},
                                      {128, "+ signal number if a signal ended the program"}};
  std::string line = filled(differing);
  std::ranges::replace(line, '\n', ' ');
  if (line.ends_with('.')) line.pop_back();
  static const std::regex kStatus("(^|[,;] )([0-9]+) ");
  const std::sregex_iterator none;
  for (std::sregex_iterator at(line.begin(), line.end(), kStatus), next; at != none; at = next) {
    next = std::next(at);
    const auto from = at->position() + at->length();
    statuses[std::stoi((*at)[2])] =
        line.substr(from, next == none ? std::string::npos : next->position() - from);
  }
  // kaz sim and kaz monitor are ended by a signal.
  if (statuses[0].find("Ctrl-C") != std::string::npos) statuses.erase(128);
  std::string all;
  for (const auto& [number, text] : statuses)
    all += (all.empty() ? "" : "; ") + std::to_string(number) + " " + text;
  return all + ".";
}

// The last space up to `columns` that is not in quotes, nor in the first `indent` columns.
std::size_t last_space(const std::string& line, std::size_t columns, std::size_t indent) {
  std::size_t found = std::string::npos;
  char quote = 0;
  for (std::size_t i = indent; i < line.size() && i <= columns; ++i) {
    if (quote == 0 && (line[i] == '\'' || line[i] == '"')) {
      quote = line[i];
    } else if (line[i] == quote) {
      quote = 0;
    } else if (line[i] == ' ' && quote == 0) {
      found = i;
    }
  }
  return found;
}

// A command goes on behind a backslash, so that what is copied from the terminal runs. Its comment, where
// both are too long for a line, stands before it.
std::string wrapped_example(std::string line, std::size_t columns) {
  constexpr const char* kGoesOn = " \\";
  constexpr std::size_t kDeeper = 4;
  std::string out;
  const auto indent = line.find_first_not_of(' ');
  if (line.size() <= columns || indent == std::string::npos) return line + "\n";
  if (const auto comment = line.find(" # "); comment != std::string::npos) {
    std::string text = line.substr(comment + 1);
    while (indent + text.size() > columns) {
      const auto space = text.rfind(' ', columns - indent);
      if (space == std::string::npos || space < 2) break;
      out += std::string(indent, ' ') + text.substr(0, space) + "\n";
      text = "# " + text.substr(space + 1);
    }
    out += std::string(indent, ' ') + text + "\n";
    line.resize(line.find_last_not_of(' ', comment) + 1);
  }
  // Of an example that has lines of its own, the end of this one is its backslash.
  const bool goes_on = line.ends_with(kGoesOn);
  if (goes_on) line.resize(line.size() - 2);
  while (line.size() + (goes_on ? 2 : 0) > columns) {
    const auto space = last_space(line, columns - 2, line.find_first_not_of(' '));
    if (space == std::string::npos) break;  // one long word
    out += line.substr(0, space) + kGoesOn + "\n";
    line = std::string(indent + kDeeper, ' ') + line.substr(space + 1);
  }
  return out + line + (goes_on ? kGoesOn : "") + "\n";
}

std::string wrapped_examples(const std::string& examples) {
  std::string out;
  std::istringstream lines(examples);
  for (std::string line; std::getline(lines, line);) out += wrapped_example(line, help_columns());
  return out;
}

}  // namespace

std::size_t help_columns() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col == 0)
    return kMaxColumns;
  return std::clamp<std::size_t>(size.ws_col, kMinColumns, kMaxColumns);
}

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name()
                                     : full_name(*app.get_parent()) + " " + app.get_name();
}

std::string usage(const CLI::App& app) {
  const std::string name = full_name(app);
  const auto verbs = app.get_subcommands(nullptr);
  std::string text = name + " [OPTIONS]";
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    const std::string word = option->get_name(true, false) + (takes_many(*option) ? " ..." : "");
    // Where there are verbs too, one of both is given.
    text += option->get_required() || !verbs.empty() ? " " + word : " [" + word + "]";
  }
  if (verbs.empty()) return text;
  if (app.get_require_subcommand_min() > 0) return text + " VERB";
  for (const CLI::App* verb : verbs) text += " | " + name + " " + verb->get_name() + " ...";
  return text;
}

std::string typed_form(const CLI::Option& option) {
  if (!option.nonpositional()) return option.get_name(true, false);
  if (option.get_items_expected_max() == 0) return flag_names(option);
  const std::string value = placeholder(option);
  std::string form = option.get_lnames().empty() ? option.get_name() : long_names(option);
  if (!value.empty()) form += " " + value;
  if (takes_many(option)) {
    form += " ...";
  } else if (option.get_expected_min() == 2 && !value.empty() &&
             value.find(' ') == std::string::npos) {
    form += " " + value;
  }
  return form;
}

std::string option_text(const CLI::Option& option) {
  std::string facts;
  const auto add = [&](const std::string& fact) { facts += (facts.empty() ? "" : "; ") + fact; };
  if (option.get_required()) add("required");
  const std::string bounds = range(option);
  if (!bounds.empty() && option.get_description().find(bounds) == std::string::npos) add(bounds);
  if (option.get_type_size() != 0 && !option.get_default_str().empty())
    add("default: " + default_text(option));
  if (!option.get_needs().empty()) add("needs " + names_of(option.get_needs()));
  if (!option.get_excludes().empty()) add("not with " + names_of(option.get_excludes()));
  const std::string text = option.get_description();
  return facts.empty() ? text : text + (text.empty() ? "(" : " (") + facts + ")";
}

Footer footer_of(const CLI::App& app) {
  static const std::string kStatus = "Exit status: ", kExamples = "Examples:";
  std::string notes, status, examples;
  std::string* part = &notes;
  std::istringstream lines(app.get_footer());
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find(kStatus);
    if (line == kExamples) {
      part = &examples;
      continue;
    }
    if (at != std::string::npos) {
      if (at > 0) notes += line.substr(0, at - 1) + "\n";
      line.erase(0, at + kStatus.size());
      part = &status;
    } else if (part == &examples && !line.starts_with(' ')) {
      part = &notes;
    }
    *part += line + "\n";
  }
  return {filled(notes), exit_status(app, status), examples};
}

std::string wrapped(const std::string& text, std::size_t indent) {
  const std::size_t columns = help_columns();
  std::string out, line;
  std::istringstream lines(text);
  while (std::getline(lines, line)) {
    if (!out.empty()) out += '\n';
    const auto first = line.find_first_not_of(' ');
    const std::size_t deep = std::max(
        indent, first == std::string::npos || first == 0 ? 0 : first + (indent == 0 ? 4 : 0));
    while (line.size() > columns) {
      const auto space = line.rfind(' ', columns);
      if (space == std::string::npos || space <= deep) break;  // one long word
      out += line.substr(0, space) + '\n';
      line = std::string(deep, ' ') + line.substr(space + 1);
    }
    out += line;
  }
  return out;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool positional) const {
  if (positional) return two_columns(option->get_name(true, false), option_text(*option));
  // One that is a positional too is explained there.
  return two_columns(typed_form(*option),
                     option->get_positional()
                         ? "the same as the argument " + option->get_name(true, false)
                         : option_text(*option));
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name,
                                     CLI::AppFormatMode mode) const {
  std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
  // A hidden group leaves an empty line.
  for (auto at = help.find("\n\n\n"); at != std::string::npos; at = help.find("\n\n\n"))
    help.erase(at, 1);
  return help;
}

std::string HelpFormatter::make_subcommands(const CLI::App* app, CLI::AppFormatMode) const {
  std::string list;
  for (const CLI::App* verb : app->get_subcommands(nullptr)) list += make_subcommand(verb);
  return list.empty() ? "" : "\nVerbs:\n" + list;
}

std::string HelpFormatter::make_subcommand(const CLI::App* verb) const {
  return two_columns(verb->get_name(), verb->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(CLI::Formatter::make_description(app)) + "\n";
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string) const {
  return wrapped("Usage: " + usage(*app), 4) + "\n";
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  const Footer footer = footer_of(*app);
  std::string text = footer.notes.empty() ? "" : wrapped(footer.notes) + "\n";
  if (!footer.exit_status.empty()) text += wrapped("Exit status: " + footer.exit_status, 4) + "\n";
  if (!footer.examples.empty()) text += "Examples:\n" + wrapped_examples(footer.examples);
  return text;
}

}  // namespace kaz::tools
