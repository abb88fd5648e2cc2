// What befell the line while something else was measured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/link_statistics.h"

namespace kaz::hil {

// Adds `what` to a list that begins with "on the line".
void add_trouble(std::string& trouble, const std::string& what);
// As "on the line 3 replies did not come, 1 frame came damaged", by the host's counts before and after;
// empty: nothing. Damage towards the board is among the replies that did not come.
std::string line_trouble(const host::LinkStatistics& before, const host::LinkStatistics& after);

}  // namespace kaz::hil
