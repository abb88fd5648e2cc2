// `kaz`: the command line.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "shared/base/one_line.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/provenance.h"
#include "tools/app/base/version.h"
#include "tools/kaz/help.h"
#include "tools/kaz/verbs.h"

namespace {

constexpr int kUsage = static_cast<int>(kaz::Fault::usage);

// The verb that was given, for messages: "kaz mcu run".
std::string spoken_name(const CLI::App& program) {
  std::string name = "kaz";
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    name += " " + app->get_name();
  }
  return name;
}

// A first word that is no verb, which the parser would report as a missing one; empty if there is none.
std::string unknown_verb(const CLI::App& program, int argc, char** argv) {
  const CLI::App* app = &program;
  for (int i = 1; i < argc && !app->get_subcommands(nullptr).empty() && argv[i][0] != '-'; ++i) {
    const CLI::App* next = nullptr;
    for (const CLI::App* verb : app->get_subcommands(nullptr)) {
      if (verb->get_name() == argv[i]) next = verb;
    }
    if (next == nullptr) {
      const bool takes_words = std::ranges::any_of(
          app->get_options(), [](const CLI::Option* option) { return option->get_positional(); });
      return takes_words ? "" : argv[i];
    }
    app = next;
  }
  return "";
}

// One line, whatever names from files and ports the message contains. Diagnostics of flashing have indented
// lines of their own (host/flash/diagnostic.h).
std::string printed(const std::string& name, const std::string& message) {
  std::string text;
  for (std::size_t from = 0; from <= message.size();) {
    std::size_t end = message.size();
    if (name.starts_with("kaz flash")) end = std::min(message.find("\n  ", from), end);
    text +=
        (from == 0 ? "" : "\n") + kaz::one_line(std::string_view(message).substr(from, end - from));
    from = end + 1;
  }
  return text;
}

int report(const std::string& name, const kaz::Error& error) {
  std::fprintf(stderr, "%s: %s\n", name.c_str(), printed(name, error.message).c_str());
  return kaz::tools::exit_status(error);
}

int parse_and_run(int argc, char** argv) {
  kaz::tools::set_command_line(argc, argv);
  CLI::App program(
      "Kaz: a desktop humanoid with stereo eyes, real or virtual. What runs against the virtual "
      "robot runs on\nthe real one unchanged: both speak the same bytes on the same kind of line.");
  program.name("kaz");
  program.set_version_flag("--version", std::string("kaz ") + kaz::tools::kVersion);
  program.require_subcommand(1);
  program.formatter(std::make_shared<kaz::tools::HelpFormatter>());  // its verbs inherit it
  kaz::tools::Action action;
#define KAZ_VERB(name) kaz::tools::add_##name(program, action);
#include "tools/kaz/verbs.def"
#undef KAZ_VERB
  // After the verbs, which would inherit it.
  program.footer(
      "Examples:\n"
      "  kaz demo                              search and track the ball, leave pictures\n"
      "  kaz sim --world ball --serial board --cameras board.eyes\n"
      "  kaz run track-ball --robot serial:board --camera board.eyes\n"
      "  kaz replay kaz-demo/recording.mcap    run it again and print the first difference\n"
      "Recordings are MCAP files: Foxglove (foxglove.dev), PlotJuggler and the mcap command line "
      "open "
      "them.\n"
      "Exit status: 0 done, 1 the task failed, 2 wrong usage, 3 the environment failed, 130 ended "
      "by "
      "Ctrl-C,\n143 by SIGTERM; what there was by then is kept (docs/reference/exit-status.md).\n"
      "`kaz VERB --help` says more about a verb.");
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return program.exit(success);
  } catch (const CLI::ParseError& wrong) {
    const std::string name = spoken_name(program);
    const std::string verb = unknown_verb(program, argc, argv);
    const std::string what = verb.empty() ? wrong.what() : "there is no verb `" + verb + "`";
    std::fprintf(stderr, "%s: %s; see `%s --help`\n", name.c_str(), kaz::one_line(what).c_str(),
                 name.c_str());
    return kUsage;
  }
  const kaz::Result<kaz::tools::Outcome> done = action();
  if (!done) return report(spoken_name(program), done.error());
  return done->status;
}

}  // namespace

int main(int argc, char** argv) {
  kaz::tools::catch_signals();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of size is an error of write(), as a full disk is
  try {
    return parse_and_run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kaz: %s\n", kaz::one_line(error.what()).c_str());
    return static_cast<int>(kaz::Fault::environment);
  }
}
