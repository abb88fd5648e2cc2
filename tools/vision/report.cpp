// Collects what modules say of a frame until all have spoken.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/report.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/counted.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/drawing/vision_views.h"
#include "vision/depth/depth_file.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

struct FlowSummary {
  double known = 0, median_px = 0, p95_px = 0;  // lengths
};

FlowSummary summarize(const vision::FlowImage& flow) {
  std::vector<float> lengths;
  for (const Eigen::Vector2f& f : flow.flow_px) {
    if (!std::isnan(f.x())) lengths.push_back(f.norm());
  }
  FlowSummary summary;
  if (lengths.empty()) return summary;
  std::sort(lengths.begin(), lengths.end());
  summary.known = static_cast<double>(lengths.size()) / static_cast<double>(flow.flow_px.size());
  summary.median_px = static_cast<double>(lengths[lengths.size() / 2]);
  summary.p95_px = static_cast<double>(lengths[(lengths.size() - 1) * 95 / 100]);
  return summary;
}

Json moving_json(const vision::MovingRegions& moving) {
  Json all = Json::array();
  for (const vision::MovingRegion& region : moving.regions) {
    Json one{{"center_px", {region.center_u, region.center_v}},
             {"box_px", {region.left, region.top, region.right, region.bottom}},
             {"velocity_px_s", {region.velocity_px_s.x(), region.velocity_px_s.y()}},
             {"confidence", region.confidence}};
    if (region.position_m && region.velocity_m_s) {
      const Eigen::Vector3d p = *region.position_m, v = *region.velocity_m_s;
      one["position_m"] = {p.x(), p.y(), p.z()};
      one["velocity_m_s"] = {v.x(), v.y(), v.z()};
    }
    all.push_back(std::move(one));
  }
  return all;
}

Json planes_json(const vision::PlaneSegments& planes) {
  Json all = Json::array();
  for (const vision::PlaneSegment& s : planes.segments) {
    Json one{{"plane", s.plane},
             {"normal", {s.normal.x(), s.normal.y(), s.normal.z()}},
             {"distance_m", s.distance_m},
             {"error_px", s.error_px},
             {"error_m", s.error_m},
             {"pixels", s.pixels},
             {"box_px", {s.left, s.top, s.right, s.bottom}},
             {"extent_m", {s.length_m, s.width_m}}};
    // Without the posture the floor is not known among them.
    if (planes.info.posture_known) one["floor"] = s.floor;
    all.push_back(std::move(one));
  }
  return all;
}

vision::Image ball_picture(const vision::Image& left, const vision::BallObservation& ball) {
  vision::Image image = left;
  if (!ball.found) return image;
  figure::draw_circle(image, ball.center_u, ball.center_v, ball.radius_px + 2, figure::kYellow);
  char text[32];
  std::snprintf(text, sizeof text, "%.3f m", ball.distance_m);
  figure::draw_text(image, ball.center_u + ball.radius_px + 6, ball.center_v + 4, text,
                    std::max(10.0, left.width / 40.0), figure::kYellow);
  return image;
}

template <class T>
void subscribe(vision::Pipeline& pipeline, const char* module,
               std::function<void(const vision::Frame&, const T*, const Error*)> use) {
  if (!pipeline.has(module)) return;
  // Cannot fail: the module is there.
  static_cast<void>(pipeline.subscribe<T>(module, std::move(use)));
}

std::string csv_text(const Json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (!value.is_string()) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

Json depth_json(const vision::DepthImage& depth) {
  std::vector<double> known;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      if (depth.known(u, v)) known.push_back(depth.depth_m(u, v));
    }
  }
  Json json{{"known",
             static_cast<double>(known.size()) / static_cast<double>(depth.disparity_px.size())}};
  if (known.empty()) return json;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  json["median_m"] = *middle;
  return json;
}

Json flow_json(const vision::FlowImage& flow) {
  const FlowSummary summary = summarize(flow);
  Json json{{"known", summary.known}};
  if (summary.known == 0) return json;
  json["median_px"] = summary.median_px;
  json["p95_px"] = summary.p95_px;
  return json;
}

Json ball_json(const vision::BallObservation& b) {
  Json json{{"found", b.found}};
  if (!b.found) return json;
  json["center_px"] = {b.center_u, b.center_v};
  json["radius_px"] = b.radius_px;
  json["distance_m"] = b.distance_m;
  json["position_m"] = {b.position().x(), b.position().y(), b.position().z()};
  json["confidence"] = b.confidence;
  return json;
}

