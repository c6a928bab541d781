// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/inspect/inspected_part.h"

namespace glint {

/// A part in result.json, docs/inspect.md.
nlohmann::ordered_json part_json(const InspectedPart& part, const InspectionSettings& settings);

/// Of the sizes in the limits: "px" or "weight".
std::string unit_of(InspectionSettings::Measure measure);

/// A row for each defect that was found.
std::string defects_csv(std::span<const InspectedPart> parts);

}  // namespace glint
