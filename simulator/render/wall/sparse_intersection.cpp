// SPDX-License-Identifier: GPL-3.0-or-later
//
// Intersects a picture of corner rays with the wall, tile by tile. Only every eighth ray of a row
// and of a column is intersected; between these nodes hits are the quintic through 6 x 6 of them.
// Two more rays of each tile check that against 1/100 of what a pixel sees of the wall (1/200
// across the tunnel, more away from the light's boundaries); tiles that fail, or whose rays were
// not smooth to begin with, are intersected ray by ray. Own method: docs/theory/footprints.md,
// "Between every eighth ray". Cost: three intersections and an interpolation for a smooth tile of
// 64 rays. Memory: 12 or 20 bytes per ray for the hits, besides the nodes.
#include "simulator/render/wall/sparse_intersection.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "simulator/render/corner_rays/node_plane.h"
#include "simulator/render/corner_rays/sparse_kernels.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {
namespace {

namespace kernels = sparse_kernels;
using kernels::kStep;

/// Of what a pixel sees of the wall, by which a tile's hits may be wrong: along the stripes' order,
/// and across the tunnel ...
constexpr float kLargestShareAlong = 0.01F;
constexpr float kLargestShareAcross = 0.005F;
/// ... and what floats cannot do better.
constexpr float kMinError_mm = 1e-3F;
/// Across the tunnel hits only decide about the light's boundaries: so many times as much where
/// none is near.
constexpr float kFarFromBoundaries = 5.0F;
/// Of the distance from the rim: by which side of it a hit lies, nothing else depends on it.
constexpr float kLargestShareOfMargin = 1e-3F;
/// Of the cosine, which has no footprint.
constexpr float kLargestCosineError = 1e-4F;
/// So many rays are met where they lie, fewer together with others.
constexpr int kLongStretch = 128;

/// Meets a picture of rays tile by tile.
class SparseIntersection {
 public:
  SparseIntersection(const SparseRays& sparse, const RayCache& corners, const Tunnel& tunnel)
      : sparse_(sparse),
        corners_(corners),
        tunnel_(tunnel),
        tiles_(sparse.columns),
        last_width_(kernels::places_of(sparse.columns - 1, corners.width_px)) {
    hits_.resize(corners.weight.size(), tunnel.settings());
    results_ = hits_.arrays();
    intersect(sparse.nodes, nodes_);
    for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
      intersect(sparse.checks[k], checks_[k]);
      at_checks_[k] = checks_[k].arrays();
    }
    for (const FloatArray* values : nodes_.arrays()) {
      planes_.emplace_back(sparse).set(values->data());
    }
    blended_.resize(static_cast<std::size_t>(planes_.front().width_around()));
    allowed_.resize(static_cast<std::size_t>(tiles_));
    errors_.resize(allowed_.size());
    is_sparse_.resize(allowed_.size());
  }

  WallHits intersect(TileLimits& limits) {
    begin(limits);
    for (int row = 0; row < sparse_.rows; ++row) {
      find_limits(row, limits);
      check(row, limits);
      set_kinds(row, limits);
      spread(row);
      sort_others(row);
    }
    intersect(sparse_.rest, met_);
    store(sparse_.rest_stretches);
    intersect_others();
    clear_dark();
    return std::move(hits_);
  }

 private:
  using Stretches = std::vector<RayStretch>;

  /// Of a row of tiles.
  int height_of(int row) const { return kernels::places_of(row, corners_.height_px); }

  void intersect(const PickedRays& rays, WallHits& hits) const {
    hits.resize(static_cast<std::size_t>(rays.count()), tunnel_.settings());
    intersect_rays(rays.block(), tunnel_, 0, hits);
  }

  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(corners_.width_px) +
           static_cast<std::size_t>(x);
  }

  const TileKind* kinds(int row) const {
    return sparse_.kind.data() + static_cast<std::ptrdiff_t>(row) * tiles_;
  }

  void begin(TileLimits& limits) const;
  void check(int row, const TileLimits& limits);
  void find_errors(std::size_t array, int row);
  void allow_errors(std::size_t array, int row, const TileLimits& limits);
  void set_kinds(int row, TileLimits& limits) const;
  void find_limits(int row, TileLimits& limits);
  void spread(int row);
  void sort_others(int row);
  void clear_dark();
  void intersect_others();
  void store(const Stretches& stretches);

  const SparseRays& sparse_;
  const RayCache& corners_;
  const Tunnel& tunnel_;
  int tiles_;       ///< in a row
  int last_width_;  ///< rays in a row of the last one
  WallHits hits_, nodes_;
  std::vector<FloatArray*> results_;  ///< the hits' arrays
  std::array<WallHits, SparseRays::kChecks> checks_;
  std::array<std::vector<FloatArray*>, SparseRays::kChecks> at_checks_;
  std::vector<NodePlane> planes_;  ///< of the hits' arrays
  std::vector<float> blended_, allowed_, errors_;
  std::vector<unsigned char> is_sparse_;
  Stretches others_;  ///< of smooth tiles that fail the checks, the short ones
  WallHits met_;      ///< some of the rays intersected one by one
};

