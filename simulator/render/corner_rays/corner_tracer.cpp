// SPDX-License-Identifier: GPL-3.0-or-later
//
// Traces a ray through each corner of the pixel grid and refines pixels that four corners do not
// describe. Rows are independent, sixteen rays are traced at a time. A pixel that fails the rule of
// cell_rule.h is cut into 2, 4, 8 or 16 cells per axis with corner rays of their own, until the
// rays interpolated between corners are wrong by no more than render.max_direction_error_rad; the
// first number of cells is predicted, as the error falls with its square. With a plan
// (update_plan.h) only what height features can change is traced, and the rest copied. Own method:
// docs/theory/footprints.md. Cost: one ray per pixel and (n + 1)^2 per refined pixel; 28 bytes per
// ray.
#include "simulator/render/corner_rays/corner_tracer.h"

#include <algorithm>
#include <iterator>

namespace glint {
namespace {

/// Free triangles of a part with exact surfaces are its defects, often flat ones: their pixels are
/// to be so much more exact.
constexpr double kKinkFactorOfDefects = 4.0;

void copy_ray(const RayCache& from, std::size_t i, RayCache& to, std::size_t j) {
  to.origin_x[j] = from.origin_x[i];
  to.origin_y[j] = from.origin_y[i];
  to.origin_z[j] = from.origin_z[i];
  to.direction_x[j] = from.direction_x[i];
  to.direction_y[j] = from.direction_y[i];
  to.direction_z[j] = from.direction_z[i];
  to.weight[j] = from.weight[i];
}

/// Rays that missed the part are kept as no ray that met it can be: at (0, 0, 0) straight down.
bool has_missed(const RayCache& rays, std::size_t i) {
  return rays.weight[i] == 0.0F && rays.direction_z[i] == -1.0F && rays.origin_x[i] == 0.0F &&
         rays.origin_y[i] == 0.0F && rays.origin_z[i] == 0.0F;
}

}  // namespace

CornerTracer::CornerTracer(const TraceScene& scene,
                           const CameraRays& camera,
                           const RefinementNeed& need,
                           const UpdatePlan& plan,
                           const CornerRays* base,
                           int max_cells,
                           CornerRays& result)
    : max_cells_(max_cells),
      kink_factor_(scene.part.patches.empty() ? 1.0 : kKinkFactorOfDefects),
      scene_(scene),
      camera_(camera),
      area_(camera.area_of(scene.box)),
      need_(need),
      plan_(plan),
      base_(base),
      result_(result) {
  corners_.make_room((static_cast<std::size_t>(result.width_px) + 1) *
                     (static_cast<std::size_t>(result.height_px) + 1));
}

CornerRow CornerTracer::trace_corners(int y) {
  CornerRow row;
  const int columns = result_.width_px + 1;
  const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns);
  Lanes x_px = {};
  Lanes y_px;
  y_px.fill(y);
  PacketTracer tracer(scene_);
  CameraPacket rays;
  EscapePacket escapes;
  for (int x = 0; x < columns;) {
    if (!plan_.has_corner(x, y)) {
      copy_corner(first + static_cast<std::size_t>(x), row.counts);
      ++x;
      continue;
    }
    int count = 0;
    while (count < kPacketSize && x + count < columns && plan_.has_corner(x + count, y)) {
      x_px[static_cast<std::size_t>(count)] = x + count;
      ++count;
    }
    const std::size_t at = first + static_cast<std::size_t>(x);
    if (area_.touches(x, x + count - 1, y, y)) {
      camera_.through(x_px.data(), y_px.data(), count, rays);
      tracer.trace(rays, escapes);
      add_counts(escapes, count, row.counts);
      corners_.take(escapes, count, at);
    } else {
      store_missed(at, static_cast<std::size_t>(count), corners_.rays);
      row.counts.camera += count;
    }
    row.traced += count;
    x += count;
  }
  return row;
}

void CornerTracer::copy_corner(std::size_t i, RayCounts& counts) {
  copy_ray(base_->corners, i, corners_.rays, i);
  ++counts.camera;
  counts.part += has_missed(corners_.rays, i) ? 0 : 1;
}

