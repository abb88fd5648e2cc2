// Describes line errors during a measurement as text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/link_statistics.h"

namespace kaz::hil {

// `trouble` is a list of line errors in words. If `trouble` is empty, sets `trouble` to "on the line",
// followed by `what`. Otherwise appends a comma and `what`.
void add_trouble(std::string& trouble, const std::string& what);
// `before` and `after` are error counts of a line at two times. Returns a text about the line errors between
// these times. For example, the text for one damaged frame is "on the line 1 frame arrived damaged". The text
// is empty if there were no line errors. A frame that is damaged on the way to the board appears as a missing
// reply.
std::string line_trouble(const host::LinkStatistics& before, const host::LinkStatistics& after);

}  // namespace kaz::hil
