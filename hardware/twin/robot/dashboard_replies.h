// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace glint {

class TwinController;

/// What the dashboard of a twin answers, and what a command does to it.
class DashboardReplies {
 public:
  explicit DashboardReplies(TwinController& twin) : twin_(twin) {}

  /// The first line after a client has connected.
  static std::string greeting() { return "Connected: Universal Robots Dashboard Server"; }

  std::string reply(std::string_view line);

 private:
  std::string query(std::string_view line) const;
  std::string stop();
  std::string unlock();
  std::string power(bool is_on);
  std::string release_brakes();

  TwinController& twin_;
};

}  // namespace glint