CornerRow CornerTracer::refine(int y) {
  CornerRow row;
  std::vector<Candidate> open;
  std::vector<std::uint8_t> is_smooth(static_cast<std::size_t>(result_.width_px));
  mark_smooth_row(corner_grid(), y, scene_.settings.max_direction_error_rad, is_smooth.data());
  for (int x = 0; x < result_.width_px; ++x) {
    if (!plan_.has_pixel(x, y)) {
      continue;
    }
    if (is_smooth[static_cast<std::size_t>(x)] != 0 && need_.cells(x, y) == 0) {
      set_smooth(x, y);
    } else {
      classify(x, y, open);
    }
  }
  while (!open.empty()) {
    open = refine_once(open, y, row);
  }
  if (base_ != nullptr) {
    copy_pixels(y, row);
  }
  for (RowGroup& group : row.groups) {
    sort_by_pixel(group);
    shrink(group);
  }
  return row;
}

namespace {

/// Appends one refined pixel of a picture's rays.
void copy_refined(const RefinedGroup& from, std::size_t index, RowGroup& to) {
  const std::size_t num_rays = corners_of(from.cells_per_axis);
  const auto num_cells = static_cast<std::ptrdiff_t>(from.cells_per_axis * from.cells_per_axis);
  const std::vector<std::uint8_t> plain(num_rays, 0);
  const std::size_t first = index * num_rays;
  append_rays(from.rays, plain.data(), first, num_rays, to);
  to.group.pixels.push_back(from.pixels[index]);
  const auto cells = from.is_smooth.begin() + static_cast<std::ptrdiff_t>(index) * num_cells;
  to.group.is_smooth.insert(to.group.is_smooth.end(), cells, cells + num_cells);
  for (std::size_t i = first; i < first + num_rays; ++i) {
    ++to.group.rays.counts.camera;
    to.group.rays.counts.part += has_missed(from.rays, i) ? 0 : 1;
  }
}

}  // namespace

/// @return pixels that need more cells
std::vector<Candidate> CornerTracer::refine_once(const std::vector<Candidate>& open,
                                                 int y,
                                                 CornerRow& row) {
  std::vector<Candidate> more;
  for (const int cells : kCellCounts) {
    std::vector<Candidate> same;
    std::ranges::copy_if(
        open, std::back_inserter(same), [&](const Candidate& c) { return c.cells == cells; });
    if (!same.empty()) {
      refine_batch(same, y, row, more);
    }
  }
  return more;
}

/// Takes what the plan leaves out of a row from the base.
void CornerTracer::copy_pixels(int y, CornerRow& row) {
  for (int x = 0; x < result_.width_px; ++x) {
    if (!plan_.has_pixel(x, y)) {
      result_.kind(x, y) = base_->kind(x, y);
      result_.coverage(x, y) = base_->coverage(x, y);
      result_.seen_x(x, y) = base_->seen_x(x, y);
      result_.seen_y(x, y) = base_->seen_y(x, y);
      result_.seen_z(x, y) = base_->seen_z(x, y);
    }
  }
  for (const RefinedGroup& from : base_->refined) {
    RowGroup& to = group_of(row.groups, from.cells_per_axis);
    const std::int32_t begin = y * result_.width_px;
    const auto p = std::ranges::lower_bound(from.pixels, begin);
    for (auto i = static_cast<std::size_t>(p - from.pixels.begin());
         i < from.pixels.size() && from.pixels[i] < begin + result_.width_px;
         ++i) {
      if (!plan_.has_pixel(from.pixels[i] - begin, y)) {
        copy_refined(from, i, to);
      }
    }
  }
}

namespace {

/// The weight of the smooth pixels' first corners, -1 where they differ.
float common_weight(const CornerRays& rays) {
  float common = -1.0F;
  for (int y = 0; y < rays.height_px; ++y) {
    const float* weight = rays.corners.weight.data() +
                          static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.width_px + 1);
    const PixelKind* kind = rays.kind.row(y);
    for (int x = 0; x < rays.width_px; ++x) {
      if (kind[x] == PixelKind::kSmooth && weight[x] != common) {
        if (common >= 0.0F) {
          return -1.0F;
        }
        common = weight[x];
      }
    }
  }
  return common;
}

}  // namespace

