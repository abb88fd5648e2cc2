// Which moments of a run are worth a picture.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/moments.h"

namespace kaz::tools {

std::optional<std::string> Moments::on_phase(double at_s, std::string_view behavior,
                                             std::string_view phase) {
  std::optional<std::string> shown;
  if (due_ != nullptr) shown = due_->shown;  // it was shorter than that
  due_ = nullptr;
  if (phase == "track" && phase_ != "track" && tracked_ == 0) track_s_ = at_s;
  phase_ = phase;
  began_s_ = at_s;
  catching_ = behavior == "catch-ball";
  for (Awaited& one : caught_) {
    if (!catching_ || one.phase != phase || one.taken) continue;
    one.taken = true;
    due_ = &one;
    if (one.after_s == 0 && !shown) {
      shown = one.shown;
      due_ = nullptr;
    }
  }
  return shown;
}

std::optional<std::string> Moments::on_cycle(double at_s) {
  if (due_ != nullptr && at_s >= began_s_ + due_->after_s) {
    const std::string shown(due_->shown);
    due_ = nullptr;
    return shown;
  }
  if (catching_ || phase_ != "track" || tracked_ == kTracked) return std::nullopt;
  if (at_s < track_s_ + 0.4 + (expected_s_ - 0.4) * tracked_ / kTracked) return std::nullopt;
  ++tracked_;
  return "";
}

}  // namespace kaz::tools
