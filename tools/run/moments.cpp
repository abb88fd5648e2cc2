// Which moments of a run are worth a picture.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/moments.h"

#include <algorithm>

namespace kaz::tools {

using behavior::Milestone;

std::optional<std::string> Moments::on_phase(double at_s, std::span<const Milestone> milestones,
                                             std::string_view phase) {
  std::optional<std::string> shown;
  if (due_ != nullptr) shown = due_->name;  // it was shorter than that
  due_ = nullptr;
  if (phase == "track" && phase_ != "track" && tracked_ == 0) track_s_ = at_s;
  phase_ = phase;
  began_s_ = at_s;
  has_milestones_ = !milestones.empty();
  const auto found = std::ranges::find(milestones, phase, &Milestone::phase);
  if (found == milestones.end() || std::ranges::count(begun_, &*found) > 0) return shown;
  begun_.push_back(&*found);
  due_ = &*found;
  if (due_->after_s == 0 && !shown) {
    shown = due_->name;
    due_ = nullptr;
  }
  return shown;
}

std::optional<std::string> Moments::on_cycle(double at_s) {
  if (due_ != nullptr && at_s >= began_s_ + due_->after_s) {
    const std::string shown(due_->name);
    due_ = nullptr;
    return shown;
  }
  if (has_milestones_ || phase_ != "track" || tracked_ == kTracked) return std::nullopt;
  if (at_s < track_s_ + 0.4 + (expected_s_ - 0.4) * tracked_ / kTracked) return std::nullopt;
  ++tracked_;
  return "";
}

}  // namespace kaz::tools
