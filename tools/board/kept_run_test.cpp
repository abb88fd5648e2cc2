// Runs that alter a board, ended at any time: the board is as before, or the message names what is not.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kept/kept_run.h"

#include <csignal>
#include <filesystem>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil/conformance/suite.h"
#include "host/robot/robot.h"
#include "shared/base/files.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/board/recover.h"
#include "tools/kept/write_notes.h"
#include "tools/lockstep/virtual_bench.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

enum class Stop { none, interrupt, terminate, unplug };

// The port of a virtual board, on which something happens at a time.
class StoppedPort final : public host::Link, public host::Clock {
 public:
  StoppedPort(lockstep::VirtualBench& board, Stop how, Time at, const host::Interrupt& interrupt)
      : board_(board), how_(how), at_(at), interrupt_(interrupt) {}
  std::string name() const override { return "test-port"; }
  Time now() const override { return board_.now(); }
  Result<void> sleep_until(Time t) override { return board_.sleep_until(t); }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    if (unplugged_) return gone();
    return board_.write(bytes);
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    const bool waiting = how_ != Stop::none;
    const auto count = board_.read(bytes, waiting ? std::min(deadline, at_) : deadline);
    if (waiting && now() >= at_) stop();
    if (unplugged_) return gone();
    if (interrupt_.ends_waiting()) return tl::unexpected(host::Interrupt::error());
    if (count && *count == 0 && now() < deadline) return board_.read(bytes, deadline);
    return count;
  }
  Result<void> reopen() override {
    if (unplugged_) return gone();
    return {};
  }
  void plug_in() { unplugged_ = false; }

 private:
  void stop() {
    if (how_ == Stop::interrupt) std::raise(SIGINT);
    if (how_ == Stop::terminate) std::raise(SIGTERM);
    unplugged_ = how_ == Stop::unplug;
    how_ = Stop::none;
  }
  static tl::unexpected<Error> gone() {
    return fail(Fault::environment, "port test-port was closed");
  }

  lockstep::VirtualBench& board_;
  Stop how_;
  Time at_;
  const host::Interrupt& interrupt_;
  bool unplugged_ = false;
};

