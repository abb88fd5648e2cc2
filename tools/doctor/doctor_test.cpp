// `kaz doctor` on planted devices: each fault is found, and named with what mends it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/doctor.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Level = Finding::Level;

constexpr uid_t kSomebody = 4321;

// A machine of files: one FTDI adapter, one UART that exists and one that does not, a CAN interface, a
// camera, all in order.
class Doctor : public testing::Test {
 protected:
  void SetUp() override {
    files_.root = made_folder();
    files_.user = kSomebody;
    files_.cores = 4;
    files_.kernel = "6.1.0";
    files_.search_path = "/usr/bin:/opt";
    files_.interface_details = [this](const std::string&) { return can_; };
    files_.video_formats = [this](const std::string&) { return video_; };
    put("/usr/bin/h8300-hitachi-coff-gcc");
    put("/proc/loadavg", "0.52 0.58 0.59 1/967 4242");
    put("/sys/devices/usb1/1-1/idVendor", "0403");
    put("/sys/devices/usb1/1-1/idProduct", "6001");
    put("/sys/devices/usb1/1-1/1-1:1.0/ttyUSB0/latency_timer", "1");
    put("/sys/devices/usb1/1-1/1-1:1.0/bInterfaceClass", "ff");
    link("../../../devices/usb1/1-1/1-1:1.0/ttyUSB0", "/sys/class/tty/ttyUSB0/device");
    link("../../../devices/usb1/1-1/1-1:1.0/ttyUSB0", "/sys/bus/usb-serial/devices/ttyUSB0");
    put("/sys/class/tty/ttyS0/type", "4");
    put("/sys/class/tty/ttyS9/type", "0");
    device("/dev/ttyUSB0");
    device("/dev/ttyS0");
    link("../../ttyUSB0", "/dev/serial/by-id/usb-FTDI_A50285BI");
    put("/sys/class/net/can0/type", "280");
    put("/sys/class/net/can0/flags", "0x40081");
    put("/sys/class/net/lo/type", "772");
    put("/sys/module/can_isotp/refcnt");
    put("/sys/class/video4linux/video0/name", "Left eye");
    device("/dev/video0");
  }
  void TearDown() override { fs::remove_all(files_.root); }

  void put(const std::string& path, const std::string& text = "") {
    fs::create_directories(fs::path(files_.root + path).parent_path());
    std::ofstream(files_.root + path) << text << "\n";
  }
  void link(const std::string& target, const std::string& path) {
    fs::create_directories(fs::path(files_.root + path).parent_path());
    fs::create_symlink(target, files_.root + path);
  }
  void device(const std::string& path, mode_t mode = 0666) {
    put(path);
    chmod((files_.root + path).c_str(), mode);
  }
  // Everything about a subject as LEVEL TEXT REMEDY; good findings have level "".
  std::string about(const std::string& subject) {
    std::string text;
    for (const Finding& one : examine(files_))
      if (one.subject == subject)
        text += std::string(one.level == Level::good   ? ""
                            : one.level == Level::note ? "note "
                                                       : "wrong ") +
                one.text + (one.remedy.empty() ? "" : " | " + one.remedy) + "\n";
    return text;
  }
  static std::string made_folder() {
    std::string name = testing::TempDir() + "doctor-XXXXXX";
    return mkdtemp(name.data()) != nullptr ? name : "";
  }

  MachineFiles files_;
  std::string can_ = R"([{"linkinfo": {"info_kind": "can", "info_data":
      {"state": "ERROR-ACTIVE", "bittiming": {"bitrate": 500000}}}}])";
  VideoFormats video_{true, {"YUYV", "MJPG"}, ""};
};

TEST_F(Doctor, FindsNothingWrongWhereNothingIs) {
  for (const Finding& one : examine(files_))
    EXPECT_EQ(one.level, Level::good) << one.part << " " << one.subject << ": " << one.text;
  EXPECT_EQ(
      about("/dev/ttyUSB0"),
      "USB adapter 0403:6001, free; its persistent name is /dev/serial/by-id/usb-FTDI_A50285BI\n");
  EXPECT_EQ(about("/dev/ttyS0"), "a free UART of this machine\n");
  EXPECT_EQ(about("/dev/ttyS9"), "");
  EXPECT_EQ(about("can0"), "up, 500000 bit/s, ERROR-ACTIVE\n");
  EXPECT_EQ(about("/dev/video0"), "Left eye, formats YUYV, MJPG\n");
}

TEST_F(Doctor, FindsPortsThatCannotBeUsed) {
  device("/dev/ttyUSB0", 0600);
  EXPECT_EQ(about("/dev/ttyUSB0"),
            "wrong you have no permission to read and write this device | sudo chgrp dialout "
            "/dev/ttyUSB0 && sudo chmod 660 /dev/ttyUSB0\n");
  files_.user = 0;
  EXPECT_EQ(about("/dev/ttyUSB0").substr(0, 11), "USB adapter");
  put("/proc/77/comm", "minicom");
  link("/dev/ttyUSB0", "/proc/77/fd/3");
  EXPECT_EQ(about("/dev/ttyUSB0"), "wrong in use by process 77 (minicom) | kill 77\n");
  fs::remove(files_.root + "/dev/ttyS0");
  EXPECT_EQ(about("/dev/ttyS0"),
            "wrong the kernel lists this device, but the device file is missing | sudo udevadm "
            "trigger\n");
}

