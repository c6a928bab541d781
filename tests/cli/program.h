// SPDX-License-Identifier: GPL-3.0-or-later
//
// The built program as a child process, and small studies for it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tests/support/temporary_folder.h"

namespace glint::test {

using Arguments = std::vector<std::string>;

struct ProgramResult {
  int code = -1;   ///< exit code; -1 when a signal ended it
  int signal = 0;  ///< that ended it
  std::string out;
  std::string err;
};

/// `glint` with its working folder, stdout and stderr caught in files beside it.
class Program {
 public:
  /// @param in_child  called between fork and exec, for limits
  Program(const std::filesystem::path& folder,
          const Arguments& arguments,
          const std::function<void()>& in_child = {});
  ~Program();  ///< kills what still runs
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t id() const { return child_; }

  void send(int signal) const;
  bool is_running();  ///< does not wait
  ProgramResult wait();

 private:
  void note_end(int status);

  TemporaryFolder caught_;
  pid_t child_ = -1;
  bool has_ended_ = false;
  ProgramResult result_;
};

/// Runs the program to its end.
ProgramResult glint_in(const std::filesystem::path& folder,
                       const Arguments& arguments,
                       const std::function<void()>& in_child = {});
ProgramResult glint_in(const TemporaryFolder& folder, const Arguments& arguments);

/// Runs it with each of these arguments, all at once: they must not disturb each other.
std::vector<ProgramResult> glint_at_once(const TemporaryFolder& folder,
                                         const std::vector<Arguments>& calls);

/// The one JSON object that a call with --json prints; the call must end with exit code 0.
nlohmann::json json_of(const TemporaryFolder& folder, Arguments arguments);

/// A study whose evaluations take about a millisecond: 200 x 60 pixels, 8 positions, 1 ray a pixel,
/// two variables, 12 evaluations.
std::string small_study();

/// The same job with a choice among the variables, noise and two prototypes.
std::string mixed_study();

/// 40 evaluations of some 10 ms, so that kills and interrupts land in the search.
std::string slow_study();

/// Replaces texts that must occur.
std::string edited(std::string text,
                   const std::vector<std::pair<std::string, std::string>>& replacements);

/// Regular expression of the place of a text in study.toml: "study\.toml:12:1: ".
std::string place_of(const std::string& study, const std::string& text);

/// ASCII STL of a flat rectangle about the origin, in the numbers given.
std::string rectangle_stl(double length, double width);

/// Every file below a folder by relative path. Files that tell times (run.json, log.txt, the
/// database, the element of report.html that has the date) are left out: the rest must be the same
/// bytes for the same study.
std::map<std::string, std::string> files_below(const std::filesystem::path& folder);

/// files_below() of both folders agree; names the files that do not.
void expect_same_files(const std::filesystem::path& folder, const std::filesystem::path& expected);

}  // namespace glint::test
