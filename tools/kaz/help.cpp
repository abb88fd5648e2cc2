// Help texts: at most 100 columns, in words instead of CLI11's notation.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/help.h"

#include <algorithm>
#include <sstream>

namespace kaz::tools {
namespace {

constexpr std::size_t kTextColumn = 34;

// CLI11 joins type and checks: "TEXT:{h8,native}", "UINT:INT in [0 - 255]", "INT:POSITIVE".
std::string value_name(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto colon = type.find(":{");
  if (colon != std::string::npos && type.back() == '}') {
    std::string choices = type.substr(colon + 2, type.size() - colon - 3);
    std::ranges::replace(choices, ',', '|');
    return choices;
  }
  if (const auto in = type.find(" in ["); in != std::string::npos && type.back() == ']') {
    std::string range = type.substr(in + 5, type.size() - in - 6);
    if (const auto dash = range.find(" - "); dash != std::string::npos)
      range.replace(dash, 3, "..");
    return range;
  }
  // A name that a verb chose may contain a colon: "ctl:PATH|manual".
  for (const char* check : {":POSITIVE", ":NONNEGATIVE", ":INT"}) {
    if (type.ends_with(check)) return type.substr(0, type.size() - std::string_view(check).size());
  }
  return type.starts_with(':') ? type.substr(1) : type;
}

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

}  // namespace

std::string typed_form(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true, false);
  if (option.get_items_expected() == 0 || option.get_type_size() == 0) return flag_names(option);
  const std::string value = value_name(option);
  std::string form = option.get_name(false, true);
  if (!value.empty()) form += " " + value;
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size) {
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
  if (option.get_type_size() != 0 && !option.get_default_str().empty())
    add("default: " + option.get_default_str());
  if (!option.get_needs().empty()) add("needs " + names_of(option.get_needs()));
  if (!option.get_excludes().empty()) add("not with " + names_of(option.get_excludes()));
  const std::string text = option.get_description();
  return facts.empty() ? text : text + (text.empty() ? "(" : " (") + facts + ")";
}

std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out, line;
  std::istringstream lines(text);
  while (std::getline(lines, line)) {
    if (!out.empty()) out += '\n';
    const auto first = line.find_first_not_of(' ');
    const std::size_t deep = std::max(indent, first == std::string::npos ? 0 : first);
    while (line.size() > kHelpColumns) {
      const auto space = line.rfind(' ', kHelpColumns);
      if (space == std::string::npos || space <= deep) break;  // one long word
      out += line.substr(0, space) + '\n';
      line = std::string(deep, ' ') + line.substr(space + 1);
    }
    out += line;
  }
  return out;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool) const {
  return two_columns(typed_form(*option), option_text(*option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* verb) const {
  return two_columns(verb->get_name(), verb->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(CLI::Formatter::make_description(app)) + "\n";
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  return wrapped(CLI::Formatter::make_usage(app, std::move(name)), 4) + "\n";
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  const std::string footer = app->get_footer();
  return footer.empty() ? "" : wrapped(footer) + "\n";
}

}  // namespace kaz::tools