template <class T>
T sure(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

class KeptRuns : public testing::Test {
 protected:
  KeptRuns() : folder_(make_temporary_folder("kaz-kept-").value()) {}
  ~KeptRuns() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  // A board with a calibration and an address of its own, and settings until its next reset.
  void prepare(lockstep::VirtualBench& board, int address) {
    auto robot = sure(host::Robot::connect(board, board));
    auto calibration = sure(robot.calibration()).joints;
    calibration[2].centre_rad += 0.03;
    sure(robot.set_calibration(1U << 2, calibration));
    sure(robot.store_calibration());
    sure(robot.unlock(5));
    sure(robot.set_address(address, false));
    (void)robot.reset();  // it answers elsewhere
    auto moved =
        sure(host::Robot::connect(board, board, {.address = static_cast<std::uint8_t>(address)}));
    sure(moved.set_gains(0x30, {.kp_per_rad = 5}));
    sure(moved.set_limits(0x1, {.ramp_rad_per_s = 3, .lower_rad = -0.2, .upper_rad = 0.3}));
  }

  KeptRunOptions options(int address) const {
    return {.verb = "kaz conformance",
            .port = "test-port",
            .address = static_cast<std::uint8_t>(address),
            .flash = true,
            .alone = true,
            .patience = std::chrono::seconds(2),  // no loader is entered
            .folder = folder_};
  }

  // As `kaz conformance --allow-flash` runs it.
  Result<void> run(StoppedPort& port, host::Interrupt& interrupt, int address,
                   const std::string& filter) {
    const auto kept = KAZ_TRY(KeptRun::begin(port, port, interrupt, options(address)));
    hil::RunOptions suite;
    suite.filter = filter;
    suite.address = static_cast<std::uint8_t>(address);
    suite.allowed = hil::kFlash;
    const auto report = hil::run_suite(port, port, nullptr, Time::zero(), suite);
    Result<void> ran;
    if (!report) ran = tl::unexpected(report.error());
    if (report && report->interrupted) ran = tl::unexpected(host::Interrupt::error());
    if (report) {
      EXPECT_EQ(report->count(hil::Verdict::failed), 0) << filter;
    }
    return together(std::move(ran), kept->end());
  }

  bool no_notes() const { return fs::is_empty(folder_); }
  std::string notes() const { return fs::directory_iterator(folder_)->path().string(); }

  std::string folder_;
};

// With the calibration in flash; only the number of its copy may have grown.
host::BoardState whole_state(lockstep::VirtualBench& board, int address) {
  auto state = sure(host::read_board(board, board, static_cast<std::uint8_t>(address)));
  sure(host::read_flash(board, board, state));
  state.stored_copy = 0;
  return state;
}

constexpr const char* kFlashCases[] = {"^address.set$", "^address.set-last$",
                                       "^address.shared-line$", "^calibration.store$",
                                       "^calibration.store-answers$"};

TEST_F(KeptRuns, At200RandomTimesTheBoardIsAsBeforeOrTheMessageNamesWhatIsNot) {
  std::mt19937_64 random(20260701);
  int put_back = 0, finished = 0;
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE(n);
    const Stop how = n % 3 == 0 ? Stop::interrupt : n % 3 == 1 ? Stop::terminate : Stop::unplug;
    const int address = n % 2 == 0 ? 1 : 6;
    lockstep::VirtualBench board(sim::make_native());
    prepare(board, address);
    // What the flash holds does not change by looking, what RAM holds does: read in this order.
    const auto settings = sure(host::read_board(board, board, static_cast<std::uint8_t>(address)));
    InterruptSignals::forget_earlier();  // the signal of the run before
    host::Interrupt interrupt;
    const InterruptSignals signals(interrupt);
    const Time at = board.now() + milliseconds(random() % 2000);
    StoppedPort port(board, how, at, interrupt);
    const auto ran = run(port, interrupt, address, kFlashCases[random() % std::size(kFlashCases)]);
    if (how == Stop::unplug && !ran && !no_notes()) {
      // It was altered, and cannot be put back: the message has the command.
      EXPECT_NE(ran.error().message.find("kaz recover --robot serial:test-port --from " + notes()),
                std::string::npos)
          << ran.error().message;
      const auto kept = sure(parse_kept(sure(read_whole_file(notes(), 1 << 20)), notes()));
      fs::remove(notes());
      port.plug_in();
      const auto recovered = sure(recover_board(port, port, {}, kept));
      EXPECT_TRUE(recovered.left.empty()) << recovered.left.front();
      put_back += static_cast<int>(!recovered.done.empty());
    } else if (how != Stop::unplug && !ran) {
      EXPECT_NE(ran.error().message.find("interrupted"), std::string::npos) << ran.error().message;
      EXPECT_EQ(ran.error().message.find("kaz recover"), std::string::npos) << ran.error().message;
      ++put_back;
    }
    finished += static_cast<int>(ran.has_value());
    EXPECT_TRUE(no_notes());
    auto now = sure(host::read_board(board, board, static_cast<std::uint8_t>(address)));
    EXPECT_EQ(now, settings);
    auto before = settings;
    const auto flash = whole_state(board, address);
    // `prepare` has stored what is in use.
    for (host::KeptJoint& joint : before.joints) {
      joint.stored_centre = joint.centre;
      joint.stored_scale = joint.scale;
    }
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      EXPECT_EQ(flash.joints[j].stored_centre, before.joints[j].stored_centre) << j;
      EXPECT_EQ(flash.joints[j].stored_scale, before.joints[j].stored_scale) << j;
    }
    EXPECT_EQ(flash.address, address);
    EXPECT_FALSE(flash.shared_line);
  }
  EXPECT_GT(put_back, 60);
  EXPECT_LT(finished, 140);
}

TEST_F(KeptRuns, AnExceptionPutsTheBoardBackToo) {
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 1);
  const auto before = sure(host::read_board(board, board, 1));
  host::Interrupt interrupt;
  StoppedPort port(board, Stop::none, Time::max(), interrupt);
  try {
    const auto kept = sure(KeptRun::begin(port, port, interrupt, options(1)));
    auto robot = sure(host::Robot::connect(port, port));
    sure(robot.unlock(5));
    sure(robot.set_address(9, true));
    throw std::runtime_error("of a case");
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "of a case");
  }
  EXPECT_EQ(sure(host::read_board(board, board, 1)), before);
  EXPECT_TRUE(no_notes());
}

