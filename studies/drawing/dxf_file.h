// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "studies/drawing/arc_chain.h"

namespace glint {

/// A DXF drawing under construction, of the version that every reader knows (AutoCAD R12, ASCII).
/// Lengths are mm at 1 : 1, written with 4 decimals in any locale, so equal drawings are equal
/// bytes.
///
/// Source: Autodesk, DXF Reference, release 12, appendix C of the Customization Manual.
class DxfFile {
 public:
  void line(std::string_view layer, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

  /// Arcs one after the other, as one curve.
  void chain(std::string_view layer, std::span<const Arc> arcs);

  void polyline(std::string_view layer,
                std::span<const Eigen::Vector2d> points,
                bool is_closed = false);

  /// @param at  left end of the line the letters stand on
  void text(std::string_view layer,
            const Eigen::Vector2d& at,
            double height_mm,
            std::string_view words);

  std::string document() const;

 private:
  void begin(std::string_view kind, std::string_view layer);
  void point(const Eigen::Vector2d& at, int code = 10);
  void vertex(std::string_view layer, const Eigen::Vector2d& at, double bulge);
  void begin_polyline(std::string_view layer, bool is_closed);
  void end_polyline(std::string_view layer);

  std::vector<std::string> layers_;
  std::string entities_;
};

}  // namespace glint
