// The options --view, --view-wait and --pace.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/watch_options.h"

#include <cstdio>

#include "tools/base/interrupt_signals.h"
#include "tools/base/paths.h"
#include "tools/cli/options.h"
#include "tools/cli/view_observer.h"
#include "tools/monitor/terminal.h"
#include "tools/replay/recorded_backend.h"
#include "tools/viewer/player.h"
#include "tools/viewer/view.h"

namespace kaz::tools {
namespace {

Result<viewer::ViewOptions> view_of(const WatchArguments& arguments,
                                    const std::string& robot_file) {
  viewer::ViewOptions view;
  view.where = arguments.where;
  view.wait = arguments.wait;
  view.open = arguments.open;
  view.pace = arguments.pace;
  view.robot_path = robot_file.empty() ? KAZ_TRY(data_file("robot/kaz/kaz.urdf")) : robot_file;
  if (const auto page = view_page()) {
    view.page_folder = *page;
  } else {
    view.no_page = page.error().message;
    std::fprintf(stderr, "%s: %s\n", named_verb().c_str(), view.no_page.c_str());
  }
  view.stopped = [] { return received_signal() != 0; };
  return view;
}

void print_address(const std::string& label, const std::string& url) {
  std::fprintf(stderr, "%s: watch the run at %s\n", label.c_str(), url.c_str());
}

// A run that somebody had a hand in proves nothing by itself.
void print_acts(const std::string& label, const viewer::View& view) {
  if (const int acts = view.done_by_hand(); acts > 0)
    std::fprintf(stderr, "%s: %d manual action%s, recorded in the topic /hand\n", label.c_str(),
                 acts, acts == 1 ? "" : "s");
}

// Publishes the eyes' pictures of one episode.
class EpisodeView final : public RunObserver {
 public:
  explicit EpisodeView(std::unique_ptr<viewer::View> view) : view_(std::move(view)) {}
  void pair(const vision::StereoPair& pair) override { view_->picture(pair); }

