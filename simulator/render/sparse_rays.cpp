// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/sparse_rays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/error.h"
#include "simulator/render/ray_cache.h"
#include "simulator/render/sparse_kernels.h"

namespace glint {
namespace {

namespace kernels = sparse_kernels;
using kernels::kStep;

/// Origins of smooth tiles lie this near to their quintic.
constexpr float kLargestOriginError_mm = 2e-4F;

/// Of what a pixel sees of the wall, by which a tile's hits may be wrong ...
constexpr float kLargestShare = 0.005F;
/// ... and what floats cannot do better.
constexpr float kLeastError_mm = 1e-3F;
/// Across the tunnel hits only decide about the light's boundaries: so many times as much where
/// none is near.
constexpr float kFarFromBoundaries = 5.0F;
/// Of the cosine, which has no footprint.
constexpr float kLargestCosineError = 1e-4F;

struct CheckPlace {
  int column, row;
};

/// Where a quintic is wrong most, and two places on either side.
constexpr std::array<CheckPlace, SparseRays::kChecks> kCheckPlaces = {{{4, 4}, {6, 2}, {1, 6}}};

/// Nodes that a plane has more on each side.
constexpr int kMargin = kernels::kBefore;

/// Numbers at nodes and around them, as quintics go on there.
class NodePlane {
 public:
  explicit NodePlane(const SparseRays& sparse)
      : sparse_(sparse),
        width_(sparse.columns + 2 * kMargin),
        values_(static_cast<std::size_t>(width_) *
                static_cast<std::size_t>(sparse.rows + 2 * kMargin)) {}

  /// @param nodes  row by row
  void set(const float* nodes) {
    for (int row = 0; row < sparse_.rows; ++row) {
      std::copy_n(nodes + static_cast<std::ptrdiff_t>(row) * sparse_.columns,
                  sparse_.columns,
                  values_.data() + static_cast<std::ptrdiff_t>(row + kMargin) * width_ + kMargin);
    }
    for (const auto& [to, step, is_cubic] : sparse_.beyond) {
      float* at = values_.data() + to;
      const auto next = [&, by = step](int k) { return at[k * by]; };
      at[0] = is_cubic ? 4.0F * (next(1) + next(3)) - 6.0F * next(2) - next(4)
                       : 6.0F * (next(1) + next(5)) - 15.0F * (next(2) + next(4)) +
                             20.0F * next(3) - next(6);
    }
  }

  /// The first of `columns + 2 kMargin`. @param index  from -kMargin to rows + kMargin - 1
  const float* row(int index) const {
    return values_.data() + static_cast<std::ptrdiff_t>(index + kMargin) * width_;
  }

  /// The rows around tiles.
  kernels::NodeRows around(int tile_row) const {
    kernels::NodeRows rows;
    for (int i = 0; i < kernels::kNodes; ++i) {
      rows[static_cast<std::size_t>(i)] = row(tile_row + i - kernels::kBefore);
    }
    return rows;
  }

  int width() const { return width_; }

 private:
  const SparseRays& sparse_;
  int width_;
  std::vector<float> values_;
};

/// Which nodes of a plane are known, those of lit rays at first.
class KnownNodes {
 public:
  KnownNodes(const SparseRays& sparse, const std::vector<unsigned char>& is_lit)
      : width_(sparse.columns + 2 * kMargin),
        height_(sparse.rows + 2 * kMargin),
        is_known_(static_cast<std::size_t>(width_ * height_)) {
    for (int row = 0; row < sparse.rows; ++row) {
      std::copy_n(is_lit.data() + static_cast<std::ptrdiff_t>(row) * sparse.columns,
                  sparse.columns,
                  is_known_.data() + static_cast<std::ptrdiff_t>(row + kMargin) * width_ + kMargin);
    }
  }

  /// Those beside known ones, which then are known, too.
  std::vector<SparseRays::Beyond> extend() {
    std::vector<SparseRays::Beyond> beyond;
    for (int row = 0; row < height_; ++row) {
      for (int column = 0; column < width_; ++column) {
        if (!is_known(column, row)) {
          add_beyond(column, row, beyond);
        }
      }
    }
    for (const SparseRays::Beyond& node : beyond) {
      is_known_[static_cast<std::size_t>(node.to)] = 1;
    }
    return beyond;
  }