TEST_F(Doctor, AGroupsMemberMayUseItsDevices) {
  device("/dev/ttyUSB0", 0660);
  EXPECT_EQ(about("/dev/ttyUSB0").substr(0, 5), "wrong");
  struct stat status {};
  ASSERT_EQ(stat((files_.root + "/dev/ttyUSB0").c_str(), &status), 0);
  files_.groups.push_back(status.st_gid);
  EXPECT_EQ(about("/dev/ttyUSB0").substr(0, 11), "USB adapter");
}

TEST_F(Doctor, FindsSlowAdaptersAndThoseWithoutALastingName) {
  put("/sys/devices/usb1/1-1/1-1:1.0/ttyUSB0/latency_timer", "16");
  EXPECT_NE(about("/dev/ttyUSB0").find("note the adapter delays received bytes by up to 16 ms"),
            std::string::npos);
  EXPECT_NE(about("/dev/ttyUSB0")
                .find("| echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer"),
            std::string::npos);
  fs::remove_all(files_.root + "/dev/serial");
  EXPECT_NE(about("/dev/ttyUSB0").find("note USB adapter 0403:6001 has no persistent name"),
            std::string::npos);
}

TEST_F(Doctor, FindsWhatIsWrongWithCan) {
  can_ = R"([{"linkinfo": {"info_kind": "can", "info_data": {"state": "BUS-OFF"}}}])";
  EXPECT_NE(about("can0").find("wrong the controller is bus-off"), std::string::npos);
  EXPECT_NE(about("can0").find("| sudo ip link set can0 type can restart"), std::string::npos);
  put("/sys/class/net/can0/flags", "0x40080");
  EXPECT_EQ(about("can0"),
            "wrong the interface is down | sudo ip link set can0 up type can bitrate 1000000 "
            "restart-ms 100\n");
  can_ = "no JSON";
  EXPECT_EQ(about("can0").substr(0, 5), "wrong");
  fs::remove_all(files_.root + "/sys/module/can_isotp");
  EXPECT_EQ(about("can-isotp").substr(0, 5), "wrong");
  put("/lib/modules/6.1.0/kernel/net/can/can-isotp.ko");
  EXPECT_EQ(about("can-isotp"),
            "note the kernel module for ISO-TP is not loaded | sudo modprobe can-isotp\n");
}

TEST_F(Doctor, FindsWhatIsWrongWithCameras) {
  video_.formats = {"H264"};
  EXPECT_EQ(about("/dev/video0").substr(0, 36), "wrong Left eye, formats H264: kaz re");
  video_ = {false, {}, ""};
  EXPECT_EQ(about("/dev/video0"), "");
  video_.error = "Input/output error";
  EXPECT_EQ(about("/dev/video0"),
            "wrong Left eye cannot be opened: Input/output error | sudo dmesg | tail\n");
}

TEST_F(Doctor, FindsMissingDriversToolsAndCores) {
  link("../../../devices/usb1/1-1/1-1:1.0", "/sys/bus/usb/devices/1-1:1.0");
  link("../../../devices/usb1/1-1", "/sys/bus/usb/devices/1-1");
  EXPECT_EQ(about("USB 0403:6001"),
            "wrong its driver ftdi_sio is not loaded | sudo modprobe ftdi_sio\n");
  put("/sys/devices/usb1/1-1/1-1:1.0/driver/module");
  EXPECT_EQ(about("USB 0403:6001"), "");
  fs::remove(files_.root + "/usr/bin/h8300-hitachi-coff-gcc");
  EXPECT_EQ(about("h8300-hitachi-coff-gcc").substr(0, 4), "note");
  put("/proc/loadavg", "3.52 0.58 0.59 1/967 4242");
  const auto findings = examine(files_);
  EXPECT_TRUE(std::ranges::any_of(findings, [](const Finding& one) {
    return one.part == "cores" && one.level == Level::note;
  }));
}

TEST(DoctorsBoard, FirmwareThatCanIgnoreAStopIsWrong) {
  kz_identify_reply board{};
  board.protocol_version = KZ_PROTOCOL_VERSION;
  EXPECT_EQ(examine_board("/dev/ttyUSB0", board).level, Level::good);
  board.protocol_version = 2;
  const Finding found = examine_board("/dev/ttyUSB0", board);
  EXPECT_EQ(found.level, Level::wrong);
  EXPECT_NE(
      found.text.find("can acknowledge a repeated stop request without switching the motors off"),
      std::string::npos)
      << found.text;
  EXPECT_EQ(found.remedy.substr(0, 16), "kaz flash write ");
  const Finding silent = examine_board("/dev/ttyUSB0", fail(Fault::environment, "nothing answers"));
  EXPECT_EQ(silent.level, Level::wrong);
  EXPECT_EQ(silent.text, "nothing answers");
}

}  // namespace
}  // namespace kaz::tools
