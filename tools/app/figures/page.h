// The figures on a page, beside what the paper shows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace kaz::tools {

// The paper's caption of a figure that there is (figures.h).
std::string paper_caption(int number);
// `result`: what result.json has. HTML that needs nothing but the pictures beside it.
std::string figures_page(const nlohmann::ordered_json& result);

}  // namespace kaz::tools
