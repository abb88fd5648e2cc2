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

// Each entry of `left` and `right` is a path or a pattern ('eyes/left*.jpg'). The last number in both names
// of a pair is the same (left07.jpg, right07.jpg), or both names have no number. Pairs are sorted by this
// number. Fails if no file matches a pattern, if two pictures of one eye have the same number, or if a
// picture has no partner.
Result<std::vector<PicturePair>> find_pairs(const std::vector<std::string>& left,
                                            const std::vector<std::string>& right);

}  // namespace kaz::tools
