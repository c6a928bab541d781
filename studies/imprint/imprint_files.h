// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files of one defective part: meshes, metadata, previews.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/config/config.h"
#include "core/thread_pool.h"
#include "simulator/render/preview/preview.h"
#include "studies/imaging/built_part.h"

namespace glint {

inline constexpr const char* kImprintMetadata = "defects.json";

struct ImprintFileOptions {
  bool has_previews = true;
  std::vector<PreviewView> views = {};
  ConfigNode scene = {};  ///< as written: the metadata names files as the scene does
};

/// Seconds that one part took, for run.json.
struct ImprintSeconds {
  double make_s = 0.0;
  double files_s = 0.0;
  double previews_s = 0.0;
};

/// Writes part.stl, part.ply, defect_map.obj, defects.json and the previews into a folder.
/// @throws IoError
void write_imprint_files(const std::filesystem::path& folder,
                         const SceneSettings& scene,
                         const BuiltDefects& part,
                         std::uint64_t seed,
                         const ImprintFileOptions& options,
                         ThreadPool& pool,
                         ImprintSeconds& seconds);

/// What the verb tells of a part, from its metadata: made, given_up, retries, jitters,
/// removed_volume_mm3.
nlohmann::ordered_json imprint_summary(const nlohmann::ordered_json& metadata);

/// make_s, files_s, previews_s and the seconds of each defect.
nlohmann::ordered_json timings_json(const ImprintSeconds& seconds, const DefectivePart& made);

}  // namespace glint
