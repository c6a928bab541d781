// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a page shows of a front, and how it stays small.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image.h"

namespace glint {

/// What a page with a front may take.
inline constexpr std::size_t kMaxPageBytes = 30'000'000;

/// Of a front that the database alone does not tell, what result.json keeps for its page: under
/// `front_expected` of expected values, under `front_likely` of values as they were seen of designs
/// that models expect to keep the limits.
inline constexpr std::array<const char*, 4> kOfExpected = {
    "noise", "outside", "history", "noise_history"};

/// Close-ups of the defects of a design, from its folder and its mean image.
using Closeups = std::function<nlohmann::ordered_json(const std::filesystem::path& folder,
                                                      const ImageF& aspect)>;

/// Adds to a front what the run has found with fresh seeds (add_rescored(), judge_front(); its
/// summary as `rescored`), and to each design what its folder holds: `aspect` or `thumbnail`
/// (base64 PNG), `drawing` (SVG), `closeups` and `notes` as in studies/report/report.h. A design
/// without a folder has none of these. Where models of the run had a say in its front, it is that
/// front.
/// @param result  the object of the run's result.json
/// @param front   of plan_front(), as the database tells it
/// @throws IoError
void add_front_to_page(const std::filesystem::path& run,
                       const nlohmann::ordered_json& result,
                       const Closeups& closeups,
                       nlohmann::ordered_json& front);

/// Takes frames out of the sequences of a page's designs, every second one at a time, until its
/// texts take at most so many bytes or single frames are left; then the small pictures and drawings
/// of the front's designs, those that add least to the hypervolume first. `methods` says so.
/// @param data  as in studies/report/report.h
void limit_sequences(nlohmann::ordered_json& data, std::size_t max_bytes);

}  // namespace glint
