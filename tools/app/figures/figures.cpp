// Runs what the figures need, draws them, and writes them down.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/figures.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "host/behavior/behavior.h"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/output.h"
#include "tools/app/base/paths.h"
#include "tools/app/base/provenance.h"
#include "tools/app/figures/drawn.h"
#include "tools/app/figures/page.h"
#include "tools/app/figures/run_collector.h"
#include "tools/app/replay/recorded_backend.h"
#include "tools/app/replay/replay.h"
#include "tools/app/session/session.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLabel = "kaz figures";
constexpr int kScene = 3, kSetup = 5, kMap = 6, kFrames = 7, kCatch = 8;

// What is run where nothing else is given.
struct Run {
  std::string behavior, world;
  std::map<std::string, std::string> settings;
  std::set<int> figures;  // that are drawn of it
};

std::string joined(const std::set<int>& numbers) {
  std::string text;
  for (const int number : numbers) text += (text.empty() ? "" : ",") + std::to_string(number);
  return text;
}

const OutputKind& figures_output() {
  static const OutputKind kind = [] {
    OutputKind made{"figures", {"figures.html", "result.json"}};
    for (const int number : figure_numbers()) {
      for (const char* ending : {".png", ".jpg"})
        made.files.push_back("figure" + std::to_string(number) + ending);
    }
    return made;
  }();
  return kind;
}

// The figures that a run of this behavior shows.
std::set<int> shown_by(const std::string& behavior) {
  if (behavior == "navigate") return {kScene, kSetup, kMap};
  if (behavior == "catch-ball") return {kScene, kSetup, kCatch};
  if (behavior == "track-ball" || behavior == "search-ball") return {kScene, kSetup};
  return {};
}

// The figures to draw of a recording. Errors (usage): it is none, or shows none of those that are wanted.
Result<std::set<int>> figures_of(const FiguresOptions& options, const std::string& behavior) {
  const std::set<int> shown = shown_by(behavior);
  if (shown.empty())
    return fail(Fault::usage,
                options.recording + ": a run of " + behavior +
                    " contains none of the figures; give a run of track-ball, navigate "
                    "or catch-ball");
  if (options.only.empty()) {
    // The scene of a walk is there only if the ball was in view.
    std::set<int> all = shown;
    if (behavior == "navigate") all.erase(kScene);
    return all;
  }
  for (const int number : options.only) {
    if (number == kFrames)
      return fail(Fault::usage,
                  "figure 7 cannot be drawn from a recording: leave out --recording, or remove 7 "
                  "from --only");
    if (!shown.contains(number))
      return fail(Fault::usage, options.recording + ": a run of " + behavior +
                                    " does not contain figure " + std::to_string(number) +
                                    ", only " + joined(shown));
  }
  return options.only;
}

RunCollector::Wanted wanted_for(const std::set<int>& figures) {
  return {figures.contains(kScene), figures.contains(kSetup), figures.contains(kMap),
          figures.contains(kCatch)};
}

class Figures {
 public:
  Figures(const FiguresOptions& options, const OutputFolder& folder)
      : options_(options), folder_(folder), signals_(interrupt_) {}

  Result<bool> make(const std::vector<Run>& runs, bool sweep) {
    const auto made = make_all(runs, sweep);
    const bool interrupted = !made && made.error().fault == Fault::interrupted;
    if (!made && !interrupted) return tl::unexpected(made.error());
    KAZ_TRY(write_result(interrupted));
    if (interrupted)
      return fail(Fault::interrupted,
                  made.error().message + "; completed figures: " +
                      (result_["figures"].empty() ? std::string("none") : "in " + options_.out));
    return success_;
  }

 private:
  Result<void> make_all(const std::vector<Run>& runs, bool sweep) {
    for (const Run& run : runs) {
      // In the order of their numbers.
      if (sweep && *run.figures.begin() > kFrames) {
        KAZ_TRY(make_sweep());
        sweep = false;
      }
      KAZ_TRY(make_run(run));
    }
    return sweep ? make_sweep() : Result<void>();
  }

  // A signal that came between runs, or while a figure was drawn.
  Result<void> check_interrupt() {
    if (!interrupt_.requested() && received_signal() == 0) return {};
    return fail(Fault::interrupted, "interrupted");
  }