TEST_F(KeptRuns, WithoutAStoredCalibrationBeforeThatIsANote) {
  lockstep::VirtualBench board(sim::make_native());
  host::Interrupt interrupt;
  StoppedPort port(board, Stop::none, Time::max(), interrupt);
  testing::internal::CaptureStderr();
  EXPECT_TRUE(run(port, interrupt, 1, "^calibration.store$"));
  // It names no command that this board refuses.
  const std::string note = testing::internal::GetCapturedStderr();
  EXPECT_NE(note.find("no calibration was stored before"), std::string::npos) << note;
  EXPECT_NE(note.find("kaz sim --mcu native"), std::string::npos) << note;
  EXPECT_EQ(note.find("flash erase"), std::string::npos) << note;
  kz_identify_reply with_image{};
  with_image.image_crc = 0x1234;
  EXPECT_EQ(host::how_calibration_goes(with_image, "/dev/ttyUSB0", 3),
            "; `kaz flash erase --blocks 1,2 --robot serial:/dev/ttyUSB0 --address 3` erases these "
            "values");
}

TEST_F(KeptRuns, WithoutAPlaceForNotesNothingIsAltered) {
  const std::string file = folder_ + "/file";
  ASSERT_TRUE(write_whole_file(file, "no folder"));
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 1);
  const auto before = sure(host::read_board(board, board, 1));
  host::Interrupt interrupt;
  StoppedPort port(board, Stop::none, Time::max(), interrupt);
  for (const std::string& folder :
       {file, file + "/below", std::string("/proc/kaz"), std::string()}) {
    SCOPED_TRACE(folder);
    KeptRunOptions where = options(1);
    where.folder = folder;
    const auto begun = KeptRun::begin(port, port, interrupt, where);
    ASSERT_FALSE(begun);
    EXPECT_EQ(begun.error().fault, Fault::environment);
    EXPECT_NE(begun.error().message.find("set XDG_STATE_HOME to a writable folder"),
              std::string::npos)
        << begun.error().message;
    EXPECT_EQ(sure(host::read_board(board, board, 1)), before) << "not even a reset";
  }
}

// Hostile requests and cases of a suite may end with an emergency stop.
TEST_F(KeptRuns, AResetAtTheEndClearsAShutdownAndKeepsTheSettings) {
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 1);
  const host::BoardState before = sure(host::read_board(board, board, 1));
  const auto status_after = [&](bool reset) {
    host::Interrupt interrupt;
    StoppedPort port(board, Stop::none, Time::max(), interrupt);
    auto wanted = options(1);
    wanted.flash = false;
    wanted.reset = reset;
    const auto kept = sure(KeptRun::begin(port, port, interrupt, wanted));
    sure(sure(host::Robot::connect(port, port, {.watchdog = Time::zero()})).stop());
    const auto ended = kept->end();
    EXPECT_TRUE(ended) << ended.error().message;
    EXPECT_EQ(sure(host::read_board(board, board, 1)), before);
    return sure(sure(host::Robot::connect(board, board, {.watchdog = Time::zero()})).health())
        .shutdown;
  };
  EXPECT_FALSE(status_after(false).empty());
  EXPECT_EQ(status_after(true), "");
}

// A board one of whose motors stays on, whatever is requested.
class StuckPort final : public host::Link {
 public:
  explicit StuckPort(lockstep::VirtualBench& board) : board_(board) {
    kz_receiver_init(&receiver_);
  }
  std::string name() const override { return "test-port"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (kz_receive(&receiver_, byte, 0) != KZ_RECEIVE_FRAME) continue;
      if (stuck && receiver_.body[KZ_BODY_TYPE] == KZ_TYPE_enable)
        receiver_.body[receiver_.length - 1] |= 1;  // of the mask, joint 0
      std::array<std::uint8_t, KZ_FRAME_MAX> frame{};
      const auto length = kz_frame_encode(receiver_.body, receiver_.length, frame.data());
      KAZ_TRY(board_.write(std::span(frame).first(length)));
    }
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    return board_.read(bytes, deadline);
  }
  bool stuck = false;

 private:
  lockstep::VirtualBench& board_;
  kz_receiver receiver_{};
};

