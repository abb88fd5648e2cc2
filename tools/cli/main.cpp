// `kaz`: the command line.
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/base/version.h"
#include "tools/cli/help.h"
#include "tools/cli/verbs.h"
#include "tools/cli/wrong_usage.h"

namespace {

constexpr int kUsage = static_cast<int>(kaz::Fault::usage);

int report(const std::string& name, const kaz::Error& error) {
  // The message may contain names from files and ports, with line breaks.
  const kaz::Error printed{.message = kaz::one_line(error.message), .details = error.details};
  std::fprintf(stderr, "%s: %s\n", name.c_str(), kaz::full_text(printed).c_str());
  return kaz::tools::exit_status(error);
}

// What reads the results of --json gets an object, too, where there is no result.
void report_json(CLI::App& verb, const kaz::Error& error) {
  const CLI::Option* json = verb.get_option_no_throw("--json");
  if (json == nullptr || json->count() == 0 || kaz::tools::json_printed()) return;
  if (json->get_expected_max() > 0) return;  // names a file, whose report has its own end
  kaz::tools::print_json({{"error", kaz::full_text(error)},
                          {"exit_code", kaz::tools::exit_status(error)},
                          {"provenance", kaz::tools::provenance_json()}});
}

// As the parser takes them: the last first. `kaz help VERB` is `kaz VERB --help`.
std::vector<std::string> reversed_words(int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  std::ranges::reverse(words);
  return words;
}

int parse_and_run(int argc, char** argv) {
  kaz::tools::set_command_line(argc, argv);
  CLI::App program(
      "a desktop humanoid with stereo eyes, real or virtual. Programs for the virtual robot run "
      "unchanged on the real robot, because both robots use the same protocol on the same kind of "
      "port");
  program.name("kaz");
  program.set_help_flag("-h,--help", "print this help");  // its verbs inherit it
  program.set_version_flag("--version", std::string("kaz ") + kaz::tools::kVersion,
                           "print the version");
  program.require_subcommand(1);
  program.group("Verbs");  // the heading of their list
  // CLI11 accepts any number above 0, and some words, as the value of a flag.
  program.option_defaults()->disable_flag_override();
  program.formatter(std::make_shared<kaz::tools::HelpFormatter>());  // its verbs inherit it
  kaz::tools::Action action;
#define KAZ_VERB(name, folder) kaz::tools::add_##name(program, action);
#include "tools/cli/verbs.def"
#undef KAZ_VERB
  // After the verbs, which would inherit it.
  program.footer(
      "Recordings are MCAP files. Foxglove (foxglove.dev), PlotJuggler and the command mcap can "
      "open these files.\n"
      "`kaz VERB --help` or `kaz help VERB` describes a verb.\n"
      "Exit status: 1 the task failed, 3 the environment failed (docs/reference/output.md), 128 + "
      "the signal number if a signal ended the program, such as 130 after Ctrl-C. These "
      "commands return 0 after Ctrl-C, not 130: `kaz sim`, `kaz monitor`, `kaz serve-port`, `kaz "
      "can-bridge` and `kaz replay --view`\n"
      "Examples:\n"
      "  kaz demo                              # find and track the ball, write pictures\n"
      "  kaz sim --world ball --serial board --cameras board.eyes\n"
      "  kaz run track-ball --robot serial:board --camera board.eyes\n"
      "  kaz replay kaz-demo/recording.mcap    # run the recording again, print the first "
      "difference");
  const auto refuse = [&program](const std::string& what) {
    const std::string name = kaz::tools::full_name(kaz::tools::chosen_verb(program));
    std::fprintf(stderr, "%s: %s%s `%s --help`\n", name.c_str(), kaz::one_line(what).c_str(),
                 what.ends_with('?') ? " See" : "; see", name.c_str());
    return kUsage;
  };
  kaz::tools::set_command_words({argv + 1, argv + argc});
  try {
    program.parse(reversed_words(argc, argv));
  } catch (const CLI::Success& success) {  // --help, --version
    kaz::tools::name_verb(kaz::tools::full_name(kaz::tools::chosen_verb(program)));
    const std::string unknown = kaz::tools::unknown_words(program);
    if (!unknown.empty()) return refuse(unknown);
    return program.exit(success);
  } catch (const CLI::ParseError& wrong) {
    if (argc < 2) {  // somebody's first look: what there is
      std::fputs(program.help().c_str(), stderr);
      return kUsage;
    }
    return refuse(kaz::tools::wrong_usage(program, wrong));
  }
  const std::string name = kaz::tools::full_name(kaz::tools::chosen_verb(program));
  kaz::tools::name_verb(name);
  if (const std::string empty = kaz::tools::empty_value(program); !empty.empty())
    return refuse(empty);
  const kaz::Result<kaz::tools::ExitStatus> done = action();
  if (!done) {
    const kaz::Error error = kaz::tools::with_saved_files(done.error());
    report_json(kaz::tools::chosen_verb(program), error);
    return report(name, error);
  }
  return done->status;
}

// Files that are opened do not take the place of standard streams that are closed.
void open_standard_streams() {
  int fd = 0;
  while (fd >= 0 && fd <= STDERR_FILENO) fd = open("/dev/null", O_RDWR);
  if (fd > STDERR_FILENO) close(fd);
}

// The status of a program that has printed its results. A reader that has seen enough is no error.
int printed_status(int status) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  // Of an earlier write's error errno is gone: one more write has the same.
  const bool written = errno == 0 && ::write(STDOUT_FILENO, "\n", 1) == 1;
  const int error = written || errno == 0 ? EIO : errno;
  pollfd reader{STDOUT_FILENO, POLLOUT, 0};
  const bool gone = poll(&reader, 1, 0) == 1 && (reader.revents & POLLERR) != 0;
  constexpr int kFailed = static_cast<int>(kaz::Fault::failed);
  if (gone || status > kFailed) return status;
  return report(kaz::tools::named_verb(),
                kaz::write_failure("standard output", "write", error).value());
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  kaz::tools::catch_signals();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of size is an error of write(), as a full disk is
  try {
    return printed_status(parse_and_run(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", kaz::tools::named_verb().c_str(),
                 kaz::one_line(error.what()).c_str());
    return static_cast<int>(kaz::Fault::environment);
  }
}
