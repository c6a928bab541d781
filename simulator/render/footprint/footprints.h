// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixel footprints on a tunnel, over which footprint_frames.h integrates the frames of a scan.
//
// Each corner ray is intersected with the tunnel's wall once. A pixel whose four corners lie on the
// lit wall at every position of the scan is plain: its frames follow from one phase and two
// differences. Pixels on a boundary of the light (slot, rim, ends), with footprints wider than the
// stripes, or refined because the part is bent there, are summed from cells (stripe_integral.h).
// See docs/theory/footprints.md.
#pragma once

#include <array>
#include <memory>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"
#include "simulator/light/tunnel/scan_settings.h"
#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/footprint/distinct_stripes.h"
#include "simulator/render/footprint/footprint_kernels.h"
#include "simulator/render/footprint/lit_pixels.h"
#include "simulator/render/wall/occluded_pixels.h"
#include "simulator/render/wall/sparse_intersection.h"

namespace glint {

WallHits intersect_light(const RayCache& rays, const Tunnel& tunnel);

/// intersect_light() of the corners, by simulator/render/corner_rays/sparse_rays.h where these are
/// worth it.
WallHits intersect_corners(const CornerRays& rays, const Tunnel& tunnel, TileLimits& limits);

/// The same for rays [begin, begin + count); arrays of hits begin at 0.
void intersect_light(
    const RayCache& rays, const Tunnel& tunnel, std::int64_t begin, int count, WallHits& hits);

/// What of a picture depends on the wall and not on its stripes: equal for all tunnels of the same
/// shape, slot, length and orientation.
struct WallView {
  TileLimits limits;        ///< of hits in tiles; empty where corners are intersected one by one
  WallHits hits;            ///< of the corner rays
  OccludedPixels occluded;  ///< pixels of the part that the wall hides from the camera

  WallView(const CornerRays& rays, const Tunnel& tunnel, const Eigen::Vector3d& camera_in_world_mm);

  std::size_t bytes() const;
};

/// Stripes and boundaries of a tunnel at all positions of a scan.
struct ScanPositions {
  ScanPositions(const Tunnel& tunnel, const ScanSettings& scan);

  int frames() const { return static_cast<int>(shift_mm.size()); }

  /// How many different phases the frames have if together they take the stripes through whole
  /// periods, each as often as the others; 0 if they do not.
  int even_phases() const;

  /// A single position whose radiance is the mean over all of them: a square wave of as
  /// many times the frequency as there are different positions. Needs even_phases() and even light,
  /// and places that the tunnel's ends never pass.
  ScanPositions mean_position() const;

  /// Takes over the stripes of a tunnel with black dark ones and has these shine.
  /// @param dark  radiance of dark stripes, where bright ones have 1
  void shine(const ScanPositions& black, double dark_radiance) {
    dark = black.dark + dark_radiance * (1.0 - black.dark);
    bright = black.bright * (1.0 - dark_radiance);
  }

  /// The same tunnel with its stripes at other places.
  /// @param places  their shift_periods, each in [0, 1)
  ScanPositions with_stripes_at(const std::vector<double>& places) const;

  /// Under uneven light, which moves with the stripes, each frame has its own.
  DistinctStripes distinct_stripes() const;

  /// True when the tunnel's ends pass no place of [low, high] in the scene.
  bool is_inside_ends(double low_mm, double high_mm) const {
    return low_mm - shift_mm.back() > -half_length_mm &&
           high_mm - shift_mm.front() < half_length_mm;
  }

  double period_mm = 1.0;
  double offset_mm = 0.0;
  double duty = 0.5;
  double dark = 0.0;         ///< radiance of dark stripes; 0 where it depends on the place
  double bright = 1.0;       ///< what bright ones add to it
  double darkest = 0.0;      ///< the smallest radiance of dark stripes
  bool is_dark_even = true;  ///< the radiance of dark stripes does not depend on the place
  double half_slot_mm = 0.0;
  double half_length_mm = 0.0;
  footprint_kernels::Unevenness unevenness;  ///< at shift 0
  bool is_even = true;
  std::vector<double> shift_mm;       ///< of the tunnel, frame by frame
  std::vector<double> shift_periods;  ///< of the stripes, in [0, 1)
};

class Footprints {
 public:
  enum class State : unsigned char {
    kDark,   ///< no light at any position
    kPlain,  ///< all of it lit at every position
    kCells   ///< summed from cells
  };

  /// @param rays, tunnel  must outlive this object
  Footprints(const CornerRays& rays,
             const Tunnel& tunnel,
             const ScanSettings& scan,
             const Eigen::Vector3d& camera_in_world_mm);

  /// The same with the wall met before.
  /// @param view  of these rays and a tunnel that differs in its stripes at most
  Footprints(const CornerRays& rays,
             const Tunnel& tunnel,
             const ScanSettings& scan,
             std::shared_ptr<const WallView> view);

  const CornerRays& rays() const { return rays_; }

  const ScanPositions& positions() const { return positions_; }

  const Image<State>& state() const { return state_; }

  /// Wholly; empty: none.
  const Mask& occluded() const { return view_->occluded.whole; }

  /// Where the wall hides a part of a pixel; nullptr: it does not.
  const OccludedEdge* occluded_edge(std::int32_t pixel) const;

  const WallHits& hits() const { return view_->hits; }

  const Tunnel& tunnel() const { return tunnel_; }

  /// Radiance of dark stripes where each corner ray meets the wall; empty: that of positions().
  const std::vector<float>& dark() const { return dark_; }

  /// Of the four rays at the corners of a pixel, from the left and from the top.
  std::array<std::size_t, 4> corners_of(std::int32_t pixel) const;

  /// Share of the part's pixels that the wall hides from the camera; in part where it hides a part.
  double hidden_share() const;

 private:
  void classify();
  void classify_tiles();
  void find_dark();
  const unsigned char* occluded_row(int y) const;
  void classify_pixels(int top, int bottom, int left, int right);
  footprint_kernels::LitLimits lit_limits() const;

  const CornerRays& rays_;
  const Tunnel& tunnel_;
  ScanPositions positions_;
  std::shared_ptr<const WallView> view_;
  Image<State> state_;
  std::vector<float> dark_;
  std::vector<unsigned char> none_occluded_;  ///< in a row
};

}  // namespace glint
