// A folder of results: checked and locked before a run starts, results of two runs never mixed.
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

// What a kind of run writes into its folder. A name that begins with '*' stands for all that end so.
struct OutputKind {
  std::string name;  // is_output_kind(): "run"
  std::vector<std::string> files;
};

// Each file in it appears whole or not at all. A list in it, `.kaz-results`, names the files that such
// runs have written (output_list.h); it is locked as long as the object and its copies live. May be used
// by several threads.
class OutputFolder {
 public:
  // Creates the folder if need be, locks it, writes a test file. Nothing that is there is changed, except
  // temporary files of a run that was killed. If nothing is written afterwards, list and created folders go
  // with the object. Errors:
  // - usage: it cannot be created or written to; it holds results of another kind, or files with names of
  //   this kind that the list does not contain
  // - environment: another process writes there; the disk is full
  static Result<OutputFolder> open(const std::string& path, const OutputKind& kind);
  // Removes the results of an earlier run, which open() has left, and says so on standard error: when a run
  // begins.
  Result<void> clear() const;
  // Both.
  static Result<OutputFolder> begin(const std::string& path, const OutputKind& kind);

  const std::string& folder() const;
  // Of one of the kind's files, or one that was added.
  std::string path(const std::string& name) const { return folder() + "/" + name; }
  // A file whose name the kind does not state: into the list, before it is written. Returns its path.
  Result<std::string> add(const std::string& name) const;
  Result<void> remove(const std::string& name) const;
  Result<void> write(const std::string& name, std::string_view bytes) const;
  Result<void> write_json(const std::string& name, const nlohmann::ordered_json& value) const;

  // Errors of a full disk, with what is saved in this folder; others as they are.
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
