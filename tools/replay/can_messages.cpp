// Assembles ISO-TP messages from the frames of a CAN log.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/can_messages.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "host/link/can_link.h"
#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

// The upper four bits of a frame's first byte.
enum class IsoTp : std::uint8_t { single = 0, first = 1, consecutive = 2, flow_control = 3 };

// One direction of one board: the message that is under way.
struct Assembly {
  std::vector<std::uint8_t> bytes;
  std::size_t length = 0;     // of the whole message; 0: no message is under way
  std::uint8_t sequence = 0;  // of the next consecutive frame
};

enum class Step { more, complete, broken };

Step begin_message(Assembly& assembly, const std::vector<std::uint8_t>& data) {
  const bool interrupted = assembly.length > 0;
  assembly = {};
  const std::size_t length = std::size_t{data[0] & 15U} << 8 | (data.size() > 1 ? data[1] : 0U);
  if (length < 8 || data.size() != 8) return Step::broken;
  assembly.length = length;
  assembly.sequence = 1;
  assembly.bytes.assign(data.begin() + 2, data.end());
  return interrupted ? Step::broken : Step::more;
}

Step add_consecutive(Assembly& assembly, const std::vector<std::uint8_t>& data) {
  if (assembly.length == 0) return Step::more;  // the rest of a message that was already broken
  const std::size_t wanted = std::min<std::size_t>(assembly.length - assembly.bytes.size(), 7);
  if ((data[0] & 15) != assembly.sequence || data.size() < 1 + wanted) {
    assembly = {};
    return Step::broken;
  }
  assembly.sequence = static_cast<std::uint8_t>((assembly.sequence + 1) & 15);
  assembly.bytes.insert(assembly.bytes.end(), data.begin() + 1,
                        data.begin() + 1 + static_cast<std::ptrdiff_t>(wanted));
  return assembly.bytes.size() == assembly.length ? Step::complete : Step::more;
}

Step assemble(Assembly& assembly, const std::vector<std::uint8_t>& data) {
  if (data.empty()) return Step::broken;
  switch (static_cast<IsoTp>(data[0] >> 4)) {
    case IsoTp::single: {
      const std::size_t length = data[0] & 15U;
      assembly = {};
      if (length == 0 || length >= data.size()) return Step::broken;
      assembly.bytes.assign(data.begin() + 1,
                            data.begin() + 1 + static_cast<std::ptrdiff_t>(length));
      return Step::complete;
    }
    case IsoTp::first:
      return begin_message(assembly, data);
    case IsoTp::consecutive:
      return add_consecutive(assembly, data);
    case IsoTp::flow_control:  // for messages with the other identifier of the board
      return Step::more;
  }
  return Step::broken;
}

bool is_request(const CanLogFrame& frame) {
  return frame.id > host::kCanRequests && frame.id <= host::kCanRequests + host::kCanAll;
}

bool is_kaz(const CanLogFrame& frame) {
  const bool reply =
      frame.id > host::kCanReplies && frame.id <= host::kCanReplies + KZ_ADDRESS_LAST;
  return frame.kind == CanLogFrame::Kind::data && !frame.extended && (is_request(frame) || reply);
}

std::string identifiers_of(const std::vector<CanLogFrame>& frames) {
  constexpr std::size_t kMostNamed = 8;
  std::set<std::uint32_t> ids;
  for (const CanLogFrame& frame : frames) ids.insert(frame.id);
  std::string text;
  for (const std::uint32_t id : ids) {
    char hex[16];
    std::snprintf(hex, sizeof hex, "0x%X", static_cast<unsigned>(id));
    text += (text.empty() ? "" : ", ") + std::string(hex);
    if (text.size() > kMostNamed * 6) return text + ", ...";
  }
  return text;
}

}  // namespace

Result<CanMessages> can_messages(const std::string& name, const std::vector<CanLogFrame>& frames) {
  CanMessages result;
  std::map<std::uint32_t, Assembly> assemblies;
  std::string_view interface;
  bool requested = false;
  for (const CanLogFrame& frame : frames) {
    if (!is_kaz(frame)) {
      ++result.other_frames;
      continue;
    }
    if (interface.empty()) interface = frame.interface;
    if (frame.interface != interface)
      return fail(Fault::usage, name + ":" + std::to_string(frame.line) +
                                    ": has frames of boards on both " + shown_text(interface) +
                                    " and " + shown_text(frame.interface) +
                                    ": write the lines of one interface to a file (grep)");
    Assembly& assembly = assemblies[frame.id];
    const Step step = assemble(assembly, frame.data);
    if (step == Step::broken) ++result.incomplete;
    if (step != Step::complete) continue;
    result.messages.push_back(
        {frame.line, frame.time, frame.id, is_request(frame), std::move(assembly.bytes)});
    assembly = {};
    requested = requested || is_request(frame);
  }
  for (const auto& [id, assembly] : assemblies) result.incomplete += assembly.length > 0 ? 1 : 0;
  if (!requested)
    return fail(Fault::usage,
                name +
                    ": contains no request of a host to a board (identifiers 0x6A1 to "
                    "0x6AF); its identifiers are " +
                    identifiers_of(frames) +
                    ": record the bus of `kaz can-bridge` with `candump -l`");
  return result;
}

}  // namespace kaz::tools
