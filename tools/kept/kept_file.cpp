// The notes of a run that alters a board, as JSON.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kept/kept_file.h"

#include <limits>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::size_t kMaxBytes = 1 << 20;
constexpr const char* kHint = "give the recovery notes of an interrupted run, or leave --from out";

bool in_bounds(const Json& value, long min, long max) {
  if (value.is_number_unsigned())
    return value.get<std::uint64_t>() <= static_cast<std::uint64_t>(max) &&
           value.get<long>() >= min;
  return value.is_number_integer() && value.get<long>() >= min && value.get<long>() <= max;
}

// Fields of an object, each with its bounds; remembers the first that is wrong.
class Fields {
 public:
  Fields(const Json& object, std::string where) : object_(object), where_(std::move(where)) {}

  template <class Number>
  void number(const char* name, Number& to, long min = std::numeric_limits<Number>::min(),
              long max = std::numeric_limits<Number>::max()) {
    const auto at = object_.find(name);
    if (at == object_.end() || !in_bounds(*at, min, max)) return wrong(name);
    to = at->template get<Number>();
  }
  void flag(const char* name, bool& to) {
    const auto at = object_.find(name);
    if (at == object_.end() || !at->is_boolean()) return wrong(name);
    to = at->get<bool>();
  }
  void text(const char* name, std::string& to) {
    const auto at = object_.find(name);
    if (at == object_.end() || !at->is_string()) return wrong(name);
    to = at->get<std::string>();
  }
  const std::string& first_wrong() const { return wrong_; }

 private:
  void wrong(const std::string& name) {
    if (wrong_.empty()) wrong_ = where_ + name;
  }
  const Json& object_;
  std::string where_, wrong_;
};

// The same names for both directions.
template <class Do>
void each_number(host::KeptJoint& joint, bool flash, Do act) {
  act("kp", joint.kp, 0L, long{KZ_KP_MAX});
  act("kd", joint.kd, 0L, long{KZ_KD_MAX});
  act("dead_band", joint.dead_band, 0L, long{KZ_DEAD_BAND_MAX});
  act("friction", joint.friction, 0L, long{KZ_FRICTION_MAX});
  act("ramp", joint.ramp, 1L, long{KZ_RAMP_MAX});
  constexpr long low = std::numeric_limits<std::int16_t>::min();
  constexpr long high = std::numeric_limits<std::int16_t>::max();
  act("lower", joint.lower, low, high);
  act("upper", joint.upper, low, high);
  act("centre", joint.centre, low, high);
  act("scale", joint.scale, low, high);
  if (!flash) return;
  act("stored_centre", joint.stored_centre, low, high);
  act("stored_scale", joint.stored_scale, low, high);
}

// The first field that is wrong; empty: none.
std::string read_joints(const Json& joints, host::BoardState& board) {
  if (!joints.is_array() || joints.size() != KZ_JOINTS) return "joints";
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const std::string where = "joints[" + std::to_string(j) + "]";
    if (!joints[j].is_object()) return where;
    Fields fields(joints[j], where + ".");
    each_number(board.joints[j], board.flash, [&](const char* name, auto& to, long min, long max) {
      fields.number(name, to, min, max);
    });
    if (!fields.first_wrong().empty()) return fields.first_wrong();
    if (board.joints[j].lower > board.joints[j].upper) return where + ".lower";
  }
  return "";
}

std::string read_others(const Json& others, std::vector<std::uint8_t>& to) {
  if (!others.is_array() || others.size() >= KZ_ADDRESS_LAST) return "others";
  for (const Json& other : others) {
    if (!in_bounds(other, 1, KZ_ADDRESS_LAST)) return "others";
    to.push_back(other.get<std::uint8_t>());
  }
  return "";
}

}  // namespace

std::string kept_text(const KeptFile& kept) {
  const host::BoardState& board = kept.board;
  Json json{{"kaz_kept_board", kVersion},
            {"verb", kept.verb},
            {"port", kept.port},
            {"line", kept.line},
            {"process", kept.process},
            {"process_began", kept.process_began},
            {"others", kept.others},
            {"address", board.address},
            {"shared_line", board.shared_line},
            {"watchdog_10ms", board.watchdog_10ms},
            {"reaction", board.reaction},
            {"flash", board.flash},
            {"stored_copy", board.stored_copy},
            {"joints", Json::array()}};
  for (host::KeptJoint joint : board.joints) {
    Json one = Json::object();
    each_number(joint, board.flash,
                [&](const char* name, auto& number, long, long) { one[name] = number; });
    json["joints"].push_back(std::move(one));
  }
  // A path may contain bytes that are not valid UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<KeptFile> parse_kept(const std::string& text, const std::string& name) {
  const auto wrong = [&](const std::string& what) {
    return fail(Fault::usage, name + ": " + what + "; " + kHint);
  };
  const Json json = parse_bounded_json<Json>(text).value_or(nullptr);
  if (!json.is_object() || !json.contains("kaz_kept_board"))
    return wrong("not recovery notes of a board, or damaged");
  if (json["kaz_kept_board"] != kVersion) return wrong("was written by another version of kaz");
  KeptFile kept;
  host::BoardState& board = kept.board;
  Fields fields(json, "");
  fields.text("verb", kept.verb);
  fields.text("port", kept.port);
  if (json.contains("line")) {
    fields.text("line", kept.line);
    fields.number("process", kept.process, 0);
    fields.number("process_began", kept.process_began, 0, std::numeric_limits<long>::max());
  }
  fields.number("address", board.address, 1, KZ_ADDRESS_LAST);
  fields.flag("shared_line", board.shared_line);
  fields.number("watchdog_10ms", board.watchdog_10ms, 1, 100);
  fields.number("reaction", board.reaction, KZ_REACTION_LIMP, KZ_REACTION_HOLD);
  fields.flag("flash", board.flash);
  fields.number("stored_copy", board.stored_copy);
  std::string field = fields.first_wrong();
  if (field.empty()) field = read_others(json.value("others", Json()), kept.others);
  if (field.empty()) field = read_joints(json.value("joints", Json()), board);
  if (!field.empty()) return wrong("its field " + field + " is missing or out of range");
  return kept;
}

std::string write_text(const WriteFile& write) {
  const Json json{{"kaz_flash_write", kVersion},
                  {"port", write.run.port},
                  {"line", write.run.line},
                  {"process", write.run.process},
                  {"process_began", write.run.process_began},
                  {"command", write.command},
                  {"folder", write.folder}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<WriteFile> parse_write(const std::string& text, const std::string& name) {
  const Json json = parse_bounded_json<Json>(text).value_or(nullptr);
  WriteFile write;
  Fields fields(json, "");
  if (json.is_object() && json.value("kaz_flash_write", Json()) == kVersion) {
    fields.text("port", write.run.port);
    fields.text("line", write.run.line);
    fields.number("process", write.run.process, 0);
    fields.number("process_began", write.run.process_began, 0, std::numeric_limits<long>::max());
    fields.text("command", write.command);
    fields.text("folder", write.folder);
    if (fields.first_wrong().empty()) return write;
  }
  return fail(Fault::usage, name + ": not recovery notes of `kaz flash write`, or damaged");
}

Result<WriteFile> read_write(const std::string& path) {
  const auto text = KAZ_TRY(read_whole_file(path, kMaxBytes));
  return parse_write(text, path);
}

Result<KeptFile> read_kept(const std::string& path) {
  const auto text = KAZ_TRY(read_whole_file(path, kMaxBytes, kHint));
  return parse_kept(text, path);
}

}  // namespace kaz::tools
