// SPDX-License-Identifier: GPL-3.0-or-later
//
// Frames of a scan, or their mean, in pieces of 256 pixels of a row. Phases and trapezoids are
// computed once per piece and evaluated for every frame; a frame whose stripes equal those of an
// earlier one is copied, and one with bright and dark exchanged is a subtraction
// (distinct_stripes.h). Where few pixels are rendered, such earlier frames are made once for the
// whole scan and kept. The mean over whole periods needs no frames: it is one picture under a
// square wave of N times the frequency. docs/theory/footprints.md and clipped_mean.md. Cost: one
// trapezoid per pixel and rendered frame, one evaluation per pixel for a mean. Memory: about 10 kB
// besides the images and the pixels of footprint_cells.h.
#include "simulator/render/footprint/footprint_frames.h"

#include <algorithm>
#include <array>
#include <utility>

#include "simulator/render/footprint/footprint_kernels.h"
#include "simulator/render/footprint/stripe_shares.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Pixels that are worked on together.
constexpr int kTile = 256;

/// Rows of a mean that are finished before its consumer is called: they are still in a near cache.
constexpr int kRowsAtOnce = 12;

/// For each of some frames an earlier one of them whose stripes are its source; -1: none.
std::vector<int> find_sources(const DistinctStripes& stripes, int first, std::size_t count) {
  std::vector<int> rendered(stripes.shift_periods.size(), -1);
  std::vector<int> sources;
  for (std::size_t k = 0; k < count; ++k) {
    const auto [source, is_opposite] = stripes.frames[static_cast<std::size_t>(first) + k];
    sources.push_back(rendered[source]);
    if (rendered[source] < 0 && !is_opposite) {
      rendered[source] = static_cast<int>(k);
    }
  }
  return sources;
}

}  // namespace

FootprintFrames::FootprintFrames(const Footprints& footprints,
                                 const Spans& where,
                                 std::shared_ptr<const PixelCells> cells)
    : footprints_(footprints), where_(where), cells_(std::move(cells)) {}

/// Footprints of some pixels of a row.
struct FootprintFrames::Tile {
  using Values = std::array<float, kTile>;
  int count = 0;
  alignas(64) Values v, gx, gy, outer, inner, per_major, per_both, gain, x_mm, other_frame;
  alignas(64) Values dark;  ///< radiance of dark stripes, where it depends on the place

  kernels::Trapezoids shape() {
    return {.outer = outer.data(),
            .inner = inner.data(),
            .per_major = per_major.data(),
            .per_both = per_both.data()};
  }
};

/// @return the pixels' states
const unsigned char* FootprintFrames::load(const RowSpan& span, int begin, Tile& tile) const {
  const CornerRays& rays = footprints_.rays();
  const ScanPositions& p = footprints_.positions();
  const WallHits& hits = footprints_.hits();
  const auto corner_width = static_cast<std::size_t>(rays.width_px) + 1;
  const std::size_t top =
      static_cast<std::size_t>(span.y) * corner_width + static_cast<std::size_t>(begin);
  const auto rows = [&](const FloatArray& values) {
    return kernels::CornerRows{.top = values.data() + top,
                               .bottom = values.data() + top + corner_width};
  };
  tile.count = std::min(kTile, span.end - begin);
  const kernels::PhaseRow phases = {.v = tile.v.data(), .gx = tile.gx.data(), .gy = tile.gy.data()};
  if (!p.is_even) {
    kernels::phases_of_corners(rows(hits.x_mm), tile.count, 0.0F, 1.0F, phases);
    std::copy_n(tile.v.data(), tile.count, tile.x_mm.data());
  }
  kernels::phases_in_period(
      rows(hits.stripes_mm()), tile.count, p.offset_mm, 1.0 / p.period_mm, phases);
  const auto* state =
      reinterpret_cast<const unsigned char*>(footprints_.state().row(span.y) + begin);
  static_assert(static_cast<int>(Footprints::State::kPlain) == 1);
  const float* cosine = hits.cosine.empty() ? nullptr : hits.cosine.data() + top;
  if (!p.is_dark_even) {
    const float* dark = footprints_.dark().data() + top;
    kernels::means_of_corners(
        {.top = dark, .bottom = dark + corner_width}, tile.count, tile.dark.data());
  }
  if (rays.smooth_weight >= 0.0F) {
    kernels::even_gains(state, rays.smooth_weight, cosine, tile.count, tile.gain.data());
  } else {
    kernels::plain_gains(
        state, rays.corners.weight.data() + top, cosine, tile.count, tile.gain.data());
  }
  return state;
}

