// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/light/stage.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/wall_clock.h"
#include "hardware/twin/stage/stage_twin.h"
#include "tests/support/loopback_listener.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

// 600 mm/min are 10 mm/s: after 1.5 s of a way of 20 mm the carriage is at 15 mm.
TEST(StageController, MovesAtTheSpeedItIsGiven) {
  StageController controller({});
  EXPECT_EQ(controller.receive("G90\nG21\n", 0.0), "ok\r\nok\r\n");
  EXPECT_EQ(controller.receive("G1 X20 F600\n", 1.0), "ok\r\n");
  EXPECT_EQ(controller.receive("?", 2.5), "<Run|MPos:15.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(controller.receive("?", 3.5), "<Idle|MPos:20.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(controller.receive("G1 X10\n", 4.0), "ok\r\n");
  EXPECT_DOUBLE_EQ(controller.position_mm(4.5), 15.0);  // and back, at the same speed
  EXPECT_EQ(controller.reached_mm(4.5), std::nullopt);
  EXPECT_EQ(controller.reached_mm(5.0), 10.0);
  EXPECT_EQ(StageController({}).reached_mm(5.0), std::nullopt) << "nobody has moved it";
}

TEST(StageController, RefusesWhatItDoesNotKnowAndLinesWithoutAnEnd) {
  StageController controller({.travel_mm = 100.0});
  EXPECT_EQ(controller.receive("G5 X1\n", 0.0), "error:20\r\n");
  EXPECT_EQ(controller.receive("G1 Y1\n", 0.0), "error:2\r\n");
  EXPECT_EQ(controller.receive("G1 X1 F0\n", 0.0), "error:2\r\n");
  EXPECT_EQ(controller.receive(std::string(100000, 'G') + "\n", 0.0), "error:11\r\n");
  EXPECT_EQ(controller.receive("G1 X101 F60\n", 0.0), "ALARM:2\r\n");
  EXPECT_EQ(controller.receive("G1 X1 F60\n", 0.0), "error:9\r\n");
  EXPECT_EQ(controller.receive("$X\nG1 X1 F60\n", 0.0), "ok\r\nok\r\n");
}

// A real one without a text answers "[VER:1.1h.20190825:]".
TEST(StageController, TellsTheTextThatItKeepsAlsoInAlarm) {
  StageController controller({.kept_text = "left rail"});
  controller.raise_alarm(0.0);
  EXPECT_EQ(controller.receive("$I\n", 0.0),
            "[VER:1.1h.20190825:left rail]\r\n[OPT:V,15,128]\r\nok\r\n");
}

constexpr StageWay kWay = {.positions = 5, .first_mm = 10.0, .step_mm = 2.5, .speed_mm_s = 200.0};

TEST(LinearStage, StandsWhereItWasSent) {
  const StageTwin twin({});
  TextLink link = TextLink::tcp("127.0.0.1", twin.port(), milliseconds(1000));
  LinearStage stage(link, kWay);
  EXPECT_EQ(stage.position(), -1);
  stage.go_to(4);
  EXPECT_EQ(stage.position(), 4);
  EXPECT_DOUBLE_EQ(twin.position_mm(), 20.0);  // 10 + 4 * 2.5
  stage.go_to(1);
  EXPECT_DOUBLE_EQ(twin.position_mm(), 12.5);
  EXPECT_THROW(stage.go_to(5), ConfigError);
}

TEST(LinearStage, NamesAnAlarmAndIsNowhereThen) {
  StageTwin twin({});
  TextLink link = TextLink::tcp("127.0.0.1", twin.port(), milliseconds(1000));
  LinearStage stage(link, kWay);
  stage.go_to(0);
  twin.raise_alarm();
  try {
    stage.go_to(1);
    FAIL() << "no error";
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), HasSubstr("G1 X12.5000 F12000.0 is answered by error:9"));
  }
  EXPECT_EQ(stage.position(), -1);
}

TEST(LinearStage, NamesAControllerThatIsGone) {
  auto twin = std::make_unique<StageTwin>(StageTwinSettings{});
  const int port = twin->port();
  TextLink link = TextLink::tcp("127.0.0.1", port, milliseconds(1000));
  LinearStage stage(link, kWay);
  twin.reset();
  EXPECT_THROW(stage.go_to(1), IoError);
  EXPECT_THROW(TextLink::tcp("127.0.0.1", port, milliseconds(1000)), IoError);
}

/// Nobody can be connected with a broadcast address: connect() says so itself, and the socket asked
/// later knows of no failure.
TEST(TextLink, ToldOfAFailureAtOnceIsNoLink) {
  EXPECT_THROW(TextLink::tcp("255.255.255.255", 9, milliseconds(1000)), IoError);
}

/// A controller that answers each piece of text by what a function says.
class AnsweringController {
 public:
  using Answer = std::function<std::string(std::string_view text)>;

  explicit AnsweringController(Answer answer)
      : answer_(std::move(answer)), thread_([this] { serve(); }) {}

