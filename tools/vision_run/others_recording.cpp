// `kaz vision run` on the stereo pictures of another program's recording.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision_run/others_recording.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/counted.hpp"
#include "sim/runtime/formats/picture_messages.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/vision/report.h"
#include "tools/vision_run/picture_topics.h"
#include "tools/vision_run/stereo_run.h"
#include "vision/calibration/rectify.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::tools {
namespace {

// Decodes and rectifies the pictures of a pair.
class PairDecoder {
 public:
  PairDecoder(const sim::McapRecording& recording, const RecordedEyes& eyes)
      : recording_(recording), eyes_(eyes), rectifier_(eyes.calibration) {}

  Result<vision::StereoImages> decode(const RecordedPair& pair) const {
    vision::StereoImages images;
    images.left = KAZ_TRY(picture(*pair.left, "left picture"));
    images.right = KAZ_TRY(picture(*pair.right, "right picture"));
    if (eyes_.rectified) return images;
    vision::StereoImages rectified;
    rectifier_.rectify(images, rectified);
    return rectified;
  }

 private:
  Result<vision::Image> picture(const sim::McapRecording::Message& message,
                                const std::string& name) const {
    const auto parsed = KAZ_TRY(sim::parse_picture(recording_, message));
    auto image = KAZ_TRY(sim::decode_message_picture(parsed, name));
    const auto& c = eyes_.calibration;
    if (image.width == c.width && image.height == c.height) return image;
    return fail(Fault::usage, name + ": its size is " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height) + ": must be " +
                                  std::to_string(c.width) + " x " + std::to_string(c.height) +
                                  ", as in the calibration");
  }

  const sim::McapRecording& recording_;
  const RecordedEyes& eyes_;
  vision::Rectifier rectifier_;
};

Result<void> check_others_options(const RecordedOptions& options, const VisionOptions& vision) {
  if (options.view_deg != 0)
    return fail(Fault::usage,
                "--view is only valid with folders of pictures; a recording of another program "
                "needs topics camera_info or --calibration FILE");
  return refuse(vision, {"moving", "floor"},
                "needs the robot's posture, which recordings of other programs do not contain");
}

void report_left_out(const RecordedPairs& found) {
  if (found.unpaired > 0)
    std::fprintf(stderr, "kaz vision run: left out: %s without a picture of the other eye\n",
                 counted(found.unpaired, "picture").c_str());
  if (found.invalid > 0)
    std::fprintf(stderr,
                 "kaz vision run: left out: %s that do not have the fields of their schema\n",
                 counted(found.invalid, "message").c_str());
}

}  // namespace

Result<bool> run_on_others_recording(const RecordedOptions& options,
                                     const sim::McapRecording& recording,
                                     const VisionOptions& vision) {
  KAZ_TRY(check_others_options(options, vision));
  const auto topics = KAZ_TRY(stereo_topics(recording, options.in, options.topics));
  const auto eyes = KAZ_TRY(recorded_eyes(recording, options.in, topics, options.calibration));
  KAZ_TRY(check_nearest(options, eyes.calibration.rectified));
  const RecordedPairs found = pairs_in(recording, topics);
  report_left_out(found);
  if (found.pairs.empty())
    return fail(Fault::usage, options.in + ": has no pictures of " + topics.left + " and " +
                                  topics.right + " within 5 ms: record both cameras at once");
  const auto folder = KAZ_TRY(OutputFolder::begin(options.out, vision_output()));
  const PairDecoder decoder(recording, eyes);
  vision::Pipeline pipeline({vision::Pace::lockstep, Time(0)});
  KAZ_TRY(add_modules(vision, pipeline));
  VisionReport report(pipeline, vision, &folder);
  Progress progress("kaz vision", options.json);
  const std::size_t count = options.frames > 0
                                ? std::min<std::size_t>(options.frames, found.pairs.size())
                                : found.pairs.size();
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  bool interrupted = false;
  for (std::size_t i = 0; i < count; ++i) {
    if ((interrupted = interrupt.requested())) break;
    const RecordedPair& pair = found.pairs[i];
    const std::string name = std::to_string(i);
    progress.update(static_cast<double>(i) / static_cast<double>(count), "pair " + name);
    const nlohmann::ordered_json facts{{"pair", i}, {"stamp_ns", pair.stamp_ns}};
    auto images = decoder.decode(pair);
    if (!images) {
      report.add_error(facts, "pair " + name + ": " + images.error().message);
      continue;
    }
    vision::FrameInfo info;
    info.sequence = i;
    info.exposure = Time(static_cast<std::int64_t>(pair.stamp_ns - found.pairs[0].stamp_ns));
    info.camera = eyes.calibration.rectified;
    report.begin(i, name, facts);
    pipeline.submit(vision::stereo_pair(std::move(info), std::move(*images)));
    pipeline.finish();
  }
  if (!interrupted) progress.update(1, "done");
  progress.done();
  return finish(report, module_statistics_json(pipeline), module_statistics_text(pipeline), options,
                vision, folder, interrupted);
}

}  // namespace kaz::tools
