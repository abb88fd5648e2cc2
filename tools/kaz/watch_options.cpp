// The options --view, --view-wait and --pace.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/watch_options.h"

#include <cstdio>

#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/paths.h"
#include "tools/app/replay/recorded_backend.h"
#include "tools/kaz/options.h"
#include "tools/view/player.h"
#include "tools/view/view.h"

namespace kaz::tools {
namespace {

Result<watch::ViewOptions> view_of(const WatchArguments& arguments, const std::string& robot_file) {
  watch::ViewOptions view;
  view.where = arguments.where;
  view.wait = arguments.wait;
  view.pace = arguments.pace;
  view.robot_path = robot_file.empty() ? KAZ_TRY(data_file("robot/kaz/kaz.urdf")) : robot_file;
  if (const auto page = data_file("view/index.html"))
    view.page_folder = page->substr(0, page->rfind('/'));
  view.stopped = [] { return received_signal() != 0; };
  return view;
}

void print_address(const std::string& label, const std::string& url) {
  std::fprintf(stderr, "%s: watch it at %s\n", label.c_str(), url.c_str());
}

}  // namespace

void add_watch_options(CLI::App& verb, WatchArguments& arguments) {
  auto* view = verb.add_option_function<std::string>(
      "--view",
      [&arguments](const std::string& where) {
        arguments.view = true;
        arguments.where = where;
      },
      "show it in a browser, or in Foxglove, at this address and port (default: "
      "127.0.0.1:8765); of another address than this machine's own whoever looks needs the token "
      "that is printed");
  view->check(CLI::Validator(
      [](std::string& text) {
        return watch::parse_where(text) ? std::string()
                                        : "give a port, or address and port in numbers, as 8765, "
                                          "127.0.0.1:8765 or 0.0.0.0:8765";
      },
      ""));
  view->expected(0, 1)->type_name("[ADDRESS:]PORT")->trigger_on_parse();
  verb.add_flag("--view-wait", arguments.wait,
                "begin when the first viewer has subscribed to a channel")
      ->needs(view);
  verb.add_option("--pace", arguments.pace,
                  "with --view: simulated seconds in a second at most (default: as fast as it "
                  "goes; of a recording 1)")
      ->check(between(0.01, 100))
      ->type_name("TIMES")
      ->needs(view);
}

Result<bool> run_watched(const WatchArguments& arguments, SessionOptions session) {
  if (!arguments.view) return run_session(std::move(session));
  if (session.backend.robot != "sim")
    return fail(Fault::usage, "--view shows the virtual robot; leave it out with --robot " +
                                  session.backend.robot);
  auto options = KAZ_TRY(view_of(arguments, session.backend.robot_file));
  options.recorded_pictures = session.backend.record_pictures;
  const auto view = KAZ_TRY(watch::View::open(std::move(options)));
  print_address(session.label, view->url());
  session.backend.tap = view.get();
  session.on_pair = [&view](const vision::StereoPair& pair) { view->picture(pair); };
  return run_session(std::move(session));
}

Result<void> play_recording(const WatchArguments& arguments, const std::string& file) {
  const auto recording = KAZ_TRY(sim::McapRecording::load(file));
  auto recorded = KAZ_TRY(recorded_backend(recording, file));
  find_beside(recorded.backend, file);
  watch::PlayOptions play;
  play.view = KAZ_TRY(view_of(arguments, recorded.backend.robot_file));
  if (const auto world = world_file(recorded.backend.world)) play.world_path = *world;
  play.on_open = [](const std::string& url) {
    print_address("kaz replay", url);
    std::fprintf(stderr, "kaz replay: Ctrl-C ends it\n");
  };
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  return watch::play(recording, play);
}

}  // namespace kaz::tools
