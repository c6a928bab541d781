// SPDX-License-Identifier: GPL-3.0-or-later
//
// A simulated picture beside a real one: outlines, grey values, textures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "metrics/appearance/grey_match.h"
#include "metrics/appearance/surface_texture.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/ring_offsets.h"
#include "studies/compare/compared_picture.h"
#include "studies/compare/outlines.h"
#include "studies/compare/surface/part_edges.h"

namespace glint {

/// Of the picture's width: edges that lie farther apart are others.
inline constexpr double kMaxDistanceShare = 0.05;

/// Where the outlines are against each other.
struct PairGeometry {
  OutlinePair outlines;
  std::optional<double> iou;  ///< empty: no silhouette
  std::optional<double> dice;
  BoundaryDistance distance;        ///< of points 0 where no edges were located on both sides
  std::vector<EdgeOffset> offsets;  ///< from the simulated to the real edge
  std::vector<PartEdge> edges;      ///< the same by edge of the part
  UnlistedEdges unlisted;           ///< beside these
  RingOffsets rings;
};

/// How alike grey values are, in the part's pixels.
struct PairAppearance {
  ExposureMatch exposure;     ///< real = gain simulated + offset
  double residual_rms = 0.0;  ///< in shares of full scale, after the match
  double correlation = 0.0;
  double ssim = 0.0;
  double gmsd = 0.0;
  double histogram_distance = 0.0;  ///< after the match, in shares of full scale
  SurfaceTexture simulated;
  SurfaceTexture real;
  std::optional<TextureDistance> texture;  ///< empty: no window fits into the part
};

/// The same in a ninth of the part's extent: a light or a shadow that is elsewhere shows where.
struct RegionAppearance {
  std::string name;  ///< "top left", "top", ... "middle", ... "bottom right"
  std::size_t pixels = 0;
  double grey = 0.0;          ///< mean of the real picture
  double difference = 0.0;    ///< mean of the real minus the exposed simulated one
  double residual_rms = 0.0;  ///< of the same
  double correlation = 0.0;
  double ssim = 0.0;
  double gmsd = 0.0;
  double histogram_distance = 0.0;  ///< of greys up to full scale, to half a thousandth
};

/// A turn or mirror image of the real picture that fits the simulated one better than itself.
struct BetterTurn {
  std::string name;  ///< "mirrored from left to right", "turned by 180 degrees"
  double correlation = 0.0;
  double correlation_as_is = 0.0;  ///< the better of that and of the part moved a little
  bool is_inside = false;          ///< both are within the part, without the slope of its light
};

struct ComparedPair {
  ComparedPicture simulated;
  ComparedPicture real;
  PairGeometry geometry;
  PairAppearance appearance;
  ImageF exposed;                         ///< the simulated picture in the real one's exposure
  Mask region;                            ///< where grey values are compared; empty: everywhere
  ImageF similarity;                      ///< ssim_map()
  ImageF gradient_similarity;             ///< gradient_similarity_map()
  std::vector<RegionAppearance> regions;  ///< those with at least 100 pixels
  std::optional<BetterTurn> better_turn;
  std::vector<std::string> notes;
};

struct PairOptions {
  std::filesystem::path real_mask;  ///< empty: none
  OutlineChoice outline = OutlineChoice::kAuto;
  ExposureModel exposure = ExposureModel::kGain;
  /// Allows pictures of one grey value all over: they have neither edges nor textures.
  bool may_be_plain = false;
};

/// @throws ConfigError for pictures of different sizes, and as read_compared() and find_outlines()
ComparedPair compare_pair(const ComparePair& pair, const PairOptions& options);

/// @throws ConfigError naming a picture that was taken with the lens covered or overexposed: dark,
/// or nearly at full scale, with nothing in it but noise, and not like the other one
void check_shows_part(const ComparedPair& pair);

/// The texture of a picture over its mean, in a region shrunk by some pixels.
/// @param window_px  halved until windows fit
SurfaceTexture texture_in(const ImageF& picture, const Mask& region, int window_px = 256);

}  // namespace glint
