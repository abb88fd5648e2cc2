// Ports, CAN interfaces, cameras, drivers, toolchain, cores, and the firmware of one board.
// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/doctor.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/link/port_address.h"
#include "host/link/port_link.h"
#include "host/link/serial_port.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "host/robot/robot.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/counted.hpp"
#include "shared/base/number_text.hpp"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

using Level = Finding::Level;
using Findings = std::vector<Finding>;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// The USB device above a device of sysfs, a folder with idVendor; empty if there is none.
std::string usb_device(const MachineFiles& files, std::string folder) {
  for (int up = 0; up < 5 && folder.size() > 1; ++up) {
    if (files.exists(folder + "/idVendor")) return folder;
    folder = folder.substr(0, folder.rfind('/'));
  }
  return "";
}

std::string id_of(const MachineFiles& files, const std::string& usb) {
  return files.line(usb + "/idVendor").value_or("") + ":" +
         files.line(usb + "/idProduct").value_or("");
}

// Permission and other users of a device. True: nobody is in the way.
bool is_usable(const MachineFiles& files, const std::string& part, const std::string& device,
               const std::string& group, Findings& findings) {
  if (!files.exists(device)) {
    findings.push_back({Level::wrong, part, device,
                        "the kernel lists this device, but the device file is missing",
                        "sudo udevadm trigger"});
    return false;
  }
  if (!files.may_use(device)) {
    const std::string with_access = host::group_with_access(files.root + device);
    findings.push_back(
        {Level::wrong, part, device, "you have no permission to read and write this device",
         with_access.empty()
             ? "sudo chgrp " + group + " " + device + " && sudo chmod 660 " + device
             : "sudo adduser $USER " + with_access + " && echo 'log out and in again'"});
    return false;
  }
  const auto holders = files.holders(device);
  if (holders.empty()) return true;
  const std::string process = holders.front().substr(0, holders.front().find(' '));
  findings.push_back(
      {Level::wrong, part, device, "in use by process " + joined(holders), "kill " + process});
  return false;
}

// Names that outlive unplugging: links of udev.
std::string stable_name(const MachineFiles& files, const std::string& device) {
  for (const std::string& name : files.names("/dev"))
    if (name.starts_with("kaz") && files.target("/dev/" + name) == device) return "/dev/" + name;
  for (const char* folder : {"/dev/serial/by-id/", "/dev/serial/by-path/"})
    for (const std::string& name : files.names(folder))
      if (files.target(folder + name) == device) return folder + name;
  return "";
}

void examine_port(const MachineFiles& files, const std::string& name, Findings& findings) {
  const std::string device = "/dev/" + name,
                    sysfs = files.target("/sys/class/tty/" + name + "/device");
  if (!is_usable(files, "serial", device, "dialout", findings)) return;
  const std::string usb = usb_device(files, sysfs);
  if (usb.empty()) {
    findings.push_back({Level::good, "serial", device, "a free UART of this machine", ""});
    return;
  }
  const std::string stable = stable_name(files, device);
  const std::string what = "USB adapter " + id_of(files, usb);
  if (stable.empty()) {
    findings.push_back(
        {Level::note, "serial", device, what + " has no persistent name",
         "sudo cp tools/udev/70-kaz.rules /etc/udev/rules.d/ && sudo udevadm control --reload && "
         "sudo udevadm trigger"});
  } else {
    findings.push_back(
        {Level::good, "serial", device, what + ", free; its persistent name is " + stable, ""});
  }
  const std::string timer = "/sys/bus/usb-serial/devices/" + name + "/latency_timer";
  const auto latency = files.line(timer);
  const auto latency_ms = latency ? parse_number<int>(*latency) : std::nullopt;
  if (latency_ms && *latency_ms > 1)
    findings.push_back({Level::note, "serial", device,
                        "the adapter delays received bytes by up to " +
                            std::to_string(*latency_ms) +
                            " ms; kaz sets this delay to 1 ms while kaz uses the port; other "
                            "programs may leave the delay unchanged",
                        "echo 1 | sudo tee " + timer});
}

void examine_ports(const MachineFiles& files, Findings& findings) {
  const std::size_t before = findings.size();
  for (const std::string& name : files.names("/sys/class/tty")) {
    const bool usb = name.starts_with("ttyUSB") || name.starts_with("ttyACM");
    // The kernel has ttyS* for UARTs that may not exist; those have type 0.
    const bool uart = name.starts_with("ttyS") &&
                      files.line("/sys/class/tty/" + name + "/type").value_or("0") != "0";
    if (usb || uart) examine_port(files, name, findings);
  }
  if (findings.size() == before)
    findings.push_back(
        {Level::note, "serial", "", "no serial port found: plug in the adapter", ""});
}

