// Controls of the kernel's virtual video driver, by their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::tests {

// A second handle on a device, as another program has it. Throws std::runtime_error when the driver
// has no such control or refuses the value.
class Vivid {
 public:
  explicit Vivid(const std::string& path);
  ~Vivid();
  Vivid(const Vivid&) = delete;
  Vivid& operator=(const Vivid&) = delete;

  void set(const std::string& control, int value);  // buttons too
  void choose(const std::string& control, const std::string& entry);
  void reserve_buffers();  // the device is then in use

 private:
  int descriptor_;
};

}  // namespace kaz::tests