 private:
  std::unique_ptr<viewer::View> view_;
};

}  // namespace

void add_watch_options(CLI::App& verb, WatchArguments& arguments, bool paced) {
  auto* view = verb.add_option_function<std::string>(
      "--view",
      [&arguments](const std::string& where) {
        arguments.view = true;
        arguments.where = where;
      },
      "serve a view for a browser or Foxglove at this address and port (default: 127.0.0.1:8765); "
      "open the printed URL, which contains the token");
  view->check(CLI::Validator(
      [](std::string& text) {
        return viewer::parse_where(text) ? std::string()
                                         : "give a port, or a numeric address and port, such as "
                                           "8765, 127.0.0.1:8765 or 0.0.0.0:8765";
      },
      ""));
  view->expected(0, 1)->type_name("[ADDRESS:]PORT")->trigger_on_parse();
  verb.add_flag("--view-wait", arguments.wait,
                "wait until the first viewer has subscribed to a channel")
      ->needs(view);
  verb.add_flag("--view-open", arguments.open,
                "let programs read all data without the token. Web pages of other servers, and "
                "programs that control the run, still need it")
      ->needs(view);
  if (!paced) return;
  verb.add_option("--pace", arguments.pace,
                  "with --view: maximum speed, as a multiple of real time (default: no limit)")
      ->check(between(0.01, 100))
      ->type_name("TIMES")
      ->needs(view);
}

Result<bool> run_watched(const WatchArguments& arguments, RunOptions run_options) {
  if (!arguments.view) {
    RunObserver nobody;
    return run(std::move(run_options), nobody);
  }
  const bool real = run_options.backend.at_port();
  if (real && arguments.pace > 0)
    return fail(
        Fault::usage,
        "--pace is not valid with a robot at a port, which runs in real time; leave --pace out");
  auto options = KAZ_TRY(view_of(arguments, run_options.backend.robot_file));
  options.recorded_pictures = run_options.backend.record_pictures;
  options.hands = !real;
  if (const auto behavior = behavior::find_behavior(run_options.behavior))
    options.requests = !real && behavior->takes_requests;
  const bool requests = options.requests;
  if (real) options.source = "robot";
  const auto view = KAZ_TRY(viewer::View::open(std::move(options)));
  print_address(run_options.label, view->url());
  // A board that waited for its host within the run would switch its motors off.
  if (real) view->wait();
  run_options.backend.tap = view.get();
  if (!real) run_options.backend.hands = view.get();
  if (requests) run_options.requests = [&view](Time) { return view->take_requests(); };
  ViewObserver observer(*view);
  const std::string label = run_options.label;
  auto ran = run(std::move(run_options), observer);
  print_acts(label, *view);
  return ran;
}

Result<bool> serve_watched(const WatchArguments& arguments, ServeOptions serve_options) {
  // What serve() refuses is refused before an address is printed.
  if (!arguments.view || serve_options.real_time.serial_path.empty())
    return serve(std::move(serve_options));
  auto options = KAZ_TRY(view_of(arguments, serve_options.backend.robot_file));
  options.recorded_pictures = serve_options.backend.record_pictures;
  options.joints_only = serve_options.backend.stand;
  options.hands = !serve_options.backend.stand;
  options.own_time = true;
  const auto view = KAZ_TRY(viewer::View::open(std::move(options)));
  print_address("kaz sim", view->url());
  view->wait();
  serve_options.backend.tap = view.get();
  if (!serve_options.backend.stand) serve_options.backend.hands = view.get();
  serve_options.real_time.on_pair = [&view](const vision::StereoPair& pair) {
    view->picture(pair);
  };
  serve_options.real_time.wants_pairs = [&view] { return view->wants_pictures(); };
  auto served = serve(std::move(serve_options));
  print_acts("kaz sim", *view);
  return served;
}

Result<ExitStatus> bench_watched(const WatchArguments& arguments, BenchOptions bench) {
  if (!arguments.view) return run_bench(bench);
  const bool real = !bench.target.port.empty();
  if (real && arguments.pace > 0)
    return fail(
        Fault::usage,
        "--pace is not valid with a board at a port, which runs in real time; leave --pace out");
  auto options = KAZ_TRY(view_of(arguments, ""));
  options.joints_only = true;
  if (real) options.source = "robot";
  const auto view = KAZ_TRY(viewer::View::open(std::move(options)));
  print_address("kaz bench", view->url());
  if (real) view->wait();
  bench.target.backend.tap = view.get();
  return run_bench(bench);
}

Result<bool> monitor_watched(const WatchArguments& arguments, MonitorOptions options) {
  if (!arguments.view) return monitor(options);
  KAZ_TRY(Terminal::check());
  auto view_options = KAZ_TRY(view_of(arguments, options.robot_file));
  view_options.source = "robot";
  const auto view = KAZ_TRY(viewer::View::open(std::move(view_options)));
  print_address("kaz monitor", view->url());
  options.watched_at = view->url();
  options.tap = view.get();
  return monitor(options);
}

// Each episode is a process of its own, which serves the page while it runs; the page connects to the
// next by itself. Of several at the same time that one is shown which came first.
Result<bool> evaluate_watched(const WatchArguments& arguments, CampaignOptions campaign) {
  if (!arguments.view) return run_campaign(campaign);
  if (campaign.realtime)
    return fail(Fault::usage,
                "--view is not valid with --realtime, because --realtime runs each episode in two "
                "separate processes; leave --view or --realtime out");
  auto options = KAZ_TRY(view_of(arguments, ""));
  options.token = viewer::make_token();
  {
    const auto where = KAZ_TRY(viewer::parse_where(options.where));
    if (where.port == 0)
      return fail(Fault::usage,
                  "--view: port 0 would select a new port for each episode; give a fixed port, "
                  "as in --view 8765");
    // Whether it can be served, and the address; the episodes take it over.
    print_address("kaz evaluate", KAZ_TRY(viewer::View::open(options))->url());
  }
  campaign.watch = [options](BackendOptions& backend) -> std::unique_ptr<RunObserver> {
    auto opened = viewer::View::open(options);
    if (!opened) return std::make_unique<RunObserver>();  // another episode has the port
    backend.tap = opened->get();
    return std::make_unique<EpisodeView>(std::move(*opened));
  };
  return run_campaign(campaign);
}

Result<void> play_recording(const WatchArguments& arguments, const std::string& file) {
  const auto recording = KAZ_TRY(sim::McapRecording::load_run(file));
  viewer::PlayOptions play;
  if (recording.facts.contains("port")) {  // no world is known
    play.view = KAZ_TRY(view_of(arguments, ""));
  } else {
    auto recorded = KAZ_TRY(recorded_backend(recording, file));
    find_beside(recorded.backend, file);
    play.view = KAZ_TRY(view_of(arguments, recorded.backend.robot_file));
  }
  play.on_open = [](const std::string& url) {
    print_address("kaz replay", url);
    std::fprintf(stderr, "kaz replay: press Ctrl-C to end the replay\n");
  };
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  return viewer::play(recording, play);
}

}  // namespace kaz::tools
