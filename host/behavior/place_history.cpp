// The latest places of odometry, interpolated.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/place_history.h"

#include <algorithm>
#include <cmath>

namespace kaz::behavior {

namespace {

constexpr std::size_t kPlaces = 200;  // 2 to 4 s

}  // namespace

void PlaceHistory::add(Time t, const motion::Place& place) {
  if (!places_.empty() && t <= places_.back().first) return;
  places_.emplace_back(t, place);
  if (places_.size() > kPlaces) places_.pop_front();
}

std::optional<motion::Place> PlaceHistory::at(Time t) const {
  if (places_.empty() || t < places_.front().first) return std::nullopt;
  const auto after = std::find_if(places_.begin(), places_.end(),
                                  [&](const auto& entry) { return entry.first >= t; });
  if (after == places_.end()) return places_.back().second;
  if (after == places_.begin()) return after->second;
  const auto before = std::prev(after);
  const double u = seconds(t - before->first) / seconds(after->first - before->first);
  motion::Place place = before->second;
  place.x = std::lerp(place.x, after->second.x, u);
  place.y = std::lerp(place.y, after->second.y, u);
  place.heading = std::lerp(place.heading, after->second.heading, u);
  return place;
}

}  // namespace kaz::behavior