void CornerTracer::finish() {
  result_.corners = std::move(corners_.rays);
  result_.corners.width_px = result_.width_px + 1;
  result_.corners.height_px = result_.height_px + 1;
  result_.corners.samples = 1;
  result_.smooth_weight = common_weight(result_);
  constexpr double kOfDirectionError = 0.01;
  result_.sparse =
      sparse_rays(result_.corners, kOfDirectionError * scene_.settings.max_direction_error_rad);
  for (std::size_t i = 0; i < corners_.is_special.size(); ++i) {
    if (corners_.is_special[i] != 0) {
      result_.special.push_back(static_cast<std::int64_t>(i));
    }
  }
}

RayGrid CornerTracer::corner_grid() const {
  return {.rays = &corners_.rays,
          .path = corners_.path.data(),
          .piece = corners_.piece.data(),
          .first = 0,
          .columns = result_.width_px + 1,
          .rows = result_.height_px + 1,
          .kink_factor = kink_factor_};
}

/// What is saved where a picture has too many rays is not saved on defects.
int CornerTracer::max_cells(int x, int y) const {
  return need_.cells(x, y) > 0 ? kCellCounts.back() : max_cells_;
}

/// Decides from the four corners; pixels to be cut go to `open`.
void CornerTracer::classify(int x, int y, std::vector<Candidate>& open) {
  const double max_error_rad = need_.max_error_rad(x, y, scene_.settings.max_direction_error_rad);
  const RayGrid grid = corner_grid();
  const auto columns = static_cast<std::size_t>(grid.columns);
  const std::size_t i = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
  const auto is_missed = [&](std::size_t k) { return corners_.path[k] == RayPath::kMissed; };
  if (is_missed(i) && is_missed(i + 1) && is_missed(i + columns) && is_missed(i + columns + 1)) {
    if (need_.has_vertex(x, y)) {  // a corner of the part breaks through
      open.push_back({.x = x, .cells = std::min(kCellsOfBroken, max_cells(x, y))});
    }
    return;
  }
  const CellCheck check = check_cell(grid, x, y);
  const int needed = need_.cells(x, y);
  if (!check.is_whole || check.error_rad > max_error_rad) {
    const int predicted = predicted_cells(check, max_error_rad, max_cells(x, y));
    open.push_back({.x = x, .cells = std::max(needed, predicted)});
  } else if (needed > 0) {
    open.push_back({.x = x, .cells = needed, .is_examined = true});
  } else {
    set_smooth(x, y);
  }
}

void CornerTracer::set_smooth(int x, int y) {
  const std::size_t columns = static_cast<std::size_t>(result_.width_px) + 1;
  const std::size_t first = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
  const auto mean = [&](const RayCache::Floats& v) {
    const double sum = static_cast<double>(v[first]) + static_cast<double>(v[first + 1]) +
                       static_cast<double>(v[first + columns]) +
                       static_cast<double>(v[first + columns + 1]);
    return static_cast<float>(0.25 * sum);
  };
  result_.kind(x, y) = PixelKind::kSmooth;
  result_.coverage(x, y) = 1.0F;
  result_.seen_x(x, y) = mean(corners_.rays.origin_x);
  result_.seen_y(x, y) = mean(corners_.rays.origin_y);
  result_.seen_z(x, y) = mean(corners_.rays.origin_z);
}

/// Traces the sub-corners of pixels cut into the same number of cells.
void CornerTracer::trace_batch(const std::vector<Candidate>& pixels,
                               int y,
                               SubCorners& batch) const {
  const int n = pixels.front().cells;
  const std::size_t count = corners_of(n) * pixels.size();
  batch.make_room(count);
  Lanes x_px = {};
  Lanes y_px = {};
  PacketTracer tracer(scene_);
  CameraPacket rays;
  EscapePacket escapes;
  for (std::size_t first = 0; first < count; first += kPacketSize) {
    const std::size_t lanes = std::min<std::size_t>(kPacketSize, count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t pixel = (first + lane) / corners_of(n);
      const auto corner = static_cast<int>((first + lane) % corners_of(n));
      const int row = corner / (n + 1);
      x_px[lane] = pixels[pixel].x + static_cast<double>(corner % (n + 1)) / n;
      y_px[lane] = y + static_cast<double>(row) / n;
    }
    camera_.through(x_px.data(), y_px.data(), static_cast<int>(lanes), rays);
    tracer.trace(rays, escapes);
    batch.take(escapes, static_cast<int>(lanes), first);
  }
}

