// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of one view of a path-traced scene:
//
//   image.exr            linear radiance R, G, B or Y, W / (m^2 sr), mean of the frames; with
//   several
//                        light groups also each of them at power 1: "ring.3.R"
//   image.png image.tif  what the sensor shows, linear grey values in 8 and 16 bits; mean of frames
//   sequence/frame_000.png ...   where a tunnel makes several frames
//   standard_error.exr   of the radiance, mean of its channels (Y); not of a sum without noise
//   part_mask.png        255: the whole pixel is on the part
//   mask.png             255: defects cover at least half of the pixel
//   coverage.exr         background, sound, defect.<id>: shares of the pixel, together 1
//   geometry.exr         depth_mm, normal.x ..., position_mm.x ..., incidence_deg: means over the
//                        pixel's samples on the part, 0 beside it; triangle, defect: of the first
//                        of these samples, -1: none. Whole numbers up to 2^24 are exact.
//   defects.png          defect map in colours, side_by_side.png: picture and map
//   defects.json         each defect and how many pixels show it
//   scene.toml           the scene with this viewpoint alone
//
// Masks and geometry are written without light too, the same bytes.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image_io.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"

namespace glint {

/// One view as it was rendered. What it refers to must outlive it.
struct RenderedView {
  const SceneSettings& scene;  ///< with this viewpoint alone
  const BuiltDefects& part;
  const PathPicture& picture;  ///< without groups: rendered without light
  const Film& seen;            ///< what masks and geometry show: the samples of picture, or more
  const Mask& part_mask;       ///< pixels that lie on the part as a whole
  std::vector<std::string> groups = {};  ///< names

  bool has_light() const { return !picture.sums.groups.empty(); }
};

/// Mean of the frames' factors.
FrameFactors mean_factors(std::span<const FrameFactors> frames);

/// Standard error of the mean of the frames' radiance, mean of the channels: by the scatter of the
/// picture's batches (of which there are few: right on average, rough in each pixel), or without
/// batches a bound by the spread of single samples with the lights at equal powers.
/// @param picture  with noise
ImageF standard_error_of(const PathPicture& picture);

/// Mean standard error of the part's pixels, share of their mean radiance; 0 where all is dark.
double relative_error(const PathPicture& picture, const ImageF& standard_error);

/// How much of the picture shows a defect [px]: the shares of pixels together.
double area_px(const Film& sums, const DefectSums& defect);

/// Whether that is a pixel or more, up to rounding: ten tenths add up to 1 - 1e-16.
bool is_seen(const Film& sums, const DefectSums& defect);

/// An entry of defects.json: what a defect is and where, and how a view shows it.
/// @param slope_rad  one of defect_slopes_rad()
nlohmann::ordered_json defect_in_view_json(const Defect& defect,
                                           const HeightFeature& outline,
                                           double slope_rad,
                                           const nlohmann::ordered_json& view);

/// What write_view_files() made, for pages that show it.
struct ViewPictures {
  ImageRgb image;  ///< empty without light
  ImageRgb map;
  double relative_error = 0.0;  ///< NaN: a sum, which has no noise
};

/// Writes the files above. @param has_design  write_design() has put frames and defects.json there
/// @throws IoError
ViewPictures write_view_files(const RenderedView& view,
                              const std::filesystem::path& folder,
                              bool has_design);

}  // namespace glint
