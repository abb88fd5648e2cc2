// Reads the weights of a balance policy.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/balance_setting.h"

#include <sstream>

#include "host/motion/balance.h"
#include "shared/base/files.hpp"

namespace kaz::tools {

Result<void> load_balance(const std::string& behavior,
                          std::map<std::string, std::string>& settings) {
  constexpr std::size_t kLargest = 1 << 20;
  const auto found = settings.find("balance");
  if (behavior != "go-forward" || found == settings.end() || found->second == "none" ||
      found->second == "learned" || motion::BalancePolicy::parse(found->second, "balance"))
    return {};
  const std::string path = found->second;
  const auto text = KAZ_TRY(
      read_whole_file(path, kLargest, "give balance=none, balance=learned, or a file of weights"));
  KAZ_TRY(motion::BalancePolicy::parse(text, path));
  // In one line, without comments.
  std::string weights;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find("//")));
    for (std::string word; words >> word;) weights += (weights.empty() ? "" : " ") + word;
  }
  found->second = weights;
  return {};
}

}  // namespace kaz::tools
