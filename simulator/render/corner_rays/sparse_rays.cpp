// SPDX-License-Identifier: GPL-3.0-or-later
//
// Finds out where a picture's corner rays may be interpolated from every eighth of them: in tiles
// of 8 x 8 whose rays all lie near the quintic through 6 x 6 nodes. Beyond the part's outline and
// the picture's end nodes are extrapolated along rows and columns, so that tiles there have
// neighbours too. This is done once per traced picture, for all lightings to come. Own method:
// docs/theory/footprints.md, "Between every eighth ray". Cost: one interpolation of six components
// per ray. Memory: about 1.5 bytes per ray, and 24 for each ray of a tile that is not smooth.
#include "simulator/render/corner_rays/sparse_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "simulator/render/corner_rays/node_plane.h"
#include "simulator/render/corner_rays/sparse_kernels.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {
namespace {

namespace kernels = sparse_kernels;
using kernels::kStep;

/// Origins of smooth tiles lie this near to their quintic.
constexpr float kLargestOriginError_mm = 2e-4F;

/// Which nodes of a plane are known, those of lit rays at first.
class KnownNodes {
 public:
  KnownNodes(const SparseRays& sparse, const std::vector<unsigned char>& is_lit)
      : width_(sparse.columns + 2 * kNodeMargin),
        height_(sparse.rows + 2 * kNodeMargin),
        is_known_(static_cast<std::size_t>(width_ * height_)) {
    for (int row = 0; row < sparse.rows; ++row) {
      std::copy_n(
          is_lit.data() + static_cast<std::ptrdiff_t>(row) * sparse.columns,
          sparse.columns,
          is_known_.data() + static_cast<std::ptrdiff_t>(row + kNodeMargin) * width_ + kNodeMargin);
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
    for (const int minimum : {kernels::kNodes, kCubic}) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (run_length(column, row, dx, dy) >= minimum) {
          beyond.push_back({.to = row * width_ + column,
                            .step = dy * width_ + dx,
                            .is_cubic = minimum == kCubic});
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
  constexpr int kRounds = 2 * kNodeMargin;  // as many steps in both directions at a corner
  KnownNodes known(sparse, is_lit);
  std::vector<SparseRays::Beyond> all;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<SparseRays::Beyond> beyond = known.extend();
    all.insert(all.end(), beyond.begin(), beyond.end());
  }
  return all;
}

using Components = std::array<const float*, 6>;

template <class Rays>
Components components_of(const Rays& rays) {
  return {rays.origin_x.data(),
          rays.origin_y.data(),
          rays.origin_z.data(),
          rays.direction_x.data(),
          rays.direction_y.data(),
          rays.direction_z.data()};
}

/// In the same order.
std::array<std::vector<float>*, 6> arrays_of(PickedRays& rays) {
  return {&rays.origin_x,
          &rays.origin_y,
          &rays.origin_z,
          &rays.direction_x,
          &rays.direction_y,
          &rays.direction_z};
}

/// For each tile the largest error of its quintics at lit rays by what is allowed.
std::vector<float> ray_errors(const SparseRays& sparse,
                              const RayCache& corners,
                              float max_direction_error_rad) {
  const int tiles = sparse.columns;
  const auto width = static_cast<std::size_t>(corners.width_px);
  std::vector<float> errors(static_cast<std::size_t>(tiles) *
                            static_cast<std::size_t>(sparse.rows));
  NodePlane plane(sparse);
  std::vector<float> blended(static_cast<std::size_t>(plane.width_around()));
  std::vector<float> row(static_cast<std::size_t>(tiles * kStep)), values(row.size());
  std::vector<float> of_row(static_cast<std::size_t>(tiles));
  const Components nodes = components_of(sparse.nodes);
  const Components all = components_of(corners);
  for (std::size_t component = 0; component < all.size(); ++component) {
    const float allowed = component < 3 ? kLargestOriginError_mm : max_direction_error_rad;
    plane.set(nodes[component]);
    for (int y = 0; y < corners.height_px; ++y) {
      kernels::blend_rows(plane.around(y / kStep),
                          kernels::kNodeWeights[static_cast<std::size_t>(y % kStep)],
                          plane.width_around(),
                          blended.data());
      kernels::spread(blended.data(), tiles, row.data());
      values = row;
      const std::size_t first = static_cast<std::size_t>(y) * width;
      for (std::size_t x = 0; x < width; ++x) {
        values[x] = corners.weight[first + x] > 0.0F ? all[component][first + x] : row[x];
      }
      std::ranges::fill(of_row, 0.0F);
      kernels::find_errors_of_all(row.data(), values.data(), tiles, of_row.data());
      float* to = errors.data() + static_cast<std::ptrdiff_t>(y / kStep) * tiles;
      for (std::size_t i = 0; i < of_row.size(); ++i) {
        to[i] = std::max(to[i], of_row[i] / allowed);
      }
    }
  }
  return errors;
}

bool has_lit_ray(const RayCache& corners, int column, int row) {
  const int width = kernels::places_of(column, corners.width_px);
  const int height = kernels::places_of(row, corners.height_px);
  for (int y = row * kStep; y < row * kStep + height; ++y) {
    const float* weight =
        corners.weight.data() + static_cast<std::ptrdiff_t>(y) * corners.width_px + column * kStep;
    if (std::any_of(weight, weight + width, [](float w) { return w > 0.0F; })) {
      return true;
    }
  }
  return false;
}

/// The rays that are checked, one of each tile: dark ones as the lit ones beside them go on.
PickedRays check_rays(const SparseRays& sparse, const RayCache& corners, std::size_t check) {
  PickedRays rays;
  const auto to = arrays_of(rays);
  NodePlane plane(sparse);
  std::vector<float> blended(static_cast<std::size_t>(plane.width_around()));
  const Components nodes = components_of(sparse.nodes);
  const Components all = components_of(corners);
  for (std::size_t component = 0; component < all.size(); ++component) {
    plane.set(nodes[component]);
    for (int row = 0; row < sparse.rows; ++row) {
      const int row_in_tile = sparse.check_place(check, 0, row, corners).row;
      kernels::blend_rows(plane.around(row),
                          kernels::kNodeWeights[static_cast<std::size_t>(row_in_tile)],
                          plane.width_around(),
                          blended.data());
      for (int column = 0; column < sparse.columns; ++column) {
        const SparseRays::Place at = sparse.check_place(check, column, row, corners);
        const auto index = static_cast<std::size_t>(row * kStep + at.row) *
                               static_cast<std::size_t>(corners.width_px) +
                           static_cast<std::size_t>(column * kStep + at.column);
        const auto& weights = kernels::kNodeWeights[static_cast<std::size_t>(at.column)];
        to[component]->push_back(
            corners.weight[index] > 0.0F
                ? all[component][index]
                : std::inner_product(
                      weights.begin(), weights.end(), blended.begin() + column, 0.0F));
      }
    }
  }
  return rays;
}

}  // namespace

SparseRays::Place SparseRays::check_place(std::size_t check,
                                          int column,
                                          int row,
                                          const RayCache& corners) const {
  const Place at = kCheckPlaces[check];
  const int last_column = kernels::places_of(column, corners.width_px) - 1;
  const int last_row = kernels::places_of(row, corners.height_px) - 1;
  return {.column = column + 1 < columns ? at.column : last_column,
          .row = row + 1 < rows ? at.row : last_row};
}

RayBlock PickedRays::block() const {
  return {.origin_x = origin_x.data(),
          .origin_y = origin_y.data(),
          .origin_z = origin_z.data(),
          .direction_x = direction_x.data(),
          .direction_y = direction_y.data(),
          .direction_z = direction_z.data(),
          .count = count()};
}

void PickedRays::take(const RayCache& rays, const std::vector<RayStretch>& stretches) {
  std::size_t count = 0;
  for (const RayStretch& stretch : stretches) {
    count += static_cast<std::size_t>(stretch.count);
  }
  const Components from = components_of(rays);
  const auto to = arrays_of(*this);
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i]->resize(count);
    float* next = to[i]->data();
    for (const RayStretch& stretch : stretches) {
      copy_stretch(from[i] + stretch.first, static_cast<std::size_t>(stretch.count), next);
      next += stretch.count;
    }
  }
}

