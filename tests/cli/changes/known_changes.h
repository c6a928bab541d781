// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that differ by known changes, rendered with other noise, and what `glint compare` says
// of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/compare/causes.h"
#include "studies/compare/refined_scene.h"
#include "tests/cli/changes/change_list.h"
#include "tests/cli/program.h"

namespace glint::test {

/// What was said of one case.
struct CaseVerdict {
  int named = 0;            ///< of the changes, itself or a group that it is in
  int others = 0;           ///< causes that are none of the changes
  std::vector<double> off;  ///< value minus truth over sigma, of those named by themselves
  std::vector<double> gain_off = {};  ///< the same of the gain, where it was changed and named
  std::vector<double> over;           ///< sigma over the Cramer-Rao bound, of the same
  /// The same over the bound that holds while the partners of a group are free, too; beside no
  /// group both are equal.
  std::vector<double> over_open;
};

/// A gear seen at an angle, as in the gallery, with the noise and the blur of a sensor.
class ChangedGear {
 public:
  /// @param width_px  of a picture of the same field, 612 : 512
  /// @param change  of a key of the scene; empty: none
  /// @param distance  of the camera, in those of the gallery: at 0.8 the gear fills the picture
  ChangedGear(int width_px, int samples, const std::string& change = "", double distance = 1.0)
      : width_px_(width_px), samples_(samples), distance_(distance) {
    if (!change.empty()) {
      set(change);
    }
    write_file(folder_ / "gear.toml", scene_text());
    render("gear.toml", "base", 1);
    std::vector<Problem> errors;
    scene_ = read_scene(load_toml(folder_ / "base/baseline/scene.toml"), errors);
    throw_if_any(errors);
    middle_mm_ = find_causes(pair_with("base/baseline")).middle_mm;
  }

  /// Causes between the scene and the same with the changes, which changed.toml holds.
  /// @param options  further ones of `glint compare`
  /// @param gain  of the changed picture's sensor over the scene's
  /// @param rougher  what is added to the roughness of its metal
  nlohmann::json causes_of(std::span<const Change> changes,
                           int seed,
                           const Arguments& options = {},
                           double gain = 1.0,
                           double rougher = 0.0) {
    PairCauses causes = {.edges = CauseFit{}};
    causes.gain = gain;
    causes.roughness_change = rougher;
    for (const Change& change : changes) {
      causes.edges->changes[static_cast<std::size_t>(change.parameter)] = change.value;
      causes.edges->causes.push_back({.parameter = change.parameter, .value = change.value});
    }
    causes.middle_mm = middle_mm_;
    write_file(folder_ / "changed.toml", to_toml(write_scene(refined_scene(scene_, causes))));
    render("changed.toml", "changed", seed);
    Arguments arguments = {
        "compare", "base/baseline", "changed/baseline", "--quiet", "--out", "compared"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const nlohmann::json result = json_of(folder_, arguments);
    last_pair_ = result["pairs"][0];
    return last_pair_["causes"];
  }

  double roughness() const { return scene_.material.roughness; }

  /// A key of the changed scene, as --set has it, in all that follows.
  void set(const std::string& key_and_value) { set_.insert(set_.end(), {"--set", key_and_value}); }

  /// The cause of that name; null: none.
  static nlohmann::json named(const nlohmann::json& causes, const std::string& name) {
    const auto found = std::ranges::find_if(
        causes, [&](const nlohmann::json& cause) { return cause["name"] == name; });
    return found == causes.end() ? nlohmann::json() : *found;
  }

  /// The scene is rendered anew, too: one simulated picture's noise would be an error that all
  /// cases have in common.
  /// @param rougher  what is added to the roughness of the metal; not 0: `--roughness` is given
  CaseVerdict verdict_of(std::span<const Change> changes,
                         int seed,
                         double gain = 1.0,
                         double rougher = 0.0) {
    render("gear.toml", "base", 1000 + seed);
    const Arguments options = rougher != 0.0 ? Arguments{"--roughness"} : Arguments{};
    const nlohmann::json causes = causes_of(changes, seed, options, gain, rougher);
    const std::vector<double> bounds = bounds_of(changes);
    const std::vector<double> open = bounds_of(with_partners(changes, causes));
    CaseVerdict verdict;
    std::size_t of_edges = 0;
    for (const nlohmann::json& cause : causes) {
      of_edges += cause["of"] == "edges" ? 1U : 0U;
    }
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const nlohmann::json cause = find(causes, changes[i].parameter);
      if (cause.is_null()) {
        continue;
      }
      ++verdict.named;
      if (cause["name"] == name_of(changes[i].parameter) && !cause.contains("group")) {
        const double per = told_per_inner(changes[i].parameter);
        const double sigma = cause["sigma"].get<double>();
        verdict.off.push_back((cause["value"].get<double>() - per * changes[i].value) / sigma);
        verdict.over.push_back(sigma / (per * bounds[i]));
        verdict.over_open.push_back(sigma / (per * open[i]));
      }
    }
    verdict.others = std::max(0, static_cast<int>(of_edges) - verdict.named);
    add_gain(causes, gain, verdict);
    add_roughness_of(causes, rougher, verdict);
    return verdict;
  }

  /// What was said last, of the pair and of its causes.
  const nlohmann::json& last_pair() const { return last_pair_; }

  std::string last() const { return last_pair_["causes"].dump(); }

  const std::filesystem::path& folder() const { return folder_.path(); }

  /// The cause of that name, or one that it cannot be told from; null: none.
  static nlohmann::json find(const nlohmann::json& causes, CauseParameter parameter) {
    for (const nlohmann::json& cause : causes) {
      const nlohmann::json group = cause.value("group", nlohmann::json::array());
      if (cause["name"] == name_of(parameter) ||
          std::ranges::count(group, nlohmann::json(name_of(parameter))) > 0) {
        return cause;
      }
    }
    return nullptr;
  }