/// Where the quintics are near enough to the hits at the places that are checked.
void SparseIntersection::check(int row, const TileLimits& limits) {
  for (std::size_t i = 0; i < is_sparse_.size(); ++i) {
    is_sparse_[i] = kinds(row)[i] == TileKind::kSmooth ? 1 : 0;
  }
  for (std::size_t array = 0; array < planes_.size(); ++array) {
    find_errors(array, row);
    allow_errors(array, row, limits);
    kernels::keep_allowed(errors_.data(), allowed_.data(), tiles_, is_sparse_.data());
  }
}

void SparseIntersection::find_errors(std::size_t array, int row) {
  std::ranges::fill(errors_, 0.0F);
  for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
    const float* values = at_checks_[k][array]->data() + static_cast<std::ptrdiff_t>(row) * tiles_;
    const auto compare = [&](int first, int count, int place) {
      kernels::find_errors(blended_.data() + first,
                           values + first,
                           kernels::kNodeWeights[static_cast<std::size_t>(place)],
                           count,
                           errors_.data() + first);
    };
    const SparseRays::Place at = sparse_.check_place(k, 0, row, corners_);
    kernels::blend_rows(planes_[array].around(row),
                        kernels::kNodeWeights[static_cast<std::size_t>(at.row)],
                        planes_[array].width_around(),
                        blended_.data());
    compare(0, tiles_ - 1, at.column);
    compare(tiles_ - 1, 1, sparse_.check_place(k, tiles_ - 1, row, corners_).column);
  }
}

/// Along the stripes a share of the footprint there; across the tunnel a share of that, and more
/// where no boundary of the light is near.
void SparseIntersection::allow_errors(std::size_t array, int row, const TileLimits& limits) {
  std::ranges::fill(allowed_, array == WallHits::kCosine ? kLargestCosineError : kMinError_mm);
  if (array == WallHits::kCosine) {
    return;
  }
  const bool is_across = array == WallHits::kY || array == WallHits::kMargin;
  const NodePlane& seen = planes_[is_across ? WallHits::kY : array];
  kernels::allow_errors(seen.row(row) + kNodeMargin,
                        seen.row(row + 1) + kNodeMargin,
                        tiles_,
                        (is_across ? kLargestShareAcross : kLargestShareAlong) / kStep,
                        allowed_.data());
  if (!is_across) {
    return;
  }
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * tiles_;
  kernels::allow_more({.y_low = limits.y_low_mm.data() + first,
                       .y_high = limits.y_high_mm.data() + first,
                       .margin_low = limits.margin_low_mm.data() + first,
                       .margin_high = limits.margin_high_mm.data() + first},
                      tiles_,
                      static_cast<float>(tunnel_.settings().half_slot_mm()),
                      kFarFromBoundaries,
                      allowed_.data());
  if (array == WallHits::kMargin) {
    kernels::allow_share(limits.margin_low_mm.data() + first,
                         limits.margin_high_mm.data() + first,
                         tiles_,
                         kLargestShareOfMargin,
                         allowed_.data());
  }
}

/// In the order of the hits' arrays.
std::array<std::pair<std::vector<float>*, std::vector<float>*>, 4> limit_arrays(
    TileLimits& limits) {
  return {{{&limits.x_low_mm, &limits.x_high_mm},
           {&limits.y_low_mm, &limits.y_high_mm},
           {&limits.margin_low_mm, &limits.margin_high_mm},
           {&limits.stripes_low_mm, &limits.stripes_high_mm}}};
}

void SparseIntersection::begin(TileLimits& limits) const {
  limits.columns = tiles_;
  limits.rows = sparse_.rows;
  limits.kind.resize(sparse_.kind.size());
  const auto arrays = limit_arrays(limits);
  for (std::size_t i = 0; i < std::min(arrays.size(), planes_.size()); ++i) {
    arrays[i].first->resize(sparse_.kind.size());
    arrays[i].second->resize(sparse_.kind.size());
  }
}

