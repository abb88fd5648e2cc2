// The input as a text or a file, and the judgement of an error.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/inputs/input.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "shared/base/files.hpp"

namespace kaz::fuzz {
namespace {

class Folder {
 public:
  Folder() {
    const auto made = make_temporary_folder("kaz-fuzz-");
    if (!made) {
      std::fprintf(stderr, "%s\n", made.error().message.c_str());
      std::exit(3);
    }
    path_ = *made;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

std::string text_of(Bytes bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string input_folder() {
  static const Folder folder;
  return folder.path();
}

std::string input_file(Bytes bytes, const std::string& name) {
  std::string path = input_folder() + "/" + name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    std::perror(path.c_str());
    std::exit(3);
  }
  return path;
}

Complaint judge_error(const Error& error, const std::string& source, Fault fault) {
  const std::string& text = error.message;
  if (text.find(source) == std::string::npos) return "the error does not name its source: " + text;
  if (text.find('\n') != std::string::npos) return "the error has several lines: " + text;
  if (text.size() > 2000 + source.size())
    return "the error has " + std::to_string(text.size()) + " bytes: " + text.substr(0, 200);
  if (error.fault != fault) return "the error has the wrong fault: " + text;
  return std::nullopt;
}

}  // namespace kaz::fuzz