  Result<void> make_run(const Run& run) {
    RunCollector collector(wanted_for(run.figures));
    Json facts{{"behavior", run.behavior}};
    const auto listen = [&](SessionOptions& session) {
      collector.listen(session);
      session.on_end = [&](const Result<behavior::Outcome>& outcome, double run_s, double) {
        facts["outcome"] = outcome && outcome->success ? "done" : "failed";
        facts["sentence"] = outcome ? outcome->sentence : outcome.error().message;
        facts["duration_s"] = std::round(1000 * run_s) / 1000;
      };
    };
    const auto succeeded = KAZ_TRY(options_.recording.empty() ? run_anew(run, listen, facts)
                                                              : run_again(listen, facts));
    if (!succeeded) {
      success_ = false;
      say(run.behavior + " did not succeed: " + facts.value("sentence", std::string()));
    }
    result_["runs"].push_back(facts);
    KAZ_TRY(check_interrupt());
    if (collector.error()) return tl::unexpected(*collector.error());
    for (const int number : run.figures)
      KAZ_TRY(place(number, run.behavior, draw(number, collector)));
    return {};
  }

  Result<bool> run_anew(const Run& run, const std::function<void(SessionOptions&)>& listen,
                        Json& facts) {
    SessionOptions session;
    session.backend = options_.backend;
    session.backend.world = run.world;
    session.behavior = run.behavior;
    session.settings = run.settings;
    session.out = folder_.path(run.behavior);
    session.quiet = true;
    session.json = options_.json;
    session.label = kLabel;
    listen(session);
    facts["world"] = run.world;
    facts["folder"] = run.behavior;
    return run_session(std::move(session));
  }

  Result<bool> run_again(const std::function<void(SessionOptions&)>& listen, Json& facts) {
    ReplayOptions replayed;
    replayed.file = options_.recording;
    replayed.mode = ReplayMode::whole;
    replayed.quiet = true;
    replayed.json = options_.json;
    replayed.label = kLabel;
    replayed.on_session = listen;
    facts["recording"] = options_.recording;
    const auto identical = KAZ_TRY(replay(replayed));
    if (!identical)
      return fail(
          Fault::failed,
          options_.recording +
              ": the run now differs from the recording, for example because of another version of "
              "Kaz (`kaz replay` prints the first difference); record the run again");
    return facts.value("outcome", std::string()) == "done";
  }

  static Result<DrawnFigure> draw(int number, const RunCollector& collector) {
    switch (number) {
      case kScene:
        return draw_scene(collector);
      case kSetup:
        return draw_setup(collector);
      case kMap:
        return draw_map_and_path(collector);
      default:
        return draw_catch(collector);
    }
  }

  Result<void> make_sweep() {
    figure7::Options sweep;
    sweep.world = KAZ_TRY(world_file(options_.yard));
    const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
    sweep.robot_folder = std::filesystem::path(robot).parent_path().string();
    sweep.mcu = options_.backend.mcu;
    if (sweep.mcu == sim::McuKind::h8)
      sweep.image_path = KAZ_TRY(firmware_image(options_.backend.image));
    else if (!options_.backend.image.empty())
      return fail(Fault::usage,
                  "--image is only valid with --mcu h8: native has no firmware image");
    if (options_.backend.eye_width != 0) sweep.eye_width = options_.backend.eye_width;
    sweep.eyes = options_.backend.eyes;
    sweep.renderer = options_.backend.renderer;
    sweep.sensors = options_.backend.sensors;
    sweep.seed = options_.backend.seed;
    sweep.interrupt = &interrupt_;
    Progress progress(kLabel, options_.json);
    sweep.on_time = [&](Time now, Time end) {
      progress.update(seconds(now) / seconds(end), "looking around with slow vision");
    };
    const auto swept = figure7::sweep(sweep);
    if (swept) progress.update(1, "done");
    progress.done();
    if (!swept && interrupt_.requested()) return check_interrupt();
    if (!swept) return tl::unexpected(swept.error());
    result_["runs"].push_back(
        {{"behavior", "sweep"}, {"outcome", "done"}, {"world", options_.yard}});
    return place(kFrames, "sweep", draw_frame_information(*swept, sweep));
  }

