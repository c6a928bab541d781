// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/designs_drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "studies/drawing/chart.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 760.0;
constexpr double kTop = 74.0;
constexpr double kRow = 38.0;
constexpr double kNames = 236.0;  ///< width of the column of names
constexpr double kShareRight = 490.0;
constexpr double kRateLeft = 526.0;
constexpr double kRight = 740.0;

constexpr std::string_view kShareColour = "#0072b2";
constexpr std::string_view kOtherColour = "#56b4e9";
constexpr std::string_view kRateColour = "#d55e00";

/// As much of a title as fits into the column of names.
std::string shortened(const std::string& title) {
  constexpr std::size_t kMost = 36;
  return title.size() <= kMost ? title : title.substr(0, kMost - 3) + "...";
}

class DesignsDrawing {
 public:
  explicit DesignsDrawing(const DesignsChart& chart)
      : chart_(chart), bottom_(kTop + kRow * static_cast<double>(chart.rows.size())) {
    double least = 1.0;
    double most_rate = 0.0;
    for (const DesignRow& row : chart.rows) {
      least = std::min({least, row.share.low, row.other_share.value_or(row.share).low});
      most_rate = std::max(most_rate, row.rate.high);
    }
    share_ = {
        .low = 10.0 * std::floor(10.0 * least), .high = 100.0, .from = kNames, .to = kShareRight};
    share_.low = std::min(share_.low, 90.0);
    rate_ = {.scale = ChartAxis::Scale::kRoot,
             .high = most_rate > 0.0 ? round_above(most_rate) : 1.0,
             .from = kRateLeft,
             .to = kRight};
  }

  std::string draw() {
    page_.text({16.0, 22.0}, chart_.title, "start", 0.0, R"(font-weight="bold")");
    draw_x_axis(page_, share_, kTop, bottom_, chart_.share_label);
    draw_x_axis(page_, rate_, kTop, bottom_, chart_.rate_label);
    double y = kTop + 0.5 * kRow;
    for (const DesignRow& row : chart_.rows) {
      page_.text({kNames - 12.0, y + 4.0}, shortened(row.title), "end");
      const double aside = row.other_share ? 6.0 : 0.0;
      interval(share_, row.share, 100.0, y - aside, Mark::kCircle, kShareColour, false);
      if (row.other_share) {
        interval(share_, *row.other_share, 100.0, y + aside, Mark::kDiamond, kOtherColour, true);
      }
      interval(rate_, row.rate, 1.0, y, Mark::kSquare, kRateColour, false);
      y += kRow;
    }
    legend();
    return page_.document(kWidth, bottom_ + 56.0, chart_.title);
  }

 private:
  void interval(const ChartAxis& axis,
                const Estimate& estimate,
                double factor,
                double y,
                Mark form,
                std::string_view colour,
                bool is_open) {
    const double low = axis.place(factor * estimate.low);
    const double high = axis.place(factor * estimate.high);
    const std::string style = fmt::format(R"(stroke="{}" stroke-width="1.6")", colour);
    page_.line({low, y}, {high, y}, style);
    for (const double x : {low, high}) {
      page_.line({x, y - 4.0}, {x, y + 4.0}, style);
    }
    draw_mark(page_, {axis.place(factor * estimate.value), y}, form, colour, is_open);
  }

  void legend() {
    if (chart_.share_name.empty()) {
      return;
    }
    draw_mark(page_, {24.0, 44.0}, Mark::kCircle, kShareColour);
    page_.text({36.0, 48.0}, chart_.share_name, "start");
    const bool has_other = std::ranges::any_of(
        chart_.rows, [](const DesignRow& row) { return row.other_share.has_value(); });
    if (has_other) {
      draw_mark(page_, {284.0, 44.0}, Mark::kDiamond, kOtherColour, true);
      page_.text({296.0, 48.0}, chart_.other_name, "start");
    }
  }

  const DesignsChart& chart_;
  SvgPage page_;
  double bottom_ = 0.0;
  ChartAxis share_;
  ChartAxis rate_;
};

}  // namespace

std::string designs_svg(const DesignsChart& chart) {
  return DesignsDrawing(chart).draw();
}

}  // namespace glint