 private:
  bool is_known(int column, int row) const {
    return column >= 0 && column < width_ && row >= 0 && row < height_ &&
           is_known_[static_cast<std::size_t>(row * width_ + column)] != 0;
  }

  int run_length(int column, int row, int dx, int dy) const {
    int length = 0;
    while (length < kernels::kNodes &&
           is_known(column + (length + 1) * dx, row + (length + 1) * dy)) {
      ++length;
    }
    return length;
  }

  void add_beyond(int column, int row, std::vector<SparseRays::Beyond>& beyond) const {
    constexpr int kCubic = 4;
    for (const int least : {kernels::kNodes, kCubic}) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (run_length(column, row, dx, dy) >= least) {
          beyond.push_back(
              {.to = row * width_ + column, .step = dy * width_ + dx, .is_cubic = least == kCubic});
          return;
        }
      }
    }
  }

  int width_, height_;
  std::vector<unsigned char> is_known_;
};

/// As far as the quintics of tiles at an outline reach.
std::vector<SparseRays::Beyond> nodes_beyond(const SparseRays& sparse,
                                             const std::vector<unsigned char>& is_lit) {
  constexpr int kRounds = 5;  // three steps, and a corner's diagonal
  KnownNodes known(sparse, is_lit);
  std::vector<SparseRays::Beyond> all;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<SparseRays::Beyond> beyond = known.extend();
    all.insert(all.end(), beyond.begin(), beyond.end());
  }
  return all;
}

using Components = std::array<const std::vector<float>*, 6>;

template <class Rays>
Components components_of(const Rays& rays) {
  return {&rays.origin_x,
          &rays.origin_y,
          &rays.origin_z,
          &rays.direction_x,
          &rays.direction_y,
          &rays.direction_z};
}

/// For each tile the largest error of its quintics by what is allowed.
std::vector<float> ray_errors(const SparseRays& sparse,
                              const RayCache& corners,
                              float max_direction_error_rad) {
  const int tiles = sparse.columns - 1;
  const auto width = static_cast<std::size_t>(corners.width_px);
  std::vector<float> errors(static_cast<std::size_t>(tiles) *
                            static_cast<std::size_t>(sparse.rows - 1));
  NodePlane plane(sparse);
  std::vector<float> blended(static_cast<std::size_t>(plane.width()));
  std::vector<float> row(static_cast<std::size_t>(tiles * kStep));
  std::vector<float> of_row(static_cast<std::size_t>(tiles));
  const Components nodes = components_of(sparse.nodes);
  const Components all = components_of(corners);
  for (std::size_t component = 0; component < all.size(); ++component) {
    const float allowed = component < 3 ? kLargestOriginError_mm : max_direction_error_rad;
    plane.set(nodes[component]->data());
    for (int y = 0; y < (sparse.rows - 1) * kStep; ++y) {
      kernels::blend_rows(
          plane.around(y / kStep), kernels::node_weights(y % kStep), plane.width(), blended.data());
      kernels::spread(blended.data(), tiles, row.data());
      std::ranges::fill(of_row, 0.0F);
      kernels::find_errors_of_all(row.data(),
                                  all[component]->data() + static_cast<std::size_t>(y) * width,
                                  tiles,
                                  of_row.data());
      float* to = errors.data() + static_cast<std::ptrdiff_t>(y / kStep) * tiles;
      for (std::size_t i = 0; i < of_row.size(); ++i) {
        to[i] = std::max(to[i], of_row[i] / allowed);
      }
    }
  }
  return errors;
}

/// Rays of a tile that have met the part and are not given up.
int lit_rays(const RayCache& corners, int column, int row) {
  int lit = 0;
  for (int y = row * kStep; y < (row + 1) * kStep; ++y) {
    const float* weight =
        corners.weight.data() + static_cast<std::ptrdiff_t>(y) * corners.width_px + column * kStep;
    lit +=
        static_cast<int>(std::count_if(weight, weight + kStep, [](float w) { return w > 0.0F; }));
  }
  return lit;
}

}  // namespace