/// A frame that follows from another one gets the same bits whether that one is rendered or not.
/// @param sources  find_sources() of these frames
void FootprintFrames::render_span(int first,
                                  const RowSpan& span,
                                  const DistinctStripes& stripes,
                                  const std::vector<int>& sources,
                                  std::vector<ImageF>& frames) const {
  const ScanPositions& p = footprints_.positions();
  Tile tile;
  for (int begin = span.begin; begin < span.end; begin += tile.count) {
    const unsigned char* state = load(span, begin, tile);
    kernels::trapezoids(tile.gx.data(), tile.gy.data(), tile.count, tile.shape());
    const bool is_narrow = kernels::largest_lit(tile.outer.data(), tile.gain.data(), tile.count) <=
                           kernels::narrow_limit(static_cast<float>(p.duty));
    const auto box_frame = is_narrow ? kernels::narrow_box_frame : kernels::box_frame;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const std::size_t frame = static_cast<std::size_t>(first) + k;
      const auto [source, is_opposite] = stripes.frames[frame];
      float* out = frames[k].row(span.y) + begin;
      const float* of_source = nullptr;
      if (sources[k] >= 0) {
        of_source = frames[static_cast<std::size_t>(sources[k])].row(span.y) + begin;
      } else {
        float* to = is_opposite ? tile.other_frame.data() : out;
        box_frame(tile.v.data(),
                  tile.shape(),
                  tile.gain.data(),
                  tile.count,
                  {.shift = static_cast<float>(stripes.shift_periods[source]),
                   .duty = static_cast<float>(p.duty),
                   .dark = static_cast<float>(p.dark)},
                  to);
        of_source = to;
      }
      if (is_opposite) {
        kernels::opposite_frame(
            of_source, tile.gain.data(), tile.count, static_cast<float>(p.dark), out);
      } else if (of_source != out) {
        std::copy_n(of_source, tile.count, out);
      }
    }
    // After all frames: others may have followed from this one.
    for (std::size_t k = 0; k < frames.size(); ++k) {
      finish(state, static_cast<std::size_t>(first) + k, tile, frames[k].row(span.y) + begin);
    }
  }
}

/// What depends on the place: the light of dark stripes and an uneven one of the wall.
void FootprintFrames::finish(const unsigned char* state,
                             std::size_t frame,
                             const Tile& tile,
                             float* out) const {
  const ScanPositions& p = footprints_.positions();
  if (!p.is_dark_even) {
    kernels::shine_beside_cells(state, tile.dark.data(), tile.gain.data(), tile.count, out);
  }
  if (!p.is_even) {
    kernels::Unevenness uneven = p.unevenness;
    uneven.shift_mm = static_cast<float>(p.shift_mm[frame]);
    kernels::modulate(tile.x_mm.data(), tile.count, uneven, out);
  }
}

void FootprintFrames::render_mean(const Spans& near,
                                  ImageF& mean,
                                  const std::function<void(int)>& done) const {
  // The fast form errs where stripes are thin, and by less the more phases share the error.
  constexpr int kFastPhases = 8;
  constexpr double kFastDuty = 0.1;
  const ScanPositions p = footprints_.positions().mean_position();
  const int phases = footprints_.positions().even_phases();
  const bool is_fast = phases >= kFastPhases && std::min(p.duty, 1.0 - p.duty) >= kFastDuty;
  const PixelCells cells = mean_of_cells(footprints_, where_, near);
  for (std::size_t i = 0; i < cells.pixels.size(); ++i) {
    mean.values()[static_cast<std::size_t>(cells.pixels[i])] = cells.values[i];
  }
  Tile tile;
  tile.x_mm.fill(0.0F);
  int reported = 0;
  for (const RowSpan& span : where_) {
    if (done && span.y >= reported + kRowsAtOnce) {
      reported = span.y;
      done(reported);
    }
    for (int begin = span.begin; begin < span.end; begin += tile.count) {
      const unsigned char* state = load(span, begin, tile);
      float* shares = tile.x_mm.data();
      if (is_fast) {
        kernels::half_widths(
            tile.gx.data(), tile.gy.data(), tile.count, tile.outer.data(), tile.inner.data());
        kernels::any_shares_fast(tile.v.data(),
                                 tile.outer.data(),
                                 tile.inner.data(),
                                 tile.count,
                                 static_cast<float>(phases),
                                 static_cast<float>(p.duty),
                                 shares);
      } else if (p.duty > 0.0) {
        kernels::any_shares(
            tile.v.data(), tile.gx.data(), tile.gy.data(), tile.count, phases, p.duty, shares);
      }
      kernels::mix_beside_cells(state,
                                tile.gain.data(),
                                shares,
                                tile.count,
                                static_cast<float>(p.dark),
                                static_cast<float>(p.bright),
                                mean.row(span.y) + begin);
      if (!p.is_dark_even) {
        kernels::shine_beside_cells(
            state, tile.dark.data(), tile.gain.data(), tile.count, mean.row(span.y) + begin);
      }
    }
  }
  if (done) {
    done(mean.height());
  }
}

