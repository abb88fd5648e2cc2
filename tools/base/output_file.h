// Output files and folders of results. Both are checked and locked before a run starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/descriptor.hpp"
#include "shared/base/files.hpp"
#include "shared/base/result.hpp"

namespace kaz::tools {

// If the disk is full, appends a list of the files that this process has saved to the error message. Returns
// other errors unchanged.
Error with_saved_files(Error error);

// Sets the arguments of the command line. OutputFile::open() then refuses a file that two of the arguments
// name, because one of them may be an input.
void set_command_words(std::vector<std::string> words);

// Action for a file that exists and is not empty. Use `keep` if the old content could not be recreated.
enum class Existing { replace, keep };

// One file at a path given by the user. Writes to the locked file PATH.part and renames that file to PATH at
// the end. So PATH is never an incomplete file. If PATH is a symbolic link, the link stays and its target is
// replaced. If PATH is a character device, or a pipe with a reader, the bytes are written to PATH directly.
class OutputFile {
 public:
  // `option` names the file in errors: "--json". Errors:
  // - usage: the file cannot be created; the existing file must be kept; another argument of the command line
  //   names the file; or the file would be in a folder of results (OutputFolder).
  // - environment: another process writes the file, or the disk is full.
  static Result<OutputFile> open(const std::string& path, const std::string& option,
                                 Existing existing = Existing::replace);
  OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }
  OutputFile& operator=(OutputFile&& other) noexcept;
  // Removes PATH.part, unless commit() or failure() was called. If a second Ctrl-C ends the program,
  // PATH.part stays unless it is empty.
  ~OutputFile();

  const std::string& path() const { return path_; }
  // Path to write to before commit().
  const std::string& part() const { return part_; }
  // Checks that the disk has room for `bytes` more bytes, by writing and removing these bytes. Call this
  // function before long work. Succeeds for devices and pipes.
  Result<void> check_room(std::size_t bytes);
  // Writes the complete content and calls commit().
  Result<void> write(std::string_view bytes);
  // Flushes the file to disk and renames it to its final path.
  Result<void> commit();
  // Call this function after a stream failed to write to part(). Returns the error. The stream does not keep
  // the reason of its failure, so this function writes again to find the reason. PATH.part stays.
  Error failure();

 private:
  OutputFile() = default;
  void release();

  // target_: file that path_ points to; empty for a device or pipe.
  std::string path_, target_, part_;
  Descriptor file_;
  int at_last_ = -1;  // number that remove_empty_file_at_last() returned
};

// The mark of a folder of results: first line "kaz-results 1", second line "kind KIND". The mark is also the
// folder's lock.
inline constexpr const char* kResultsMark = ".kaz-results";

// Kind of run, for example "run", and name patterns (fnmatch) of all files that runs of this kind write. A
// pattern must not match files of users: the next run removes the files that match.
struct OutputKind {
  std::string name;
  std::vector<std::string> files;
};

// A folder for the results of one run. The folder is locked while this object or a copy of this object
// exists. Each file is written completely or not at all. Several threads may call path() and write().
class OutputFolder {
 public:
  // Creates the folder if necessary, locks it, and tests writing. Changes no existing results, but removes
  // temporary files that a killed run has left. If there are no results, the destructor of the last copy
  // removes the mark and the folders that open() created. Errors:
  // - usage: the folder cannot be written to.
  // - usage: the folder contains results of another kind of run.
  // - usage: the folder has no mark, but contains a file that matches `kind.files`.
  // - environment: another process writes to the folder, or the disk is full.
  static Result<OutputFolder> open(const std::string& path, const OutputKind& kind);
  // Removes the results of an earlier run, and prints a message about the removal on standard error. Call
  // clear() when a run begins.
  Result<void> clear() const;
  // Calls open() and clear().
  static Result<OutputFolder> begin(const std::string& path, const OutputKind& kind);

  const std::string& folder() const;
  // Returns the path of a file in the folder. If `name` matches no pattern of OutputKind::files, the file
  // stays when the next run begins.
  std::string path(const std::string& name) const { return folder() + "/" + name; }
  Result<void> write(const std::string& name, std::string_view bytes) const;
  Result<void> write_json(const std::string& name, const nlohmann::ordered_json& value) const;

 private:
  struct State;
  explicit OutputFolder(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

}  // namespace kaz::tools
