// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/coverage/scene_coverage.h"

namespace glint {

/// The smallest defect that a study of detection finds nine times of ten, and how finely its
/// camera saw the part.
struct PodReference {
  std::string design;
  double a90_mm = 0.0;
  double pixel_mm = 0.0;  ///< of the part in one pixel, the median over what was inspected
};

/// "view_01"
std::string view_name(std::size_t viewpoint);

/// Width of the smallest defect that is found on a cell [mm]: defect_px pixels, and no less than
/// a90 in proportion to the pixel. 0 where no view inspects it.
double smallest_defect_mm(const CellCoverage& cell,
                          const CoverageSettings& settings,
                          const std::optional<PodReference>& pod);

/// The same of all cells [um].
std::vector<float> smallest_defects_um(const SceneCoverage& covered,
                                       const CoverageSettings& settings,
                                       const std::optional<PodReference>& pod);

/// a90 of the best design in the result of a run with [pod]. pixel_mm stays 0.
/// @param folder  of the run
/// @throws ConfigError when it holds no such result, or sizes that are no lengths across; IoError
PodReference read_pod(const std::filesystem::path& folder);

/// The object of result.json.
nlohmann::ordered_json coverage_json(const SceneCoverage& covered,
                                     const CoverageSettings& settings,
                                     const std::optional<PodReference>& pod);

/// A row for each viewpoint, chosen or not.
std::string views_csv(const SceneCoverage& covered);

}  // namespace glint
