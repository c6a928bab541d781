// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/place_file.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "studies/calibrate/point_table.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

std::array<std::size_t, 3> columns_of(const PointTable& table, const std::string& before) {
  return {
      table.column(before + "x_mm"), table.column(before + "y_mm"), table.column(before + "z_mm")};
}

/// As the table names it, or by its number.
std::string name_of(const PointTable& table, std::size_t row) {
  const auto column = table.find("name");
  return column ? table.field(row, *column).text : fmt::format("{}", row + 1);
}

TouchedPoints touched_points(const PointTable& table) {
  const auto part = columns_of(table, "");
  const auto base = columns_of(table, "base_");
  TouchedPoints points;
  for (std::size_t i = 0; i < table.size(); ++i) {
    points.names.push_back(name_of(table, i));
    points.part_mm.push_back(table.point(i, part));
    points.base_mm.push_back(table.point(i, base));
  }
  return points;
}

/// Across an edge; none where both fields are empty.
std::optional<Vector2d> normal_of(const PointTable& table, std::size_t row) {
  const auto u = table.find("normal_u");
  if (!u.has_value()) {
    return std::nullopt;
  }
  const std::size_t v = table.column("normal_v");
  if (table.field(row, *u).text.empty() && table.field(row, v).text.empty()) {
    return std::nullopt;
  }
  const Vector2d normal(table.number(row, *u), table.number(row, v));
  if (!(normal.norm() > 0.0)) {
    throw ConfigError(fmt::format("{}normal_u and normal_v are 0, must point across the edge",
                                  table.field(row, *u).place.prefix()));
  }
  return normal.normalized();
}

std::vector<SeenPoint> seen_points(const PointTable& table) {
  const std::size_t picture = table.column("picture");
  const auto part = columns_of(table, "");
  const std::size_t u = table.column("u_px");
  const std::size_t v = table.column("v_px");
  std::vector<SeenPoint> points;
  for (std::size_t i = 0; i < table.size(); ++i) {
    points.push_back({.name = name_of(table, i),
                      .picture = table.field(i, picture).text,
                      .part_mm = table.point(i, part),
                      .pixel_px = Vector2d(table.number(i, u), table.number(i, v)),
                      .normal = normal_of(table, i)});
    if (points.back().picture.empty()) {
      throw ConfigError(fmt::format("{}picture is empty", table.field(i, picture).place.prefix()));
    }
  }
  return points;
}

PlaceFile place_table(std::string_view text, const std::string& file) {
  const PointTable table(
      text,
      file,
      "touched points have x_mm, y_mm, z_mm, base_x_mm, base_y_mm, base_z_mm; points in pictures "
      "picture, x_mm, y_mm, z_mm, u_px, v_px");
  if (table.find("picture").has_value()) {
    return seen_points(table);
  }
  return touched_points(table);
}

Eigen::Isometry3d pose_of(const MeasuredPoseSettings& settings) {
  const RigidTransform transform = transform_of(settings.pose);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = transform.rotation;
  pose.translation() = transform.translation_mm;
  return pose;
}

Matrix6d covariance_of(const MeasuredPoseSettings& settings) {
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Index>(i);
    covariance(k, k) = settings.sigma_rad[i] * settings.sigma_rad[i];
    covariance(k + 3, k + 3) = settings.sigma_mm[i] * settings.sigma_mm[i];
  }
  return covariance;
}

/// The tables that a file may have.
struct PlaceTables {
  int schema = 1;
  std::optional<MeasuredPoseSettings> board_from_part;
  std::optional<MeasuredPoseSettings> part_from_board;
  CellSettings cell;
};

void visit_keys(KeyVisitor& keys, PlaceTables& tables) {
  keys.integer("schema", tables.schema, Range::at_least(1), "of a placement's file");
  keys.optional_table(
      "board_from_part", tables.board_from_part, "where the part is as the board sees it");
  keys.optional_table(
      "part_from_board", tables.part_from_board, "where the board is as the part sees it");
  keys.table(
      "cell", [&](KeyVisitor& inner) { visit_keys(inner, tables.cell); }, "an earlier placement");
}

PlaceFile place_settings(std::string_view text, const std::string& file) {
  const ConfigNode root = parse_toml(text, file);
  PlaceTables tables;
  std::vector<Problem> errors;
  KeyReader reader(&root, "", errors);
  visit_keys(reader, tables);
  reader.report_unknown();
  throw_if_any(errors);
  const auto& base = tables.cell.base_from_part;
  const auto& flange = tables.cell.flange_from_part;
  const int given = (tables.board_from_part ? 1 : 0) + (tables.part_from_board ? 1 : 0) +
                    (base || flange ? 1 : 0);
  if (given != 1) {
    throw ConfigError(
        fmt::format("{}: has {} of [board_from_part], [part_from_board] and [cell.base_from_part], "
                    "must have one",
                    file,
                    given));
  }
  if (tables.board_from_part) {
    return BoardOffset{.board_from_part = pose_of(*tables.board_from_part),
                       .part_covariance = covariance_of(*tables.board_from_part)};
  }
  if (tables.part_from_board) {
    return BoardOffset{.board_from_part = pose_of(*tables.part_from_board).inverse(),
                       .board_covariance = covariance_of(*tables.part_from_board)};
  }
  const MeasuredPoseSettings& pose = base ? *base : *flange;
  return EarlierPlacement{
      .placed = {.base_from_part = pose_of(pose), .covariance = covariance_of(pose)},
      .is_on_flange = !base};
}

}  // namespace

PlaceFile parse_place_file(std::string_view text,
                           const std::string& file,
                           std::string_view ending) {
  if (ending == ".csv") {
    return place_table(text, file);
  }
  if (ending == ".toml") {
    return place_settings(text, file);
  }
  throw ConfigError(
      fmt::format("{}: must be a .csv file of points, or a .toml file of a board on the part or of "
                  "an earlier placement",
                  file));
}

PlaceFile read_place_file(const std::filesystem::path& file) {
  return parse_place_file(read_file(file), file.string(), file.extension().string());
}

MeasuredPoseSettings measured_pose(const PlacedPart& placed) {
  MeasuredPoseSettings settings = {
      .pose = pose_settings({.rotation = placed.base_from_part.linear(),
                             .translation_mm = placed.base_from_part.translation()})};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Index>(i);
    settings.sigma_rad[i] = std::sqrt(placed.covariance(k, k));
    settings.sigma_mm[i] = std::sqrt(placed.covariance(k + 3, k + 3));
  }
  return settings;
}

}  // namespace glint
