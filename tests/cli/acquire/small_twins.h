// SPDX-License-Identifier: GPL-3.0-or-later
//
// Twins of the gallery's cell that are quick, and `glint acquire` with them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/robot/twin_proof.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"

namespace glint::test {

/// The gallery's cell with the ring on in each view, which nobody has to switch then.
inline std::string cell_with_ring() {
  return edited(fast_cell(), {{"lights = [\"bar\"]", "lights = [\"ring\", \"bar\"]"}});
}

/// The gallery's cell with pictures of a quarter as many pixels, and an arm that moves 20 times as
/// fast.
class SmallTwins {
 public:
  explicit SmallTwins(const std::string& cell = cell_with_ring()) {
    write_file(folder / "truth.toml", small_truth());
    write_file(folder / "cell.toml", cell);
    twins_.emplace(folder, "both", "cell.toml");
  }

  SmallTwins(const SmallTwins&) = delete;
  SmallTwins& operator=(const SmallTwins&) = delete;

  static Arguments acquire(const std::string& out) {
    Arguments call = driving({"acquire"});
    call.insert(call.end(), {"--out", out});
    return call;
  }

  void fault(const std::string& what) const {
    const std::filesystem::path socket = twins_->of("robot")["side_channel"].get<std::string>();
    EXPECT_EQ(ask_side_channel(socket, "fault " + what).value_or("nobody"), "ok");
  }

  /// Bytes of all pictures that were kept, by their names.
  std::map<std::string, std::string> pictures(const std::string& out) const {
    std::map<std::string, std::string> found;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(folder / out / "views")) {
      if (entry.is_regular_file()) {
        found[entry.path().lexically_relative(folder / out).string()] = read_file(entry.path());
      }
    }
    return found;
  }

  nlohmann::json acquired(const std::string& out) const {
    return nlohmann::json::parse(read_file(folder / out / "acquired.json"));
  }

  TemporaryFolder folder;

 private:
  std::optional<ServedTwins> twins_;  // after the folder
};

}  // namespace glint::test