  ~AnsweringController() {
    listener_.shut_down();
    thread_.join();
  }

  AnsweringController(const AnsweringController&) = delete;
  AnsweringController& operator=(const AnsweringController&) = delete;

  int port() const { return listener_.port(); }

 private:
  void serve() {
    const int peer = listener_.accept(5000);
    std::array<char, 256> bytes = {};
    ssize_t count = 0;
    while ((count = ::recv(peer, bytes.data(), bytes.size(), 0)) > 0) {
      const std::string text = answer_({bytes.data(), static_cast<std::size_t>(count)});
      ::send(peer, text.data(), text.size(), MSG_NOSIGNAL);
    }
    ::close(peer);
  }

  Answer answer_;
  LoopbackListener listener_;
  std::thread thread_;  // last: uses the others
};

/// What going to a position fails with; the controller says that it stands there.
std::string failure_at(const std::string& where) {
  const AnsweringController controller([&where](std::string_view text) {
    return text == "?" ? "<Idle|MPos:" + where + ",0,0>\n" : std::string("ok\n");
  });
  TextLink link = TextLink::tcp("127.0.0.1", controller.port(), milliseconds(1000));
  LinearStage stage(link, kWay);
  return text_thrown_by<IoError>([&stage] { stage.go_to(0); });
}

TEST(LinearStage, AtNoNumberIsNotThere) {
  EXPECT_EQ(failure_at("10.000"), "nothing thrown");
  EXPECT_THAT(failure_at("10.03"), HasSubstr("stands at 10.03 mm, not at 10 mm"));
  EXPECT_THAT(failure_at("nan"), HasSubstr("stands at nan mm"));
}

constexpr const char* kGreeting = "\r\nGrbl 1.1h ['$' for help]\r\n";

// At 12.5 mm it restarts: it says 0 there, and would tell 15 mm at 27.5 mm.
TEST(LinearStage, AControllerThatRestartsHasNoZero) {
  double at_mm = 0.0;
  const AnsweringController controller([&at_mm](std::string_view text) {
    if (text.starts_with("G1 X15")) {
      return std::string(kGreeting) + "ok\n";
    }
    at_mm = text.starts_with("G1 X12.5") ? 12.5 : at_mm;
    return text == "?" ? "<Idle|MPos:" + std::to_string(at_mm) + ",0,0>\n" : std::string("ok\n");
  });
  TextLink link = TextLink::tcp("127.0.0.1", controller.port(), milliseconds(1000));
  LinearStage stage(link, kWay);
  stage.go_to(1);
  EXPECT_THAT(text_thrown_by<IoError>([&stage] { stage.go_to(2); }),
              HasSubstr("has restarted (Grbl 1.1h ['$' for help]), and its zero"));
  EXPECT_EQ(stage.position(), -1);
}

TEST(LinearStage, AControllerThatGreetsWhoConnectsHasNotRestarted) {
  const AnsweringController controller([](std::string_view text) {
    if (text == "G90\n") {
      return std::string(kGreeting) + "ok\n";
    }
    return std::string(text == "?" ? "<Idle|MPos:10,0,0>\n" : "ok\n");
  });
  TextLink link = TextLink::tcp("127.0.0.1", controller.port(), milliseconds(1000));
  LinearStage stage(link, kWay);
  EXPECT_NO_THROW(stage.go_to(0));
}

/// A controller at the other end of a serial line, which answers each line by what a function says.
class SerialController {
 public:
  using Answer = std::function<std::string(std::string_view line)>;

  explicit SerialController(Answer answer)
      : answer_(std::move(answer)), controlling_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    GLINT_CHECK(::grantpt(controlling_) == 0 && ::unlockpt(controlling_) == 0, "a pseudo-terminal");
    device_ = ::ptsname(controlling_);
    open_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY);
    termios settings = {};
    ::tcgetattr(open_, &settings);
    settings.c_cflag |= HUPCL;  // as a serial line has it at first
    ::tcsetattr(open_, TCSANOW, &settings);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }

  ~SerialController() {
    thread_ = {};
    ::close(open_);
    ::close(controlling_);
  }

  SerialController(const SerialController&) = delete;
  SerialController& operator=(const SerialController&) = delete;

  const std::string& device() const { return device_; }

  /// Whether DTR falls when the line is closed.
  bool hangs_up() const {
    termios settings = {};
    return ::tcgetattr(open_, &settings) == 0 && (settings.c_cflag & HUPCL) != 0;
  }

 private:
  void serve(const std::stop_token& stop) {
    std::string line;
    while (!stop.stop_requested()) {
      pollfd waiting = {.fd = controlling_, .events = POLLIN, .revents = 0};
      char letter = 0;
      if (::poll(&waiting, 1, 10) <= 0 || ::read(controlling_, &letter, 1) != 1) {
        continue;
      }
      if (letter == '\n' || letter == '?') {
        const std::string text = answer_(letter == '?' ? "?" : line);
        GLINT_CHECK(::write(controlling_, text.data(), text.size()) >= 0, "an open line");
        line.clear();
      } else {
        line += letter;
      }
    }
  }

  Answer answer_;
  int controlling_;
  int open_ = -1;  ///< the device: without it reading fails until somebody opens it
  std::string device_;
  std::jthread thread_;
};

