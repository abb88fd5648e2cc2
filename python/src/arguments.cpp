// Keyword arguments, taken one by one so that the unknown ones can be named.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/arguments.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>
#include <vector>

namespace kaz::python {
namespace {

// Archive (robot_options.h) that takes the options from keyword arguments.
class KeywordArguments {
 public:
  explicit KeywordArguments(py::dict& from) : from_(from) {}

  void operator()(const sim::OptionText& text, auto& value) {
    value = take(from_, text.name, value);
  }
  void operator()(const sim::OptionText& text, std::string& value) {
    if (text.option != nullptr) value = path(text.name, value);
  }
  void operator()(const sim::OptionText&, std::vector<std::string>&) {}  // only in recordings
  template <class T, std::size_t N>
  void operator()(const sim::OptionText& text, T& value, const std::array<T, N>& values) {
    value = named(text.name, path(text.name, to_string(value)), values);
  }
  void operator()(const sim::OptionText& text, double& value, const sim::OptionRange& range) {
    value = take(from_, text.name, value);
    if (!range.limited() || (value >= range.min && value <= range.max)) return;
    std::ostringstream error;
    error << text.name << ": must be " << range.min << " to " << range.max << " " << range.unit;
    raise({Fault::usage, error.str()});
  }
  template <std::size_t N>
  void operator()(const sim::OptionText& text, int& value, const std::array<int, N>& sizes) {
    value = take(from_, text.name, value);
    if (value == 0 || std::ranges::find(sizes, value) != sizes.end()) return;
    std::string valid;
    for (const int one : sizes) valid += (valid.empty() ? "" : " or ") + std::to_string(one);
    raise({Fault::usage,
           std::string(text.name) + " " + std::to_string(value) + ": must be " + valid});
  }
  // Returns a text argument, which may also be a path object, or `otherwise` if the argument is missing.
  std::string path(const char* name, const std::string& otherwise) {
    if (from_.contains(name) && py::hasattr(from_[name], "__fspath__"))
      from_[name] = from_[name].attr("__fspath__")();
    return take<std::string>(from_, name, otherwise);
  }

 private:
  py::dict& from_;
};

}  // namespace

tools::BackendOptions take_world_arguments(py::dict& arguments) {
  tools::BackendOptions options;
  KeywordArguments keywords(arguments);
  options.visit(keywords);
  options.faults = keywords.path("faults", "");
  return options;
}

void nothing_left(const std::string& function, const py::dict& arguments) {
  for (const auto& [name, value] : arguments)
    throw py::type_error(function + "() has no argument '" + std::string(py::str(name)) + "'");
}

}  // namespace kaz::python
