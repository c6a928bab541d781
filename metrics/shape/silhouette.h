// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the part is, from its pictures alone, as the first seed does it (section 2.2.2): the mean
// of the sequence, a threshold, and a flood from outside, so that what no stripe lit inside the
// outline belongs to the part. Choices: docs/theory/inspection_masks.md.
#pragma once

#include <optional>
#include <string_view>

#include "core/image/image.h"

namespace glint {

/// Why there is no silhouette.
enum class NoSilhouette {
  kDark,         ///< the whole picture is black
  kSaturated,    ///< the whole picture is at full scale
  kNoContrast,   ///< nothing is brighter than the rest by more than noise
  kTooSmall,     ///< nothing of 16 pixels is above the threshold
  kFillsPicture  ///< nothing is outside: the background is not darker than the part
};

/// A sentence for the user: what is wrong and what to do.
std::string_view sentence(NoSilhouette reason);

/// Which connected pieces (8 neighbours) make up the part.
enum class PartPieces {
  kLargest,  ///< one: what else is bright is beside the part
  kAll       ///< all but crumbs: dark bands, like the camera slot's reflection, may cut the part
};

/// Pieces below this share of the largest one are crumbs: dust, hot pixels.
inline constexpr double kCrumb = 0.01;

struct Silhouette {
  std::optional<Mask> mask;           ///< filled
  int pieces = 0;                     ///< of the mask
  std::optional<NoSilhouette> fault;  ///< set when there is no mask
  double threshold = 0.0;             ///< Otsu's, share of full scale: best parts dark and bright
  double contrast = 0.0;              ///< mean of the bright pixels minus mean of the dark ones
  bool touches_border = false;        ///< the part leaves the picture: its moments are cut
};

/// @param aspect  mean of the sequence (aspect_of()), in shares of full scale
/// @throws ConfigError for an empty picture, NaN or infinity
Silhouette find_silhouette(const ImageF& aspect, PartPieces pieces = PartPieces::kLargest);

}  // namespace glint
