// The recording of a run at a port.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/line_recorder.h"

#include <algorithm>
#include <utility>

#include "sim/runtime/time.h"

namespace kaz::tools {

class LineRecorder::RecordedLink final : public host::Link {
 public:
  RecordedLink(host::Link& link, LineRecorder& recorder, std::size_t line)
      : link_(link), recorder_(recorder), line_(line) {}
  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override { return link_.set_baud(baud); }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    auto written = link_.write(bytes);
    if (written) recorder_.wire(sim::Recorder::Direction::to_board, line_, bytes);
    return written;
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    auto count = link_.read(bytes, deadline);
    if (count) recorder_.wire(sim::Recorder::Direction::to_host, line_, bytes.first(*count));
    return count;
  }
  Result<void> reopen() override { return link_.reopen(); }

 private:
  host::Link& link_;
  LineRecorder& recorder_;
  std::size_t line_;
};

Result<std::unique_ptr<LineRecorder>> LineRecorder::create(const std::string& path,
                                                           sim::McapWriter::Metadata facts,
                                                           const host::Clock& clock,
                                                           sim::MessageTap* tap) {
  const Time start = clock.now();
  facts.push_back({kStart, std::to_string(start.count())});
  auto recorder = KAZ_TRY(sim::Recorder::create(path, facts, tap));
  return std::unique_ptr<LineRecorder>(new LineRecorder(std::move(recorder), clock, start));
}

host::Link* LineRecorder::record(host::Link& link, std::size_t line) {
  auto& recorded = links_[line];
  recorded = std::make_unique<RecordedLink>(link, *this, line);
  return recorded.get();
}

sim::States LineRecorder::now() {
  last_ = std::max(last_, sim::states_of(clock_.now() - start_));
  return last_;
}

void LineRecorder::wire(sim::Recorder::Direction direction, std::size_t line,
                        std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (!recorder_ || bytes.empty()) return;
  const sim::States at = now();
  std::vector<sim::SerialByte> serial;
  for (const std::uint8_t byte : bytes) serial.push_back({.value = byte, .at = at});
  recorder_->wire(direction, at - at % KZ_STATES_PER_TICK, serial, line);
}

void LineRecorder::behavior(const std::string& json) {
  const std::lock_guard lock(mutex_);
  if (recorder_) recorder_->behavior(now(), json);
}

void LineRecorder::map(const sim::RecordedMap& map) {
  const std::lock_guard lock(mutex_);
  if (recorder_) recorder_->map(now(), map);
}

Result<std::string> LineRecorder::finish(const std::string& interrupted_by) {
  const std::lock_guard lock(mutex_);
  if (!recorder_) return finished_;
  if (!interrupted_by.empty()) recorder_->interrupted(interrupted_by);
  finished_ = std::exchange(recorder_, nullptr)->finish();
  return finished_;
}

bool LineRecorder::failed() const {
  const std::lock_guard lock(mutex_);
  return recorder_ ? !recorder_->written() : !finished_;
}

}  // namespace kaz::tools
