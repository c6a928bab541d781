// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/corner_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "core/csv.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/corner_residuals.h"

namespace glint {
namespace {

constexpr std::array<const char*, 13> kColumns = {"picture",
                                                  "width_px",
                                                  "height_px",
                                                  "board_x_mm",
                                                  "board_y_mm",
                                                  "x_px",
                                                  "y_px",
                                                  "residual_x_px",
                                                  "residual_y_px",
                                                  "used",
                                                  "outcome",
                                                  "reason",
                                                  "orientation"};

std::string head_row() {
  return csv_row(std::vector<std::string>(kColumns.begin(), kColumns.end()));
}

/// Reads rows by the names of their columns.
class CornerTable {
 public:
  CornerTable(std::string_view text, const std::string& file) : rows_(parse_csv(text, file, '#')) {
    if (rows_.empty()) {
      throw ConfigError(
          fmt::format("{}: is empty; a table of corners begins with {}", file, head_row()));
    }
    for (std::size_t i = 0; i < rows_.front().size(); ++i) {
      column_[rows_.front()[i].text] = i;
    }
    for (const char* needed :
         {"picture", "width_px", "height_px", "board_x_mm", "board_y_mm", "x_px", "y_px"}) {
      if (!column_.contains(needed)) {
        throw ConfigError(
            fmt::format("{}has no column {}", rows_.front().front().place.prefix(), needed));
      }
    }
  }

  std::size_t num_rows() const { return rows_.size() - 1; }

  /// Of row 0, 1, ... below the head; empty where the column or the field is missing.
  std::string text(std::size_t row, const char* column) const {
    const CsvField* field = find(row, column);
    return field == nullptr ? std::string() : field->text;
  }

  bool has(const char* column) const { return column_.contains(column); }

  bool is_empty(std::size_t row, const char* column) const { return text(row, column).empty(); }

  /// @throws ConfigError
  double number(std::size_t row, const char* column) const {
    const CsvField* field = find(row, column);
    const auto value = field == nullptr ? std::nullopt : field->number();
    if (!value || !std::isfinite(*value)) {
      fail(row, column, "must be a number");
    }
    return *value;
  }

  int size(std::size_t row, const char* column) const {
    const double value = number(row, column);
    if (!(value >= 1.0 && value <= 1e6) || value != std::floor(value)) {
      fail(row, column, "must be a whole number from 1 on");
    }
    return static_cast<int>(value);
  }

  [[noreturn]] void fail(std::size_t row, const char* column, const std::string& what) const {
    const CsvField* field = find(row, column);
    const Place& place = field != nullptr ? field->place : rows_[row + 1].front().place;
    throw ConfigError(fmt::format("{}{}: {}", place.prefix(), column, what));
  }

 private:
  const CsvField* find(std::size_t row, const char* column) const {
    const auto at = column_.find(column);
    return at == column_.end() || at->second >= rows_[row + 1].size() ? nullptr
                                                                      : &rows_[row + 1][at->second];
  }

  std::vector<CsvRow> rows_;
  std::map<std::string, std::size_t> column_;
};

/// Of a picture without corners; nullopt for a word that is no such outcome.
std::optional<BoardOutcome> outcome_without_corners(std::string_view name) {
  for (int i = static_cast<int>(BoardOutcome::kNoBoard);
       i <= static_cast<int>(BoardOutcome::kDoubled);
       ++i) {
    if (const auto outcome = static_cast<BoardOutcome>(i); outcome_name(outcome) == name) {
      return outcome;
    }
  }
  return std::nullopt;
}

/// Of a table without the column outcome: "dark" or "dark: white is 3 % of full scale".
BoardView older_view(const std::string& field) {
  const std::size_t colon = field.find(": ");
  const auto outcome = outcome_without_corners(std::string_view(field).substr(0, colon));
  if (!outcome) {
    return {.outcome = BoardOutcome::kNoBoard, .why = field};
  }
  return {.outcome = *outcome,
          .why = colon == std::string::npos ? std::string() : field.substr(colon + 2)};
}

/// What became of a picture without corners.
BoardView view_without_corners(const CornerTable& table, std::size_t row) {
  const std::string reason = table.text(row, "reason");
  if (!table.has("outcome")) {
    return older_view(reason);
  }
  const std::string name = table.text(row, "outcome");
  const auto outcome = outcome_without_corners(name);
  if (!outcome) {
    table.fail(row,
               "outcome",
               fmt::format("is \"{}\" of a picture without corners, must be no board, cut off, "
                           "blurred, saturated, dark or doubled",
                           name));
  }
  return {.outcome = *outcome, .why = reason};
}

bool is_orientation_known(const CornerTable& table, std::size_t row) {
  const std::string text = table.text(row, "orientation");
  if (!text.empty() && text != "known" && text != "unknown") {
    table.fail(row, "orientation", fmt::format("is \"{}\", must be known or unknown", text));
  }
  return text != "unknown";
}

/// A row's numbers are added to the picture that it belongs to.
void add_row(const CornerTable& table, std::size_t row, FoundCorners& found) {
  const std::string name = table.text(row, "picture");
  if (name.empty()) {
    table.fail(row, "picture", "is empty, must be the picture's name");
  }
  const bool is_found = !table.is_empty(row, "x_px") || !table.is_empty(row, "y_px");
  if (found.names.empty() || found.names.back() != name) {
    if (std::ranges::find(found.names, name) != found.names.end()) {
      table.fail(row, "picture", "corners of one picture must stand together");
    }
    found.names.push_back(name);
    found.views.push_back(is_found ? BoardView() : view_without_corners(table, row));
  }
  if (!is_found) {
    return;
  }
  BoardView& view = found.views.back();
  view.outcome = BoardOutcome::kAccepted;
  view.why.clear();
  const bool is_known = is_orientation_known(table, row);
  if (!view.picture_px.empty() && is_known != view.is_orientation_known) {
    table.fail(row, "orientation", "must be the same in all rows of a picture");
  }
  view.is_orientation_known = is_known;
  view.board_mm.emplace_back(table.number(row, "board_x_mm"), table.number(row, "board_y_mm"), 0.0);
  view.picture_px.emplace_back(table.number(row, "x_px"), table.number(row, "y_px"));
}

bool has_corner(const Board& board, const Eigen::Vector3d& at_mm) {
  const double near_mm = 1e-3 * board.square_mm;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      if ((corner_mm(board, col, row) - at_mm).norm() < near_mm) {
        return true;
      }
    }
  }
  return false;
}

