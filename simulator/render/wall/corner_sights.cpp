// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera's rays through the corners of pixels, met with the wall between part and camera. They
// do not depend on what of the part they see, and run on smoothly where the part ends; only a point
// of each inside the tunnel is needed, at the distance of what the pixel beside it sees. A pixel
// whose corners are all on one side of every edge of the wall is seen or hidden as a whole, others
// keep their crossings, which become boundaries of their footprint. docs/theory/footprints.md,
// "What the wall hides". Cost: one sight line per corner of the pixels looked at.
#include "simulator/render/wall/corner_sights.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Why a sight line passes, or on which side of the slot the wall stops it.
enum SightCode : unsigned char {
  kBesideWall = 1,  ///< below its rim, above a panel
  kBeforeStart = 2,
  kBehindEnd = 4,
  kInSlot = 8,
  kNoCrossing = 16,  ///< or behind the camera
  kRightOfSlot = 32,
  kLeftOfSlot = 64
};

constexpr unsigned char kPasses = kBesideWall | kBeforeStart | kBehindEnd | kInSlot | kNoCrossing;

/// Lower margins are no places on the wall.
constexpr float kNoCrossingBelow_mm = -1e20F;

const PlacedCamera& camera_of(const VisibilityBuffer& seen) {
  GLINT_CHECK(seen.camera.has_value(), "the camera whose pixels these are");
  return *seen.camera;
}

}  // namespace

void CornerSights::Row::resize(std::size_t count) {
  for (auto* array : {&origin_x,
                      &origin_y,
                      &origin_z,
                      &direction_x,
                      &direction_y,
                      &direction_z,
                      &x_mm,
                      &y_mm,
                      &margin_mm}) {
    array->resize(count);
  }
  code.resize(count);
}

CornerSights::CornerSights(const VisibilityBuffer& seen,
                           const Tunnel& tunnel,
                           const Vector3d& camera_in_world_mm)
    : seen_(seen),
      tunnel_(tunnel),
      camera_mm_(camera_in_world_mm),
      rays_(camera_of(seen).camera, camera_of(seen).camera_from_world),
      half_slot_mm_(tunnel.settings().half_slot_mm()),
      half_length_mm_(0.5 * tunnel.settings().length_mm),
      is_between_panels_(tunnel.settings().shape == TunnelSettings::Shape::kFlat &&
                         tunnel.contains(camera_in_world_mm.y(), camera_in_world_mm.z())) {}

Vector3d CornerSights::direction(double x_px, double y_px) const {
  CameraPacket packet;
  rays_.through(&x_px, &y_px, 1, packet);
  return {packet.direction_x[0], packet.direction_y[0], packet.direction_z[0]};
}

/// From the camera to where the ray through a corner is beside what a pixel at it sees; any number
/// where none of them sees the part.
double CornerSights::distance_mm(int x, int y, const Vector3d& direction) const {
  for (int row = std::max(0, y - 1); row <= std::min(y, seen_.height_px - 1); ++row) {
    for (int column = std::max(0, x - 1); column <= std::min(x, seen_.width_px - 1); ++column) {
      if (seen_.coverage(column, row) > 0.0F) {
        const Vector3d point = vector_of(
            seen_.seen_x(column, row), seen_.seen_y(column, row), seen_.seen_z(column, row));
        return (point - camera_mm_).dot(direction);
      }
    }
  }
  return 1.0;
}

/// Corners of row y.
void CornerSights::load(const PixelArea& area, int y, Row& row) const {
  const auto count = static_cast<std::size_t>(area.right - area.left) + 1;
  row.resize(count);
  Lanes x_px = {};
  Lanes y_px;
  y_px.fill(y);
  CameraPacket packet;
  for (std::size_t first = 0; first < count; first += kPacketSize) {
    const std::size_t lanes = std::min<std::size_t>(kPacketSize, count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      x_px[lane] = static_cast<double>(area.left) + static_cast<double>(first + lane);
    }
    rays_.through(x_px.data(), y_px.data(), static_cast<int>(lanes), packet);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = first + lane;
      const Vector3d along(
          packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]);
      const Vector3d way = distance_mm(static_cast<int>(x_px[lane]), y, along) * along;
      const Eigen::Vector3f origin = (camera_mm_ + way).cast<float>();
      row.origin_x[i] = origin.x();
      row.origin_y[i] = origin.y();
      row.origin_z[i] = origin.z();
      row.direction_x[i] = static_cast<float>(-way.x());
      row.direction_y[i] = static_cast<float>(-way.y());
      row.direction_z[i] = static_cast<float>(-way.z());
    }
  }
  tunnel_.intersect_block({.origin_x = row.origin_x.data(),
                           .origin_y = row.origin_y.data(),
                           .origin_z = row.origin_z.data(),
                           .direction_x = row.direction_x.data(),
                           .direction_y = row.direction_y.data(),
                           .direction_z = row.direction_z.data(),
                           .count = static_cast<int>(count)},
                          row.x_mm.data(),
                          row.y_mm.data(),
                          row.margin_mm.data());
  for (std::size_t i = 0; i < count; ++i) {
    row.code[i] = code_of(row, i);
  }
}

