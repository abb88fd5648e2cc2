// A folder of results: checked and locked before a run starts. It never mixes the results of two runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "shared/base/result.hpp"

namespace kaz::tools {

// Files that one kind of run writes. A name that begins with '*' matches all names with that ending.
struct OutputKind {
  std::string name;  // "run"; see is_output_kind()
  std::vector<std::string> files;
};

// Each file appears complete or not at all. The list `.kaz-results` names the files that such runs have
// written (output_list.h). It is locked while this object or a copy lives. Thread-safe.
class OutputFolder {
 public:
  // Creates the folder if necessary, locks it, and writes a test file. Changes no existing results, but
  // removes temporary files of a killed run. The last copy of the object removes the list and created folders
  // if there are no results. Errors:
  // - usage: the folder cannot be written to, or contains results of another kind. Or it contains files with
  //   names of this kind that are not in the list.
  // - environment: another process writes there, or the disk is full.
  static Result<OutputFolder> open(const std::string& path, const OutputKind& kind);
  // Removes the results of an earlier run, and reports this on standard error. Call it when a run begins.
  Result<void> clear() const;
  // Calls open() and clear().
  static Result<OutputFolder> begin(const std::string& path, const OutputKind& kind);

  const std::string& folder() const;
  // Returns the path of a file of this kind, or of an added one.
  std::string path(const std::string& name) const { return folder() + "/" + name; }
  // Adds a file whose name is not in OutputKind to the list, before it is written. Returns its path.
  Result<std::string> add(const std::string& name) const;
  Result<void> remove(const std::string& name) const;
  Result<void> write(const std::string& name, std::string_view bytes) const;
  Result<void> write_json(const std::string& name, const nlohmann::ordered_json& value) const;

  // Appends the list of saved files to the error of a full disk. Returns other errors unchanged.
  Error explained(Error error) const;
  template <class T>
  Result<T> explained(Result<T> result) const {
    if (result) return result;
    return tl::unexpected(explained(result.error()));
  }

 private:
  struct State;
  explicit OutputFolder(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

}  // namespace kaz::tools
