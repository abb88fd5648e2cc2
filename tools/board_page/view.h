// A session as JSON, for the page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "tools/board_page/session.h"

namespace kaz::board_page {

// Two digits a byte, lower case.
std::string hex(std::span<const std::uint8_t> bytes);
// Time, chip, pins, supply and joints. Targets and flags are read from the servo's state in the chip's RAM,
// as a debugger does, without a frame. With `registers`: those of the I/O page that can be read.
std::string view_json(const Session& session, bool registers);
// A list of what went over the line.
std::string line_json(std::span<const LineEntry> entries);

}  // namespace kaz::board_page
