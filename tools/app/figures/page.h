// HTML page that shows the drawn figures beside the captions of the paper's figures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace kaz::tools {

// Returns the caption of a figure in the paper. `number` must be in figure_numbers().
std::string paper_caption(int number);
// Returns the page. `result`: content of result.json. The page uses no files except the pictures in the same
// folder.
std::string figures_page(const nlohmann::ordered_json& result);

}  // namespace kaz::tools
