// Reads and writes the file of an identified servo.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_model/servo_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::servo_model {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 1 << 20, kMostErrors = 50;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

struct ShippedServo {
  std::string_view name, text;
};
constexpr std::array kShippedServos{
#include "kz_shipped_servos.h"
};

struct TextKey {
  const char* name;
  std::string IdentifiedServo::*at;
};
constexpr std::array kTextKeys{
    TextKey{"servo", &IdentifiedServo::servo}, TextKey{"source", &IdentifiedServo::source},
    TextKey{"license", &IdentifiedServo::license}, TextKey{"date", &IdentifiedServo::date},
    TextKey{"logs", &IdentifiedServo::logs}};

std::string in_words(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

bool is_date(const std::string& text) {
  constexpr std::string_view kForm = "0000-00-00";
  return text.size() == kForm.size() && std::ranges::equal(text, kForm, [](char c, char form) {
           return form == '0' ? c >= '0' && c <= '9' : c == form;
         });
}

class ServoFileParser {
 public:
  explicit ServoFileParser(const std::string& path) : path_(path) {}

  Result<IdentifiedServo> servo_of(const std::string& text) {
    const auto parsed = parse_bounded_json<Json>(text);
    if (!parsed) return fail(Fault::usage, path_ + ": " + parsed.error().message);
    if (!parsed->is_object()) return fail(Fault::usage, path_ + ": must be a JSON object");
    IdentifiedServo servo;
    known("", *parsed,
          {"servo", "volts", "model", "params", "source", "license", "date", "logs", "held_out_rad",
           "floor_rad"});
    for (const TextKey& key : kTextKeys) servo.*key.at = text_of(*parsed, key.name);
    if (!servo.date.empty() && !is_date(servo.date))
      add("\"date\" is \"" + cut_text(servo.date) + "\": must be YYYY-MM-DD");
    servo.volts = number("", *parsed, "volts", 1, 60);
    const double model = number("", *parsed, "model", 1, 6);
    servo.held_out_rad = optional("", *parsed, "held_out_rad", 0, 10, kUnknown);
    servo.floor_rad = optional("", *parsed, "floor_rad", 0, 10, kUnknown);
    if (model >= 1 && model != std::floor(model)) add("\"model\" must be a whole number");
    servo.model = model >= 1 ? static_cast<int>(model) : 1;
    if (model >= 1) read_params(*parsed, servo);
    if (errors_.empty()) return servo;
    Error error{Fault::usage, errors_.front()};
    error.details.assign(errors_.begin() + 1, errors_.end());
    return tl::unexpected(std::move(error));
  }

 private:
  void add(const std::string& what) {
    if (errors_.size() < kMostErrors) errors_.push_back(path_ + ": " + one_line(what));
  }
  void known(const std::string& in, const Json& object, std::vector<std::string_view> keys) {
    for (const auto& [key, value] : object.items()) {
      if (std::ranges::find(keys, key) == keys.end())
        add(in + "unknown key \"" + cut_text(key) + "\"; remove it");
    }
  }
  std::string text_of(const Json& in, const char* key) {
    const auto found = in.find(key);
    const bool is_text = found != in.end() && found->is_string();
    const std::string text = is_text ? found->get<std::string>() : "";
    if (text.empty()) add(std::string("\"") + key + "\" is missing, empty or not a text");
    return text;
  }
  double optional(const std::string& where, const Json& in, const char* key, double low,
                  double high, double otherwise) {
    return in.contains(key) ? number(where, in, key, low, high) : otherwise;
  }
  // NaN after an error.
  double number(const std::string& where, const Json& in, const char* key, double low,
                double high) {
    const auto found = in.find(key);
    const std::string name = where + "\"" + key + "\"";
    const double value = found != in.end() && found->is_number() ? found->get<double>() : kUnknown;
    if (value >= low && value <= high) return value;
    add(name + (std::isnan(value) ? " is missing or not a number"
                                  : " is " + in_words(value) + ": must be " + in_words(low) +
                                        " to " + in_words(high)));
    return kUnknown;
  }

  void read_params(const Json& in, IdentifiedServo& servo) {
    const auto found = in.find("params");
    if (found == in.end() || !found->is_object())
      return add("\"params\" is missing or not an object");
    const auto infos = servo_params(servo.model);
    std::vector<std::string_view> names;
    for (const ServoParamInfo& info : infos) names.push_back(info.name);
    known("\"params\": ", *found, names);
    for (const ServoParamInfo& info : infos) {
      const std::string name(info.name), where = "\"params\": \"" + name + "\": ";
      const auto param = found->find(name);
      if (param == found->end() || !param->is_object()) {
        add(where + "is missing or not an object; model " + std::to_string(servo.model) +
            " needs it");
        continue;
      }
      known(where, *param, {"unit", "value", "within"});
      if (param->value("unit", Json()) != info.unit)
        add(where + "\"unit\" must be \"" + std::string(info.unit) + "\"");
      const double value = number(where, *param, "value", info.low, info.high);
      const double within = optional(where, *param, "within", 0, 1e9, kNoLimit);
      servo.identified.push_back({&info, value, within});
    }
  }

  const std::string& path_;
  std::vector<std::string> errors_;
};

const IdentifiedParam* param_named(const IdentifiedServo& servo, std::string_view name) {
  const auto found = std::ranges::find_if(
      servo.identified, [&](const IdentifiedParam& one) { return one.of->name == name; });
  return found == servo.identified.end() ? nullptr : &*found;
}

}  // namespace