RayBlock PickedRays::block() const {
  return {.origin_x = origin_x.data(),
          .origin_y = origin_y.data(),
          .origin_z = origin_z.data(),
          .direction_x = direction_x.data(),
          .direction_y = direction_y.data(),
          .direction_z = direction_z.data(),
          .count = count()};
}

void PickedRays::add(const RayCache& rays, std::size_t index) {
  origin_x.push_back(rays.origin_x[index]);
  origin_y.push_back(rays.origin_y[index]);
  origin_z.push_back(rays.origin_z[index]);
  direction_x.push_back(rays.direction_x[index]);
  direction_y.push_back(rays.direction_y[index]);
  direction_z.push_back(rays.direction_z[index]);
}

double SparseRays::sparse_share() const {
  const auto bent = std::ranges::count(kind, TileKind::kBent);
  return kind.empty() ? 0.0 : 1.0 - static_cast<double>(bent) / static_cast<double>(kind.size());
}

SparseRays sparse_rays(const RayCache& corners, double max_direction_error_rad) {
  constexpr int kLeastNodes = kernels::kNodes;
  GLINT_CHECK(corners.samples == 1, "a picture of rays");
  SparseRays sparse;
  const int columns = (corners.width_px - 1) / kStep + 1;
  const int rows = (corners.height_px - 1) / kStep + 1;
  if (columns < kLeastNodes || rows < kLeastNodes) {
    return sparse;
  }
  sparse.columns = columns;
  sparse.rows = rows;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(corners.width_px) +
           static_cast<std::size_t>(x);
  };
  std::vector<unsigned char> is_lit;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t at = index(column * kStep, row * kStep);
      sparse.nodes.add(corners, at);
      is_lit.push_back(corners.weight[at] > 0.0F ? 1 : 0);
    }
  }
  sparse.beyond = nodes_beyond(sparse, is_lit);
  const std::vector<float> errors =
      ray_errors(sparse, corners, static_cast<float>(max_direction_error_rad));
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
        const CheckPlace at = kCheckPlaces[k];
        sparse.checks[k].add(corners, index(column * kStep + at.column, row * kStep + at.row));
      }
      const int lit = lit_rays(corners, column, row);
      const bool is_smooth = lit == kStep * kStep && errors[sparse.kind.size()] <= 1.0F;
      sparse.kind.push_back(is_smooth ? TileKind::kSmooth
                            : lit > 0 ? TileKind::kBent
                                      : TileKind::kNone);
    }
  }
  return sparse;
}

namespace {

/// Meets a picture of rays tile by tile.
class SparseMeeting {
 public:
  SparseMeeting(const SparseRays& sparse, const RayCache& corners, const Tunnel& tunnel)
      : sparse_(sparse), corners_(corners), tunnel_(tunnel), tiles_(sparse.columns - 1) {
    hits_.resize(corners.weight.size(), tunnel.settings());
    meet(sparse.nodes, nodes_);
    for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
      meet(sparse.checks[k], checks_[k]);
    }
    const std::vector<FloatArray*> at_nodes = nodes_.arrays();
    for (const FloatArray* values : at_nodes) {
      planes_.emplace_back(sparse).set(values->data());
    }
    blended_.resize(static_cast<std::size_t>(sparse.columns + 2 * kMargin));
    allowed_.resize(static_cast<std::size_t>(tiles_));
    errors_.resize(allowed_.size());
    is_sparse_.resize(allowed_.size());
  }

  WallHits meet(TileLimits& limits) {
    begin(limits);
    for (int row = 0; row + 1 < sparse_.rows; ++row) {
      find_limits(row, limits);
      check(row, limits);
      set_kinds(row, limits);
      spread(row);
      meet_others(row);
    }
    const std::size_t done = place(0, (sparse_.rows - 1) * kStep);
    const std::size_t rest = corners_.weight.size() - done;
    meet_rays(corners_.block(static_cast<std::int64_t>(done), static_cast<int>(rest)),
              tunnel_,
              done,
              hits_);
    return std::move(hits_);
  }

