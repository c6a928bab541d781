// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/place_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/place_file.h"
#include "studies/calibrate/place_pictures.h"
#include "studies/calibrate/settings_from_sets.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Fewer hardly tell a standard deviation: of two it is itself known to 60 %, of five to 34 %.
constexpr std::size_t kFewPlacements = 5;

const std::array<std::string, 3> place_files = {"placement.toml", "placement.json", "run.json"};

/// Keys of --set place.; 0: from what remains.
struct PlaceSettings {
  double sigma_mm = 0.0;
  double sigma_px = 0.0;
};

void visit_keys(KeyVisitor& keys, PlaceSettings& s) {
  keys.number("sigma_mm",
              s.sigma_mm,
              Range::at_least(0),
              "of a touched point along one axis; 0 = from what remains");
  keys.number("sigma_px",
              s.sigma_px,
              Range::at_least(0),
              "of a point in a picture along one axis; 0 = from what remains");
}

/// What the readers of poses take.
std::vector<KeyValue> sets_of_poses(const std::vector<KeyValue>& sets) {
  std::vector<KeyValue> others;
  for (const KeyValue& set : sets) {
    if (!is_of_table(set, "place")) {
      if (!set.path.starts_with("convention.") && !set.path.starts_with("poses.")) {
        throw ConfigError(fmt::format(
            "--set: {}: must begin with \"place.\", like place.sigma_mm=0.05, \"convention.\" or "
            "\"poses.\"",
            set.path));
      }
      others.push_back(set);
    }
  }
  return others;
}

/// Root of the sum of three variances.
double sigma_of(const Matrix6d& covariance, Index first) {
  return std::sqrt(covariance.diagonal().segment<3>(first).sum());
}

Json pose_json(const PlacedPart& placed, bool is_on_flange) {
  Json rows = Json::array();
  for (Index i = 0; i < 6; ++i) {
    Json row = Json::array();
    for (Index k = 0; k < 6; ++k) {
      row.push_back(placed.covariance(i, k));
    }
    rows.push_back(std::move(row));
  }
  const bool is_known = !placed.covariance.isZero(0.0);
  const auto known = [&](double sigma) { return is_known ? Json(sigma) : Json(nullptr); };
  return {{"from", "part"},
          {"to", is_on_flange ? "flange" : "base"},
          {"rotation_vector_rad", vector_json(rotation_vector_rad(placed.base_from_part.linear()))},
          {"translation_mm", vector_json(placed.base_from_part.translation())},
          {"sigma_deg", known(sigma_of(placed.covariance, 0) * kDegPerRad)},
          {"sigma_mm", known(sigma_of(placed.covariance, 3))},
          {"covariance", std::move(rows)}};
}

// --- Touched points ------------------------------------------------------------------------------

Placement by_touch(const TouchedPoints& points, const fs::path& file, double sigma_mm) {
  const auto sigma = sigma_mm > 0.0 ? std::optional(sigma_mm) : std::nullopt;
  const auto placed = place_by_points(points.part_mm, points.base_mm, sigma);
  if (!placed.has_value()) {
    throw ConfigError(
        fmt::format("{}: {} points do not determine the part's place: it needs 3 that are not on "
                    "one line, or 4 "
                    "where --set place.sigma_mm does not say how well they were touched",
                    file.string(),
                    points.names.size()));
  }
  Json list = Json::array();
  for (std::size_t i = 0; i < points.names.size(); ++i) {
    const Vector3d off = placed->base_from_part * points.part_mm[i] - points.base_mm[i];
    list.push_back({{"name", points.names[i]}, {"distance_mm", off.norm()}});
  }
  return {.placed = *placed,
          .told = {{"by", "touched points"}, {"rms_mm", placed->rms}, {"points", std::move(list)}}};
}

// --- Several placements --------------------------------------------------------------------------