// Adapters and cameras on the USB whose driver has not made a device.
void examine_drivers(const MachineFiles& files, Findings& findings) {
  static constexpr std::array<std::pair<const char*, const char*>, 5> kAdapters{
      {{"0403", "ftdi_sio"},
       {"10c4", "cp210x"},
       {"1a86", "ch341"},
       {"067b", "pl2303"},
       {"0e", "uvcvideo"}}};
  for (const std::string& name : files.names("/sys/bus/usb/devices")) {
    const std::string folder = "/sys/bus/usb/devices/" + name;
    if (!files.exists(folder + "/bInterfaceClass") || files.exists(folder + "/driver")) continue;
    const std::string device = folder.substr(0, folder.rfind(':'));
    const std::string vendor = files.line(device + "/idVendor").value_or("");
    const bool video = files.line(folder + "/bInterfaceClass") == "0e";
    for (const auto& [id, module] : kAdapters) {
      if (vendor != id && !(video && std::string_view(id) == "0e")) continue;
      findings.push_back({Level::wrong, "kernel", "USB " + id_of(files, device),
                          std::string("its driver ") + module + " is not loaded",
                          std::string("sudo modprobe ") + module});
    }
  }
}

void examine_isotp(const MachineFiles& files, Findings& findings) {
  if (files.exists("/sys/module/can_isotp")) return;
  const std::string folder = "/lib/modules/" + files.kernel + "/kernel/net/can";
  for (const std::string& name : files.names(folder)) {
    if (!name.starts_with("can-isotp.ko")) continue;
    findings.push_back({Level::note, "kernel", "can-isotp",
                        "the kernel module for ISO-TP is not loaded", "sudo modprobe can-isotp"});
    return;
  }
  findings.push_back({Level::wrong, "kernel", "can-isotp",
                      "kernel " + files.kernel + " has no module for ISO-TP (ISO 15765-2)",
                      "sudo apt-get install linux-image-amd64 && sudo reboot"});
}

void examine_can(const MachineFiles& files, Findings& findings) {
  bool any = false;
  for (const std::string& name : files.names("/sys/class/net")) {
    constexpr const char* kArphrdCan = "280";
    const std::string folder = "/sys/class/net/" + name;
    if (files.line(folder + "/type") != kArphrdCan) continue;
    any = true;
    const auto flags =
        parse_number<unsigned>(files.line(folder + "/flags").value_or("0x0").substr(2), 16);
    const bool up = (flags.value_or(0) & 1) != 0;  // IFF_UP
    const auto details = parse_bounded_json(files.interface_details(name)).value_or(nullptr);
    const nlohmann::json info = details.is_array() && !details.empty()
                                    ? details[0].value("linkinfo", nlohmann::json::object())
                                    : nlohmann::json::object();
    const nlohmann::json data = info.value("info_data", nlohmann::json::object());
    const bool is_virtual =
        info.value("info_kind", "") == "vcan" || info.value("info_kind", "") == "vxcan";
    const int rate = data.contains("bittiming") ? data["bittiming"].value("bitrate", 0) : 0;
    const std::string state = data.value("state", "");
    const std::string with_rate = "sudo ip link set " + name + " up type can bitrate " +
                                  std::to_string(rate > 0 ? rate : 1000000) + " restart-ms 100";
    if (!up) {
      findings.push_back({Level::wrong, "can", name, "the interface is down",
                          is_virtual ? "sudo ip link set " + name + " up" : with_rate});
    } else if (state == "BUS-OFF") {
      findings.push_back({Level::wrong, "can", name,
                          "the controller is bus-off after too many errors: check the wiring, both "
                          "terminators of 120 ohm and the bit rate",
                          "sudo ip link set " + name + " type can restart"});
    } else if (is_virtual) {
      findings.push_back({Level::good, "can", name, "up (virtual bus)", ""});
    } else {
      findings.push_back(
          {state.empty() || state == "ERROR-ACTIVE" ? Level::good : Level::note, "can", name,
           "up" + (rate > 0 ? ", " + std::to_string(rate) + " bit/s" : ", bit rate unknown") +
               (state.empty() ? "" : ", " + state),
           ""});
    }
  }
  if (any) examine_isotp(files, findings);
}

void examine_cameras(const MachineFiles& files, Findings& findings) {
  const std::size_t before = findings.size();
  for (const std::string& name : files.names("/sys/class/video4linux")) {
    if (!name.starts_with("video")) continue;
    const std::string device = "/dev/" + name;
    const std::string card = files.line("/sys/class/video4linux/" + name + "/name").value_or("?");
    if (!is_usable(files, "camera", device, "video", findings)) continue;
    const VideoFormats video = files.video_formats(device);
    if (!video.error.empty()) {
      findings.push_back({Level::wrong, "camera", device,
                          card + " cannot be opened: " + video.error, "sudo dmesg | tail"});
    } else if (video.captures) {
      static constexpr std::array<std::string_view, 4> kReadable{"YUYV", "RGB3", "MJPG", "GREY"};
      const bool readable = std::ranges::any_of(video.formats, [](const auto& format) {
        return std::ranges::find(kReadable, format) != kReadable.end();
      });
      findings.push_back(
          {readable ? Level::good : Level::wrong, "camera", device,
           card + ", formats " + joined(video.formats) +
               (readable ? "" : ": kaz reads only YUYV, RGB3, MJPG and GREY; use another camera"),
           ""});
    }
  }
  if (findings.size() == before)
    findings.push_back({Level::note, "camera", "", "no camera found: plug a camera in", ""});
}