/// The frames of the sources' stripes at the pixels of a tile.
/// @param at  of its first pixel among those of all spans
void FootprintFrames::render_tile(const DistinctStripes& stripes,
                                  Tile& tile,
                                  std::size_t at,
                                  Sources& sources) const {
  const ScanPositions& p = footprints_.positions();
  kernels::trapezoids(tile.gx.data(), tile.gy.data(), tile.count, tile.shape());
  std::copy_n(tile.gain.data(), tile.count, sources.gain.data() + at);
  const bool is_narrow = kernels::largest_lit(tile.outer.data(), tile.gain.data(), tile.count) <=
                         kernels::narrow_limit(static_cast<float>(p.duty));
  const auto box_frame = is_narrow ? kernels::narrow_box_frame : kernels::box_frame;
  for (std::size_t k = 0; k < sources.radiance.size(); ++k) {
    box_frame(tile.v.data(),
              tile.shape(),
              tile.gain.data(),
              tile.count,
              {.shift = static_cast<float>(stripes.shift_periods[k]),
               .duty = static_cast<float>(p.duty),
               .dark = static_cast<float>(p.dark)},
              sources.radiance[k].data() + at);
  }
}

FootprintFrames::Sources FootprintFrames::render_sources() const {
  std::size_t pixels = 0;
  for (const RowSpan& span : where_) {
    pixels += static_cast<std::size_t>(span.size());
  }
  const DistinctStripes stripes = footprints_.positions().distinct_stripes();
  Sources sources = {.gain = std::vector<float>(pixels),
                     .radiance = std::vector<std::vector<float>>(stripes.shift_periods.size(),
                                                                 std::vector<float>(pixels))};
  Tile tile;
  std::size_t at = 0;
  for (const RowSpan& span : where_) {
    for (int begin = span.begin; begin < span.end; begin += tile.count) {
      load(span, begin, tile);
      render_tile(stripes, tile, at, sources);
      at += static_cast<std::size_t>(tile.count);
    }
  }
  return sources;
}

void FootprintFrames::copy_sources(int first, std::vector<ImageF>& frames) const {
  const DistinctStripes stripes = footprints_.positions().distinct_stripes();
  const auto dark = static_cast<float>(footprints_.positions().dark);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto [source, is_opposite] = stripes.frames[static_cast<std::size_t>(first) + k];
    const float* radiance = sources_.radiance[source].data();
    const float* gain = sources_.gain.data();
    for (const RowSpan& span : where_) {
      float* out = frames[k].row(span.y) + span.begin;
      if (is_opposite) {
        kernels::opposite_frame(radiance, gain, span.size(), dark, out);
      } else {
        std::copy_n(radiance, span.size(), out);
      }
      radiance += span.size();
      gain += span.size();
    }
  }
}

void FootprintFrames::set_cells(int first, std::vector<ImageF>& frames) const {
  const auto total = static_cast<std::size_t>(footprints_.positions().frames());
  for (std::size_t i = 0; i < cells_->pixels.size(); ++i) {
    const float* values = cells_->values.data() + i * total + first;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      frames[k].values()[static_cast<std::size_t>(cells_->pixels[i])] = values[k];
    }
  }
}

void FootprintFrames::render(int first, std::vector<ImageF>& frames) const {
  if (!cells_) {
    cells_ = std::make_shared<const PixelCells>(sum_cells(footprints_, where_));
  }
  const ScanPositions& p = footprints_.positions();
  if (keeps_sources_ && p.is_even && p.is_dark_even) {
    if (sources_.radiance.empty()) {
      sources_ = render_sources();
    }
    copy_sources(first, frames);
  } else {
    const DistinctStripes stripes = p.distinct_stripes();
    const std::vector<int> sources = find_sources(stripes, first, frames.size());
    for (const RowSpan& span : where_) {
      render_span(first, span, stripes, sources, frames);
    }
  }
  set_cells(first, frames);
}

}  // namespace glint