/// A row of kColumns. Numbers are written as such: csv_row_of() would take their text for a formula
/// where it begins with a minus.
/// @param numbers  from board_x_mm on; those that are missing stay empty
/// @param words    from used on, as a spreadsheet may have them
std::string corner_row(const CalibrateInput& input,
                       std::size_t picture,
                       std::span<const double> numbers,
                       std::initializer_list<std::string> words) {
  constexpr std::size_t kNumbers = 6;
  std::vector<std::string> fields = {csv_plain_text(input.names[picture]),
                                     std::to_string(input.width_px),
                                     std::to_string(input.height_px)};
  for (const double number : numbers) {
    fields.push_back(shortest(number));
  }
  fields.resize(fields.size() + kNumbers - numbers.size());
  fields.insert(fields.end(), words);
  return csv_row(fields);
}

}  // namespace

std::string corners_csv(const CalibrateInput& input,
                        const SolvedCalibration& solved,
                        const std::vector<std::vector<Eigen::Vector2d>>& residuals_px) {
  std::string text = head_row();
  for (std::size_t i = 0; i < input.names.size(); ++i) {
    const BoardCorners& corners = input.corners[i];
    const char* used = is_used(solved, i) ? "yes" : "no";
    const BoardView& view = input.views[i];
    const std::string reason = view.is_accepted() ? reason_of(input, solved, i) : view.why;
    const auto row = [&](const std::vector<double>& numbers, const char* orientation) {
      return corner_row(input,
                        i,
                        numbers,
                        {used, outcome_name(view.outcome), csv_plain_text(reason), orientation});
    };
    if (corners.picture_px.empty()) {
      text += row({}, "");
    }
    const char* orientation = view.is_orientation_known ? "known" : "unknown";
    for (std::size_t k = 0; k < corners.picture_px.size(); ++k) {
      const Eigen::Vector3d& board_mm = corners.board_mm[k];
      const Eigen::Vector2d& px = corners.picture_px[k];
      std::vector<double> numbers = {board_mm.x(), board_mm.y(), px.x(), px.y()};
      if (!residuals_px[i].empty()) {
        numbers.insert(numbers.end(), {residuals_px[i][k].x(), residuals_px[i][k].y()});
      }
      text += row(numbers, orientation);
    }
  }
  return text;
}

FoundCorners parse_corners(std::string_view text, const std::string& file) {
  const CornerTable table(text, file);
  FoundCorners found;
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const int width = table.size(row, "width_px");
    const int height = table.size(row, "height_px");
    if (row > 0 && (width != found.width_px || height != found.height_px)) {
      table.fail(row, "width_px", "pictures of one camera have one size");
    }
    found.width_px = width;
    found.height_px = height;
    add_row(table, row, found);
  }
  if (found.names.empty()) {
    throw ConfigError(fmt::format("{}: has no corners", file));
  }
  return found;
}

void check_corners(const FoundCorners& found, const Board& board, const std::string& file) {
  for (const BoardView& view : found.views) {
    for (const Eigen::Vector3d& at_mm : view.board_mm) {
      if (!has_corner(board, at_mm)) {
        throw ConfigError(fmt::format(
            "{}: has a corner at {:g}, {:g} mm, where the board given has none ({} x {} corners, "
            "squares of {:g} mm): its corners were found with another board",
            file,
            at_mm.x(),
            at_mm.y(),
            board.cols,
            board.rows,
            board.square_mm));
      }
    }
  }
}

}  // namespace glint
