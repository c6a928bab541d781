// SPDX-License-Identifier: GPL-3.0-or-later
//
// Twins that the built program serves until the end of a test. Starting the program costs most of a
// test's time, so this starts it once and ends it by a signal.
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"

namespace glint::test {

class ServedTwins {
 public:
  /// On free ports and addresses. @param folder  for twin.json, their ready file; must outlive this
  /// @param kind  camera, robot or both
  /// @param more  options
  ServedTwins(const TemporaryFolder& folder,
              const std::string& kind,
              const std::string& cell,
              const Arguments& more = {})
      : ready_file_(folder / "twin.json"), program_(folder.path(), call(kind, cell, more)) {
    while (program_.is_running() && !std::filesystem::exists(ready_file_)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (!std::filesystem::exists(ready_file_)) {
      ADD_FAILURE() << program_.wait().err;
      return;
    }
    ready_ = nlohmann::json::parse(read_file(ready_file_));
  }

  ~ServedTwins() {
    program_.send(SIGTERM);
    program_.wait();
  }

  ServedTwins(const ServedTwins&) = delete;
  ServedTwins& operator=(const ServedTwins&) = delete;

  pid_t process() const { return program_.id(); }

  /// The object of the ready file that describes the twin of this kind; null without one.
  nlohmann::json of(const std::string& kind) const {
    for (const nlohmann::json& twin : ready_["twins"]) {
      if (twin["kind"] == kind) {
        return twin;
      }
    }
    return nullptr;
  }

 private:
  static Arguments call(const std::string& kind, const std::string& cell, const Arguments& more) {
    Arguments words = {"cell", "twin", kind, cell, "--port", "0", "--ready_file", "twin.json"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  std::filesystem::path ready_file_;
  Program program_;
  nlohmann::json ready_;
};

}  // namespace glint::test
