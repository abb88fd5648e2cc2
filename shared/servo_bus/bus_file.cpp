// Reads bus.json.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_bus/bus_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"
#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"

namespace kaz::servo_bus {
namespace {

using nlohmann::json;

// Ids, highest: protocol 1.0, which Feetech's is, has one more.
constexpr int max_id(Protocol protocol) {
  return protocol == Protocol::feetech ? feetech::kMaxId : dynamixel::kMaxId;
}

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
      return error(std::string("\"") + key + "\" is missing or not a number");
    const double value = found->get<double>();
    if (!(value >= min && value <= max))
      return error(std::string("\"") + key + "\" must be " + json(min).dump() + " to " +
                   json(max).dump());
    return value;
  }
  Result<std::string> text(const json& in, const char* key) const {
    const auto found = in.find(key);
    if (found == in.end() || !found->is_string())
      return error(std::string("\"") + key + "\" is missing or not a text");
    return found->get<std::string>();
  }
  Result<void> known(const json& in, std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, value] : in.items()) {
      if (std::ranges::find(keys, key) == keys.end())
        return error("unknown key \"" + cut_text(key) + "\"");
    }
    return {};
  }

  Result<BusServo> servo(const json& in, Protocol protocol) const {
    if (!in.is_object()) return error("\"servos\" has an entry that is not an object");
    KAZ_TRY(known(in, {"joint", "id", "model", "zero", "reversed", "supply_volts"}));
    BusServo servo;
    servo.joint = KAZ_TRY(text(in, "joint"));
    const auto model = KAZ_TRY(text(in, "model"));
    servo.model = find_model(model);
    if (servo.model == nullptr || servo.model->protocol != protocol) {
      std::string names;
      for (const Model& one : models()) {
        if (one.protocol == protocol) names += (names.empty() ? "" : ", ") + std::string(one.name);
      }
      return error("\"model\" is \"" + cut_text(model) +
                   "\": with this protocol it must be one of " + names);
    }
    const double id = KAZ_TRY(number(in, "id", 0, max_id(protocol), NAN));
    if (id != std::floor(id)) return error("\"id\" must be a whole number");
    servo.id = static_cast<int>(id);
    servo.zero = KAZ_TRY(number(in, "zero", -32766, 32766, servo.model->steps / 2));
    const auto reversed = in.find("reversed");
    if (reversed != in.end() && !reversed->is_boolean())
      return error("\"reversed\" must be true or false");
    servo.reversed = reversed != in.end() && reversed->get<bool>();
    if (in.contains("supply_volts")) servo.supply_volts = KAZ_TRY(volts(in));
    return servo;
  }

  Result<double> volts(const json& in) const { return number(in, "supply_volts", 0, 30, NAN); }

  // How virtual servos answer a broadcast ping.
  Result<bool> broadcast_ping_in_turn(const json& in, Protocol protocol) const {
    if (!in.contains("broadcast_ping")) return false;
    if (protocol != Protocol::feetech)
      return error(
          "\"broadcast_ping\" is only for the protocol \"feetech\"; DYNAMIXEL servos always answer "
          "in turn");
    const auto way = KAZ_TRY(text(in, "broadcast_ping"));
    if (way != "together" && way != "in turn")
      return error("\"broadcast_ping\" is \"" + cut_text(way) +
                   "\": it must be \"together\" or \"in turn\"");
    return way == "in turn";
  }

  Result<long> baud(const json& in, Protocol protocol) const {
    const double given =
        KAZ_TRY(number(in, "baud", 1, 1e7, static_cast<double>(factory_baud(protocol))));
    const long wanted = std::floor(given) == given ? static_cast<long>(given) : 0;
    for (const Model& model : models()) {
      if (model.protocol == protocol && std::ranges::find(model.bauds, wanted) != model.bauds.end())
        return wanted;
    }
    return error("\"baud\" is not a bit rate of this protocol's servos");
  }

  // Each is a register that a host writes once, and that is kept without power, of every servo.
  Result<std::vector<BusSetting>> settings(const json& in, const std::vector<BusServo>& on) const {
    std::vector<BusSetting> settings;
    const auto found = in.find("settings");
    if (found == in.end()) return settings;
    if (!found->is_object()) return error("\"settings\" is not an object");
    for (const auto& [name, value] : found->items()) {
      for (const BusServo& servo : on) {
        const Register* reg = servo.model->find(name);
        const bool settable =
            reg != nullptr && reg->writable && reg->eeprom && name != "id" && name != "baud_rate";
        if (!settable)
          return error("\"" + cut_text(name) +
                       "\" in \"settings\" must be a writable EEPROM register of " +
                       std::string(servo.model->name) + " other than id and baud_rate");
        const double number = value.is_number() ? value.get<double>() : NAN;
        if (!(std::floor(number) == number && std::abs(number) < 2e9) ||
            !reg->allows(static_cast<int>(number)))
          return error("\"" + cut_text(name) +
                       "\" in \"settings\" has a value that the register of " +
                       std::string(servo.model->name) + " does not accept");
      }
      settings.push_back({name, value.get<int>()});
    }
    return settings;
  }
};

}  // namespace