void examine_toolchain(const MachineFiles& files, Findings& findings) {
  constexpr const char* kCompiler = "h8300-hitachi-coff-gcc";
  if (files.has_program(kCompiler)) {
    findings.push_back({Level::good, "toolchain", kCompiler,
                        "the compiler for the board's firmware is installed", ""});
  } else {
    findings.push_back({Level::note, "toolchain", kCompiler,
                        "the compiler for the board's firmware is missing; only the firmware build "
                        "needs this compiler",
                        "sudo apt-get install gcc-h8300-hms binutils-h8300-hms"});
  }
}

void examine_cores(const MachineFiles& files, Findings& findings) {
  const std::string text = files.line("/proc/loadavg").value_or("0");
  const double load = parse_number<double>(text.substr(0, text.find(' '))).value_or(0);
  const double free = files.cores - load;
  char sentence[120];
  std::snprintf(sentence, sizeof sentence, "%d, load %.1f in the last minute", files.cores, load);
  if (free >= 0.5) {
    findings.push_back({Level::good, "cores", "", sentence, ""});
  } else {
    findings.push_back({Level::note, "cores", "",
                        std::string(sentence) + ": less than half a core is free, and a late host "
                                                "trips the board's watchdog; end other programs",
                        "top -o %CPU"});
  }
}

Result<kz_identify_reply> identified(const host::PortAddress& port, std::uint8_t address) {
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  const auto robot = KAZ_TRY(host::Robot::connect(
      *link, clock, {.address = address, .watchdog = Time::zero(), .reconnect = Time::zero()}));
  return robot.identity();
}

const char* word(Level level) {
  return level == Level::good ? "good" : level == Level::note ? "note" : "wrong";
}

}  // namespace

std::vector<Finding> examine(const MachineFiles& files) {
  Findings findings;
  examine_ports(files, findings);
  examine_can(files, findings);
  examine_cameras(files, findings);
  examine_drivers(files, findings);
  examine_toolchain(files, findings);
  examine_cores(files, findings);
  return findings;
}

Finding examine_board(const std::string& port, const Result<kz_identify_reply>& board) {
  if (!board) return {Level::wrong, "board", port, board.error().message, ""};
  const std::string what = host::board_text(*board), fault = host::firmware_fault(*board);
  if (fault.empty()) return {Level::good, "board", port, what, ""};
  return {
      Level::wrong, "board", port, what + ": " + fault,
      "kaz flash write " + firmware_image("").value_or("kaz.mot") + " " + host::robot_option(port)};
}

Result<bool> run_doctor(const DoctorOptions& options) {
  Findings findings = examine(MachineFiles::of_this_machine());
  if (!options.port.empty()) {
    const auto port = KAZ_TRY(parse_port(options.port));
    const auto board = identified(port, options.address);
    if (!board && board.error().fault == Fault::interrupted) return tl::unexpected(board.error());
    findings.push_back(examine_board(port.name(), board));
  }
  const auto wrong = std::ranges::count(findings, Level::wrong, &Finding::level);
  if (options.json) {
    nlohmann::ordered_json json{{"wrong", wrong}, {"findings", nlohmann::ordered_json::array()}};
    for (const Finding& one : findings) {
      nlohmann::ordered_json object{{"level", word(one.level)}, {"part", one.part}};
      if (!one.subject.empty()) object["subject"] = one.subject;
      object["text"] = one.text;
      if (!one.remedy.empty()) object["remedy"] = one.remedy;
      json["findings"].push_back(std::move(object));
    }
    json["provenance"] = provenance_json();
    print_json(json);
    return wrong == 0;
  }
  for (const Finding& one : findings) {
    char columns[60];
    std::snprintf(columns, sizeof columns, "%-5s  %-9s  ", word(one.level), one.part.c_str());
    std::fputs(
        list_row(columns, one.subject + (one.subject.empty() ? "" : ": ") + one.text, list_width())
            .c_str(),
        stdout);
    // A command to be copied stays in one line.
    if (!one.remedy.empty()) std::printf("                  %s\n", one.remedy.c_str());
  }
  const auto notes = std::ranges::count(findings, Level::note, &Finding::level);
  std::string sum = wrong == 0 ? "no fault found" : std::to_string(wrong) + " wrong";
  if (notes > 0) sum += ", " + counted(notes, "note");
  std::printf("%s\n", sum.c_str());
  return wrong == 0;
}

}  // namespace kaz::tools