 private:
  void meet(const PickedRays& rays, WallHits& hits) const {
    hits.resize(static_cast<std::size_t>(rays.count()), tunnel_.settings());
    meet_rays(rays.block(), tunnel_, 0, hits);
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
  void meet_others(int row);
  void meet_tiles(int row, int begin, int end);
  void clear_tile(int row, int column);

  const SparseRays& sparse_;
  const RayCache& corners_;
  const Tunnel& tunnel_;
  int tiles_;  ///< in a row
  WallHits hits_, nodes_;
  std::array<WallHits, SparseRays::kChecks> checks_;
  std::vector<NodePlane> planes_;  ///< of the hits' arrays
  std::vector<float> blended_, allowed_, errors_;
  std::vector<unsigned char> is_sparse_;
  PickedRays others_;
  WallHits met_;
};

/// Where the quintics are near enough to the hits at the places that are checked.
void SparseMeeting::check(int row, const TileLimits& limits) {
  for (std::size_t i = 0; i < is_sparse_.size(); ++i) {
    is_sparse_[i] = kinds(row)[i] == TileKind::kSmooth ? 1 : 0;
  }
  for (std::size_t array = 0; array < planes_.size(); ++array) {
    find_errors(array, row);
    allow_errors(array, row, limits);
    kernels::keep_allowed(errors_.data(), allowed_.data(), tiles_, is_sparse_.data());
  }
}

void SparseMeeting::find_errors(std::size_t array, int row) {
  std::ranges::fill(errors_, 0.0F);
  for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
    const CheckPlace at = kCheckPlaces[k];
    kernels::blend_rows(planes_[array].around(row),
                        kernels::node_weights(at.row),
                        planes_[array].width(),
                        blended_.data());
    kernels::find_errors(
        blended_.data(),
        checks_[k].arrays()[array]->data() + static_cast<std::ptrdiff_t>(row) * tiles_,
        kernels::node_weights(at.column),
        tiles_,
        errors_.data());
  }
}

/// Along the stripes a share of the footprint there; across the tunnel a share of that, and more
/// where no boundary of the light is near.
void SparseMeeting::allow_errors(std::size_t array, int row, const TileLimits& limits) {
  enum : std::size_t { kX, kY, kMargin_, kPattern, kCosine };

  constexpr float kPerPixel = kLargestShare / kStep;
  std::ranges::fill(allowed_, array == kCosine ? kLargestCosineError : kLeastError_mm);
  if (array == kCosine) {
    return;
  }
  const bool is_across = array == kY || array == kMargin_;
  const NodePlane& seen = planes_[is_across ? kY : array];
  kernels::allow_errors(
      seen.row(row) + kMargin, seen.row(row + 1) + kMargin, tiles_, kPerPixel, allowed_.data());
  if (!is_across) {
    return;
  }
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * tiles_;
  const double slot_mm = tunnel_.settings().slot_mm;
  kernels::allow_more({.y_low = limits.y_low_mm.data() + first,
                       .y_high = limits.y_high_mm.data() + first,
                       .margin_low = limits.margin_low_mm.data() + first,
                       .margin_high = limits.margin_high_mm.data() + first},
                      tiles_,
                      slot_mm > 0.0 ? static_cast<float>(0.5 * slot_mm) : -1e30F,
                      kFarFromBoundaries,
                      allowed_.data());
}

/// In the order of the hits' arrays.
std::array<std::pair<std::vector<float>*, std::vector<float>*>, 4> limit_arrays(
    TileLimits& limits) {
  return {{{&limits.x_low_mm, &limits.x_high_mm},
           {&limits.y_low_mm, &limits.y_high_mm},
           {&limits.margin_low_mm, &limits.margin_high_mm},
           {&limits.stripes_low_mm, &limits.stripes_high_mm}}};
}

void SparseMeeting::begin(TileLimits& limits) const {
  limits.columns = tiles_;
  limits.rows = sparse_.rows - 1;
  limits.kind.resize(sparse_.kind.size());
  const auto arrays = limit_arrays(limits);
  for (std::size_t i = 0; i < std::min(arrays.size(), planes_.size()); ++i) {
    arrays[i].first->resize(sparse_.kind.size());
    arrays[i].second->resize(sparse_.kind.size());
  }
}

