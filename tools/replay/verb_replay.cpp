// `kaz replay`: runs a recording again and reports the first difference.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/arguments.h"
#include "tools/base/paths.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"
#include "tools/film/film.h"
#include "tools/replay/replay.h"

namespace kaz::tools {

void add_replay(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "replay",
      "repeat a recorded run of kaz run or kaz demo, and report the first difference "
      "from the recording");
  struct Arguments {
    ReplayOptions replay;
    std::vector<std::string> settings;
    bool host = false, whole = false;
    WatchArguments watch;
    FilmOptions film;
  };
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("FILE", arguments->replay.file, "recording.mcap of a run, or the run's folder")
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
      "Exit status: 0 the replay is identical, or the recording was played or filmed; 1 the replay "
      "is different.\n"
      "Examples:\n"
      "  kaz run search-ball --record-pictures --out seen\n"
      "  kaz replay seen/recording.mcap\n"
      "  kaz replay seen/recording.mcap --set seconds=1 --json\n"
      "  kaz replay seen/recording.mcap --whole\n"
      "  kaz replay seen/recording.mcap --view\n"
      "  kaz replay seen/recording.mcap --video seen.mp4");
  verb->callback([&action, arguments] {
    action = [arguments]() -> Result<ExitStatus> {
      arguments->replay.file = recording_of(arguments->replay.file);
      if (arguments->watch.view) {
        KAZ_TRY(play_recording(arguments->watch, arguments->replay.file));
        return ExitStatus();
      }
      if (!arguments->film.path.empty()) {
        FilmOptions& film = arguments->film;
        film.recording = arguments->replay.file;
        film.json = arguments->replay.json;
        if (arguments->watch.pace > 0) film.pace = arguments->watch.pace;
        KAZ_TRY(make_film(film));
        return ExitStatus();
      }
      if (arguments->watch.pace > 0)
        return fail(Fault::usage, "--pace is only valid with --view or --video; leave --pace out");
      const auto settings = KAZ_TRY(parse_settings(arguments->settings));
      arguments->replay.settings = settings;
      if (arguments->host) arguments->replay.mode = ReplayMode::host;
      if (arguments->whole) arguments->replay.mode = ReplayMode::whole;
      const auto identical = KAZ_TRY(replay(arguments->replay));
      return ExitStatus(identical);
    };
  });
}

}  // namespace kaz::tools