void SparseIntersection::find_limits(int row, TileLimits& limits) {
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * tiles_;
  const auto arrays = limit_arrays(limits);
  for (std::size_t i = 0; i < std::min(arrays.size(), planes_.size()); ++i) {
    kernels::find_limits(planes_[i].around(row),
                         tiles_,
                         arrays[i].first->data() + first,
                         arrays[i].second->data() + first,
                         blended_.data());
  }
}

void SparseIntersection::set_kinds(int row, TileLimits& limits) const {
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * tiles_;
  for (std::size_t i = 0; i < is_sparse_.size(); ++i) {
    limits.kind[static_cast<std::size_t>(first) + i] = kinds(row)[i] == TileKind::kNone
                                                           ? TileLimits::kNoRays
                                                       : is_sparse_[i] != 0 ? TileLimits::kKnown
                                                                            : TileLimits::kUnknown;
  }
}

/// What the last tile writes behind the end of a row of rays is overwritten by the next row.
void SparseIntersection::spread(int row) {
  for (std::size_t i = 0; i < results_.size(); ++i) {
    for (int y = 0; y < height_of(row); ++y) {
      kernels::blend_rows(planes_[i].around(row),
                          kernels::kNodeWeights[static_cast<std::size_t>(y)],
                          planes_[i].width_around(),
                          blended_.data());
      float* to = results_[i]->data() + place(0, row * kStep + y);
      if (row * kStep + y + 1 < corners_.height_px) {
        kernels::spread(blended_.data(), tiles_, to);
        continue;
      }
      const int before = tiles_ - 1;
      std::array<float, kStep> last;
      kernels::spread(blended_.data(), before, to);
      kernels::spread(blended_.data() + before, 1, last.data());
      std::copy_n(last.data(), last_width_, to + before * kStep);
    }
  }
}

void SparseIntersection::sort_others(int row) {
  const auto fails = [&](int column) {
    return kinds(row)[column] == TileKind::kSmooth &&
           is_sparse_[static_cast<std::size_t>(column)] == 0;
  };
  for (int column = 0, end = 0; column < tiles_; column = end) {
    end = column + 1;
    if (!fails(column)) {
      continue;
    }
    while (end < tiles_ && fails(end)) {
      ++end;
    }
    const int count = std::min(end * kStep, corners_.width_px) - column * kStep;
    for (int y = row * kStep; y < row * kStep + height_of(row); ++y) {
      const std::size_t first = place(column * kStep, y);
      if (count >= kLongStretch) {
        intersect_rays(
            corners_.block(static_cast<std::int64_t>(first), count), tunnel_, first, hits_);
      } else {
        others_.push_back({.first = static_cast<std::int32_t>(first), .count = count});
      }
    }
  }
}

void SparseIntersection::clear_dark() {
  for (std::size_t i = 0; i < results_.size(); ++i) {
    const float none =
        i == WallHits::kMargin ? kNoHitMargin_mm : (i == WallHits::kCosine ? 1.0F : 0.0F);
    for (const auto& [first, count] : sparse_.dark_stretches) {
      std::fill_n(results_[i]->data() + first, count, none);
    }
  }
}

/// Rays of a few stretches at a time.
void SparseIntersection::intersect_others() {
  constexpr int kTogether = 4096;
  PickedRays rays;
  Stretches batch;
  int count = 0;
  for (std::size_t i = 0; i < others_.size(); ++i) {
    batch.push_back(others_[i]);
    count += others_[i].count;
    if (count >= kTogether || i + 1 == others_.size()) {
      rays.take(corners_, batch);
      intersect(rays, met_);
      store(batch);
      batch.clear();
      count = 0;
    }
  }
}

void SparseIntersection::store(const Stretches& stretches) {
  const std::vector<FloatArray*> found = met_.arrays();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const float* from = found[i]->data();
    for (const auto& [first, count] : stretches) {
      copy_stretch(from, static_cast<std::size_t>(count), results_[i]->data() + first);
      from += count;
    }
  }
}

}  // namespace

WallHits intersect_sparse(const SparseRays& sparse,
                          const RayCache& corners,
                          const Tunnel& tunnel,
                          TileLimits& limits) {
  return SparseIntersection(sparse, corners, tunnel).intersect(limits);
}

}  // namespace glint
