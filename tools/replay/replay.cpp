// Runs again what a recording holds, and compares.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "host/behavior/plugin.h"
#include "shared/base/files.hpp"
#include "shared/base/hex_text.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/replay/message_fields.h"
#include "tools/replay/recorded_backend.h"
#include "tools/replay/replay_host.h"
#include "tools/run/run.h"
#include "tools/vision/color_file.h"

namespace kaz::tools {
namespace {

using Message = sim::McapRecording::Message;

constexpr std::size_t kMostShown = 64;  // bytes of a message

std::string shown(std::span<const std::uint8_t> data) {
  const auto printable = [](std::uint8_t c) { return c >= 0x20 && c < 0x7f; };
  const std::span front = data.first(std::min(data.size(), kMostShown));
  std::string text;
  if (std::ranges::all_of(front, printable)) {
    text.assign(front.begin(), front.end());
  } else {
    text = hex_text(front, " ");
  }
  return data.size() > kMostShown ? text + " ..." : text;
}

std::string topic_of(const sim::McapRecording& recording, const Message& message) {
  const auto topic = recording.topics.find(message.channel);
  return topic == recording.topics.end() ? "?" : topic->second;
}

Result<RunOptions> run_of(const sim::McapRecording& recording, const ReplayOptions& options) {
  auto recorded = KAZ_TRY(recorded_backend(recording, options.file));
  find_beside(recorded.backend, options.file);
  RunOptions run;
  run.behavior = recorded.behavior;
  // Which code is loaded is the user's choice, never the recording's.
  const bool of_plugin = behavior::names_plugin(recorded.behavior);
  if (of_plugin && options.plugin.empty())
    return fail(Fault::usage, options.file + ": the behavior of this run is the plug-in " +
                                  recorded.behavior + "; give the plug-in with --plugin FILE");
  if (!of_plugin && !options.plugin.empty())
    return fail(Fault::usage, options.file + ": the behavior of this run is " + recorded.behavior +
                                  ", not a plug-in: leave out --plugin");
  if (of_plugin) run.behavior = options.plugin;
  run.settings = std::move(recorded.settings);
  run.backend = std::move(recorded.backend);
  if (options.seed) run.backend.seed = *options.seed;
  for (const auto& [name, value] : options.settings) run.settings[name] = value;
  run.requests = [requests = recorded_requests(recording),
                  next = std::size_t{0}](Time now) mutable {
    std::vector<std::string> lines;
    for (;
         next < requests.size() && requests[next].first <= static_cast<std::uint64_t>(now.count());
         ++next)
      lines.push_back(requests[next].second);
    return lines;
  };
  run.quiet = true;
  run.vision = options.vision;
  // Another one if vision is to look for that.
  if (is_usual(run.vision.ball)) run.vision.ball = recorded.ball;
  run.label = options.label;
  run.json = options.json;
  return run;
}

// Files that the recording's run had otherwise.
std::string changed_files(const sim::McapRecording& recorded, const sim::McapRecording& now) {
  std::string names;
  for (const auto& [name, value] : recorded.facts) {
    if (!name.ends_with("_sha256")) continue;
    const auto other = now.facts.find(name);
    if (other != now.facts.end() && other->second == value) continue;
    names += (names.empty() ? "" : ", ") + name.substr(0, name.size() - 7);
  }
  return names;
}

void print(const ReplayOptions& options, const sim::McapRecording& recorded,
           const std::optional<Difference>& difference, const std::string& changed,
           std::size_t messages) {
  const double end_s = 1e-9 * static_cast<double>(recorded.end_ns());
  if (options.json) {
    nlohmann::ordered_json result{{"recording", options.file},
                                  {"mode", "simulation"},
                                  {"identical", !difference},
                                  {"messages", messages},
                                  {"changed_files", changed}};
    if (recorded.ends_early()) result["cut_off_s"] = end_s;
    if (const auto by = recorded.interrupted_by(); !by.empty())
      result["recording_interrupted_by"] = by;
    if (difference) {
      result["time_s"] = difference->time_s;
      result["topic"] = difference->topic;
      result["recorded"] = difference->recorded;
      result["now"] = difference->now;
    }
    result["provenance"] = provenance_json();
    print_json(result);
    return;
  }
  std::printf("host and simulation ran again from the seed, and all messages were compared\n");
  if (const auto by = recorded.interrupted_by(); !by.empty())
    print_lines(
        "the recording ends early, because its run was interrupted by %s: compared up to %.6f s\n",
        by.c_str(), end_s);
  else if (!recorded.whole)
    print_lines("the recording was cut off: compared up to its end at %.6f s\n", end_s);
  if (!changed.empty()) print_lines("files changed since the recording: %s\n", changed.c_str());
  if (!difference) {
    std::printf("identical: %zu messages\n", messages);
    return;
  }
  std::printf("first difference at %.6f s, %s\n  recorded: %s\n  now:      %s\n",
              difference->time_s, difference->topic.c_str(), difference->recorded.c_str(),
              difference->now.c_str());
}

}  // namespace

std::optional<Difference> first_difference(const sim::McapRecording& recorded,
                                           const sim::McapRecording& now) {
  const auto& a = recorded.messages;
  const auto& b = now.messages;
  const auto [at, other] = std::ranges::mismatch(a, b);
  // Of a recording that was cut off every message that is there must come again.
  if (at == a.end() && (other == b.end() || recorded.ends_early())) return std::nullopt;
  // Different messages at one place: the earlier one is what the other run lacks.
  const bool only_there = other == b.end() || (at != a.end() && at->time_ns < other->time_ns);
  const bool only_now = at == a.end() || (other != b.end() && other->time_ns < at->time_ns);
  Difference difference;
  difference.time_s = 1e-9 * static_cast<double>(only_now ? other->time_ns : at->time_ns);
  difference.topic = only_now ? topic_of(now, *other) : topic_of(recorded, *at);
  difference.recorded = only_now ? "nothing" : shown(at->data);
  difference.now = only_there ? "nothing" : shown(other->data);
  if (only_there || only_now) return difference;
  if (at->channel != other->channel) {
    difference.now = topic_of(now, *other) + ": " + difference.now;
  } else if (const auto field = field_difference(difference.topic, at->data, other->data)) {
    difference.recorded = field->recorded;
    difference.now = field->now;
  }
  return difference;
}

RunObserver& observer_of(const ReplayOptions& options) {
  static RunObserver nobody;
  return options.observer != nullptr ? *options.observer : nobody;
}

void print_interrupted(const Error& error, const ReplayOptions& options, const std::string& mode) {
  if (error.fault != Fault::interrupted || !options.json || options.quiet) return;
  nlohmann::ordered_json result{{"recording", options.file}, {"mode", mode}};
  mark_interrupted(result);
  result["provenance"] = provenance_json();
  print_json(result);
}

// What was done by hand, done again in the same steps.
class RecordedHands final : public sim::HandSource {
 public:
  explicit RecordedHands(const sim::McapRecording& recording) : acts_(recorded_acts(recording)) {}
  std::vector<std::string> take(Time start) override {
    std::vector<std::string> lines;
    for (; next_ < acts_.size() && acts_[next_].first <= static_cast<std::uint64_t>(start.count());
         ++next_)
      lines.push_back(acts_[next_].second);
    return lines;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::string>> acts_;
  std::size_t next_ = 0;
};

// Host and simulation from the seed, every message compared.
Result<bool> replay_whole(const ReplayOptions& options, const sim::McapRecording& recorded,
                          RunOptions run_options) {
  const std::string faults = temporary_file("faults.txt");
  const FileRemover remove_faults(faults);
  if (const auto text = recorded.facts.find("faults");
      text != recorded.facts.end() && !text->second.empty()) {
    KAZ_TRY(write_whole_file(faults, text->second));
    run_options.backend.faults = faults;
  }
  const std::string again = temporary_file("replay.mcap");
  const FileRemover remove_again(again);
  run_options.backend.recording = again;
  run_options.backend.record_pictures = recorded.has_messages("/eyes/left");
  RecordedHands hands(recorded);
  run_options.backend.hands = &hands;
  // Nothing is simulated past its end; two ticks more, in which its last messages are written.
  if (recorded.ends_early())
    run_options.until =
        Time(static_cast<std::int64_t>(recorded.end_ns())) + std::chrono::milliseconds(2);
  // Whether the behavior succeeded does not matter, only whether it did the same.
  if (auto ran = run(std::move(run_options), observer_of(options)); !ran) {
    print_interrupted(ran.error(), options, "simulation");
    return ran;
  }
  const auto now = KAZ_TRY(sim::McapRecording::load_run(again));

  const auto difference = first_difference(recorded, now);
  print(options, recorded, difference, changed_files(recorded, now),
        recorded.ends_early() ? recorded.messages.size() : now.messages.size());
  return !difference;
}

Result<bool> replay(const ReplayOptions& options) {
  const auto recorded = KAZ_TRY(sim::McapRecording::load_run(options.file));
  if (recorded.damaged_chunks > 0)
    return fail(Fault::usage, options.file + ": a chunk is damaged; record the run again");
  if (recorded.ends_early() && recorded.messages.empty())
    return fail(
        Fault::usage,
        options.file + ": was cut off before the first message of its run; record the run again");
  if (recorded.messages.empty())
    return fail(Fault::usage,
                options.file + ": contains no message of a run; record the run again");
  auto run_options = KAZ_TRY(run_of(recorded, options));
  if (options.mode == ReplayMode::host && options.seed)
    return fail(
        Fault::usage,
        "--seed is not valid with --host; leave out --seed, or give --whole instead of --host");
  bool whole = options.mode == ReplayMode::whole || options.seed.has_value();
  if (!whole && options.mode == ReplayMode::by_itself) {
    const auto alone = KAZ_TRY(host_can_run_alone(recorded, run_options.behavior));
    whole = !alone;
    if (whole)
      std::fprintf(
          stderr,
          "kaz replay: this recording has no pictures, so not only the host but also "
          "the simulation runs again;\nto run only the host, record with --record-pictures\n");
  }
  return whole ? replay_whole(options, recorded, std::move(run_options))
               : replay_host(options, recorded, std::move(run_options));
}

}  // namespace kaz::tools
