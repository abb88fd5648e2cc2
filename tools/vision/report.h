// Reports the results of vision for each frame: overlays, a table and JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/base/output.h"
#include "tools/drawing/figure.h"
#include "tools/vision/modules.h"
#include "tools/vision/picture_writer.h"
#include "vision/depth/swapped_cameras.h"

namespace kaz::tools {

// Return the JSON of a ball, a depth image or a flow image for result.json.
nlohmann::ordered_json ball_json(const vision::BallObservation& ball);
nlohmann::ordered_json depth_json(const vision::DepthImage& depth);
nlohmann::ordered_json flow_json(const vision::FlowImage& flow);

// Returns the number of frames, the computing times and the ages of results for each module that got frames.
// "computing" is in wall time, "age" in robot time. Empty if no module got a frame.
nlohmann::ordered_json module_statistics_json(const vision::Pipeline& pipeline);
// Returns the module statistics as one line for users; empty if no frame was processed.
std::string module_statistics_text(const vision::Pipeline& pipeline);

// Records each delivery of a pipeline as a line of CSV.
class DeliveryTable {
 public:
  // Registers this object as the pipeline's log, so the object must outlive the last delivery.
  explicit DeliveryTable(vision::Pipeline& pipeline);
  DeliveryTable(const DeliveryTable&) = delete;
  DeliveryTable& operator=(const DeliveryTable&) = delete;
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "module,frame,exposure_s,delivered_s,computing_ms,failed\n";
};

// Collects the results of all modules for each frame.
class VisionReport {
 public:
  // Subscribes to the modules of the pipeline, so the report must outlive the pipeline's last poll().
  // `options`: same as for add_modules(). `folder`: folder for overlays; null: no overlays are written. After
  // `max_frames` frames, further frames are skipped; 0: no limit.
  VisionReport(vision::Pipeline& pipeline, const VisionOptions& options, const OutputFolder* folder,
               std::uint64_t max_frames = 0);
  VisionReport(const VisionReport&) = delete;
  VisionReport& operator=(const VisionReport&) = delete;

  // Starts the entry of a frame with these facts. `name`: prefix of the name of the frame's overlay. For
  // frames without begin(), the prefix is the number of the frame.
  void begin(std::uint64_t sequence, const std::string& name, nlohmann::ordered_json facts);
  // Adds an entry for a frame that could not be processed.
  void add_error(nlohmann::ordered_json facts, const std::string& why);

  // Call end() after the last poll(). Completes the entries of frames that some modules dropped. Fails if an
  // overlay could not be written. After a signal, the remaining files are not written.
  Result<void> end();
  // Returns the number of overlays and exports that were not written because of a signal. These belong to the
  // last frames.
  std::size_t files_not_written() const { return writer_.dropped(); }

  const nlohmann::ordered_json& frames() const { return frames_; }
  bool full() const { return max_ > 0 && frames_.size() >= max_; }
  // Number of frames with a result of at least one module.
  std::size_t looked_at() const { return looked_at_; }
  // Returns whether the left and right camera are swapped, judged from all pairs so far. Always false for
  // pictures of one eye.
  bool cameras_swapped() const { return eyes_.found(); }
  // Returns a table of all frames as CSV, one line per frame.
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
