// The table of faults, and schedules at random.
// SPDX-License-Identifier: Apache-2.0
#include "shared/faults/faults.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "shared/base/counted.hpp"
#include "shared/base/random.hpp"
#include "shared/board/board.h"

namespace kaz::faults {
namespace {

constexpr Kind kTable[] = {
#define KZ_FAULT(name, target, parameter, unit, low, high, initial, where, text) \
  {Name::name, #name, Target::target, parameter, unit, low, high, initial, Where::where, text},
#include "shared/faults/faults.def"
};

bool wanted(const Kind& kind, const RandomOptions& options) {
  switch (kind.target) {
    case Target::line:
      return options.line;
    case Target::joint:
      return options.joints;
    default:
      return options.power;
  }
}

// Probabilities and similar parameters are log-uniform, so that small values are as likely as large ones.
double random_value(const Kind& kind, Random& random) {
  if (kind.parameter.empty()) return 0;
  if (random.chance(0.3)) return kind.initial;
  if (random.chance(0.1)) return random.chance(0.5) ? kind.low : kind.high;
  if (kind.low < 0) return kind.low + random.uniform() * (kind.high - kind.low);
  return kind.low + (kind.high - kind.low) * std::pow(10.0, -3.0 * random.uniform());
}

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

Schedule random_schedule(std::uint64_t seed, const RandomOptions& options) {
  Schedule schedule;
  std::vector<const Kind*> from;
  for (const Kind& kind : kTable) {
    if (wanted(kind, options)) from.push_back(&kind);
  }
  if (from.empty() || options.per_second <= 0) return schedule;
  Random random(mix64(seed));
  // Whole milliseconds and values of six digits, so that the text is exact.
  constexpr Time ms = std::chrono::milliseconds(1);
  const double mean_ms = 1000.0 / options.per_second;
  double at_ms = 0;
  while (true) {
    at_ms += -std::log(1.0 - random.uniform()) * mean_ms;
    const Time at = static_cast<std::int64_t>(at_ms) * ms;
    if (at >= options.length) return schedule;
    const Kind& kind = *from[random.below(static_cast<std::uint32_t>(from.size()))];
    Fault fault;
    fault.name = kind.id;
    fault.at = at;
    fault.length = (1 + random.below(static_cast<std::uint32_t>(
                            std::max<std::int64_t>(1, options.longest / ms)))) *
                   ms;
    if (kind.target == Target::joint) fault.joint = static_cast<int>(random.below(KZ_JOINTS));
    if (kind.target == Target::line) fault.way = static_cast<Way>(random.below(3));
    fault.value = std::round(random_value(kind, random) * 1e6) / 1e6;
    schedule.add(fault);
  }
}

}  // namespace kaz::faults
