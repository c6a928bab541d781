// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/cli/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/page_data.h"

namespace glint::test {
namespace fs = std::filesystem;

namespace {

constexpr const char* kSmallStudy = R"(schema = 1
title = "Small"

[part]
shape = "strip"
length_mm = 40
width_mm = 12
radius_along_mm = 400
radius_across_mm = 40

[camera]
width_px = 200
height_px = 60
object_pixel_mm = 0.2
working_distance_mm = 300

[render]
rays_per_axis = 1

[sensor]
gain = 1.5
blur_px = 0.7

[scan]
positions = 8

[lighting.tunnel]
shape = "semicylinder"
radius_mm = 80
slot_mm = 14
length_mm = 400
period_mm = 12

[defects.dent]
x_mm = [2]
y_mm = [1]
height_um = 4
diameter_mm = 1.5

[variables]
"lighting.tunnel.radius_mm" = { min = 60, max = 120 }
"lighting.tunnel.base_mm" = { min = -10, max = 10 }

[objective]
maximise = "homogeneity.h_rms"

[constraints]
"homogeneity.clipped_share" = { max = 0.9 }
"defects.min_cnr" = { min = 0.1 }

[search]
batch = 2

[budget]
evaluations = 12
)";

[[noreturn]] void become_program(const fs::path& folder,
                                 const fs::path& caught,
                                 std::vector<char*>& arguments,
                                 const std::function<void()>& in_child) {
  const int out = ::open((caught / "out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open((caught / "err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (::chdir(folder.c_str()) == 0) {
    if (in_child) {
      in_child();
    }
    ::execv(GLINT_PROGRAM, arguments.data());
  }
  ::_exit(126);
}

}  // namespace

Program::Program(const fs::path& folder,
                 const Arguments& arguments,
                 const std::function<void()>& in_child) {
  Arguments words = {"glint"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  child_ = ::fork();
  if (child_ == 0) {
    become_program(folder, caught_.path(), pointers, in_child);
  }
  GLINT_CHECK(child_ > 0, "fork works");
}

Program::~Program() {
  if (!has_ended_) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
}

void Program::send(int signal) const {
  if (!has_ended_) {
    ::kill(child_, signal);
  }
}

void Program::note_end(int status) {
  has_ended_ = true;
  result_.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result_.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

bool Program::is_running() {
  int status = 0;
  if (!has_ended_ && ::waitpid(child_, &status, WNOHANG) == child_) {
    note_end(status);
  }
  return !has_ended_;
}

ProgramResult Program::wait() {
  int status = 0;
  if (!has_ended_) {
    ::waitpid(child_, &status, 0);
    note_end(status);
  }
  result_.out = read_file(caught_ / "out");
  result_.err = read_file(caught_ / "err");
  return result_;
}

ProgramResult glint_in(const fs::path& folder,
                       const Arguments& arguments,
                       const std::function<void()>& in_child) {
  return Program(folder, arguments, in_child).wait();
}

ProgramResult glint_in(const TemporaryFolder& folder, const Arguments& arguments) {
  return glint_in(folder.path(), arguments);
}

std::vector<ProgramResult> glint_at_once(const TemporaryFolder& folder,
                                         const std::vector<Arguments>& calls) {
  std::vector<std::unique_ptr<Program>> programs;
  for (const Arguments& call : calls) {
    programs.push_back(std::make_unique<Program>(folder.path(), call));
  }
  std::vector<ProgramResult> results;
  for (const auto& program : programs) {
    results.push_back(program->wait());
  }
  return results;
}

nlohmann::json json_of(const TemporaryFolder& folder, Arguments arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = glint_in(folder, arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

std::string small_study() {
  return kSmallStudy;
}

std::string mixed_study() {
  return edited(kSmallStudy,
                {{"blur_px = 0.7\n", "blur_px = 0.7\nfull_well_e = 5000\nread_noise_e = 6\n"},
                 {"[variables]\n",
                  "[prototypes.wide]\n\"lighting.tunnel.radius_mm\" = 110\n\n"
                  "[prototypes.ellipse]\ntitle = \"An ellipse\"\n"
                  "\"lighting.tunnel.shape\" = \"ellipse\"\n\n"
                  "[variables]\n"
                  "\"lighting.tunnel.shape\" = { choices = [\"semicylinder\", \"ellipse\"] }\n"
                  "\"lighting.tunnel.half_width_mm\" = { min = 50, max = 120, when = "
                  "\"lighting.tunnel.shape == ellipse\" }\n"}});
}

std::string slow_study() {
  // Without noise: noisy pictures take longer to write than all evaluations together.
  return edited(mixed_study(),
                {{"width_px = 200", "width_px = 600"},
                 {"height_px = 60", "height_px = 180"},
                 {"object_pixel_mm = 0.2", "object_pixel_mm = 0.0667"},
                 {"full_well_e = 5000\nread_noise_e = 6\n", ""},
                 {"[prototypes.wide]\n\"lighting.tunnel.radius_mm\" = 110\n\n", ""},
                 {"positions = 8", "positions = 6"},
                 {"evaluations = 12", "evaluations = 40"}});
}

std::string edited(std::string text,
                   const std::vector<std::pair<std::string, std::string>>& replacements) {
  for (const auto& [from, to] : replacements) {
    const auto at = text.find(from);
    GLINT_CHECK(at != std::string::npos, "the text to replace is there");
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string place_of(const std::string& study, const std::string& text) {
  const auto at = study.find(text);
  GLINT_CHECK(at != std::string::npos, "the text is in the study");
  const auto start = study.rfind('\n', at) + 1;  // npos + 1 is 0
  const auto line =
      1 + std::count(study.begin(), study.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  return "study\\.toml:" + std::to_string(line) + ":" + std::to_string(at - start + 1) + ": ";
}

std::string rectangle_stl(double length, double width) {
  const std::string x = std::to_string(length / 2);
  const std::string y = std::to_string(width / 2);
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 1\nouter loop\nvertex " + a + " 0\nvertex " + b + " 0\nvertex " + c +
           " 0\nendloop\nendfacet\n";
  };
  return "solid rectangle\n" + facet("-" + x + " -" + y, x + " -" + y, x + " " + y) +
         facet("-" + x + " -" + y, x + " " + y, "-" + x + " " + y) + "endsolid rectangle\n";
}

std::map<std::string, std::string> files_below(const fs::path& folder) {
  static const std::set<std::string> kWithTimes = {
      "run.json", "log.txt", "study.sqlite", "study.sqlite-wal", "study.sqlite-shm"};
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_regular_file() && !kWithTimes.contains(name)) {
      files[name] = name.ends_with("report.html") ? without_when(read_file(entry.path()))
                                                  : read_file(entry.path());
    }
  }
  return files;
}

void expect_same_files(const fs::path& folder, const fs::path& expected) {
  const auto mine = files_below(folder);
  const auto theirs = files_below(expected);
  for (const auto& [name, bytes] : theirs) {
    const auto found = mine.find(name);
    EXPECT_TRUE(found != mine.end() && found->second == bytes)
        << name << (found == mine.end() ? " is missing" : " differs");
  }
  for (const auto& [name, bytes] : mine) {
    EXPECT_TRUE(theirs.contains(name)) << name << " should not be there";
  }
}

}  // namespace glint::test
