// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frames of a scan, integrated over pixel footprints in closed form. See
// docs/theory/footprints.md.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/render/footprint/distinct_stripes.h"
#include "simulator/render/footprint/footprint_cells.h"
#include "simulator/render/footprint/footprints.h"

namespace glint {

/// Renders frames of a scan on some pixels. Not to be shared between threads.
class FootprintFrames {
 public:
  /// @param footprints  must outlive this object
  /// @param where       must outlive this object
  /// @param cells       of these pixels or more, if known; all of them are rendered
  FootprintFrames(const Footprints& footprints,
                  const Spans& where,
                  std::shared_ptr<const PixelCells> cells = nullptr);

  /// Radiance of frames [first, first + frames.size()) at the given pixels; images must have the
  /// size of the picture, their other pixels are left alone.
  void render(int first, std::vector<ImageF>& frames) const;

  /// From now on render() makes the frames that others follow from once, in four bytes a pixel and
  /// such frame, and copies from them. Of an uneven light nothing is kept. The bits are the same.
  void keep_sources() { keeps_sources_ = true; }

  /// Mean radiance over a scan of whole periods: a square wave of as many times the
  /// frequency as there are different positions.
  /// @param near  refined pixels elsewhere may be taken from their four corners and their coverage
  /// @param done  called now and then with how many rows from the top are rendered, at last with
  /// all
  void render_mean(const Spans& near,
                   ImageF& mean,
                   const std::function<void(int rows)>& done = {}) const;

  /// Those of the rendered frames; nullptr before the first.
  const std::shared_ptr<const PixelCells>& cells() const { return cells_; }

 private:
  struct Tile;

  /// Frames that others follow from, at the pixels of all spans one after the other.
  struct Sources {
    std::vector<float> gain;
    std::vector<std::vector<float>> radiance;  ///< without cells; one for each source
  };

  const unsigned char* load(const RowSpan& span, int begin, Tile& tile) const;
  void finish(const unsigned char* state, std::size_t frame, const Tile& tile, float* out) const;
  void render_span(int first,
                   const RowSpan& span,
                   const DistinctStripes& stripes,
                   const std::vector<int>& sources,
                   std::vector<ImageF>& frames) const;
  void render_tile(const DistinctStripes& stripes,
                   Tile& tile,
                   std::size_t at,
                   Sources& sources) const;
  Sources render_sources() const;
  void copy_sources(int first, std::vector<ImageF>& frames) const;
  void set_cells(int first, std::vector<ImageF>& frames) const;

  const Footprints& footprints_;
  const Spans& where_;
  /// Summed when first needed, once for all frames: a mean does not need it.
  mutable std::shared_ptr<const PixelCells> cells_;
  bool keeps_sources_ = false;
  mutable Sources sources_;  ///< made when first needed; empty: not yet
};

}  // namespace glint