ServoParams IdentifiedServo::params() const {
  ServoParams all;
  for (const IdentifiedParam& one : identified) all.*one.of->at = one.value;
  return all;
}

Result<IdentifiedServo> parse_servo_file(const std::string& path, const std::string& text) {
  return ServoFileParser(path).servo_of(text);
}

Result<IdentifiedServo> load_servo_file(const std::string& path) {
  const auto text =
      KAZ_TRY(read_whole_file(path, kMostBytes, "give the servo.json of kaz bench servo"));
  return parse_servo_file(path, text);
}

std::string shipped_servo_names() {
  std::string names;
  for (const ShippedServo& one : kShippedServos)
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  return names;
}

Result<IdentifiedServo> shipped_servo(const std::string& name) {
  for (const ShippedServo& one : kShippedServos)
    if (one.name == name) return parse_servo_file(name + ".json", std::string(one.text));
  return fail(Fault::usage, "no shipped servo has the name `" + cut_text(one_line(name)) +
                                "`: must be one of " + shipped_servo_names());
}

std::string servo_file_text(const IdentifiedServo& servo) {
  Json json{{"servo", servo.servo}, {"volts", servo.volts}, {"model", servo.model}};
  for (const IdentifiedParam& one : servo.identified) {
    Json& param = json["params"][std::string(one.of->name)];
    param = {{"value", one.value}, {"unit", one.of->unit}};
    if (std::isfinite(one.within)) param["within"] = one.within;
  }
  for (const TextKey& key : kTextKeys) json[key.name] = servo.*key.at;
  if (!std::isnan(servo.held_out_rad)) json["held_out_rad"] = servo.held_out_rad;
  if (!std::isnan(servo.floor_rad)) json["floor_rad"] = servo.floor_rad;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<ServoDifference> differences(const IdentifiedServo& shipped,
                                         const IdentifiedServo& own) {
  std::vector<ServoDifference> all;
  const auto add = [&](const ServoParamInfo& info) {
    const IdentifiedParam *a = param_named(shipped, info.name), *b = param_named(own, info.name);
    ServoDifference one{
        std::string(info.name), std::string(info.unit), kUnknown, kUnknown, kUnknown, kUnknown};
    if (a != nullptr) {
      one.shipped = a->value;
      one.shipped_within = a->within;
    }
    if (b != nullptr) {
      one.own = b->value;
      one.own_within = b->within;
    }
    one.differs = std::abs(one.own - one.shipped) > one.own_within + one.shipped_within;
    all.push_back(one);
  };
  for (const IdentifiedParam& one : shipped.identified) add(*one.of);
  for (const IdentifiedParam& one : own.identified)
    if (param_named(shipped, one.of->name) == nullptr) add(*one.of);
  return all;
}

}  // namespace kaz::servo_model
