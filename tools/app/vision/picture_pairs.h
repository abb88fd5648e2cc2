// Pictures of two eyes in folders: which left one belongs to which right one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct PicturePair {
  std::string left, right;  // paths
};

// Each word is a file or a pattern ('eyes/left*.jpg'). A pair has the same last number in both names
// (left07.jpg, right07.jpg), or none in either; pairs are sorted by it. Errors: a pattern that no
// file matches, two pictures of one eye with the same number, a picture without its partner.
Result<std::vector<PicturePair>> find_pairs(const std::vector<std::string>& left,
                                            const std::vector<std::string>& right);

}  // namespace kaz::tools
