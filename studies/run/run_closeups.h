// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image.h"

namespace glint {

/// Close-ups of a design's defects for its card, the hardest to see where there are many: each from
/// the picture that decides about the objective, its grey values stretched, with what its scale bar
/// needs (studies/report/report.h, "closeups").
/// @param folder     of the design
/// @param aspect     its mean image
/// @param objective  name of a score; of single frames: the frame in which the defect has it
/// @throws IoError
nlohmann::ordered_json closeups_of(const std::filesystem::path& folder,
                                   const ImageF& aspect,
                                   const std::string& objective);

/// How narrow a design's defects are in the picture: [ { label, width_px } ]; runs of before that
/// was told have none.
nlohmann::ordered_json defect_widths(const std::filesystem::path& folder);

}  // namespace glint