 private:
  static constexpr double kBlurPx = 0.8;  ///< of the sensor

  static void add_gain(const nlohmann::json& causes, double gain, CaseVerdict& verdict) {
    const nlohmann::json cause = named(causes, "gain");
    if (cause.is_null()) {
      return;
    }
    if (gain == 1.0) {
      ++verdict.others;
      return;
    }
    ++verdict.named;
    verdict.gain_off.push_back((cause["value"].get<double>() - gain) /
                               cause["sigma"].get<double>());
  }

  void add_roughness_of(const nlohmann::json& causes, double rougher, CaseVerdict& verdict) const {
    const nlohmann::json cause = named(causes, "roughness");
    if (cause.is_null()) {
      return;
    }
    const double sigma = cause["sigma"].get<double>();
    const double over = sigma / roughness_bound(pair_with("changed/baseline"), kBlurPx);
    ++verdict.named;
    verdict.off.push_back((cause["value"].get<double>() - rougher) / sigma);
    verdict.over.push_back(over);
    verdict.over_open.push_back(over);
  }

  /// And all that the causes cannot be told from.
  static std::vector<Change> with_partners(std::span<const Change> changes,
                                           const nlohmann::json& causes) {
    std::vector<Change> all(changes.begin(), changes.end());
    for (const Change& other : known_changes()) {
      const auto is_same = [&](const Change& change) {
        return change.parameter == other.parameter;
      };
      const nlohmann::json cause = find(causes, other.parameter);
      if (!cause.is_null() && cause.contains("group") && std::ranges::none_of(all, is_same)) {
        all.push_back(other);
      }
    }
    return all;
  }

  std::string scene_text() const {
    const int height = width_px_ * 512 / 612;
    return fmt::format(
        "schema = 1\ninclude = [\"{}/studies/gallery/viewpoints/scene.toml\"]\n"
        "[camera]\nwidth_px = {}\nheight_px = {}\npixel_um = {}\n"
        "[viewpoints]\nsource = \"listed\"\n"
        "[[viewpoint]]\nposition_mm = [{}, {}, {}]\n"
        "direction = [-0.8539, -0.31184, 0.41667]\nup = [0, 0, 1]\n"
        "[sensor]\nfull_well_e = 10000\nread_noise_e = 10\nblur_px = {}\n"
        "[render.paths]\nsamples = {}\n",
        GLINT_SOURCE_DIR,
        width_px_,
        height,
        13.8 * 612.0 / width_px_,
        124.669 * distance_,
        45.529 * distance_,
        -60.833 * distance_,
        kBlurPx,
        samples_);
  }

  void render(const std::string& scene, const std::string& out, int seed) const {
    Arguments arguments = {"render",
                           scene,
                           "--quiet",
                           "--set",
                           "render.paths.seed=" + std::to_string(seed),
                           "--set",
                           "sensor.seed=" + std::to_string(seed),
                           "--out",
                           out};
    arguments.insert(arguments.end(), set_.begin(), set_.end());
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, 0) << result.err;
  }

  /// Cramer-Rao bounds of the changes were they all that differs: by the noise of single edges and
  /// how edges move with each change. Neighbouring edges share two of their three lines, so n of
  /// them tell what n / 3 independent ones do; and greys beside an edge, were they known, would
  /// halve the variance (LocateEdges.OfAWholeEdgeAreNearlyAsGoodAsItsPixelsAllow).
  std::vector<double> bounds_of(std::span<const Change> changes) const {
    if (changes.empty()) {
      return {};
    }
    const ComparedPair pair = pair_with("changed/baseline");
    const PairCauses causes = find_causes(pair);
    const std::vector<SpaceEdge> edges = space_edges(pair, scene_);
    const PinholeIntrinsics camera = intrinsics_of(scene_);
    const auto count = static_cast<Eigen::Index>(changes.size());
    Eigen::MatrixXd slopes(static_cast<Eigen::Index>(edges.size()), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Change& change = changes[static_cast<std::size_t>(k)];
      CauseVector moved = {};
      const double step = 0.01 * change.value;
      moved[static_cast<std::size_t>(change.parameter)] = step;
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto pixel = [&](const CauseVector& by) {
          return changed_pixel(camera, causes.middle_mm, by, edges[i].in_camera_mm);
        };
        slopes(static_cast<Eigen::Index>(i), k) =
            edges[i].normal.dot(pixel(moved) - pixel({})) / step;
      }
    }
    constexpr double kOfEdges = 3.0 / 2.0;
    const Eigen::MatrixXd covariance = kOfEdges * causes.edges->noise_px * causes.edges->noise_px *
                                       (slopes.transpose() * slopes).eval().inverse();
    std::vector<double> bounds;
    for (Eigen::Index k = 0; k < count; ++k) {
      bounds.push_back(std::sqrt(covariance(k, k)));
    }
    return bounds;
  }

  ComparedPair pair_with(const std::string& real) const {
    return compare_pair({.simulated = source_in("base/baseline"), .real = source_in(real)}, {});
  }

  CompareSource source_in(const std::string& view) const {
    return compare_sources(folder_ / view).front();
  }

  TemporaryFolder folder_;
  int width_px_;
  int samples_;
  double distance_;
  SceneSettings scene_;
  Eigen::Vector3d middle_mm_ = Eigen::Vector3d::Zero();  ///< of what is seen; turns are about it
  nlohmann::json last_pair_;
  Arguments set_;
};

}  // namespace glint::test
