// How a run was put together, as its recording states it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/recorded_backend.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/enum_names.hpp"
#include "shared/base/one_line.hpp"
#include "shared/board/board.h"
#include "sim/runtime/formats/little_endian.h"
#include "tools/vision/color_file.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::json;

// Returns null if the text is not JSON.
Json object_of(const std::string& text) {
  return parse_bounded_json(text).value_or(nullptr);
}

// The error is the rest of a sentence.
template <class T, std::size_t N>
Result<void> choose(const std::string& name, const std::array<T, N>& values, T& to) {
  if (const auto value = parse_enum(values, name)) {
    to = *value;
    return {};
  }
  std::string names;
  for (const std::string& valid : enum_names(values)) names += (names.empty() ? "" : ", ") + valid;
  return fail(Fault::usage, "is `" + cut_text(name) + "`: must be one of " + names);
}

// Archive (robot_options.h) that reads the options of a recording. Missing options keep their values.
class RecordedOptions {
 public:
  explicit RecordedOptions(const Json& from) : from_(from) {}

  void operator()(const sim::OptionText& text, bool& value) {
    take(text, value, &Json::is_boolean);
  }
  void operator()(const sim::OptionText& text, std::uint64_t& value) {
    take(text, value, &Json::is_number_unsigned);
  }
  void operator()(const sim::OptionText& text, std::string& value) {
    take(text, value, &Json::is_string);
  }
  void operator()(const sim::OptionText& text, std::vector<std::string>& value) {
    take(text, value, [](const Json& json) {
      return json.is_array() && json.size() <= KZ_JOINTS &&
             std::ranges::all_of(json, &Json::is_string);
    });
  }
  template <class T, std::size_t N>
  void operator()(const sim::OptionText& text, T& value, const std::array<T, N>& values) {
    std::string name = to_string(value);
    (*this)(text, name);
    if (const auto chosen = choose(name, values, value); !chosen && unknown_.empty())
      unknown_ = quoted(key_of(text)) + " of its backend " + chosen.error().message;
  }
  void operator()(const sim::OptionText& text, double& value, const sim::OptionRange& range) {
    take(text, value, [&](const Json& json) {
      return json.is_number() && json.get<double>() >= range.min && json.get<double>() <= range.max;
    });
  }
  // Accepts more sizes than the command line does.
  template <std::size_t N>
  void operator()(const sim::OptionText& text, int& value, const std::array<int, N>&) {
    take(text, value, [](const Json& json) {
      return json.is_number_unsigned() && json.get<std::uint64_t>() <= 4096;
    });
  }

  // Returns the first part of an error message, or an empty string.
  std::string error() const {
    if (!misfit_.empty())
      return quoted(misfit_) + " of its backend has the wrong type or is out of range";
    // Without these another robot would run than the recorded one.
    for (const char* key : {"world", mcu_key(), "sensors", "eyes"}) {
      if (!from_.contains(key)) return quoted(key) + " of its backend is missing";
    }
    return unknown_;
  }

 private:
  // "engine": the key of `mcu` in older recordings.
  const char* mcu_key() const {
    return from_.contains("engine") && !from_.contains("mcu") ? "engine" : "mcu";
  }
  const char* key_of(const sim::OptionText& text) const {
    return std::string_view(text.name) == "mcu" ? mcu_key() : text.name;
  }
  static std::string quoted(const std::string& key) { return "`" + key + "`"; }

  template <class T, class Test>
  void take(const sim::OptionText& text, T& to, Test fits) {
    const auto found = from_.find(key_of(text));
    if (found == from_.end()) return;
    if (std::invoke(fits, *found)) {
      found->get_to(to);
    } else {
      misfit_ = key_of(text);
    }
  }

  const Json& from_;
  std::string misfit_;   // key of a value with the wrong type or out of range
  std::string unknown_;  // error for a name that is not in its list
};

