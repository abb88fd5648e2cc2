// Extracts the messages of boards from a CAN log: ISO-TP (ISO 15765-2) on Kaz's identifiers (can_link.h).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/replay/can_log.h"

namespace kaz::tools {

struct CanMessage {
  std::size_t line = 0;  // line of the message's last frame
  Time time{};           // time of the last frame, since the first frame of the log
  std::uint32_t id = 0;
  bool from_host = false;
  std::vector<std::uint8_t> bytes;  // 1 to 4095 bytes: stuffed body and check of a protocol frame
};

struct CanMessages {
  std::vector<CanMessage> messages;  // in the order of their last frames
  std::size_t incomplete = 0;        // messages with a missing or wrong frame
  std::size_t other_frames = 0;  // frames with other identifiers, and remote, error and FD frames
};

// Fails (usage) if the log has no complete message of a host, or has messages on two interfaces. The error
// lists the identifiers or the interfaces of the log.
Result<CanMessages> can_messages(const std::string& name, const std::vector<CanLogFrame>& frames);

}  // namespace kaz::tools