unsigned char CornerSights::code_of(const Row& row, std::size_t i) const {
  if (is_between_panels_ || row.margin_mm[i] < kNoCrossingBelow_mm) {
    return kNoCrossing;
  }
  const auto x = static_cast<double>(row.x_mm[i]);
  const auto y = static_cast<double>(row.y_mm[i]);
  const auto margin = static_cast<double>(row.margin_mm[i]);
  if (tunnel_.settings().shape != TunnelSettings::Shape::kFlat) {
    const Vector3d to = vector_of(row.direction_x[i], row.direction_y[i], row.direction_z[i]);
    const Vector3d crossing(x, y, tunnel_.settings().base_mm + margin);
    if ((crossing - camera_mm_).dot(to) >= 0.0) {
      return kNoCrossing;
    }
  }
  int code = margin < 0.0 ? kBesideWall : 0;
  code |= x <= -half_length_mm_ ? kBeforeStart : 0;
  code |= x >= half_length_mm_ ? kBehindEnd : 0;
  code |= y >= half_slot_mm_ ? kRightOfSlot : 0;
  code |= y <= -half_slot_mm_ ? kLeftOfSlot : 0;
  code |= std::abs(y) < half_slot_mm_ ? kInSlot : 0;
  return static_cast<unsigned char>(code);
}

/// @param i  of the pixel's left corners in both rows
OccludedEdge CornerSights::edge_of(std::int32_t pixel, std::size_t i) const {
  const auto corners = [&](std::vector<float> Row::*values) {
    const std::vector<float>& a = above_.*values;
    const std::vector<float>& b = below_.*values;
    return OccludedEdge::Corners{a[i], a[i + 1], b[i], b[i + 1]};
  };
  return {.pixel = pixel,
          .origin_x = corners(&Row::origin_x),
          .origin_y = corners(&Row::origin_y),
          .origin_z = corners(&Row::origin_z),
          .direction_x = corners(&Row::direction_x),
          .direction_y = corners(&Row::direction_y),
          .direction_z = corners(&Row::direction_z),
          .x_mm = corners(&Row::x_mm),
          .y_mm = corners(&Row::y_mm),
          .margin_mm = corners(&Row::margin_mm)};
}

void CornerSights::add_hidden(const PixelArea& area, OccludedPixels& found) {
  if (area.left >= area.right || area.top >= area.bottom) {
    return;
  }
  load(area, area.top, below_);
  for (int y = area.top; y < area.bottom; ++y) {
    std::swap(above_, below_);
    load(area, y + 1, below_);
    const float* coverage = seen_.coverage.row(y);
    for (int x = area.left; x < area.right; ++x) {
      const auto i = static_cast<std::size_t>(x - area.left);
      const std::array<unsigned char, 4> codes = {
          above_.code[i], above_.code[i + 1], below_.code[i], below_.code[i + 1]};
      const int all = codes[0] & codes[1] & codes[2] & codes[3];
      const int any = codes[0] | codes[1] | codes[2] | codes[3];
      if (coverage[x] <= 0.0F || (all & kPasses) != 0) {
        continue;
      }
      // Without a crossing there is no line: then most of the corners decide.
      const auto hidden =
          std::ranges::count_if(codes, [](int code) { return (code & kPasses) == 0; });
      const bool is_whole = (any & kNoCrossing) != 0 ? hidden > 2 : hidden == 4 && all != 0;
      if (is_whole) {
        if (found.whole.empty()) {
          found.whole = Mask(seen_.width_px, seen_.height_px);
        }
        found.whole(x, y) = 1;
      } else if ((any & kNoCrossing) == 0) {
        found.edges.push_back(edge_of(y * seen_.width_px + x, i));
      }
    }
  }
}

}  // namespace glint
