// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions to the person at the terminal, who answers, or wants it all to end.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using testing::HasSubstr;

/// A terminal for standard input and errors of a program.
class Terminal {
 public:
  Terminal() : number_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_GE(number_, 0);
    EXPECT_EQ(::grantpt(number_), 0);
    EXPECT_EQ(::unlockpt(number_), 0);
  }

  ~Terminal() { ::close(number_); }

  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// In the program's process. The terminal is not a controlling one: signals are sent.
  void take() const {
    std::array<char, 128> name = {};
    if (::ptsname_r(number_, name.data(), name.size()) != 0) {
      ::_exit(126);
    }
    const int there = ::open(name.data(), O_RDWR | O_NOCTTY);
    ::dup2(there, STDIN_FILENO);
    ::dup2(there, STDERR_FILENO);
  }

  /// What has come by the time that a text has; at most 20 s.
  std::string read_up_to(const std::string& text) const {
    constexpr int kPatienceMs = 20'000;
    std::string all;
    pollfd waiting = {.fd = number_, .events = POLLIN, .revents = 0};
    while (all.find(text) == std::string::npos && ::poll(&waiting, 1, kPatienceMs) > 0) {
      std::array<char, 512> some = {};
      const ssize_t count = ::read(number_, some.data(), some.size());
      if (count <= 0) {
        break;
      }
      all.append(some.data(), static_cast<std::size_t>(count));
    }
    return all;
  }

  void type(const std::string& text) const {
    EXPECT_EQ(::write(number_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

 private:
  int number_;
};

/// A design of a run with another one whose ring is built differently, in a cell that nobody
/// serves.
class QuestionForAPrototype : public testing::Test {
 protected:
  QuestionForAPrototype() {
    const std::string truth = small_truth();
    const std::string scene = truth.substr(0, truth.find("[truth]"));
    for (const char* design : {"narrow", "wide"}) {
      std::filesystem::create_directories(folder_ / "run" / design);
    }
    write_file(folder_ / "run/study.resolved.toml", scene);
    write_file(folder_ / "run/narrow/scene.toml", scene);
    write_file(
        folder_ / "run/wide/scene.toml",
        std::regex_replace(scene, std::regex("outer_radius_mm = [0-9.]+"), "outer_radius_mm = 77"));
    write_file(folder_ / "truth.toml", truth);
    write_file(folder_ / "cell.toml", edited(fast_cell(), {{"[robot]", "[robot]\nrtde_port = 1"}}));
  }

  /// Asked for the prototype, the person does something.
  template <class Function>
  ProgramResult asked(const Function& person) const {
    const Terminal terminal;
    Program program(
        folder_.path(),
        {"acquire", "run/narrow", "--cell", "cell.toml", "--out", "out", "--json", "--move"},
        [&terminal] { terminal.take(); });
    EXPECT_THAT(terminal.read_up_to("[y/N]"), HasSubstr("mount the prototype of narrow (ring)"));
    person(terminal, program);
    return program.wait();
  }

  TemporaryFolder folder_;
};

TEST_F(QuestionForAPrototype, EndsAtCtrlC) {
  const ProgramResult result =
      asked([](const Terminal&, const Program& program) { program.send(SIGINT); });
  EXPECT_EQ(result.code, 130);
  const nlohmann::json told = nlohmann::json::parse(result.out);
  EXPECT_EQ(told["status"], "waiting");
  EXPECT_EQ(told["end"]["cause"], "interrupted");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(QuestionForAPrototype, IsAnsweredByALine) {
  const auto answer = [&](const char* line) {
    return asked([line](const Terminal& terminal, const Program&) { terminal.type(line); });
  };
  const ProgramResult no = answer("not yet\n");
  EXPECT_EQ(no.code, 1);
  EXPECT_TRUE(nlohmann::json::parse(no.out)["end"].is_null());
  EXPECT_EQ(answer("y\n").code, 3) << "it goes on, and nobody listens";
}

}  // namespace
}  // namespace glint::test