Placement placement_of(const fs::path& file,
                       const CalibrateOptions& options,
                       const PlaceSettings& settings) {
  const PlaceFile read = read_place_file(file);
  Placement placement;
  if (const auto* touched = std::get_if<TouchedPoints>(&read)) {
    placement = by_touch(*touched, file, settings.sigma_mm);
  } else if (const auto* seen = std::get_if<std::vector<SeenPoint>>(&read)) {
    placement = place_by_seen_points(*seen, file, options, settings.sigma_px);
  } else if (const auto* offset = std::get_if<BoardOffset>(&read)) {
    placement = place_by_seen_board(*offset, options);
  } else {
    const auto& earlier = std::get<EarlierPlacement>(read);
    placement = {.placed = earlier.placed,
                 .is_on_flange = earlier.is_on_flange,
                 .told = {{"by", "placement"}}};
  }
  Json told = {{"file", file.string()}};
  told.update(placement.told);
  told["pose"] = pose_json(placement.placed, placement.is_on_flange);
  placement.told = std::move(told);
  return placement;
}

/// The mean of placements and how well the next one is known: along each axis by how far it lies
/// from a mean of so few, or by what is known of each, whichever is more.
struct Joined {
  PlacedPart placed;
  Json spread;
};

Joined joined(const std::vector<Placement>& placements) {
  if (placements.size() == 1) {
    return {.placed = placements[0].placed, .spread = nullptr};
  }
  std::vector<Isometry3d> poses;
  for (const Placement& placement : placements) {
    poses.push_back(placement.placed.base_from_part);
  }
  const auto count = static_cast<double>(poses.size());
  Joined result{.placed = {.base_from_part = mean_pose(poses)}};
  Matrix6d apart = Matrix6d::Zero();
  Matrix6d known = Matrix6d::Zero();
  double farthest_mm = 0.0;
  for (const Placement& placement : placements) {
    const Vector6d step =
        six_of(result.placed.base_from_part.inverse() * placement.placed.base_from_part);
    apart += step * step.transpose() / (count - 1.0);
    known += placement.placed.covariance / count;
    farthest_mm = std::max(farthest_mm, step.tail<3>().norm());
  }
  // The next one lies as far from the true mean as these, which is known to a count-th of that.
  const Matrix6d next = (1.0 + 1.0 / count) * apart;
  // What is known of each, as far as it is more than how far they lie apart, is added.
  const Vector6d more = (known.diagonal() - next.diagonal())
                            .cwiseMax(0.0)
                            .cwiseQuotient(known.diagonal().cwiseMax(1e-300))
                            .cwiseSqrt();
  result.placed.covariance = next + more.asDiagonal() * known * more.asDiagonal();
  result.spread = {{"placements", placements.size()},
                   {"deg", sigma_of(apart, 0) * kDegPerRad},
                   {"mm", sigma_of(apart, 3)},
                   {"farthest_mm", farthest_mm},
                   {"known_deg", sigma_of(known, 0) * kDegPerRad},
                   {"known_mm", sigma_of(known, 3)}};
  return result;
}

void check_same_parent(const std::vector<PlaceInput>& inputs,
                       const std::vector<Placement>& placements) {
  for (std::size_t i = 1; i < placements.size(); ++i) {
    if (placements[i].is_on_flange != placements[0].is_on_flange) {
      throw ConfigError(fmt::format("{}: is of a part {}, {} of one {}",
                                    inputs[i].file.string(),
                                    placements[i].is_on_flange ? "on the flange" : "in the cell",
                                    inputs[0].file.string(),
                                    placements[0].is_on_flange ? "on the flange" : "in the cell"));
    }
  }
}

std::string placement_toml(const PlacedPart& placed, bool is_on_flange) {
  CellSettings cell;
  (is_on_flange ? cell.flange_from_part : cell.base_from_part) = measured_pose(placed);
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, cell);
  ConfigNode root = ConfigNode::table();
  set_path(root, "schema", ConfigNode::from_integer(kNewestSchema));
  set_path(root, "cell", std::move(table));
  return "# glint calibrate --place: include = [\"placement.toml\"] in a scene puts the part "
         "here\n" +
         to_toml(root);
}

