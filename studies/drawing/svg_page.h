// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// Colours of the drawings.
inline constexpr std::string_view kDrawingInk = "#27313a";
inline constexpr std::string_view kDrawingSoft = "#6b7680";

/// An SVG drawing under construction. Positions are in drawing units, y downwards; they are written
/// with 2 decimals in any locale, so equal drawings are equal bytes. A style is a list of SVG
/// attributes.
class SvgPage {
 public:
  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::string_view style);

  /// @param tag  "polygon" or "polyline"
  void shape(std::string_view tag,
             const std::vector<Eigen::Vector2d>& points,
             std::string_view style);

  /// @param anchor  which part of the words stands at that point: "start", "middle", "end"
  void text(const Eigen::Vector2d& at,
            std::string_view words,
            std::string_view anchor = "middle",
            double angle_deg = 0.0,
            std::string_view style = "");

  /// A filled arrow head.
  void arrow(const Eigen::Vector2d& tip, const Eigen::Vector2d& direction);

  /// A dimension between two points: extension lines to a parallel `offset` to the left of a -> b,
  /// arrows (from outside where it is short), and the words on the line or, where they do not fit,
  /// to the right of it.
  void dimension(const Eigen::Vector2d& a,
                 const Eigen::Vector2d& b,
                 double offset,
                 std::string_view words);

  /// A white gap between two zigzags across a line that is not drawn to its full length.
  void break_mark(const Eigen::Vector2d& at, const Eigen::Vector2d& direction, double half_width);

  /// A bar of a round length, at most 90 units long. @param scale  units per mm, > 0
  void scale_bar(const Eigen::Vector2d& left, double scale);

  /// The two axes of a view, from their common corner.
  void axes(const Eigen::Vector2d& corner, std::string_view across, std::string_view up);

  /// The whole document.
  std::string document(double width, double height, std::string_view title) const;

 private:
  std::string body_;
};

}  // namespace glint