// Opening the line has restarted it, and its loader of programs has eaten the first line.
TEST(LinearStage, OnASerialLineAGreetingIsARestart) {
  bool is_fresh = true;
  const SerialController controller([&is_fresh](std::string_view line) {
    if (std::exchange(is_fresh, false)) {
      return std::string(kGreeting);
    }
    return std::string(line == "?" ? "<Idle|MPos:10,0,0>\n" : "ok\n");
  });
  EXPECT_TRUE(controller.hangs_up());
  {
    TextLink link = TextLink::serial(controller.device(), 115200);
    EXPECT_THAT(text_thrown_by<IoError>([&link] { LinearStage(link, kWay); }),
                HasSubstr("home the stage ($H)"));
  }
  EXPECT_FALSE(controller.hangs_up()) << "the next opening would restart it again";
  TextLink link = TextLink::serial(controller.device(), 115200);
  LinearStage stage(link, kWay);
  stage.go_to(0);
  EXPECT_EQ(stage.position(), 0);
}

/// The text that is read where `$I` is answered so.
std::string text_kept_by(const std::string& answer) {
  const AnsweringController controller([&answer](std::string_view) { return answer; });
  TextLink link = TextLink::tcp("127.0.0.1", controller.port(), milliseconds(1000));
  try {
    return kept_text(link);
  } catch (const IoError& error) {
    return error.what();
  }
}

TEST(KeptText, StandsBehindTheVersion) {
  EXPECT_EQ(text_kept_by("[VER:1.1h.20190825:left: 7]\r\n[OPT:V,15,128]\r\nok\r\n"), "left: 7");
  for (const char* none :
       {"[VER:1.1h.20190825:]\nok\n", "[VER:]\nok\n", "[VER:1.1h]\nok\n", "ok\n"}) {
    EXPECT_EQ(text_kept_by(none), "") << none;
  }
}

TEST(LinearStage, AControllerThatTalksOnDoesNotAnswer) {
  const AnsweringController controller([](std::string_view) {
    std::string text;
    for (int i = 0; i < 1000; ++i) {
      text += "[MSG:hello]\n";
    }
    return text;
  });
  TextLink link = TextLink::tcp("127.0.0.1", controller.port(), milliseconds(1000));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(text_thrown_by<IoError>([&link] { LinearStage(link, kWay); }),
              HasSubstr("G90 is not answered"));
  EXPECT_LT(seconds_since(begin), 1.5) << "not when it falls silent";
}

TEST(FolderStage, ShowsThePictureOfItsPosition) {
  const TemporaryFolder folder;
  FolderStage stage(folder / "show", {ImageF(4, 3, 0.0F), ImageF(4, 3, 1.0F)}, milliseconds(0));
  stage.go_to(1);
  EXPECT_EQ(stage.position(), 1);
  EXPECT_FLOAT_EQ(read_image(folder / "show/show.png")(3, 2), 1.0F);
  stage.go_to(0);
  EXPECT_FLOAT_EQ(read_image(folder / "show/show.png")(3, 2), 0.0F);
  EXPECT_THROW(stage.go_to(2), ConfigError);
}

// Grey 0.5 is 127.5, so 128; in 5, 6, 5 bits: 16, 32, 16 = 0x8410, the lower byte first.
TEST(FramebufferBytes, AreThoseOfTheDevice) {
  ImageF picture(2, 1, 1.0F);
  picture(1, 0) = 0.5F;
  EXPECT_THAT(framebuffer_bytes(picture, {.width_px = 2, .height_px = 1, .bytes_per_row = 8}),
              ElementsAre(255, 255, 255, 0, 128, 128, 128, 0));
  EXPECT_THAT(
      framebuffer_bytes(picture,
                        {.width_px = 3, .height_px = 1, .bytes_per_pixel = 2, .bytes_per_row = 8}),
      ElementsAre(0xff, 0xff, 0x10, 0x84, 0, 0, 0, 0));
}

TEST(FramebufferStage, WritesInPlace) {
  const TemporaryFolder folder;
  const std::filesystem::path device = folder / "fb0";
  write_file(device, std::string(8, 'x'));
  const FramebufferLayout layout = {.width_px = 2, .height_px = 1, .bytes_per_row = 8};
  FramebufferStage stage(device, layout, {ImageF(2, 1, 0.0F)}, milliseconds(0));
  stage.go_to(0);
  EXPECT_EQ(read_file(device), std::string(8, '\0'));
  std::filesystem::remove(device);
  EXPECT_THROW(stage.go_to(0), IoError);
  EXPECT_EQ(stage.position(), -1);
  EXPECT_THROW(
      FramebufferStage(device, {.width_px = 2, .height_px = 1, .bytes_per_row = 7}, {}, {}),
      ConfigError);
}

}  // namespace
}  // namespace glint
