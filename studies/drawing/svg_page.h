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
inline constexpr std::string_view kDrawingLight = "#e69f00";
inline constexpr std::string_view kDrawingPart = "#9db4c6";
inline constexpr std::string_view kDrawingRay = "#0072b2";

/// Of the page, in its units.
inline constexpr double kDrawingWidth = 440.0;
inline constexpr double kDrawingMargin = 12.0;

/// How large a drawing is on paper.
struct PaperScale {
  double unit_mm = 0.0;  ///< of the page, printed at 100 %
  std::string words;     ///< "1 : 5"
};

/// The largest usual scale, 1, 2 or 5 times a power of ten, at which the page fits onto A4.
/// @param scale  units per mm of what is drawn, > 0
PaperScale paper_scale(double scale, double width, double height);

/// "1 : 3.4", what is drawn with that scale in units per mm on paper where a unit is so long.
std::string scale_text(double scale, double unit_mm);

/// The text on lines of at most that many letters, broken at blanks; longer words stay whole.
std::vector<std::string> wrapped(std::string_view text, std::size_t letters);

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
  /// to the right of it; to its left where the page ends.
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

  /// Lines of words from a point downwards, each as wide as the page allows.
  /// @return the height below the last of them
  double lines(const Eigen::Vector2d& at,
               const std::vector<std::string>& words,
               double width,
               std::string_view style = "");

  /// The whole document.
  /// @param unit_mm  what a unit is on paper printed at 100 %; 0: as large as a viewer likes
  std::string document(double width,
                       double height,
                       std::string_view title,
                       double unit_mm = 0.0) const;

 private:
  std::string body_;
};

}  // namespace glint
