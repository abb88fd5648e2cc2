// `kaz completion` and `kaz man`: made from the verbs and options that the program has.
// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/app/base/output.h"
#include "tools/app/base/version.h"
#include "tools/kaz/help.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

// "kaz mcu run" for a verb of a verb.
std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name()
                                     : full_name(*app.get_parent()) + " " + app.get_name();
}

// The verb and all below it.
void each(CLI::App& app, const std::function<void(CLI::App&)>& visit) {
  visit(app);
  for (CLI::App* verb : app.get_subcommands(nullptr)) each(*verb, visit);
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string bash_completion(CLI::App& program) {
  std::string cases, known = "|";
  each(program, [&](CLI::App& app) {
    std::vector<std::string> words;
    for (const CLI::App* verb : app.get_subcommands(nullptr)) words.push_back(verb->get_name());
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    }
    known += full_name(app) + "|";
    cases += "    '" + full_name(app) + "') words='" + joined(words) + "' ;;\n";
  });
  return "# bash completion of kaz, made by `kaz completion bash`.\n"
         "_kaz() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} verb=kaz words='' i\n"
         "  local known='" +
         known +
         "'\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case $known in *\"|$verb ${COMP_WORDS[i]}|\"*) verb+=\" ${COMP_WORDS[i]}\" ;; esac\n"
         "  done\n"
         "  case $verb in\n" +
         cases +
         "  esac\n"
         "  case $current in\n"
         "    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$current\")) ;;\n"
         "    *) COMPREPLY=($(compgen -W \"${words//--*([^ ])/}\" -- \"$current\")) ;;\n"
         "  esac\n"
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

std::string man_page(CLI::App& app) {
  std::string upper = dashed(full_name(app));
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = ".TH " + upper + " 1 \"\" \"kaz " + kVersion + "\" \"Kaz\"\n";
  page += ".SH NAME\n" + escaped(dashed(full_name(app)) + " - " + app.get_description()) + "\n";
  page += ".SH SYNOPSIS\n.B " + full_name(app) + "\n";
  page += app.get_subcommands(nullptr).empty() ? "[OPTIONS]\n" : "VERB [OPTIONS]\n";
  add_options(app, page);
  if (!app.get_subcommands(nullptr).empty()) {
    page += ".SH VERBS\n";
    for (const CLI::App* verb : app.get_subcommands(nullptr)) {
      page += ".TP\n.B " + verb->get_name() + "\n" + escaped(verb->get_description()) + "\n";
    }
  }
  return page + ".SH NOTES\n.nf\n" + escaped(app.get_footer()) + "\n.fi\n";
}

}  // namespace

void add_shell(CLI::App& program, Action& action) {
  auto* completion = program.add_subcommand("completion", "print completion for a shell");
  auto shell = std::make_shared<std::string>();
  completion->add_option("SHELL", *shell, "bash")
      ->required()
      ->check(CLI::IsMember({"bash"}).description(""))
      ->type_name("");
  completion->footer("Examples:\n  source <(kaz completion bash)");
  completion->callback([&program, &action] {
    action = [&program]() -> Result<Outcome> {
      std::fputs(bash_completion(program).c_str(), stdout);
      return true;
    };
  });

  auto* man = program.add_subcommand("man", "print the manual page of a verb, as man(1) reads it");
  auto verb = std::make_shared<std::vector<std::string>>();
  man->add_option("VERB", *verb, "such as: mcu run; of the program itself if not given")
      ->type_name("");
  man->footer("Examples:\n  kaz man | man -l -\n  kaz man mcu run | man -l -");
  man->callback([&program, &action, verb] {
    action = [&program, verb]() -> Result<Outcome> {
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