void CornerTracer::refine_batch(const std::vector<Candidate>& pixels,
                                int y,
                                CornerRow& row,
                                std::vector<Candidate>& more) {
  const int n = pixels.front().cells;
  const auto clean_weight = static_cast<float>(scene_.settings.reflectance);
  SubCorners batch;
  trace_batch(pixels, y, batch);
  row.traced += static_cast<std::int64_t>(batch.path.size());
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const std::size_t first = p * corners_of(n);
    const RayGrid grid = {.rays = &batch.rays,
                          .path = batch.path.data(),
                          .piece = batch.piece.data(),
                          .first = first,
                          .columns = n + 1,
                          .rows = n + 1,
                          .kink_factor = kink_factor_};
    const double max_error_rad =
        need_.max_error_rad(pixels[p].x, y, scene_.settings.max_direction_error_rad);
    const CheckedCells cells = check_cells(grid, max_error_rad);
    const bool is_smooth = !cells.has_broken && !cells.has_bent;
    if (const int next = next_cells(cells, n, max_cells(pixels[p].x, y)); next > 0) {
      more.push_back({.x = pixels[p].x, .cells = next});
    } else if (pixels[p].is_examined && is_smooth &&
               is_described_by_corners(grid, max_error_rad, clean_weight)) {
      set_smooth(pixels[p].x, y);
    } else {
      keep(batch, first, pixels[p], y, cells, row);
    }
  }
}

/// Puts a cut pixel into its group.
void CornerTracer::keep(const SubCorners& batch,
                        std::size_t first,
                        const Candidate& pixel,
                        int y,
                        const CheckedCells& cells,
                        CornerRow& row) {
  const int n = pixel.cells;
  if (!set_coverage(batch, first, n, pixel.x, y)) {
    return;  // no ray met the part: it stays dark
  }
  RowGroup& to = group_of(row.groups, n);
  RefinedGroup& group = to.group;
  group.pixels.push_back(y * result_.width_px + pixel.x);
  group.is_smooth.insert(group.is_smooth.end(), cells.is_smooth.begin(), cells.is_smooth.end());
  append_rays(batch.rays, batch.is_special.data() + first, first, corners_of(n), to);
  RayCounts& counts = group.rays.counts;
  for (std::size_t i = first; i < first + corners_of(n); ++i) {
    ++counts.camera;
    counts.part += batch.path[i] != RayPath::kMissed ? 1 : 0;
    counts.followed += batch.path[i] == RayPath::kFollowed ? 1 : 0;
    counts.blocked += batch.path[i] == RayPath::kBlocked ? 1 : 0;
    counts.grazing += batch.is_grazing[i];
  }
  result_.kind(pixel.x, y) = PixelKind::kRefined;
}

/// Mean over the corners of all cells: inner corners count four times, those on an edge twice.
bool CornerTracer::set_coverage(const SubCorners& batch, std::size_t first, int n, int x, int y) {
  int hits = 0;
  double sum_x = 0.0;
  double sum_y = 0.0;
  double sum_z = 0.0;
  for (int row = 0; row <= n; ++row) {
    for (int column = 0; column <= n; ++column) {
      const std::size_t i = first + static_cast<std::size_t>(row * (n + 1) + column);
      if (batch.path[i] == RayPath::kMissed) {
        continue;
      }
      const int weight = (row == 0 || row == n ? 1 : 2) * (column == 0 || column == n ? 1 : 2);
      hits += weight;
      sum_x += weight * static_cast<double>(batch.seen_x[i]);
      sum_y += weight * static_cast<double>(batch.seen_y[i]);
      sum_z += weight * static_cast<double>(batch.seen_z[i]);
    }
  }
  if (hits == 0) {
    return false;
  }
  result_.coverage(x, y) = static_cast<float>(hits) / static_cast<float>(4 * n * n);
  result_.seen_x(x, y) = static_cast<float>(sum_x / hits);
  result_.seen_y(x, y) = static_cast<float>(sum_y / hits);
  result_.seen_z(x, y) = static_cast<float>(sum_z / hits);
  return true;
}

}  // namespace glint
