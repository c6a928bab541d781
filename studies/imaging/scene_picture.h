// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a candidate is seen as: the mean of its frames, the frames themselves, and what its defects
// hide of the flawless part. Whoever scores a picture does not know how light got into it: for
// scores picture_of() alone asks which transport a scene needs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/wall/slot_margin.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// How a mean came about by closed forms: what its derivatives need.
struct ClosedForm {
  std::unique_ptr<const Footprints> footprints;
  std::unique_ptr<const Sensor> sensor;
  ScanPlan plan;
  std::shared_ptr<const PixelCells> cells;  ///< of the frames; empty: none were rendered
};

/// The mean of all frames.
struct MeanImage {
  ImageF aspect;     ///< closed forms: right in the region and around the defects
  ImageF deviation;  ///< of its pixels by noise; empty: none, or not known
  Image<std::uint16_t> clipped_frames;  ///< in which each pixel is at full scale
  int frames = 0;
  ScanForm form;                       ///< how it came about; frames for the plain way
  std::optional<double> hidden_share;  ///< of the part's pixels, by the tunnel's wall
  std::unique_ptr<ClosedForm> closed;  ///< where it was asked for, and there is one
};

struct MeanRequest {
  FrameConsumer watch = {};        ///< sees each frame's grey values in order; may be empty
  bool has_whole_frames = false;   ///< else they are right around the defects alone
  bool keeps_closed_form = false;  ///< for derivatives
  std::optional<std::size_t> without = {};  ///< a batch of samples that is left out
};

/// For each defect the values of its own pixels.
using DefectValues = std::vector<std::vector<float>>;

/// Safe to use from several threads.
class ScenePicture {
 public:
  ScenePicture(SceneSettings scene, std::shared_ptr<const TracedScene> traced)
      : scene_(std::move(scene)), traced_(std::move(traced)) {}

  virtual ~ScenePicture() = default;
  ScenePicture(const ScenePicture&) = delete;
  ScenePicture& operator=(const ScenePicture&) = delete;

  /// From the viewpoint that is scored.
  const SceneSettings& scene() const { return scene_; }

  /// Part, masks, region of interest and defects.
  const std::shared_ptr<const TracedScene>& traced() const { return traced_; }

  /// Whether its frames show stripes.
  bool has_stripes() const { return scene_.has_tunnel; }

  /// How far the view is from the edge of the tunnel's slot; empty without a tunnel.
  std::optional<SlotMargin> find_slot_margin() const;

  /// Whether frames come out whole when somebody wants to see them, or their stripes are scored.
  virtual bool has_whole_frames(bool is_consumed, bool wants_fringes) const = 0;

  virtual MeanImage mean(const MeanRequest& request) const = 0;

  /// What the defects' pixels would show in a frame without the defects and without noise.
  /// @param without  a batch of samples that is left out
  virtual DefectValues flawless(int frame, std::optional<std::size_t> without) const = 0;

  /// Independent sets of samples behind the picture, each of which can be left out; 0 where
  /// rendering has no noise.
  virtual std::size_t batches() const { return 0; }

  /// Standard deviation that the rendering's own noise gives to the change of a defect's pixel.
  virtual double change_noise() const { return 0.0; }

  /// What became of the camera's rays; nullptr where they are not followed to their lights.
  virtual const RayCounts* ray_counts() const { return nullptr; }

  /// The scene whose scans with other noise are like this one.
  virtual SceneSettings repeated(bool /*has_whole_frames*/) const { return scene_; }

 private:
  SceneSettings scene_;
  std::shared_ptr<const TracedScene> traced_;
};

struct PictureRequest {
  bool has_flawless = true;      ///< flawless() will be asked
  bool has_derivatives = false;  ///< derivatives will be
};

/// The scene with the exposure that brings the 99th percentile of the region of interest, over all
/// frames and without noise, to scene.expose_to of full scale; the scene itself where that is 0.
/// @throws ConfigError "sensor.expose_to" when no light reaches the region; as picture_of()
SceneSettings with_equal_exposure(SceneStore& store, SceneSettings scene);

/// Exposed as with_equal_exposure().
/// @throws ConfigError beginning with the key at fault, IoError
std::unique_ptr<ScenePicture> picture_of(SceneStore& store,
                                         const SceneSettings& scene,
                                         const PictureRequest& request = {});

}  // namespace glint