void SparseMeeting::find_limits(int row, TileLimits& limits) {
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

void SparseMeeting::set_kinds(int row, TileLimits& limits) const {
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * tiles_;
  for (std::size_t i = 0; i < is_sparse_.size(); ++i) {
    limits.kind[static_cast<std::size_t>(first) + i] = kinds(row)[i] == TileKind::kNone
                                                           ? TileLimits::kNoRays
                                                       : is_sparse_[i] != 0 ? TileLimits::kKnown
                                                                            : TileLimits::kUnknown;
  }
}

void SparseMeeting::spread(int row) {
  const std::vector<FloatArray*> arrays = hits_.arrays();
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    for (int y = 0; y < kStep; ++y) {
      kernels::blend_rows(
          planes_[i].around(row), kernels::node_weights(y), planes_[i].width(), blended_.data());
      kernels::spread(blended_.data(), tiles_, arrays[i]->data() + place(0, row * kStep + y));
    }
  }
}

/// Tiles that are not sparse, and what is left of the rows beyond the last node.
void SparseMeeting::meet_others(int row) {
  const auto is_met = [&](int column) {
    return column < tiles_ && (is_sparse_[static_cast<std::size_t>(column)] != 0 ||
                               kinds(row)[column] == TileKind::kNone);
  };
  for (int column = 0; column <= tiles_; ++column) {
    if (column < tiles_ && kinds(row)[column] == TileKind::kNone) {
      clear_tile(row, column);
    }
    int end = column;
    while (end <= tiles_ && !is_met(end)) {
      ++end;
    }
    if (end > column) {
      meet_tiles(row, column, end);
      column = end - 1;
    }
  }
}

void SparseMeeting::clear_tile(int row, int column) {
  for (int y = row * kStep; y < (row + 1) * kStep; ++y) {
    const std::size_t at = place(column * kStep, y);
    std::fill_n(hits_.x_mm.begin() + static_cast<std::ptrdiff_t>(at), kStep, 0.0F);
    std::fill_n(hits_.y_mm.begin() + static_cast<std::ptrdiff_t>(at), kStep, 0.0F);
    std::fill_n(hits_.margin_mm.begin() + static_cast<std::ptrdiff_t>(at), kStep, kNowhere_mm);
    if (!hits_.pattern_mm.empty()) {
      std::fill_n(hits_.pattern_mm.begin() + static_cast<std::ptrdiff_t>(at), kStep, 0.0F);
      std::fill_n(hits_.cosine.begin() + static_cast<std::ptrdiff_t>(at), kStep, 1.0F);
    }
  }
}

/// Short stretches, mostly of whole tiles: a call for each would take longer than to copy it.
void copy_stretch(const float* from, std::size_t count, float* to) {
  std::size_t done = 0;
  for (; done + kStep <= count; done += kStep) {
    std::memcpy(to + done, from + done, kStep * sizeof(float));
  }
  for (; done < count; ++done) {
    to[done] = from[done];
  }
}

/// Ray by ray, all rows of the tiles together.
void SparseMeeting::meet_tiles(int row, int begin, int end) {
  const int left = begin * kStep;
  const int right = end > tiles_ ? corners_.width_px : end * kStep;
  const auto width = static_cast<std::size_t>(right - left);
  const Components from = components_of(corners_);
  const std::array<std::vector<float>*, 6> to = {&others_.origin_x,
                                                 &others_.origin_y,
                                                 &others_.origin_z,
                                                 &others_.direction_x,
                                                 &others_.direction_y,
                                                 &others_.direction_z};
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i]->resize(width * kStep);
    for (std::size_t y = 0; y < kStep; ++y) {
      copy_stretch(from[i]->data() + place(left, row * kStep + static_cast<int>(y)),
                   width,
                   to[i]->data() + y * width);
    }
  }
  meet(others_, met_);
  const std::vector<FloatArray*> results = hits_.arrays();
  const std::vector<FloatArray*> found = met_.arrays();
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (std::size_t y = 0; y < kStep; ++y) {
      copy_stretch(found[i]->data() + y * width,
                   width,
                   results[i]->data() + place(left, row * kStep + static_cast<int>(y)));
    }
  }
}

}  // namespace

WallHits meet_sparse(const SparseRays& sparse,
                     const RayCache& corners,
                     const Tunnel& tunnel,
                     TileLimits& limits) {
  return SparseMeeting(sparse, corners, tunnel).meet(limits);
}

}  // namespace glint
