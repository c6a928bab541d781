// SPDX-License-Identifier: GPL-3.0-or-later
//
// One view of a scene by path tracing. Light groups are rendered at power 1 of every light; powers
// are factors that are applied afterwards, so that a search over powers renders once.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/spans.h"
#include "core/thread_pool.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/render_paths.h"
#include "studies/definition/scene.h"
#include "studies/imaging/built_part.h"
#include "studies/imaging/direct/direct_film.h"
#include "studies/imaging/path_lights.h"

namespace glint {

/// Everything that the path tracer looks at for one view, ready.
class PathView {
 public:
  /// @param part       with the scene's defects (or without, for the flawless picture)
  /// @param viewpoint  one of viewpoints_of(scene)
  /// @throws ConfigError beginning with the key at fault, IoError
  PathView(const SceneSettings& scene,
           std::shared_ptr<const BuiltDefects> part,
           const Viewpoint& viewpoint,
           bool has_defects = true);
  ~PathView();
  PathView(const PathView&) = delete;
  PathView& operator=(const PathView&) = delete;

  /// Valid as long as this object. Factors of its groups are 1: powers are in frames().
  const PhysicalScene& physical() const;

  /// The same where a drawing of its area lights shows how the scene is lit; nullptr under a
  /// tunnel, whose cross-section does.
  const PhysicalScene* area_lights() const;

  /// As frame_factors() of the scene.
  const std::vector<FrameFactors>& frames() const;

  /// Flux of each group at power 1, as frame_factors() wants it.
  const std::vector<Colour>& unit_power_w() const;

  /// How its light is summed; none: paths are followed.
  const std::optional<DirectSettings>& direct() const;

  /// Names of the groups: "ring", "bar.3", "tunnel.12".
  std::vector<std::string> group_names() const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

/// An independent share of a picture's samples.
struct PathBatch {
  Image<std::int32_t> samples;    ///< of each pixel
  std::vector<GroupSums> groups;  ///< sums over them, as Film::groups
};

/// The view of a path-traced scene from the viewpoint that is scored; nullptr for any other scene.
/// @param part, @throws  as PathView()
std::unique_ptr<const PathView> path_view_of(const SceneSettings& scene,
                                             std::shared_ptr<const BuiltDefects> part);

/// What was rendered of a view.
struct PathPicture {
  Film sums;                         ///< of all batches together; masks, depth, normals
  std::vector<PathBatch> batches;    ///< two or more, or none; they add up to sums
  std::vector<FrameFactors> frames;  ///< PathView::frames() of the scene as it was rendered
  std::vector<Colour> unit_power_w;  ///< PathView::unit_power_w()
  bool has_noise = true;             ///< false: light was summed, its standard errors are 0

  std::int64_t bytes() const;
};

/// Renders a view: paths.samples a pixel, divided into paths.batches independent pictures (samples
/// are rounded up to a multiple of them). The first batch is what render_paths() makes with those
/// settings. A view whose light is summed has one film and no batches (direct_film()). The same
/// bytes for any number of threads.
/// @param paths    channels must be those of the sensor: path_settings()
/// @param windows  only these places; empty: all
/// @param preview  sees the sums of all batches so far
PathPicture render_view(const PathView& view,
                        const PathSettings& paths,
                        ThreadPool& pool,
                        std::span<const PixelWindow> windows = {},
                        const PathPreview& preview = {});

/// The settings of [render.paths] with as many channels as the sensor has wavelengths.
PathSettings path_settings(const SceneSettings& scene);

/// Radiance of a frame, mean of its channels; 0 where nothing was rendered.
/// @param without  a batch that is left out (jackknife); empty: all samples
/// @param where    pixels that are wanted, all others are 0; empty: all
ImageF frame_radiance(const PathPicture& picture,
                      const FrameFactors& factors,
                      std::optional<std::size_t> without = {},
                      const Spans& where = {});

/// The same for one pixel, an index into Image::values().
double pixel_radiance(const PathPicture& picture,
                      const FrameFactors& factors,
                      std::size_t pixel,
                      std::optional<std::size_t> without = {});

/// Radiance of one channel of a frame.
ImageF channel_radiance(const Film& sums, const FrameFactors& factors, int channel);

/// Of everything that PathPicture depends on but the powers of lights: equal keys, equal pictures.
/// Of a sum of direct light, whose accuracy is one of grey values, their power of 2 counts.
/// Segment powers of a light without separate_segments count, as they share one group.
std::string picture_key(const SceneSettings& wanted, const Viewpoint& viewpoint);

}  // namespace glint
