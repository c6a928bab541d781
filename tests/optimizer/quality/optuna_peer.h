// SPDX-License-Identifier: GPL-3.0-or-later
//
// Optuna's samplers behind ask and tell: a Python process at the other end of two pipes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "core/error.h"
#include "optimizer/problem/space.h"

namespace glint::quality {

/// Optuna, or a package that a sampler of it needs, is not installed.
class PeerMissing : public Error {
 public:
  using Error::Error;
};

class OptunaPeer {
 public:
  /// @param sampler  "tpe" or "cmaes"; minimises
  /// @param space    conditions look at choices that come earlier
  /// @throws PeerMissing
  OptunaPeer(const SearchSpace& space, const std::string& sampler, std::uint64_t seed);
  ~OptunaPeer();

  OptunaPeer(const OptunaPeer&) = delete;
  OptunaPeer& operator=(const OptunaPeer&) = delete;

  /// Canonical in the space. Each ask is followed by its tell.
  Point ask();
  void tell(double value);

 private:
  void start(const std::string& study);
  void end();
  /// @throws IoError when the process has ended
  std::string read_line();

  const SearchSpace& space_;
  pid_t process_ = -1;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
};

}  // namespace glint::quality