TEST_F(KeptRuns, MotorsThatAreStillOnAreNotCalledOff) {
  lockstep::VirtualBench board(sim::make_native());
  StuckPort port(board);
  host::Interrupt interrupt;
  const auto end_of_run = [&](bool stuck, std::function<std::string()> still_on = nullptr) {
    port.stuck = false;
    auto wanted = options(1);
    wanted.flash = false;
    wanted.notes = false;
    wanted.still_on = std::move(still_on);
    const auto kept = sure(KeptRun::begin(port, board, interrupt, wanted));
    sure(sure(host::Robot::connect(port, board)).set_gains(1, {.kp_per_rad = 7}));
    port.stuck = stuck;
    testing::internal::CaptureStderr();
    const auto ended = kept->end();
    return testing::internal::GetCapturedStderr() + (ended ? "" : ended.error().message);
  };
  EXPECT_NE(end_of_run(false).find("motors off ("), std::string::npos);
  const std::string stuck = end_of_run(true);
  EXPECT_EQ(stuck.find("motors off ("), std::string::npos) << stuck;
  EXPECT_NE(stuck.find("not restored: motors (still on): its motors may be on"), std::string::npos)
      << stuck;
  EXPECT_EQ(end_of_run(true, [] { return "pan (id 1) still has torque: cut the power"; }),
            "test-port: pan (id 1) still has torque: cut the power");
}

// A flash write is named once it was killed, until a later write is complete.
TEST_F(KeptRuns, AKilledFlashWriteIsNamed) {
  const auto only_notes = [&] {
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
    return fs::directory_iterator(folder_)->path().string();
  };
  const auto notes = sure(WriteNotes::begin("test-port", folder_));
  const std::string path = only_notes();
  EXPECT_TRUE(interrupted_writes("test-port", folder_).empty()) << "it is under way";
  // Another process had this number before.
  std::string text = sure(read_whole_file(path, 1 << 20));
  const std::string began = "\"process_began\": ";
  text.insert(text.find(began) + began.size(), "1");
  notes.drop();
  EXPECT_FALSE(fs::exists(path));
  sure(write_whole_file(path, text));
  const auto left = earlier_notes("test-port", folder_);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_NE(left[0].find(", or remove the notes in " + path), std::string::npos) << left[0];
  EXPECT_TRUE(interrupted_writes("other-port", folder_).empty());
  EXPECT_FALSE(read_kept(path)) << "kaz recover has nothing to put back";
  for (const std::size_t size : {std::size_t{0}, text.size() / 2}) {
    sure(write_whole_file(path, text.substr(0, size)));
    EXPECT_TRUE(interrupted_writes("test-port", folder_).empty()) << size;
  }
  sure(write_whole_file(path, text));
  sure(WriteNotes::begin("other-port", folder_)).done();
  EXPECT_TRUE(fs::exists(path)) << "another port's";
  sure(WriteNotes::begin("test-port", folder_)).done();
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(KeptRuns, EarlierNotesAreNamed) {
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 1);
  host::Interrupt interrupt;
  StoppedPort port(board, Stop::none, Time::max(), interrupt);
  std::string path, text;
  {
    const auto kept = sure(KeptRun::begin(port, port, interrupt, options(1)));
    path = kept->notes_path();
    text = sure(read_whole_file(path, 1 << 20));
    EXPECT_TRUE(earlier_notes("test-port", folder_).empty()) << "it is under way";
    // Under any name and in any place they are of a run under way.
    EXPECT_TRUE(notes_in_use(sure(parse_kept(text, "a copy"))));
  }
  EXPECT_TRUE(earlier_notes("test-port", folder_).empty());
  // Another process had this number before.
  const std::string began = "\"process_began\": ";
  text.insert(text.find(began) + began.size(), "1");
  EXPECT_FALSE(notes_in_use(sure(parse_kept(text, "a copy"))));
  ASSERT_TRUE(write_whole_file(path, text));
  ASSERT_TRUE(write_whole_file(path + ".part1-0", text));
  EXPECT_TRUE(earlier_notes("other-port", folder_).empty());
  EXPECT_TRUE(earlier_notes("test-port", folder_ + "/none").empty());
  auto sentences = earlier_notes("test-port", folder_);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("`kaz recover --robot serial:test-port --from " + path +
                              "` restores the board"),
            std::string::npos)
      << sentences[0];
  // The newest first, whatever its number.
  const std::string older = path.substr(0, path.rfind('-')) + "-1.json";
  ASSERT_TRUE(write_whole_file(older, text));
  std::filesystem::last_write_time(older,
                                   std::filesystem::last_write_time(path) - std::chrono::hours(1));
  const auto both = earlier_notes("test-port", folder_);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0], sentences[0]);
  EXPECT_TRUE(both[1].starts_with("after that: ")) << both[1];
  EXPECT_NE(both[1].find("--from " + older), std::string::npos) << both[1];
  std::filesystem::remove(older);
  const Error silent{Fault::environment, "no board answers"};
  EXPECT_EQ(with_earlier_notes(silent, "test-port", folder_).message,
            sentences[0] + "; no board answers");
  EXPECT_EQ(with_earlier_notes({Fault::usage, "wrong"}, "test-port", folder_).message, "wrong");
  EXPECT_EQ(with_earlier_notes(silent, "other-port", folder_).message, "no board answers");
  // A killed run has left the board at address 9.
  {
    auto robot = sure(host::Robot::connect(board, board));
    sure(robot.unlock(5));
    sure(robot.set_address(9, false));
    (void)robot.reset();
  }
  const auto begun = KeptRun::begin(port, port, interrupt, options(1));
  ASSERT_FALSE(begun);
  EXPECT_NE(begun.error().message.find("a board answers at address 9"), std::string::npos)
      << begun.error().message;
  EXPECT_NE(begun.error().message.find("--from " + path), std::string::npos)
      << begun.error().message;
  ASSERT_TRUE(write_whole_file(path, text.substr(0, text.size() / 2)));
  sentences = earlier_notes("test-port", folder_);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("or damaged"), std::string::npos) << sentences[0];
}