Json module_statistics_json(const vision::Pipeline& pipeline) {
  const auto ms = [](double s) { return static_cast<double>(std::llround(s * 1e6)) / 1e3; };
  Json all = Json::object();
  for (const vision::ModuleStatistics& m : pipeline.statistics()) {
    if (m.delivered + m.failed + m.dropped == 0) continue;
    Json& json = all[m.name];
    json = {{"frames", m.delivered}, {"failed", m.failed}, {"dropped", m.dropped}};
    if (m.delivered + m.failed == 0) continue;  // no times
    json["computing_ms"] = {{"median", ms(m.computing_median_s)},
                            {"p95", ms(m.computing_p95_s)},
                            {"max", ms(m.computing_max_s)}};
    json["age_ms"] = {
        {"median", ms(m.age_median_s)}, {"p95", ms(m.age_p95_s)}, {"max", ms(m.age_max_s)}};
  }
  return all;
}

std::string module_statistics_text(const vision::Pipeline& pipeline) {
  std::string text;
  for (const vision::ModuleStatistics& m : pipeline.statistics()) {
    if (m.delivered + m.failed == 0) continue;
    char part[160];
    std::snprintf(part, sizeof part, "%s%s %.2f ms (95 %%: %.2f)", text.empty() ? "" : ", ",
                  m.name.c_str(), 1e3 * m.computing_median_s, 1e3 * m.computing_p95_s);
    text += part;
    if (m.dropped > 0) text += ", " + counted(m.dropped, "frame") + " dropped";
  }
  return text;
}

DeliveryTable::DeliveryTable(vision::Pipeline& pipeline) {
  pipeline.log([this](const vision::Delivery& d) {
    char line[160];
    std::snprintf(line, sizeof line, "%.*s,%llu,%.6f,%.6f,%.3f,%d\n",
                  static_cast<int>(d.module.size()), d.module.data(),
                  static_cast<unsigned long long>(d.sequence), seconds(d.exposure),
                  seconds(d.delivered), 1e3 * d.computing_s, d.failed ? 1 : 0);
    text_ += line;
  });
}

VisionReport::VisionReport(vision::Pipeline& pipeline, const VisionOptions& options,
                           const OutputFolder* folder, std::uint64_t max_frames)
    : folder_(folder), options_(options), eyes_(options.depth), max_(max_frames), writer_([] {
        return received_signal() != 0;
      }) {
  for (const vision::ModuleStatistics& m : pipeline.statistics()) modules_.push_back(m.name);
  subscribe<vision::BallObservation>(
      pipeline, "color", [this](const vision::Frame& frame, const auto* ball, const Error* error) {
        if (ball != nullptr) {
          Entry& e = entry(frame);
          e.json["ball"] = ball_json(*ball);
          if (folder_ != nullptr) {
            const vision::Image& left = frame.images().left;
            vision::Mask mask;
            vision::ColorExtractor(options_.ball.color).extract(left, mask);
            e.panels.push_back({ball_picture(left, *ball), ball->found ? "ball" : "no ball"});
            e.panels.push_back({figure::mask_picture(mask, left), "color"});
          }
        }
        heard(frame, error);
      });
  subscribe<vision::DepthImage>(
      pipeline, "depth", [this](const vision::Frame& frame, const auto* depth, const Error* error) {
        if (depth != nullptr) {
          Entry& e = entry(frame);
          e.json["depth"] = depth_json(*depth);
          if (folder_ != nullptr)
            e.panels.push_back(
                {figure::depth_picture(*depth), "depth: red 0.2 m, green 0.7 m, blue 3 m"});
          export_files(frame, *depth, e.name);
        }
        heard(frame, error);
      });
  subscribe<vision::FlowImage>(
      pipeline, "flow", [this](const vision::Frame& frame, const auto* flow, const Error* error) {
        if (flow != nullptr && flow->width > 0) {
          Entry& e = entry(frame);
          e.json["flow"] = flow_json(*flow);
          if (folder_ != nullptr) {
            const double longest = std::max(2.0, e.json["flow"].value("p95_px", 0.0));
            char caption[64];
            std::snprintf(caption, sizeof caption, "flow: hue is direction; full color at %.0f px",
                          longest);
            e.panels.push_back({figure::flow_picture(*flow, longest), caption});
          }
        }
        heard(frame, error);
      });
  subscribe<vision::MovingRegions>(
      pipeline, "moving",
      [this](const vision::Frame& frame, const auto* moving, const Error* error) {
        if (moving != nullptr && moving->cells_across > 0) {
          Entry& e = entry(frame);
          e.json["moving"] = moving_json(*moving);
          if (folder_ != nullptr) {
            // Regions are in pixels of the earlier picture; objects have moved little since.
            vision::Image image = frame.images().left;
            for (const vision::MovingRegion& region : moving->regions) {
              figure::draw_circle(
                  image, region.center_u, region.center_v,
                  0.5 * std::hypot(region.right - region.left, region.bottom - region.top),
                  figure::kOrange);
            }
            e.panels.push_back({std::move(image), std::to_string(moving->regions.size()) +
                                                      " independently moving objects"});
          }
        }
        heard(frame, error);
      });
  subscribe<vision::PlaneSegments>(
      pipeline, "floor", [this](const vision::Frame& frame, const auto* floor, const Error* error) {
        if (floor != nullptr && folder_ != nullptr)
          entry(frame).panels.push_back({figure::plane_picture(frame.images().left, *floor),
                                         "planes with refined edges of the floor"});
        heard(frame, error);
      });
  subscribe<vision::PlaneSegments>(
      pipeline, "planes",
      [this](const vision::Frame& frame, const auto* planes, const Error* error) {
        if (planes != nullptr) {
          Entry& e = entry(frame);
          e.json["planes"] = planes_json(*planes);
          if (folder_ != nullptr)
            e.panels.push_back({figure::plane_picture(frame.images().left, *planes),
                                planes->floor_found() ? "planes: green is the floor" : "planes"});
        }
        heard(frame, error);
      });
}

