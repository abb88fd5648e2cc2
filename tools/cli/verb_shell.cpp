// `kaz completion` and `kaz man`: made from the verbs and options that the program has.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "host/behavior/behavior.h"
#include "tools/base/output.h"
#include "tools/base/version.h"
#include "tools/cli/help.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {
namespace {

// The verb and all below it.
void each(CLI::App& app, const std::function<void(CLI::App&)>& visit) {
  visit(app);
  for (CLI::App* verb : app.get_subcommands(nullptr)) each(*verb, visit);
}

std::string joined(const std::vector<std::string>& words) {
  return CLI::detail::join(words, " ");
}

// The words in a type such as "h8|native" or "sim|PORT". Placeholders for other values have capital letters.
std::vector<std::string> choices(const CLI::Option& option) {
  std::vector<std::string> words = CLI::detail::split(option.get_type_name(), '|');
  std::erase_if(words, [](const std::string& word) {
    return word.empty() ||
           std::ranges::any_of(word, [](unsigned char c) { return std::isupper(c) != 0; });
  });
  return words;
}

// The words that a positional argument can be.
std::vector<std::string> words_of(const CLI::Option& positional) {
  std::vector<std::string> words = choices(positional);
  if (positional.get_name() == "BEHAVIOR") {
    for (const auto& behavior : behavior::behaviors()) words.emplace_back(behavior.name);
  }
  return words;
}

// Cases of shell code: what can follow a verb, and what an option of it.
struct Cases {
  std::string verbs, values;
  std::string known = "|";  // the verbs
};

Cases completion_cases(CLI::App& program) {
  Cases cases;
  each(program, [&cases](CLI::App& app) {
    const std::string verb = full_name(app);
    std::vector<std::string> words;
    for (const CLI::App* below : app.get_subcommands(nullptr)) words.push_back(below->get_name());
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_positional()) {
        for (const std::string& word : words_of(*option)) words.push_back(word);
      }
      const auto values = choices(*option);
      for (const std::string& name : option->get_lnames()) {
        words.push_back("--" + name);
        if (!values.empty())
          cases.values += "    '" + verb + " --" + name + "') values='" + joined(values) + "' ;;\n";
      }
    }
    cases.known += verb + "|";
    cases.verbs += "    '" + verb + "') words='" + joined(words) + "' ;;\n";
  });
  return cases;
}

std::string bash_completion(CLI::App& program) {
  const Cases cases = completion_cases(program);
  return "# bash completion of kaz, made by `kaz completion bash`.\n"
         "_kaz() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} verb=kaz words='' values='' i\n"
         "  local known='" +
         cases.known +
         "'\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    # Only verbs follow man and help, as after kaz itself.\n"
         "    case $i,${COMP_WORDS[i]} in 1,man|1,help) continue ;; esac\n"
         "    case $known in *\"|$verb ${COMP_WORDS[i]}|\"*) verb+=\" ${COMP_WORDS[i]}\" ;; esac\n"
         "  done\n"
         "  case $verb in\n" +
         cases.verbs +
         "  esac\n"
         "  case $current in\n"
         "    -*) ;;\n"
         "    *) words=${words//--*([^ ])/} ;;\n"
         "  esac\n"
         "  case \"$verb ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" +
         cases.values +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"${values:-$words}\" -- \"$current\"))\n"
         "}\n"
         "shopt -s extglob\n"
         "complete -o default -F _kaz kaz\n";
}

// Text for troff: no line of it may be taken for a request, no character for an escape.
std::string escaped(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_start = c == '\n';
  }
  return out;
}

std::string dashed(std::string name) {
  for (char& c : name) {
    if (c == ' ') c = '-';
  }
  return name;
}

void add_options(const CLI::App& app, std::string& page) {
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : app.get_options()) {
    page += ".TP\n.B " + escaped(typed_form(*option)) + "\n" + escaped(option_text(*option)) + "\n";
  }
}

// Sentences are wrapped, each line of `text` begins one.
std::string paragraphs(const std::string& text) {
  std::string out, line;
  std::istringstream lines(text);
  while (std::getline(lines, line)) out += ".br\n" + escaped(line) + "\n";
  return out;
}

// Lines as they are.
std::string as_typed(const std::string& text) {
  return ".nf\n" + escaped(text) + "\n.fi\n";
}

std::string man_page(CLI::App& app) {
  std::string upper = dashed(full_name(app));
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = ".TH " + upper + " 1 \"\" \"kaz " + kVersion + "\" \"Kaz\"\n";
  // The first sentence is for whatis(1).
  const std::string text = app.get_description();
  const auto end = text.find(". ");
  page += ".SH NAME\n" + escaped(dashed(full_name(app)) + " - " + text.substr(0, end)) + "\n";
  page += ".SH SYNOPSIS\n" + escaped(HelpFormatter().make_usage(&app, full_name(app)));
  const Footer footer = footer_of(app);
  page += ".SH DESCRIPTION\n";
  if (end != std::string::npos) page += escaped(text.substr(end + 2)) + ".\n.PP\n";
  page += paragraphs(footer.notes);
  add_options(app, page);
  if (!app.get_subcommands(nullptr).empty()) {
    page += ".SH VERBS\n";
    for (const CLI::App* verb : app.get_subcommands(nullptr)) {
      page += ".TP\n.B " + verb->get_name() + "\n" + escaped(verb->get_description()) + "\n";
    }
  }
  return page + ".SH EXAMPLES\n" + as_typed(footer.examples);
}

}  // namespace

void add_shell(CLI::App& program, Action& action) {
  auto* completion =
      program.add_subcommand("completion", "print the completion script for a shell");
  auto shell = std::make_shared<std::string>();
  completion->add_option("SHELL", *shell, "name of the shell: bash")
      ->required()
      ->check(CLI::IsMember({"bash"}).description(""))
      ->type_name("bash");
  completion->footer("Examples:\n  source <(kaz completion bash)");
  completion->callback([&program, &action, shell] {  // which CLI11 writes to until then
    action = [&program]() -> Result<ExitStatus> {
      std::fputs(bash_completion(program).c_str(), stdout);
      return true;
    };
  });

  auto* man =
      program.add_subcommand("man", "print the manual page of a verb, in the format of man(1)");
  auto verb = std::make_shared<std::vector<std::string>>();
  man->add_option("VERB", *verb, "verb, such as mcu run (default: the program itself)")
      ->type_name("");
  man->footer("Examples:\n  kaz man | man -l -\n  kaz man mcu run | man -l -");
  man->callback([&program, &action, verb] {
    action = [&program, verb]() -> Result<ExitStatus> {
      CLI::App* app = &program;
      for (const std::string& word : *verb) {
        const auto verbs =
            app->get_subcommands([&word](CLI::App* a) { return a->get_name() == word; });
        app = verbs.empty() ? nullptr : verbs.front();
        if (app == nullptr) {
          return fail(Fault::usage, "there is no verb `" + joined(*verb) + "`; see `kaz --help`");
        }
      }
      std::fputs(man_page(*app).c_str(), stdout);
      return true;
    };
  });
}

}  // namespace kaz::tools
