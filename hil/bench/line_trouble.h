// Describes line errors during a measurement as text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/link_statistics.h"

namespace kaz::hil {

// Appends `what` to the list in `trouble`. A list that is not empty begins with "on the line".
void add_trouble(std::string& trouble, const std::string& what);
// Returns a text about the line errors between two counts: "on the line 3 replies were lost, 1 frame arrived
// damaged". The text is empty if there were no line errors. A frame that is damaged on the way to the board
// appears as a missing reply.
std::string line_trouble(const host::LinkStatistics& before, const host::LinkStatistics& after);

}  // namespace kaz::hil