// Of a port's names those are followed that somebody may turn elsewhere, and not the last, which stays when a
// device comes back under another number.
TEST_F(KeptRuns, APortIsTheSameByWhereItsNameLeads) {
  namespace fs = std::filesystem;
  const std::string of = folder_ + "/";
  for (const char* device : {"pts1", "pts2", "pts3"})
    ASSERT_TRUE(write_whole_file(of + device, "a device"));
  fs::create_symlink("pts1", of + "a");
  fs::create_symlink("pts2", of + "b");
  fs::create_symlink(of + "a", of + "mine");
  KeptFile kept;
  kept.port = of + "mine";
  kept.line = of + "a";
  EXPECT_TRUE(same_port(kept, of + "mine"));
  EXPECT_TRUE(same_port(kept, of + "a"));
  EXPECT_TRUE(same_port(kept, of + "../" + fs::path(folder_).filename().string() + "/a"));
  EXPECT_TRUE(same_port(kept, of + "pts1")) << "another name of the device";
  EXPECT_FALSE(same_port(kept, of + "b"));
  fs::remove(of + "mine");
  fs::create_symlink("b", of + "mine");
  EXPECT_FALSE(same_port(kept, of + "mine")) << "it leads to another now";
  fs::remove(of + "a");
  fs::create_symlink("pts3", of + "a");
  EXPECT_TRUE(same_port(kept, of + "a")) << "plugged again";
  EXPECT_FALSE(same_port(kept, "can:a"));
  // Of devices the number counts.
  fs::create_symlink("/dev/null", of + "first");
  fs::create_symlink("/dev/null", of + "second");
  fs::create_symlink("/dev/zero", of + "third");
  kept.line = of + "first";
  EXPECT_TRUE(same_port(kept, of + "second"));
  EXPECT_TRUE(same_port(kept, "/dev/null"));
  EXPECT_FALSE(same_port(kept, of + "third"));
}

// A signal while the board is put back in the middle of a run: first that, then the end.
TEST_F(KeptRuns, ASignalWhileItPutsTheBoardBackDoesNotCutThatShort) {
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 1);
  host::Interrupt interrupt;
  StoppedPort port(board, Stop::none, Time::max(), interrupt);
  const auto kept = sure(KeptRun::begin(port, port, interrupt, options(1)));
  {
    auto robot = sure(host::Robot::connect(port, port));
    sure(robot.unlock(5));
    sure(robot.set_address(9, true));
  }
  interrupt.request();
  const auto back = kept->put_back();
  EXPECT_TRUE(back) << back.error().message;
  EXPECT_TRUE(interrupt.ends_waiting());
  EXPECT_TRUE(kept->end());
  EXPECT_EQ(sure(host::read_board(board, board, 1)).address, 1);
}

