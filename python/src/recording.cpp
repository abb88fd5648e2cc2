// Recordings: their messages, with the schemas by which kaz/recording.py decodes them.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/python.h"

#include <map>

#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "sim/runtime/simulation/recorder.h"

namespace kaz::python {
namespace {

struct Schema {
  std::string encoding, name, text;
};

// The channels that this version records, by topic.
class Schemas final : public sim::MessageTap {
 public:
  void channel(std::uint16_t, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string&,
               const std::string& schema) override {
    all[topic] = {encoding, schema_name, schema};
  }
  void message(std::uint16_t, std::uint64_t, std::span<const std::uint8_t>) override {}
  std::map<std::string, Schema> all;
};

py::dict schemas() {
  Schemas tap;
  const auto recorder = value_of(sim::Recorder::create("", {}, &tap));
  recorder->add_all_channels();
  py::dict made;
  for (const auto& [topic, schema] : tap.all)
    made[topic.c_str()] = py::make_tuple(schema.encoding, schema.name, schema.text);
  return made;
}

py::list messages(const sim::McapRecording& recording, const std::string& topic) {
  py::list all;
  for (const sim::McapRecording::Message& message : recording.messages) {
    if (recording.topics.at(message.channel) != topic) continue;
    all.append(py::make_tuple(
        message.time_ns,
        py::bytes(reinterpret_cast<const char*>(message.data.data()), message.data.size())));
  }
  return all;
}

// One after the other, for messages of one size; and their times.
py::tuple joined(const sim::McapRecording& recording, const std::string& topic) {
  std::string bytes;
  std::vector<std::uint64_t> times;
  for (const sim::McapRecording::Message& message : recording.messages) {
    if (recording.topics.at(message.channel) != topic) continue;
    bytes.append(reinterpret_cast<const char*>(message.data.data()), message.data.size());
    times.push_back(message.time_ns);
  }
  return py::make_tuple(
      py::array_t<std::uint64_t>(static_cast<py::ssize_t>(times.size()), times.data()),
      py::bytes(bytes));
}

}  // namespace

void add_recording(py::module_& module) {
  module.def("schemas", &schemas);
  py::class_<sim::McapRecording>(module, "McapRecording")
      .def(py::init([](const std::string& path) {
             return value_of(released([&] { return sim::McapRecording::load(path); }));
           }),
           py::arg("path"))
      .def_property_readonly("topics",
                             [](const sim::McapRecording& r) {
                               std::map<std::string, std::size_t> counts;
                               for (const auto& [channel, topic] : r.topics) counts[topic];
                               for (const auto& message : r.messages)
                                 ++counts[r.topics.at(message.channel)];
                               return counts;
                             })
      .def_readonly("facts", &sim::McapRecording::facts)
      .def_readonly("whole", &sim::McapRecording::whole)
      .def_property_readonly(
          "duration_s",
          [](const sim::McapRecording& r) { return 1e-9 * static_cast<double>(r.end_ns()); })
      .def("messages", &messages, py::arg("topic"))
      .def("joined", &joined, py::arg("topic"));
}

}  // namespace kaz::python
