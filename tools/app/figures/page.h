// HTML page of the figures, beside descriptions of the paper's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace kaz::tools {

// Returns the paper's caption. `number` must be in figure_numbers().
std::string paper_caption(int number);
// `result`: content of result.json. The page needs only the pictures beside it.
std::string figures_page(const nlohmann::ordered_json& result);

}  // namespace kaz::tools
