// Encodes pictures as a film, using the program ffmpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"
#include "tools/base/child.h"
#include "tools/base/output.h"

namespace kaz::tools {

struct FilmFormat {
  const char* ending;                // ending of the file's name, for example ".mp4"
  int fps;                           // default number of pictures per second
  std::vector<std::string> options;  // options of ffmpeg for its output
};

// Returns the format for the ending of `path`. Fails (usage) for an unknown ending; the message lists all
// endings.
Result<FilmFormat> film_format(const std::string& path);

struct FilmSize {
  int width = 0, height = 0, fps = 0;
};

// Runs ffmpeg as a child process. The destructor ends the process.
class FilmEncoder {
 public:
  // Starts ffmpeg, which replaces the file at `path`. `interrupt` must outlive the encoder.
  static Result<FilmEncoder> begin(const FilmFormat& format, const FilmSize& size,
                                   const std::string& path, const host::Interrupt& interrupt);

  // Adds one picture: rows from top to bottom, 3 bytes per pixel. Fails after an interrupt. Fails
  // (environment) if ffmpeg is not installed or ended with an error; the message contains the last line of
  // ffmpeg's output.
  Result<void> add(std::span<const std::uint8_t> rgb);
  // Waits until the file is complete. Fails like add().
  Result<void> finish();

 private:
  FilmEncoder(Child child, Descriptor input, std::string log, const host::Interrupt& interrupt)
      : child_(std::move(child)),
        input_(std::move(input)),
        log_(std::move(log)),
        interrupt_(&interrupt) {}
  Error failure();

  Child child_;
  Descriptor input_;
  std::string log_;  // output of ffmpeg
  const host::Interrupt* interrupt_;
};

}  // namespace kaz::tools
