// `kaz replay`: runs a recording or a CAN log again and reports the differences.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/arguments.h"
#include "tools/base/paths.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"
#include "tools/film/film.h"
#include "tools/replay/replay.h"
#include "tools/replay/replay_can.h"

namespace kaz::tools {
namespace {

struct ReplayArguments {
  ReplayOptions replay;
  std::vector<std::string> settings;
  std::string robot = "sim";
  bool host = false, whole = false;
  WatchArguments watch;
  FilmOptions film;
};

// Options for recordings of runs. The other options are also valid with a CAN log.
constexpr const char* kOnlyRecordings[] = {"--host", "--whole", "--set", "--plugin",
                                           "--view", "--video", "--pace"};

Result<bool> replay_can_log(const CLI::App& verb, const ReplayOptions& replay,
                            const std::string& robot) {
  for (const char* const option : kOnlyRecordings) {
    if (verb.get_option(option)->count() > 0)
      return fail(Fault::usage, std::string(option) + " is not valid with a CAN log: leave out " +
                                    option + ", or give the recording of a run");
  }
  ReplayCanOptions options{replay.file, {}, replay.json};
  options.backend.robot = robot;
  options.backend.needs_camera = false;
  if (replay.seed) options.backend.seed = *replay.seed;
  return replay_can(options);
}

Result<ExitStatus> run_replay(ReplayArguments& arguments, const CLI::App& verb) {
  ReplayOptions& options = arguments.replay;
  if (names_can_log(options.file)) {
    const bool same = KAZ_TRY(replay_can_log(verb, options, arguments.robot));
    return ExitStatus(same);
  }
  if (verb.get_option("--robot")->count() > 0)
    return fail(Fault::usage, "--robot is only valid with a CAN log (*.log); leave out --robot");
  options.file = recording_of(options.file);
  if (arguments.watch.view) {
    KAZ_TRY(play_recording(arguments.watch, options.file));
    return ExitStatus();
  }
  if (!arguments.film.path.empty()) {
    FilmOptions& film = arguments.film;
    film.recording = options.file;
    film.json = options.json;
    if (arguments.watch.pace > 0) film.pace = arguments.watch.pace;
    KAZ_TRY(make_film(film));
    return ExitStatus();
  }
  if (arguments.watch.pace > 0)
    return fail(Fault::usage, "--pace is only valid with --view or --video; leave --pace out");
  options.settings = KAZ_TRY(parse_settings(arguments.settings));
  if (arguments.host) options.mode = ReplayMode::host;
  if (arguments.whole) options.mode = ReplayMode::whole;
  const auto identical = KAZ_TRY(replay(options));
  return ExitStatus(identical);
}

}  // namespace

void add_replay(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "replay",
      "repeat a recorded run of kaz run or kaz demo, or a CAN log, and report the differences "
      "from the recording");
  auto arguments = std::make_shared<ReplayArguments>();
  verb->add_option("FILE", arguments->replay.file,
                   "recording.mcap of a run, or the run's folder; or a log of `candump -l` (*.log)")
      ->required()
      ->type_name("");
  auto* host = verb->add_flag("--host", arguments->host,
                              "run only the host again. The host receives the board's recorded "
                              "bytes and the recorded pictures. --host is the default, unless the "
                              "behavior needs pictures that the recording does not contain");
  verb->add_flag("--whole", arguments->whole,
                 "run the host and the simulation again from the seed, and compare all new "
                 "messages with the recorded messages. --whole is the default if the behavior "
                 "needs pictures that the recording does not contain")
      ->excludes(host);
  verb->add_option("--seed", arguments->replay.seed,
                   "seed for the new run, instead of the seed in the recording; implies --whole")
      ->transform(whole_number());
  verb->add_option("--robot", arguments->robot,
                   "for a CAN log: the virtual robot (sim), or a board's port, such as can:can0")
      ->type_name("KIND:PATH")
      ->capture_default_str();
  add_settings(*verb, arguments->settings, "for the new run, change an option of the behavior");
  verb->add_option("--plugin", arguments->replay.plugin,
                   "plug-in file, if the behavior of the run is a plug-in; a recording does not "
                   "contain the plug-in")
      ->type_name("FILE");
  add_watch_options(*verb, arguments->watch);
  auto* view = verb->get_option("--view");
  auto* video = verb->add_option("--video", arguments->film.path,
                                 "make a film of the recording with the program ffmpeg: FILE.mp4, "
                                 "FILE.webm, FILE.webp or FILE.gif")
                    ->type_name("FILE")
                    ->excludes(view);
  verb->add_option("--video-fps", arguments->film.fps,
                   "frames per second of the film (default: 30; 10 for .webp and .gif)")
      ->check(between(1, 60))
      ->needs(video);
  auto* pace = verb->get_option("--pace");
  pace->remove_needs(view);
  pace->description("with --view or --video: speed, as a multiple of real time (default: 1)");
  for (const char* option : {"--host", "--whole", "--seed", "--set", "--plugin"}) {
    view->excludes(verb->get_option(option));
    video->excludes(verb->get_option(option));
  }
  verb->add_flag("--json", arguments->replay.json, "print the result as JSON on standard output")
      ->excludes("--view");  // which has no result
  verb->footer(
      "With --host, Kaz runs the behavior, the vision and the protocol again. Kaz then checks "
      "whether the host sends the same bytes as in the recording. Kaz reports the time of the "
      "first difference, the position of the first difference in the stream of bytes, and the "
      "message with the first difference. Use --host to test changed host programs with the "
      "recorded data of a virtual robot.\n"
      "With --view or --video, Kaz only shows the recording, and does not repeat the run. --view "
      "plays the recording until Ctrl-C; the page has controls to pause and jump. --video draws "
      "the film from the recorded poses.\n"
      "With a CAN log, Kaz sends the log's requests at their times, including requests that move "
      "joints or write flash. Kaz compares the answers with the log; measured values, such as "
      "angles, do not count as differences. At a port, the motors are switched off at the end.\n"
      "Exit status: 0 the replay is identical, or the recording was played or filmed; 1 the replay "
      "is different.\n"
      "Examples:\n"
      "  kaz run search-ball --record-pictures --out seen\n"
      "  kaz replay seen/recording.mcap\n"
      "  kaz replay seen/recording.mcap --set seconds=1 --json\n"
      "  kaz replay seen/recording.mcap --whole\n"
      "  kaz replay seen/recording.mcap --view\n"
      "  kaz replay seen/recording.mcap --video seen.mp4\n"
      "  candump -l can0   # then kaz replay candump-*.log --robot can:can0");
  verb->callback([&action, arguments, verb] {
    action = [arguments, verb] { return run_replay(*arguments, *verb); };
  });
}

}  // namespace kaz::tools
