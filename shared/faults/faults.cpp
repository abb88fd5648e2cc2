// The table of faults, and lists of faults.
// SPDX-License-Identifier: Apache-2.0
#include "shared/faults/faults.h"

#include <algorithm>
#include <iterator>

#include "shared/base/counted.hpp"
#include "shared/board/board.h"

namespace kaz::faults {
namespace {

constexpr Kind kTable[] = {
#define KZ_FAULT(name, target, parameter, unit, low, high, initial, where, text) \
  {Name::name, #name, Target::target, parameter, unit, low, high, initial, Where::where, text},
#include "shared/faults/faults.def"
};

}  // namespace

std::span<const Kind> kinds() {
  return kTable;
}

const Kind& kind_of(Name name) {
  return kTable[static_cast<std::size_t>(name)];
}

bool Fault::is_possible() const {
  const Kind& kind = kind_of(name);
  const bool right_joint =
      kind.target == Target::joint ? joint >= 0 && joint < KZ_JOINTS : joint == -1;
  return right_joint && value >= kind.low && value <= kind.high;
}

std::optional<std::string_view> Schedule::only_simulated() const {
  for (const Fault& fault : faults_) {
    if (kind_of(fault.name).where == Where::simulation) return kind_of(fault.name).name;
  }
  return std::nullopt;
}

std::vector<Fault> Schedule::not_begun(Time end) const {
  std::vector<Fault> later;
  std::ranges::copy_if(faults_, std::back_inserter(later),
                       [end](const Fault& fault) { return fault.at >= end; });
  return later;
}

std::string not_begun_text(std::span<const Fault> faults) {
  if (faults.empty()) return "";
  constexpr std::size_t kMaxNamed = 6;
  std::string text = counted(faults.size(), "fault") +
                     " never began, because the run ended before " +
                     (faults.size() == 1 ? "it: " : "them: ");
  for (std::size_t i = 0; i < std::min(faults.size(), kMaxNamed); ++i)
    text += (i > 0 ? ", " : "") + text_of(faults[i]);
  return text + (faults.size() > kMaxNamed ? ", ..." : "");
}

std::string Schedule::text() const {
  std::string text;
  for (const Fault& fault : faults_) text += text_of(fault) + "\n";
  return text;
}

}  // namespace kaz::faults
