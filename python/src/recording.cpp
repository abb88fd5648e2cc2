// Recordings: their messages, with the schemas by which kaz/recording.py decodes them.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/python.h"

#include <array>
#include <map>
#include <set>

#include "sim/runtime/formats/mcap_reader.h"

namespace kaz::python {
namespace {

// Returns how a topic's messages are encoded: the encoding of the messages, then name, encoding and text of
// the schema. They are bytes, because they may be invalid UTF-8. Channels of one topic may differ. Equal
// entries are returned once.
py::list schemas(const sim::McapRecording& recording, const std::string& topic) {
  std::set<std::array<std::string, 4>> all;
  for (const auto& [channel, name] : recording.topics) {
    if (name != topic) continue;
    const sim::McapRecording::Encoding& encoding = recording.encodings.at(channel);
    const auto found = recording.schemas.find(encoding.schema);
    const auto schema =
        found == recording.schemas.end() ? sim::McapRecording::Schema() : found->second;
    all.insert({encoding.message, schema.name, schema.encoding, schema.text});
  }
  py::list made;
  for (const auto& [message, name, encoding, text] : all)
    made.append(
        py::make_tuple(py::bytes(message), py::bytes(name), py::bytes(encoding), py::bytes(text)));
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
          [](const sim::McapRecording& r) { return 1e-9 * static_cast<double>(r.duration_ns()); })
      .def("schemas", &schemas, py::arg("topic"))
      .def("messages", &messages, py::arg("topic"))
      .def("joined", &joined, py::arg("topic"));
}

}  // namespace kaz::python