// Process numbers repeat, in containers often.
TEST_F(KeptRuns, NotesOfAnEarlierRunStay) {
  lockstep::VirtualBench board(sim::make_native()), another(sim::make_native());
  host::Interrupt interrupt;
  const auto first = sure(KeptRun::begin(board, board, interrupt, options(1)));
  const std::string path = notes();
  const auto size = fs::file_size(path);
  {
    const auto second = sure(KeptRun::begin(another, another, interrupt, options(1)));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
    EXPECT_TRUE(second->end());
  }
  EXPECT_EQ(notes(), path);
  EXPECT_EQ(fs::file_size(path), size);
  EXPECT_TRUE(first->end());
  EXPECT_TRUE(no_notes());
}

TEST_F(KeptRuns, NotesAreReadAsTheyWereWritten) {
  lockstep::VirtualBench board(sim::make_native());
  prepare(board, 6);
  KeptFile kept;
  kept.verb = "kaz fuzz";
  kept.port = kept.line = "/dev/ttyUSB0";
  kept.others = {2, 14};
  kept.board = sure(host::read_board(board, board, 6));
  sure(host::read_flash(board, board, kept.board));
  const std::string text = kept_text(kept);
  const auto again = sure(parse_kept(text, "notes"));
  EXPECT_EQ(again.board, kept.board);
  EXPECT_EQ(again.others, kept.others);
  EXPECT_EQ(kept_text(again), text);
  std::string wrong = text;
  wrong.replace(wrong.find("\"address\": 6"), 12, "\"address\": 15");
  EXPECT_EQ(parse_kept(wrong, "notes").error().message,
            "notes: its field address is missing or out of range; give the recovery "
            "notes of an interrupted run, or leave --from out");
}

TEST(Recover, BringsABoardFromAnyAddressAndClearsWhatIsLatched) {
  lockstep::VirtualBench board(sim::make_native());
  {
    auto robot = sure(host::Robot::connect(board, board));
    sure(robot.store_calibration());
    sure(robot.unlock(5));
    sure(robot.set_address(11, true));
    (void)robot.reset();
    auto moved = sure(host::Robot::connect(board, board, {.address = 11}));
    sure(moved.stop());
  }
  auto recovered = sure(recover_board(board, board, {.shared_line = false}, std::nullopt));
  EXPECT_EQ(recovered.found_at, 11);
  EXPECT_EQ(recovered.address, 1);
  EXPECT_EQ(recovered.status_before >> 8, KZ_SHUTDOWN_STOP);
  EXPECT_EQ(recovered.status >> 8, KZ_SHUTDOWN_NONE);
  EXPECT_EQ(recovered.done,
            (std::vector<std::string>{"address 11 to 1", "line set to not shared"}));
  auto robot = sure(host::Robot::connect(board, board));
  EXPECT_EQ(sure(robot.calibration()).sequence, 1);
  recovered = sure(recover_board(board, board, {.address = 4}, std::nullopt));
  EXPECT_EQ(recovered.found_at, 1);
  EXPECT_TRUE(host::read_board(board, board, 4));
}

TEST(Recover, WithoutABoardItsMessageCountsTheAddresses) {
  lockstep::VirtualBench board(sim::make_native());
  board.set_power(false);
  const auto recovered = recover_board(board, board, {}, std::nullopt);
  ASSERT_FALSE(recovered);
  EXPECT_EQ(recovered.error().fault, Fault::environment);
  EXPECT_NE(recovered.error().message.find("any of the 14 addresses"), std::string::npos);
  board.set_power(true);
  const auto absent = recover_board(board, board, {.found_at = 3}, std::nullopt);
  ASSERT_FALSE(absent);
  EXPECT_NE(absent.error().message.find("give one of them with --found-at: address 1"),
            std::string::npos)
      << absent.error().message;
}

}  // namespace
}  // namespace kaz::tools