void VisionReport::export_files(const vision::Frame& frame, const vision::DepthImage& depth,
                                const std::string& name) {
  if (folder_ == nullptr || full()) return;
  if (options_.export_depth)
    writer_.add([path = folder_->path(name + ".depth.png"), depth]() -> Result<void> {
      const auto bytes = KAZ_TRY(vision::depth_png(depth));
      return figure::write_file(path, bytes);
    });
  if (options_.export_points)
    writer_.add([path = folder_->path(name + ".points.ply"), depth,
                 images = frame.shared_images()]() -> Result<void> {
      vision::PointCloud cloud;
      vision::point_cloud(depth, cloud);
      const auto bytes = KAZ_TRY(vision::points_ply(cloud, images->left));
      return figure::write_file(path, bytes);
    });
}

VisionReport::Entry& VisionReport::entry(const vision::Frame& frame) {
  const std::uint64_t sequence = frame.info().sequence;
  const auto [at, fresh] = open_.try_emplace(sequence);
  if (fresh) {
    char name[32];
    std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(sequence));
    at->second.name = name;
    at->second.json = {{"frame", sequence}, {"exposure_s", seconds(frame.info().exposure)}};
  }
  return at->second;
}

void VisionReport::heard(const vision::Frame& frame, const Error* error) {
  Entry& e = entry(frame);
  if (error != nullptr) {
    // The first failure; the others follow from it.
    if (!e.json.contains("error")) e.json["error"] = error->message;
  } else {
    if (!e.seen) eyes_.look(frame.images(), frame.info());
    e.seen = true;
  }
  if (++e.heard == modules_.size()) close(frame.info().sequence);
}

// Older frames that are still open lack modules that dropped them.
void VisionReport::close(std::uint64_t sequence) {
  while (!open_.empty() && open_.begin()->first <= sequence) {
    Entry& e = open_.begin()->second;
    if (full()) {
      open_.erase(open_.begin());
      continue;
    }
    if (e.seen) ++looked_at_;
    if (folder_ != nullptr && !e.panels.empty()) {
      const int columns = e.panels.size() > 2 && e.panels.size() % 3 == 0 ? 3 : 2;
      writer_.add(*folder_, e.name + ".vision.png", std::move(e.panels), columns);
    }
    frames_.push_back(std::move(e.json));
    open_.erase(open_.begin());
  }
}

void VisionReport::begin(std::uint64_t sequence, const std::string& name, Json facts) {
  Entry& e = open_[sequence];
  e.name = name;
  e.json = std::move(facts);
}

void VisionReport::add_error(Json facts, const std::string& why) {
  facts["error"] = why;
  frames_.push_back(std::move(facts));
}

Result<void> VisionReport::end() {
  if (!open_.empty()) close(open_.rbegin()->first);
  return writer_.finish();
}

std::string VisionReport::table() const {
  std::string text =
      "frame,ball,ball_distance_m,depth_known,depth_median_m,flow_known,flow_median_px,moving,"
      "planes,floor,error\n";
  for (const Json& one : frames_) {
    const auto cell = [](const Json& of, const char* key) {
      return of.contains(key) ? csv_text(of[key]) : std::string();
    };
    const Json ball = one.value("ball", Json::object()), depth = one.value("depth", Json::object()),
               flow = one.value("flow", Json::object());
    std::string planes, floor, moving;
    if (one.contains("moving")) moving = std::to_string(one["moving"].size());
    if (one.contains("planes")) {
      planes = std::to_string(one["planes"].size());
      for (const Json& s : one["planes"]) {
        if (!s.contains("floor")) continue;
        if (floor != "true") floor = s["floor"].get<bool>() ? "true" : "false";
      }
    }
    text += cell(one, one.contains("left") ? "left" : "frame") + "," + cell(ball, "found") + "," +
            cell(ball, "distance_m") + "," + cell(depth, "known") + "," + cell(depth, "median_m") +
            "," + cell(flow, "known") + "," + cell(flow, "median_px") + "," + moving + "," +
            planes + "," + floor + "," + cell(one, "error") + "\n";
  }
  return text;
}

}  // namespace kaz::tools
