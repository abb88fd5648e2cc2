// Reads bus.json.
// SPDX-License-Identifier: Apache-2.0
#include "shared/feetech/bus_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "shared/base/json_depth.hpp"
#include "shared/base/one_line.hpp"
#include "shared/feetech/packet.h"

namespace kaz::feetech {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = 1 << 20, kMaxServos = 254;

struct Reader {
  const std::string& path;

  tl::unexpected<Error> error(const std::string& what) const {
    return fail(Fault::usage, path + ": " + one_line(what) + "; see docs/reference/servo-bus.md");
  }
  Result<double> number(const json& in, const char* key, double min, double max,
                        double otherwise) const {
    const auto found = in.find(key);
    if (found == in.end() && !std::isnan(otherwise)) return otherwise;
    if (found == in.end() || !found->is_number())
      return error(std::string("the number \"") + key + "\" is missing");
    const double value = found->get<double>();
    if (!(value >= min && value <= max))
      return error(std::string("\"") + key + "\" must lie between " + json(min).dump() + " and " +
                   json(max).dump());
    return value;
  }
  Result<std::string> text(const json& in, const char* key) const {
    const auto found = in.find(key);
    if (found == in.end() || !found->is_string())
      return error(std::string("the text \"") + key + "\" is missing");
    return found->get<std::string>();
  }
  Result<void> known(const json& in, std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, value] : in.items()) {
      if (std::ranges::find(keys, key) == keys.end())
        return error("\"" + key + "\" is not known here");
    }
    return {};
  }

  Result<BusServo> servo(const json& in) const {
    if (!in.is_object()) return error("\"servos\" holds what is no object");
    KAZ_TRY(known(in, {"joint", "id", "model", "zero", "reversed"}));
    BusServo servo;
    servo.joint = KAZ_TRY(text(in, "joint"));
    const auto model = KAZ_TRY(text(in, "model"));
    servo.model = find_model(model);
    if (servo.model == nullptr) {
      std::string names;
      for (const Model& one : models())
        names += (names.empty() ? "" : ", ") + std::string(one.name);
      return error("the model \"" + model + "\" is not known; those that are: " + names);
    }
    const double id = KAZ_TRY(number(in, "id", 0, kMaxId, NAN));
    if (id != std::floor(id)) return error("\"id\" is no whole number");
    servo.id = static_cast<int>(id);
    servo.zero = KAZ_TRY(number(in, "zero", -32766, 32766, servo.model->steps / 2));
    const auto reversed = in.find("reversed");
    if (reversed != in.end() && !reversed->is_boolean())
      return error("\"reversed\" is neither true nor false");
    servo.reversed = reversed != in.end() && reversed->get<bool>();
    return servo;
  }
};

}  // namespace

Result<BusFile> parse_bus_file(const std::string& path, const std::string& text) {
  const Reader reader{path};
  const auto all = json_too_deep(text) ? json() : json::parse(text, nullptr, false);
  if (!all.is_object()) return reader.error("is no JSON object");
  KAZ_TRY(reader.known(all, {"protocol", "supply_volts", "supply_ohm", "servos"}));
  const auto protocol = KAZ_TRY(reader.text(all, "protocol"));
  if (protocol != "feetech") return reader.error("\"protocol\" is not \"feetech\"");
  BusFile file;
  file.supply_volts = KAZ_TRY(reader.number(all, "supply_volts", 0, 30, NAN));
  file.supply_ohm = KAZ_TRY(reader.number(all, "supply_ohm", 0, 10, 0));
  const auto servos = all.find("servos");
  if (servos == all.end() || !servos->is_array() || servos->empty())
    return reader.error("the list \"servos\" is missing or empty");
  if (servos->size() > kMaxServos) return reader.error("\"servos\" are more than a bus can have");
  for (const json& one : *servos) {
    file.servos.push_back(KAZ_TRY(reader.servo(one)));
    const std::string& joint = file.servos.back().joint;
    if (std::ranges::count(file.servos, joint, &BusServo::joint) > 1)
      return reader.error("the joint \"" + joint + "\" has two servos");
  }
  return file;
}

Result<BusFile> load_bus_file(const std::string& urdf_path) {
  const std::string path = std::filesystem::path(urdf_path).replace_filename("bus.json");
  const auto text = KAZ_TRY(read_whole_file(
      path, kMaxBytes,
      "a robot on a servo bus has one beside its URDF, see docs/reference/servo-bus.md"));
  return parse_bus_file(path, text);
}

}  // namespace kaz::feetech
