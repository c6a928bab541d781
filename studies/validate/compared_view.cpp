// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/compared_view.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "metrics/inspection/inspector.h"
#include "metrics/overlap/edge_location.h"
#include "studies/compare/compare_page.h"
#include "studies/compare/compare_result.h"
#include "studies/compare/inspected_pair.h"
#include "studies/run/render_study.h"
#include "studies/run/render_views.h"

namespace glint::validate_detail {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMinContrast = 0.02;  ///< fainter ones are noise

std::string folder_name(std::size_t index) {
  return fmt::format("view_{:02}", index + 1);
}

Study study_of(const SceneSettings& scene, const fs::path& file) {
  ConfigNode root = write_scene(scene);
  write_file(file, fmt::format("schema = {}\n{}", needs_schema_2(scene) ? 2 : 1, to_toml(root)));
  return load_study(file, {});
}

/// Median of the variances of the edges' blur along outlines; empty: no edges.
std::optional<double> edge_variance(const ImageF& picture, std::span<const Boundary> outlines) {
  std::vector<double> variances;
  for (const LocatedEdge& edge : locate_edges(picture, outlines)) {
    variances.push_back(edge.spread_px * edge.spread_px);
  }
  if (variances.size() < 50) {
    return std::nullopt;
  }
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return *middle;
}

bool are_apart(const Estimate& simulated, const Estimate& real, double share) {
  const double scale = std::max(std::abs(simulated.value), std::abs(real.value));
  return std::abs(simulated.value - real.value) > share * scale &&
         (simulated.high < real.low || real.high < simulated.low);
}

SeenContrasts contrasts_of(const InspectedPair& pair, double share) {
  SeenContrasts seen = {.defects = static_cast<int>(pair.known.size()),
                        .found_simulated = pair.simulated.found,
                        .found_real = pair.real.found};
  for (std::size_t i = 0; i < pair.known.size(); ++i) {
    const SeenDefect& first = pair.simulated.defects[i];
    const SeenDefect& second = pair.real.defects[i];
    seen.defects_simulated += first.is_beyond_picture ? 0 : 1;
    seen.defects_real += second.is_beyond_picture ? 0 : 1;
    const std::string_view kind =
        kind_name(pair.known[i].is_line() ? DefectKind::kScratch : DefectKind::kHole);
    seen.right_simulated += first.found_as == kind ? 1 : 0;
    seen.right_real += second.found_as == kind ? 1 : 0;
    if (first.is_found && second.is_found) {
      ++seen.found_both;
      seen.same_class += first.found_as == second.found_as ? 1 : 0;
    }
    if (first.contrast && second.contrast && std::abs(first.contrast->value) > kMinContrast) {
      ++seen.seen;
      seen.apart += are_apart(*first.contrast, *second.contrast, share) ? 1 : 0;
    }
  }
  return seen;
}

}  // namespace

void SeenContrasts::add(const SeenContrasts& other) {
  seen += other.seen;
  apart += other.apart;
  defects += other.defects;
  defects_simulated += other.defects_simulated;
  defects_real += other.defects_real;
  found_simulated += other.found_simulated;
  found_real += other.found_real;
  right_simulated += other.right_simulated;
  right_real += other.right_real;
  same_class += other.same_class;
  found_both += other.found_both;
}

SceneSettings with_views(SceneSettings scene, const std::vector<Viewpoint>& views) {
  scene.viewpoints = views;
  for (Viewpoint& viewpoint : scene.viewpoints) {
    viewpoint.base_from_flange.reset();
  }
  scene.viewpoint_set.source = ViewpointSource::kListed;
  scene.reference.reset();
  return scene;
}

std::vector<CompareSource> render_for(const SceneSettings& scene,
                                      const std::vector<Viewpoint>& views,
                                      const fs::path& folder,
                                      int threads) {
  make_folder(folder);
  if (allows_many_viewpoints(scene)) {
    const Study study = study_of(with_views(scene, views), folder / "views.toml");
    render_views(study,
                 {.out = folder / "views", .threads = threads, .progress = Progress::Style::kNone});
    return compare_sources(folder / "views");
  }
  std::vector<CompareSource> sources;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string name = folder_name(i);
    const Study study = study_of(with_views(scene, {views[i]}), folder / (name + ".toml"));
    render_study(study, folder / name, threads);
    sources.push_back(compare_sources(folder / name / "baseline").front());
    sources.back().name = name;
  }
  return sources;
}

std::optional<double> blur_difference(const ComparedPair& pair) {
  const auto simulated = edge_variance(pair.simulated.grey, pair.geometry.outlines.simulated.rough);
  const auto real = edge_variance(pair.real.grey, pair.geometry.outlines.real.rough);
  return simulated && real ? std::optional(*real - *simulated) : std::nullopt;
}

SeenContrasts inspect_both(const ComparedPair& pair, double share, ThreadPool& pool, Json& row) {
  try {
    if (const auto inspected = inspect_pair(pair, pool)) {
      row["inspection"] = inspection_json(*inspected);
      return contrasts_of(*inspected, share);
    }
  } catch (const ConfigError& error) {
    row["notes"].push_back(fmt::format("Not inspected: {}", error.what()));
  }
  return {};
}

void write_pair(const ComparedPair& pair, const fs::path& folder) {
  make_folder(folder);
  write_exr(folder / "difference.exr", residual_picture(pair.exposed, pair.real.grey));
  write_png(folder / "simulated.png", pair.exposed, PixelDepth::k16Bit);
  write_file(folder / "overlay.png", png_bytes(overlay_of(pair)));
}

}  // namespace glint::validate_detail
