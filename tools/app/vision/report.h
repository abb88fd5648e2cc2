// What vision found on each frame, as overlays, a table, and JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/app/base/output.h"
#include "tools/app/vision/modules.h"
#include "tools/app/vision/picture_writer.h"
#include "tools/figure/figure.h"
#include "vision/depth/swapped_cameras.h"

namespace kaz::tools {

// A ball, depth, flow in result.json.
nlohmann::ordered_json ball_json(const vision::BallObservation& ball);
nlohmann::ordered_json depth_json(const vision::DepthImage& depth);
nlohmann::ordered_json flow_json(const vision::FlowImage& flow);

// Of a pipeline's modules that got frames: how many, how long it took, how old it was. Times are of the wall
// clock where they are "computing", of the robot where they are "age". Empty if there was no frame.
nlohmann::ordered_json module_statistics_json(const vision::Pipeline& pipeline);
// The same for people: a line, or nothing where no frame was looked at.
std::string module_statistics_text(const vision::Pipeline& pipeline);

// Each delivery of a pipeline as a line of CSV.
class DeliveryTable {
 public:
  // Takes the pipeline's log.
  explicit DeliveryTable(vision::Pipeline& pipeline);
  DeliveryTable(const DeliveryTable&) = delete;
  DeliveryTable& operator=(const DeliveryTable&) = delete;
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "module,frame,exposure_s,delivered_s,computing_ms,failed\n";
};

class VisionReport {
 public:
  // Subscribes to the modules, all of which the pipeline has; it has to outlive the pipeline's
  // last poll().
  // `options` is what the modules were made with. `folder`: where overlays go; null: none.
  // `max_frames`: later frames are skipped; 0: no limit.
  VisionReport(vision::Pipeline& pipeline, const VisionOptions& options, const OutputFolder* folder,
               std::uint64_t max_frames = 0);
  VisionReport(const VisionReport&) = delete;
  VisionReport& operator=(const VisionReport&) = delete;

  // Begins a frame's entry with what is known of it beforehand; `name` begins its overlay's name.
  // Frames that are not begun are called by their number.
  void begin(std::uint64_t sequence, const std::string& name, nlohmann::ordered_json facts);
  // An entry for a frame that could not be processed at all.
  void add_error(nlohmann::ordered_json facts, const std::string& why);

  // After the last poll(): frames that some modules dropped are closed, too. An error where an
  // overlay could not be written. After a signal those that are not written yet are dropped.
  Result<void> end();
  // Overlays and exports that a signal kept from being written: those of the last frames.
  std::size_t files_not_written() const { return writer_.dropped(); }

  const nlohmann::ordered_json& frames() const { return frames_; }
  bool full() const { return max_ > 0 && frames_.size() >= max_; }
  // Frames with a result of at least one module.
  std::size_t looked_at() const { return looked_at_; }
  // Of the whole run. Pictures of one eye are never swapped.
  bool cameras_swapped() const { return eyes_.found(); }
  // A line for each frame.
  std::string table() const;

 private:
  struct Entry {
    std::string name;
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    std::vector<figure::Panel> panels;
    std::size_t heard = 0;
    bool seen = false;
  };
  Entry& entry(const vision::Frame& frame);
  void export_files(const vision::Frame& frame, const vision::DepthImage& depth,
                    const std::string& name);
  void heard(const vision::Frame& frame, const Error* error);
  void close(std::uint64_t sequence);

  const OutputFolder* folder_;
  VisionOptions options_;
  vision::SwappedCameras eyes_;
  std::vector<std::string> modules_;
  std::map<std::uint64_t, Entry> open_;
  nlohmann::ordered_json frames_ = nlohmann::ordered_json::array();
  std::size_t looked_at_ = 0;
  std::uint64_t max_;
  PictureWriter writer_;
};

}  // namespace kaz::tools