// The texts under this key in /behavior, with their times, ns.
std::vector<std::pair<std::uint64_t, std::string>> behavior_texts(
    const sim::McapRecording& recording, const char* key) {
  std::vector<std::pair<std::uint64_t, std::string>> texts;
  for (const auto& message : recording.messages) {
    const auto topic = recording.topics.find(message.channel);
    if (topic == recording.topics.end() || topic->second != "/behavior") continue;
    const Json json = object_of(std::string(message.data.begin(), message.data.end()));
    if (!json.is_object()) continue;
    const auto text = json.find(key);
    if (text != json.end() && text->is_string())
      texts.emplace_back(message.time_ns, text->get<std::string>());
  }
  return texts;
}

}  // namespace

void find_beside(BackendOptions& options, const std::string& recording) {
  namespace fs = std::filesystem;
  // A run's folder is as a rule where the run was started.
  const fs::path folder = fs::path(recording).parent_path();
  for (std::string* file : {&options.world, &options.robot_file}) {
    std::error_code none;
    const bool is_path = file->find_first_of("/.") != std::string::npos;
    if (!is_path || fs::exists(*file, none)) continue;
    for (const fs::path& beside :
         {folder / fs::path(*file).filename(), folder / ".." / fs::path(*file).filename()}) {
      if (!fs::exists(beside, none)) continue;
      *file = beside.string();
      break;
    }
  }
}

std::vector<std::pair<std::uint64_t, std::string>> recorded_acts(
    const sim::McapRecording& recording) {
  std::vector<std::pair<std::uint64_t, std::string>> acts;
  for (const auto& message : recording.messages) {
    const auto topic = recording.topics.find(message.channel);
    if (topic == recording.topics.end() || topic->second != "/hand") continue;
    sim::LittleEndianFields fields(message.data);
    acts.emplace_back(message.time_ns, fields.text());
  }
  return acts;
}

std::vector<std::pair<std::uint64_t, std::string>> recorded_requests(
    const sim::McapRecording& recording) {
  return behavior_texts(recording, "request");
}

std::vector<std::pair<std::uint64_t, std::string>> recorded_phases(
    const sim::McapRecording& recording) {
  return behavior_texts(recording, "phase");
}

Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name) {
  const auto fact = [&](const char* key) {
    const auto found = recording.facts.find(key);
    return found == recording.facts.end() ? std::string() : found->second;
  };
  const auto wrong = [&](const std::string& why) {
    return fail(Fault::usage, name + ": " + one_line(why) +
                                  "; give a recording of this version's `kaz run` or `kaz demo`");
  };
  if (const std::string port = fact("port"); !port.empty())
    return fail(Fault::usage, name + ": it was recorded at the port " + cut_text(one_line(port)) +
                                  ", so its board and world cannot be simulated again; use kaz "
                                  "compare to compare it with another run");
  const Json backend = object_of(fact("backend")), settings = object_of(fact("settings"));
  RecordedBackend result;
  result.behavior = fact("behavior");
  if (result.behavior.empty() || !backend.is_object() || !settings.is_object())
    return wrong("its behavior, settings or backend are missing");
  for (const auto& [key, value] : settings.items()) {
    if (!value.is_string())
      return wrong("the setting `" + cut_text(key) + "` of its behavior must be text");
    result.settings[key] = value.get<std::string>();
  }
  // Older recordings do not state the renderer: OpenGL was the only one, then the default.
  result.backend.renderer = sim::RendererKind::opengl;
  RecordedOptions reader(backend);
  result.backend.visit(reader);
  if (const std::string why = reader.error(); !why.empty()) return wrong(why);
  if (const std::string text_of_ball = fact("ball"); !text_of_ball.empty()) {
    result.ball.color = KAZ_TRY(parse_color(text_of_ball, name + ": the ball of its run"));
    const Json ball = object_of(text_of_ball);
    const auto radius = ball.find("radius_m");
    if (radius == ball.end() || !radius->is_number() || radius->get<double>() < 0.005 ||
        radius->get<double>() > 0.5)
      return wrong("the radius of its ball must be 0.005 to 0.5 m");
    result.ball.radius_m = radius->get<double>();
  }
  return result;
}

}  // namespace kaz::tools
