// How a run was put together, as its recording states it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/recorded_backend.h"

#include <algorithm>
#include <filesystem>

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
  std::string misfit;
  const auto take = [&](const char* key, auto& to, bool fits) {
    const auto found = backend.find(key);
    if (found == backend.end()) return;
    if (fits) {
      found->get_to(to);
    } else {
      misfit = key;
    }
  };
  const auto is = [&](const char* key, auto test) {
    const auto found = backend.find(key);
    return found != backend.end() && test(*found);
  };
  const auto text = [](const Json& value) { return value.is_string(); };
  const auto number = [](const Json& value) { return value.is_number(); };
  // "engine": the key of `mcu` in older recordings.
  const char* const mcu_key =
      backend.contains("engine") && !backend.contains("mcu") ? "engine" : "mcu";
  BackendOptions& options = result.backend;
  // Older recordings do not state the renderer: OpenGL was the only one, then the default.
  std::string mcu, sensors, eyes, renderer = to_string(sim::RendererKind::opengl);
  for (const auto& [key, to] :
       {std::pair{"world", &options.world}, std::pair{"robot_file", &options.robot_file},
        std::pair{mcu_key, &mcu}, std::pair{"image", &options.image},
        std::pair{"sensors", &sensors}, std::pair{"eyes", &eyes}, std::pair{"renderer", &renderer},
        std::pair{"dynamics", &options.dynamics}, std::pair{"memory", &options.memory}})
    take(key, *to, is(key, text));
  take("imu", options.imu, is("imu", [](const Json& value) { return value.is_boolean(); }));
  take("suspended", options.suspended,
       is("suspended", [](const Json& value) { return value.is_boolean(); }));
  take("physics_step_ms", options.physics_step_ms, is("physics_step_ms", number));
  take("supply_volts", options.supply_volts, is("supply_volts", [](const Json& value) {
         return value.is_number() && value.get<double>() >= kMinSupply_v &&
                value.get<double>() <= kMaxSupply_v;
       }));
  take("eye_width", options.eye_width, is("eye_width", [](const Json& value) {
         return value.is_number_unsigned() && value.get<std::uint64_t>() <= 4096;
       }));
  take("joints", options.joints, is("joints", [](const Json& value) {
         return value.is_array() && value.size() <= KZ_JOINTS &&
                std::ranges::all_of(value, [](const Json& one) { return one.is_string(); });
       }));
  take("seed", options.seed,
       is("seed", [](const Json& value) { return value.is_number_unsigned(); }));
  if (!misfit.empty())
    return wrong("`" + misfit + "` of its backend has the wrong type or is out of range");
  // Without these another robot would run than the recorded one.
  for (const char* key : {"world", mcu_key, "sensors", "eyes"}) {
    if (!backend.contains(key))
      return wrong(std::string("`") + key + "` of its backend is missing");
  }
  if (auto set = choose(mcu, sim::kMcuKinds, options.mcu); !set)
    return wrong(std::string("`") + mcu_key + "` of its backend " + set.error().message);
  if (auto set = choose(sensors, sim::kSensorSets, options.sensors); !set)
    return wrong("`sensors` of its backend " + set.error().message);
  if (auto set = choose(eyes, sim::kEyeKinds, options.eyes); !set)
    return wrong("`eyes` of its backend " + set.error().message);
  if (auto set = choose(renderer, sim::kRendererKinds, options.renderer); !set)
    return wrong("`renderer` of its backend " + set.error().message);
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
