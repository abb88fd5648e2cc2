// Finds the pairs of left and right pictures in folders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct PicturePair {
  std::string left, right;  // paths
};

// Each word is a file or a pattern ('eyes/left*.jpg'). Both names of a pair have the same last number
// (left07.jpg, right07.jpg), or no number. Pairs are sorted by it. Fails if no file matches a pattern, if two
// pictures of one eye have the same number, or if a picture has no partner.
Result<std::vector<PicturePair>> find_pairs(const std::vector<std::string>& left,
                                            const std::vector<std::string>& right);

}  // namespace kaz::tools
