// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint imprint`: a scene's part with its defects as files, once or many times over.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct ImprintOptions {
  std::filesystem::path out;
  int count = 0;  ///< parts in numbered folders; 0: one part in `out` itself
  int threads = 1;
  bool has_previews = true;
  Progress::Style progress = Progress::Style::kAuto;
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// The seed of a numbered part: 53 random bits of (seed, part), so that JSON keeps it.
std::uint64_t part_seed(std::uint64_t seed, int part);

/// Makes parts with the scene's defects; numbered ones that are there already are kept. Groups with
/// realisation = "auto" are imprinted: other programs get the mesh.
/// @return status "done" or "interrupted"; of one part its metadata's totals, defects and files, of
///         many the totals and a row for each (docs/imprint.md)
/// @throws ConfigError, IoError; nothing half-written is left behind
nlohmann::ordered_json imprint_scene(const Study& study, const ImprintOptions& options);

}  // namespace glint
