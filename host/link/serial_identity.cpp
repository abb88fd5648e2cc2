// Reads sysfs: a tty's USB interface, and the device above it.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/serial_identity.h"

#include <filesystem>
#include <fstream>
#include <system_error>

namespace kaz::host {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxLevels = 4;  // from a tty's device up to its USB device

std::string first_word(const fs::path& path) {
  std::ifstream file(path);
  std::string word;
  file >> word;
  return word;
}

std::string identity_of(const fs::path& tty) {
  std::error_code error;
  fs::path folder = fs::canonical(tty / "device", error);
  std::string interface;
  for (int up = 0; !error && up < kMaxLevels && folder.has_relative_path(); ++up) {
    if (interface.empty()) interface = first_word(folder / "bInterfaceNumber");
    const std::string vendor = first_word(folder / "idVendor");
    if (!vendor.empty()) {
      const std::string serial = first_word(folder / "serial");
      std::string text = vendor;
      text.append(":").append(first_word(folder / "idProduct"));
      text.append(serial.empty() ? " @" : " ");
      text.append(serial.empty() ? folder.filename().string() : serial);
      return text.append(".").append(interface);
    }
    folder = folder.parent_path();
  }
  return "";
}

}  // namespace

std::string serial_identity(const std::string& path, const std::string& sys) {
  std::error_code error;
  const fs::path port = fs::canonical(path, error);
  // In a test the port does not exist, and is named as it will be.
  const fs::path name = error ? fs::path(path).filename() : port.filename();
  return identity_of(fs::path(sys) / "class/tty" / name);
}

std::optional<std::string> find_serial_port(const std::string& identity, const std::string& sys) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(sys) / "class/tty", error)) {
    if (!identity.empty() && identity_of(entry.path()) == identity)
      return "/dev/" + entry.path().filename().string();
  }
  return std::nullopt;
}

}  // namespace kaz::host