void PickedRays::add(const RayCache& rays, std::size_t index) {
  origin_x.push_back(rays.origin_x[index]);
  origin_y.push_back(rays.origin_y[index]);
  origin_z.push_back(rays.origin_z[index]);
  direction_x.push_back(rays.direction_x[index]);
  direction_y.push_back(rays.direction_y[index]);
  direction_z.push_back(rays.direction_z[index]);
}

namespace {

/// Dark rays, or lit ones of tiles that are not smooth.
std::vector<RayStretch> stretches_left(const SparseRays& sparse,
                                       const RayCache& corners,
                                       bool is_lit) {
  std::vector<RayStretch> stretches;
  for (int y = 0; y < corners.height_px; ++y) {
    const int first = y * corners.width_px;
    const int first_tile = y / kStep * sparse.columns;
    const auto is_left = [&](int x) {
      const auto tile = static_cast<std::size_t>(first_tile + x / kStep);
      const bool is_ray_lit = corners.weight[static_cast<std::size_t>(first + x)] > 0.0F;
      return is_ray_lit == is_lit && !(is_lit && sparse.kind[tile] == TileKind::kSmooth);
    };
    for (int x = 0, end = 0; x < corners.width_px; x = end) {
      for (end = x + 1; end < corners.width_px && is_left(end) == is_left(x); ++end) {
      }
      if (is_left(x)) {
        stretches.push_back({.first = first + x, .count = end - x});
      }
    }
  }
  return stretches;
}

double bent_share(const SparseRays& sparse) {
  const auto bent = std::ranges::count(sparse.kind, TileKind::kBent);
  return static_cast<double>(bent) / static_cast<double>(sparse.kind.size());
}

}  // namespace

SparseRays sparse_rays(const RayCache& corners, double max_direction_error_rad) {
  constexpr int kMinNodes = kernels::kNodes;
  constexpr double kLargestBentShare = 0.25;
  GLINT_CHECK(corners.samples == 1, "a picture of rays");
  SparseRays sparse;
  const int columns = (corners.width_px - 1) / kStep + 1;
  const int rows = (corners.height_px - 1) / kStep + 1;
  if (columns < kMinNodes || rows < kMinNodes) {
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
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const TileKind lit = errors[sparse.kind.size()] <= 1.0F ? TileKind::kSmooth : TileKind::kBent;
      sparse.kind.push_back(has_lit_ray(corners, column, row) ? lit : TileKind::kNone);
    }
  }
  if (bent_share(sparse) > kLargestBentShare) {
    return {};
  }
  for (std::size_t k = 0; k < SparseRays::kChecks; ++k) {
    sparse.checks[k] = check_rays(sparse, corners, k);
  }
  sparse.dark_stretches = stretches_left(sparse, corners, false);
  sparse.rest_stretches = stretches_left(sparse, corners, true);
  sparse.rest.take(corners, sparse.rest_stretches);
  return sparse;
}

}  // namespace glint
