// A folder for the results of one run. The folder is checked and locked before the run starts.
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

// Names of the files that one kind of run writes. A name that begins with '*', such as "*.svg", matches all
// names with the same ending.
struct OutputKind {
  std::string name;  // for example "run"; is_output_kind() checks the name
  std::vector<std::string> files;
};

// Each file is written completely or not at all. The list `.kaz-results` in the folder contains the names of
// the written files (output_list.h). The list is locked while this object or a copy of this object exists.
// Thread-safe.
class OutputFolder {
 public:
  // Creates the folder if necessary, locks it, and writes a test file. Changes no existing results, but
  // removes temporary files that a killed run has left. If there are no results, the destructor of the last
  // copy removes the list and the folders that open() created. Errors:
  // - usage: the folder cannot be written to, or contains results of another kind of run. Or the folder
  //   contains a file that matches `kind.files` but is not in the list.
  // - environment: another process writes to the folder, or the disk is full.
  static Result<OutputFolder> open(const std::string& path, const OutputKind& kind);
  // Removes the results of an earlier run, and prints a message about the removal on standard error. Call
  // clear() when a run begins.
  Result<void> clear() const;
  // Calls open() and clear().
  static Result<OutputFolder> begin(const std::string& path, const OutputKind& kind);

  const std::string& folder() const;
  // Returns the path of a file in the folder. `name` must match OutputKind::files, or must have been added by
  // add().
  std::string path(const std::string& name) const { return folder() + "/" + name; }
  // Adds a file to the list whose name does not match OutputKind::files. Call add() before the file is
  // written. Returns the path of the file.
  Result<std::string> add(const std::string& name) const;
  Result<void> remove(const std::string& name) const;
  Result<void> write(const std::string& name, std::string_view bytes) const;
  Result<void> write_json(const std::string& name, const nlohmann::ordered_json& value) const;

  // Appends the names of the saved files to the error message for a full disk. Returns other errors
  // unchanged.
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