/// What tells where the part is.
std::vector<fs::path> files_placed(const std::vector<PlaceInput>& inputs) {
  std::vector<fs::path> files;
  for (const PlaceInput& input : inputs) {
    files.push_back(input.file);
  }
  return files;
}

void check_files(const std::vector<PlaceInput>& inputs,
                 const CalibrateOptions& options,
                 const fs::path& out) {
  check_result_folder(out, ResultKind::kPlace, place_files);
  std::vector<fs::path> files = options.pictures;
  files.insert(files.end(), options.poses.begin(), options.poses.end());
  files.push_back(options.board);
  for (const PlaceInput& input : inputs) {
    files.push_back(input.file);
    files.insert(files.end(), input.poses.begin(), input.poses.end());
  }
  check_inputs_kept(files, out, place_files);
  if (options.out.empty()) {
    check_source_of_folder(out, files_placed(inputs));
  }
}

Json notes_of(const std::vector<Placement>& placements, const PlacedPart& placed) {
  Json notes = Json::array();
  for (const Placement& placement : placements) {
    const std::string file = placement.told["file"].get<std::string>();
    if (placement.told.value("point_sigma", "") == "assumed") {
      notes.push_back(fmt::format(
          "{}: too few points to estimate how well they were found: 0.5 px; --set place.sigma_px "
          "overrules",
          file));
    }
    if (placement.told.contains("note")) {
      notes.push_back(fmt::format("{}: {}", file, placement.told["note"].get<std::string>()));
    }
    if (placement.placed.covariance.isZero(0.0)) {
      notes.push_back(fmt::format("{}: how well the place is known is not stated{}{}",
                                  file,
                                  placement.why_unknown.empty() ? "" : ": ",
                                  placement.why_unknown));
    }
  }
  if (placements.size() > 1 && placed.covariance.isZero(0.0)) {
    notes.push_back("the placements are all alike, so they do not show how well the next is known");
  } else if (placements.size() > 1 && placements.size() < kFewPlacements) {
    notes.push_back(
        fmt::format("how far the next part may lie off is estimated from {} placements; {} or more "
                    "tell it better",
                    placements.size(),
                    kFewPlacements));
  }
  return notes;
}

}  // namespace

Json place_part(const std::vector<PlaceInput>& inputs, const CalibrateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const fs::path out =
      options.out.empty()
          ? default_result_folder(inputs.front().file.stem().string(), ResultKind::kPlace)
          : options.out;
  check_files(inputs, options, out);
  const auto settings = settings_from_sets<PlaceSettings>(options.sets, "place");
  CalibrateOptions reading = options;
  reading.sets = sets_of_poses(options.sets);
  std::vector<Placement> placements;
  for (const PlaceInput& input : inputs) {
    reading.poses = input.poses.empty() ? options.poses : input.poses;
    placements.push_back(placement_of(input.file, reading, settings));
  }
  check_same_parent(inputs, placements);
  const Joined result = joined(placements);
  const bool is_on_flange = placements.front().is_on_flange;
  Json json = {{"schema", 1}, {"status", "done"}};
  json[is_on_flange ? "flange_from_part" : "base_from_part"] =
      pose_json(result.placed, is_on_flange);
  json["placements"] = Json::array();
  for (const Placement& placement : placements) {
    json["placements"].push_back(placement.told);
  }
  json["spread"] = result.spread;
  json["notes"] = notes_of(placements, result.placed);
  ResultWriter writer(out, ResultKind::kPlace);
  write_file(writer.path() / "placement.toml", placement_toml(result.placed, is_on_flange));
  write_file(writer.path() / "placement.json", json.dump(2) + "\n");
  writer.finish(
      {{"placements", placements.size()}, {"source", sources_seen_from(out, files_placed(inputs))}},
      start);
  json["folder"] = out.string();
  return json;
}

}  // namespace glint