Result<BusFile> parse_bus_file(const std::string& path, const std::string& text) {
  const Reader reader{path};
  const auto parsed = parse_bounded_json(text);
  if (!parsed) return reader.error(parsed.error().message);
  const json& all = *parsed;
  if (!all.is_object()) return reader.error("is not a JSON object");
  KAZ_TRY(reader.known(all, {"protocol", "baud", "supply_volts", "supply_ohm", "broadcast_ping",
                             "settings", "servos"}));
  const auto protocol = KAZ_TRY(reader.text(all, "protocol"));
  BusFile file;
  if (protocol == name_of(Protocol::dynamixel)) {
    file.protocol = Protocol::dynamixel;
  } else if (protocol != name_of(Protocol::feetech)) {
    return reader.error("\"protocol\" must be \"feetech\" or \"dynamixel\"");
  }
  file.baud = KAZ_TRY(reader.baud(all, file.protocol));
  file.supply_volts = KAZ_TRY(reader.volts(all));
  file.supply_ohm = KAZ_TRY(reader.number(all, "supply_ohm", 0, 10, 0));
  file.broadcast_ping_in_turn = KAZ_TRY(reader.broadcast_ping_in_turn(all, file.protocol));
  const auto servos = all.find("servos");
  if (servos == all.end() || !servos->is_array() || servos->empty())
    return reader.error("the list \"servos\" is missing or empty");
  if (servos->size() > kMaxServos)
    return reader.error("\"servos\" must have at most " + std::to_string(kMaxServos) + " entries");
  for (const json& one : *servos) {
    file.servos.push_back(KAZ_TRY(reader.servo(one, file.protocol)));
    const std::string& joint = file.servos.back().joint;
    if (std::ranges::count(file.servos, joint, &BusServo::joint) > 1)
      return reader.error("the joint \"" + cut_text(joint) + "\" has two servos");
  }
  file.settings = KAZ_TRY(reader.settings(all, file.servos));
  return file;
}

std::string bus_file_path(const std::string& urdf_path) {
  return std::filesystem::path(urdf_path).replace_filename("bus.json");
}

Result<BusFile> load_bus_file(const std::string& urdf_path) {
  const std::string path = bus_file_path(urdf_path);
  const auto text = KAZ_TRY(read_whole_file(
      path, kMaxBytes,
      "a robot on a servo bus needs the file bus.json in the folder of its URDF; see "
      "docs/reference/servo-bus.md"));
  return parse_bus_file(path, text);
}

// A line for each servo, as people write it.
std::string with_zeros(const std::string& text, const std::map<std::string, double>& zeros) {
  const auto all = parse_bounded_json<nlohmann::ordered_json>(text).value();
  std::string lines;
  for (const auto& [key, value] : all.items()) {
    lines += (lines.empty() ? "{\n  " : ",\n  ") + json(key).dump() + ": ";
    if (key != "servos") {
      lines += value.dump();
      continue;
    }
    std::string list;
    for (auto servo : value) {
      const auto zero = zeros.find(servo["joint"].get<std::string>());
      // A whole step, unless somebody wants a part of one.
      if (zero != zeros.end() && std::floor(zero->second) == zero->second)
        servo["zero"] = static_cast<long>(zero->second);
      else if (zero != zeros.end())
        servo["zero"] = zero->second;
      list += (list.empty() ? "\n    " : ",\n    ") + servo.dump();
    }
    lines += "[" + list + "\n  ]";
  }
  return lines + "\n}\n";
}

}  // namespace kaz::servo_bus
