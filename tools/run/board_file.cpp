// Reads the file of boards.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/board_file.h"

#include <nlohmann/json.hpp>

#include "host/robot/robot.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = 64 << 10;
constexpr const char* kForm =
    R"(; give {"boards": [{"port": "can:can0", "address": 1, "joints": ["neck_pan", ...]}, ...]})";

tl::unexpected<Error> wrong(const std::string& name, const std::string& what) {
  return fail(Fault::usage, name + ": " + one_line(what));
}

Result<BoardOfFile> parse_one(const std::string& where, const Json& json) {
  BoardOfFile board;
  if (!json.is_object() || !json.contains("port") || !json["port"].is_string())
    return wrong(where, std::string("its port is missing") + kForm);
  for (const auto& [key, value] : json.items())
    if (key != "port" && key != "address" && key != "joints")
      return wrong(where, "unknown key `" + cut_text(key) + "`: use port, address or joints");
  board.port = KAZ_TRY(host::parse_port_address(where + ":", json["port"].get<std::string>()));
  const Json address = json.value("address", Json(1));
  if (!address.is_number_integer() || address < 1 || address > KZ_ADDRESS_LAST)
    return wrong(where, "its address must be 1 to 14: give the address of the board");
  board.address = address.get<std::uint8_t>();
  if (!json.contains("joints") || !json["joints"].is_array())
    return wrong(where, std::string("its joints are missing") + kForm);
  for (const Json& one : json["joints"]) {
    const auto joint = one.is_string() ? host::joint_index(one.get<std::string>()) : std::nullopt;
    if (!joint)
      return wrong(where, "unknown joint " + json_sample(one) +
                              ": give names such as neck_pan; docs/reference/robot.md lists them");
    board.joints |= std::uint32_t{1} << *joint;
  }
  return board;
}

// Boards that cannot be distinguished.
Result<void> check_lines(const std::string& name, const std::vector<BoardOfFile>& boards) {
  for (std::size_t i = 0; i < boards.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (boards[i].port.name() != boards[k].port.name()) continue;
      if (boards[i].port.kind != host::PortKind::can)
        return wrong(name, "two boards are at " + boards[i].port.name() +
                               ": give each board its own port, or connect the boards to a CAN bus "
                               "with `kaz can-bridge`");
      if (boards[i].address == boards[k].address)
        return wrong(name, "two boards have address " + std::to_string(boards[i].address) + " on " +
                               boards[i].port.name() +
                               ": give the boards different addresses (kaz recover --address)");
    }
  }
  return {};
}

}  // namespace

Result<std::vector<BoardOfFile>> parse_boards(const std::string& name, std::string_view text) {
  const auto parsed = parse_bounded_json(text, JsonComments::ignored);
  if (!parsed) return wrong(name, parsed.error().message + kForm);
  const Json& json = *parsed;
  if (!json.is_object() || !json.contains("boards") || !json["boards"].is_array() ||
      json["boards"].empty())
    return wrong(name, std::string("not a file of boards") + kForm);
  std::vector<BoardOfFile> boards;
  std::vector<host::RobotBoard> masks;
  for (const Json& one : json["boards"]) {
    const std::string where = name + ", board " + std::to_string(boards.size() + 1);
    boards.push_back(KAZ_TRY(parse_one(where, one)));
    masks.push_back({nullptr, boards.back().address, boards.back().joints});
  }
  KAZ_TRY(check_lines(name, boards));
  if (const auto whole = host::check_boards(masks); !whole)
    return wrong(name, whole.error().message);
  return boards;
}

Result<std::vector<BoardOfFile>> read_boards(const std::string& path) {
  const auto text = KAZ_TRY(read_whole_file(path, kMaxBytes, "give a file of boards"));
  return parse_boards(path, {reinterpret_cast<const char*>(text.data()), text.size()});
}

}  // namespace kaz::tools