  // A figure that could not be drawn is none of the others' fault.
  Result<void> place(int number, const std::string& run, Result<DrawnFigure> drawn) {
    const std::string name = "figure" + std::to_string(number);
    if (!drawn && drawn.error().fault == Fault::failed) {
      success_ = false;
      result_["not_drawn"][std::to_string(number)] = drawn.error().message;
      say(drawn.error().message);
      return {};
    }
    if (!drawn) return tl::unexpected(drawn.error());
    // Between what takes tenths of a second each.
    KAZ_TRY(check_interrupt());
    KAZ_TRY(figure::write_png(folder_.path(name + ".png"), drawn->picture));
    KAZ_TRY(check_interrupt());
    KAZ_TRY(figure::write_jpeg(folder_.path(name + ".jpg"), drawn->picture));
    Json& facts = result_["figures"][std::to_string(number)];
    facts = {{"file", name + ".png"}, {"run", run}};
    facts.update(drawn->numbers);
    say(name + ".png: " + paper_caption(number));
    return check_interrupt();
  }

  Result<void> write_result(bool interrupted) {
    result_["outcome"] = interrupted ? "interrupted" : success_ ? "done" : "failed";
    result_["seed"] = options_.backend.seed;
    if (interrupted) mark_interrupted(result_);
    result_["provenance"] = provenance_json();
    KAZ_TRY(folder_.write("figures.html", figures_page(result_)));
    KAZ_TRY(folder_.write_json("result.json", result_));
    if (options_.json) {
      print_json(result_);
    } else if (!interrupted) {
      std::printf("figures, figures.html and result.json are in %s\n", options_.out.c_str());
    }
    return {};
  }

  void say(const std::string& sentence) const {
    if (!options_.json) std::printf("%s\n", sentence.c_str());
  }

  const FiguresOptions& options_;
  const OutputFolder& folder_;
  host::Interrupt interrupt_;
  InterruptSignals signals_;
  bool success_ = true;
  Json result_{{"outcome", ""}, {"figures", Json::object()}, {"runs", Json::array()}};
};

// Of the figures wanted, what has to be run.
std::vector<Run> runs_for(const FiguresOptions& options, const std::set<int>& wanted) {
  // 8 s of tracking: by then the ball has been flicked over the floor and into the air.
  const Run all[] = {{"track-ball", "ball", {{"seconds", "8"}}, {kScene}},
                     {"navigate", options.backend.world, {{"goal", options.goal}}, {kSetup, kMap}},
                     {"catch-ball", "catch", {}, {kCatch}}};
  std::vector<Run> runs;
  for (Run run : all) {
    std::erase_if(run.figures, [&](int number) { return !wanted.contains(number); });
    if (!run.figures.empty()) runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

const std::set<int>& figure_numbers() {
  static const std::set<int> numbers{kScene, kSetup, kMap, kFrames, kCatch};
  return numbers;
}

Result<bool> make_figures(const FiguresOptions& options) {
  const std::set<int>& wanted = options.only.empty() ? figure_numbers() : options.only;
  std::vector<Run> runs;
  bool sweep = false;
  if (options.recording.empty()) {
    runs = runs_for(options, wanted);
    sweep = wanted.contains(kFrames);
    for (const Run& run : runs) {
      KAZ_TRY(world_file(run.world));
      const auto behavior = KAZ_TRY(behavior::find_behavior(run.behavior));
      KAZ_TRY(behavior::OptionValues::parse(behavior.options, run.settings));
    }
    if (sweep) KAZ_TRY(world_file(options.yard));
  } else {
    const auto recording = KAZ_TRY(sim::McapRecording::load(options.recording));
    auto recorded = KAZ_TRY(recorded_backend(recording, options.recording));
    find_beside(recorded.backend, options.recording);
    const auto figures = KAZ_TRY(figures_of(options, recorded.behavior));
    runs = {{recorded.behavior, recorded.backend.world, {}, figures}};
  }
  const auto folder = KAZ_TRY(OutputFolder::begin(options.out, figures_output()));
  return Figures(options, folder).make(runs, sweep);
}

}  // namespace kaz::tools
