// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tables of a study that inspects many simulated parts: [sorting] sorts them into classes, [pod]
// measures how surely a defect of some size is found.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/key_writer.h"
#include "core/config/keys.h"
#include "defects/definition/defect_settings.h"

namespace glint {

/// How an expert grades a part that lies before him: by the true defects, not by their pictures.
/// Sizes are diameters of holes (dents, pits, bumps) and lengths of scratches and gouges. Shallower
/// defects than noticed_mm do not count, stains neither.
struct ExpertRule {
  double noticed_mm = 0.0;          ///< >= 0; depth or height
  double perfect_hole_mm = 0.5;     ///< >= 0; the widest hole of a perfect part
  int perfect_holes = 3;            ///< >= 0; how many it may have
  double acceptable_hole_mm = 1.0;  ///< >= perfect_hole_mm; wider ones reject the part
  int acceptable_holes = 6;         ///< >= perfect_holes; more of them reject it
  double perfect_scratch_mm = 1.0;  ///< >= 0; a longer scratch rejects the part
};

void visit_keys(KeyVisitor& keys, ExpertRule& rule);

/// Parts come from several places of the factory that spoil them in their own ways.
struct PartSource {
  std::string name;
  double share = 1.0;               ///< > 0; of the parts, in proportion
  std::vector<std::string> groups;  ///< of [defects] that its parts have; may be empty
};

/// The [sorting] table.
struct SortingSettings {
  int parts = 200;              ///< >= 4, at the study's own lighting
  int flawless = 300;           ///< >= 1; scans that certify the false alarms
  int prototype_parts = 100;    ///< >= 4, for each prototype; the first of the same parts
  int prototype_flawless = 50;  ///< >= 1
  int imprinted_every = 0;      ///< >= 0; every so many-th part has its defects imprinted; 0: none
  ExpertRule expert = {};
  std::vector<PartSource> sources;  ///< empty: all parts have all groups
};

/// The [pod] table: exactly one size is given a range.
struct PodSettings {
  std::string group;            ///< of [defects]; the others are left out
  Interval height_mm = 0.0;     ///< > 0 when given
  Interval diameter_mm = 0.0;   ///< of round defects
  Interval length_mm = 0.0;     ///< of lines
  Interval width_mm = 0.0;      ///< of lines
  int levels = 10;              ///< >= 3; sizes, evenly spaced by ratio, both ends included
  int parts = 2;                ///< >= 1; for each level, with as many defects as the group counts
  int flawless = 300;           ///< >= 1; scans that certify the rate of false alarms
  int prototype_flawless = 50;  ///< >= 1
};

/// The size that a [pod] table runs through.
struct PodSize {
  std::string_view key;   ///< of the group: "height_um", "diameter_mm", "length_mm", "width_mm"
  std::string_view what;  ///< "depth", "diameter", "length", "width"
  std::string_view unit;  ///< "um", "mm"
  double unit_mm = 1.0;   ///< in mm
  Interval range_mm;
  Interval DefectGroup::*member = nullptr;
};

PodSize size_of(const PodSettings& settings);

/// The sizes in mm, ascending.
std::vector<double> level_sizes_mm(const PodSettings& settings);

/// Reads [sorting]; empty when the file has none. @param errors  grows by the problems found
std::optional<SortingSettings> read_sorting(const ConfigNode& root,
                                            const std::vector<NamedGroup>& defects,
                                            std::vector<Problem>& errors);
std::optional<PodSettings> read_pod(const ConfigNode& root,
                                    const std::vector<NamedGroup>& defects,
                                    std::vector<Problem>& errors);

/// The tables with every key present.
ConfigNode write_sorting(const SortingSettings& settings);
ConfigNode write_pod(const PodSettings& settings);

/// Rows of the key table.
std::vector<KeyRow> population_keys();

}  // namespace glint
