// SPDX-License-Identifier: GPL-3.0-or-later
//
// One convention from what several files of poses and the user say.
#pragma once

#include <map>
#include <string>

#include "hardware/poses/pose_convention.h"

namespace glint {

/// `known` with every key that `said` says, also where it says the default.
PoseConvention overruled(PoseConvention known, const PoseConvention& said);

/// What files of poses say together. A key that one of them says holds for all.
class FileConventions {
 public:
  /// @param user  wins over all files, so that they may contradict each other in what it says
  explicit FileConventions(PoseConvention user) : user_(std::move(user)) {}

  /// @throws ConfigError naming both files and the key where an earlier file says another value
  void add(const PoseConvention& one, const std::string& file);

  const PoseConvention& all() const { return all_; }

 private:
  PoseConvention user_;
  PoseConvention all_;
  std::map<std::string, std::string> files_;  ///< by key: the first that says it
};

}  // namespace glint
