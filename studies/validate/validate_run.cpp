// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_run.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/log.h"
#include "core/median.h"
#include "core/wall_clock.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/compare/causes.h"
#include "studies/compare/compare_page.h"
#include "studies/compare/compare_result.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"
#include "studies/output/unreplaced_files.h"
#include "studies/validate/both_scores.h"
#include "studies/validate/compared_view.h"
#include "studies/validate/rescored_designs.h"
#include "studies/validate/validate_page.h"
#include "studies/validate/validate_result.h"
#include "studies/validate/validate_verdict.h"
#include "studies/validate/validated_scene.h"
#include "studies/validate/view_edges.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using validate_detail::SeenContrasts;

/// A light that is dead leaves black pictures: grey values are judged all the same.
ComparedPair compared(const CompareSource& simulated, const RealView& view) {
  return compare_pair(
      {.simulated = simulated, .real = {.name = view.name, .picture = view.picture}},
      {.may_be_plain = true});
}

std::optional<double> if_any(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(median(values));
}

class ValidateRun {
 public:
  explicit ValidateRun(const ValidateOptions& options)
      : options_(options),
        out_(options.out.empty() ? default_validate_folder(options.run) : options.out),
        pool_(options.threads),
        store_(pool_),
        sources_(find_validated(
            options.run, options.pictures, options.designs, options.calibration, store_)) {
    for (const LeftOutDesign& design : options.left_out) {
      sources_.left_out.push_back(design);
      sources_.notes.push_back(fmt::format("{} is left out: {}", design.name, design.reason));
    }
  }

  Json execute() {
    check_folder();
    OutputFolder folder(out_);
    remove_stale_stages(out_);
    StagedFolder stage(out_, "");
    const ValidatedDesign& first = sources_.designs.front();
    findings_.limits = first.scene.validate.value_or(ValidateSettings{});
    budget_ = budget_of(first.scene, sources_.notes);
    findings_.part_sigma = budget_.part_sigma;
    bar_.emplace("validate", steps(), options_.progress);
    compare_all(stage.path());
    fit_all();
    const ValidateVerdict verdict = judge(findings_);
    sources_.notes.insert(sources_.notes.end(), verdict.notes.begin(), verdict.notes.end());
    const bool is_of_twin = std::ranges::any_of(
        sources_.designs, [](const ValidatedDesign& design) { return design.real.is_of_twin; });
    if (is_of_twin) {
      sources_.notes.emplace_back(
          "The pictures are a simulated twin's: they show how the cell's programs work together, "
          "and nothing about a real part.");
    }
    Json result = result_json(verdict);
    result["twin"] = is_of_twin;
    result["refit"] = options_.is_refitting ? refit(stage.path()) : Json(nullptr);
    result["pairs"] = pairs_;
    result["notes"] = sources_.notes;
    result["report"] = "report.html";
    write_all(stage.path(), result);
    bar_.reset();
    const std::vector<fs::path> stale =
        unreplaced_files(out_, stage.path(), earlier_validation(out_), inputs());
    stage.commit();
    remove_unreplaced(out_, stale);
    folder.keep();
    result["report"] = (out_ / "report.html").string();
    result["folder"] = out_.string();
    return result;
  }

 private:
  /// A picture as fits need it.
  struct View {
    std::size_t design = 0;
    std::string name;
    ImageF real;
    double step = 0.0;
    Viewpoint viewpoint;
  };

  std::int64_t steps() const { return 2 * static_cast<std::int64_t>(sources_.designs.size()) + 2; }

  void show(const std::string& what) { bar_->update(++done_, what); }

  std::vector<fs::path> inputs() const {
    std::vector<fs::path> files = {options_.calibration};
    for (const ValidatedDesign& design : sources_.designs) {
      for (const RealView& view : design.real.views) {
        files.push_back(view.picture);
      }
    }
    return files;
  }

  void check_folder() const {
    std::vector<std::string> designs;
    for (const ValidatedDesign& design : sources_.designs) {
      designs.push_back(design.name);
    }
    const std::vector<std::string> names = validation_files(designs);
    check_result_folder(out_, ResultKind::kValidate, names);
    check_inputs_kept(inputs(), out_, names);
    if (options_.out.empty()) {
      check_default_validate_folder(options_.run, options_.pictures);
    }
  }

  void compare_all(const fs::path& stage) {
    if (sources_.is_calibrated) {
      compare_before(stage / kBeforeFolder);
    }
    for (std::size_t i = 0; i < sources_.designs.size(); ++i) {
      compare_design(i, stage / sources_.designs[i].name);
      show(sources_.designs[i].name);
    }
  }

  /// The first design as the run has it: without the calibration.
  void compare_before(const fs::path& folder) {
    const ValidatedDesign& design = sources_.designs.front();
    const auto sources = validate_detail::render_for(
        design.nominal, design.nominal_views, folder / "simulated", options_.threads);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const RealView& view = design.real.views[i];
      const ComparedPair pair = compared(sources[i], view);
      validate_detail::write_pair(pair, folder / view.name);
      before_.push_back(overlap_json(design.name, view.name, pair));
      before_pages_.push_back(page_pair(pair));
    }
    show("before the calibration");
  }

  void compare_design(std::size_t index, const fs::path& folder) {
    const ValidatedDesign& design = sources_.designs[index];
    const auto sources = validate_detail::render_for(
        design.scene, design.views, folder / "simulated", options_.threads);
    SeenContrasts seen;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const RealView& view = design.real.views[i];
      ComparedPair pair = compared(sources[i], view);
      validate_detail::write_pair(pair, folder / view.name);
      Json row = {{"design", design.name}, {"view", view.name}};
      row.update(pair_json(pair, {}));
      seen.add(validate_detail::inspect_both(pair, findings_.limits.contrast_share, pool_, row));
      pages_.push_back(page_pair(pair));
      pairs_.push_back(std::move(row));
      measure(pair, index, i);
    }
    seen_.push_back(seen);
  }

  /// What is kept of a pair.
  void measure(ComparedPair& pair, std::size_t index, std::size_t i) {
    const ValidatedDesign& design = sources_.designs[index];
    const RealView& view = design.real.views[i];
    if (pair.geometry.distance.points > 0) {
      distances_.push_back(pair.geometry.distance.mean_px);
    }
    if (pair.appearance.texture) {
      textures_.push_back(pair.appearance.texture->radial);
    }
    if (const auto blur = validate_detail::blur_difference(pair)) {
      blurs_.push_back(*blur);
    }
    ViewEdges edges = {.camera_from_scene = camera_from_world(design.views[i]),
                       .robot_sigma_mm = view.position_sigma_mm,
                       .robot_sigma_rad = view.rotation_sigma_rad};
    if (!pair.simulated.source.geometry.empty()) {
      const SceneSettings scene = validate_detail::with_views(design.scene, {design.views[i]});
      edges.edges = space_edges(pair, scene);
    }
    edges_.push_back(std::move(edges));
    const double step = camera_step(view, pair.real.grey, design.scene.sensor.bits);
    views_.push_back({.design = index,
                      .name = view.name,
                      .real = std::move(pair.real.grey),
                      .step = step,
                      .viewpoint = design.views[i]});
  }

  void fit_all() {
    budget_.middle_mm = middle_of_edges(edges_).value_or(budget_.middle_mm);
    const SceneSettings& scene = sources_.designs.front().scene;
    findings_.geometry = fit_geometry(edges_, intrinsics_of(scene), budget_);
    findings_.texture = if_any(textures_);
    findings_.blur_px2 = if_any(blurs_);
    if (!distances_.empty()) {
      findings_.distance_px = std::accumulate(distances_.begin(), distances_.end(), 0.0) /
                              static_cast<double>(distances_.size());
    }
    for (const SeenContrasts& seen : seen_) {
      findings_.contrasts += seen.seen;
      findings_.contrasts_apart += seen.apart;
    }
    fit_grey_values();
    rank();
  }

  /// The scene of a picture with what the edges say of lens and poses.
  SceneSettings fitted_scene(std::size_t view) const {
    const ValidatedDesign& design = sources_.designs[views_[view].design];
    SceneSettings scene = validate_detail::with_views(design.scene, {views_[view].viewpoint});
    const GeometryFit& fit = findings_.geometry;
    if (fit.is_known) {
      scene.viewpoints = {
          viewpoint_of_pose(refitted_view(fit, budget_, edges_[view].camera_from_scene, view))};
      put_lens_change(fit, scene);
    }
    return scene;
  }

  /// All designs together: their lights stand in one cell.
  void fit_grey_values() {
    std::vector<GreyDesign> grey(sources_.designs.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      grey[views_[v].design].views.push_back({.scene = fitted_scene(v),
                                              .real = views_[v].real,
                                              .step = views_[v].step,
                                              .pose = static_cast<int>(v)});
    }
    for (std::size_t i = 0; i < grey.size(); ++i) {
      grey[i].name = sources_.designs[i].name;
      score_views(i);
      show(grey[i].name + ": scores");
    }
    fit_exposures(grey);
    const double agree_share = options_.is_refitting ? 0.0 : findings_.limits.grey_share;
    const std::vector<GreyFit> fits =
        fit_grey(store_,
                 grey,
                 {.agree_share = agree_share, .camera_covariance = findings_.geometry.covariance});
    for (std::size_t i = 0; i < grey.size(); ++i) {
      findings_.grey.push_back({.design = grey[i].name, .fit = fits[i]});
    }
    show("grey values");
  }

  /// Takes those out whose light is not path traced: of these one exposure alone is fitted.
  void fit_exposures(std::vector<GreyDesign>& grey) {
    std::erase_if(grey, [](const GreyDesign& design) { return design.views.empty(); });
    const auto others =
        std::stable_partition(grey.begin(), grey.end(), [](const GreyDesign& design) {
          return allows_many_viewpoints(design.views.front().scene);
        });
    for (const GreyDesign& design : std::span(others, grey.end())) {
      GreyFit fit = {.is_exposure_only = true};
      try {
        fit = fit_exposure(store_, design);
      } catch (const ConfigError& error) {
        sources_.notes.push_back(
            fmt::format("{}: its grey values are not compared: {}", design.name, error.what()));
      }
      findings_.grey.push_back({.design = design.name, .fit = std::move(fit)});
    }
    grey.erase(others, grey.end());
  }

  void score_views(std::size_t index) {
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (views_[v].design == index) {
        score_view(index, v);
      }
    }
  }

  void score_view(std::size_t index, std::size_t view) {
    const std::string& name = sources_.designs[index].name;
    try {
      const BothScores both =
          scores_of_both(store_, fitted_scene(view), views_[view].real, wanted());
      scores_[name].push_back(both);
      sheet_.add(name, views_[view].name, both);
    } catch (const ConfigError& error) {
      sources_.notes.push_back(
          fmt::format("{}, {}: not scored: {}", name, views_[view].name, error.what()));
    }
  }

  WantedScores wanted() const {
    return {.fringes = false, .defects = true, .robust = true, .slot = false};
  }

  void rank() {
    findings_.rankings = sheet_.rankings(sources_.designs.size());
    for (const ObjectiveRanking& by : findings_.rankings) {
      if (!by.ranking) {
        sources_.notes.push_back(
            fmt::format("The designs are not ranked by {}: {}", by.objective, by.reason));
      }
    }
  }

  Json result_json(const ValidateVerdict& verdict) const {
    Json result = {{"schema", 1}, {"kind", "validation"}, {"status", "done"}};
    const Json told = verdict_json(verdict);
    result["agreement"] = told["agreement"];
    result["verdict"] = told["sentence"];
    result["causes"] = told["causes"];
    result["advice"] = told["advice"];
    result["undetermined"] = undetermined_json(undetermined_of(findings_));
    result["is_calibrated"] = sources_.is_calibrated;
    result["before"] = before_;
    result["edges"] = edges_json(findings_, verdict.edge_limit_px, before_);
    result["geometry"] = geometry_json(findings_.geometry);
    result["grey"] = grey_json(findings_);
    result["texture"] = texture_json(findings_);
    const Objective& objective = sheet_.objective();
    result["objective"] = {{"name", objective.name}, {"is_maximised", objective.is_maximised}};
    result["designs"] = Json::array();
    for (std::size_t i = 0; i < sources_.designs.size(); ++i) {
      result["designs"].push_back(design_json(i));
    }
    result["left_out"] = Json::array();
    for (const LeftOutDesign& design : sources_.left_out) {
      result["left_out"].push_back({{"name", design.name}, {"reason", design.reason}});
    }
    result["rankings"] = rankings_json(findings_.rankings);
    result["ranking"] =
        findings_.rankings.size() == 1 ? result["rankings"][0]["ranking"] : Json(nullptr);
    return result;
  }

  Json design_json(std::size_t index) const {
    const std::string& name = sources_.designs[index].name;
    const auto found = scores_.find(name);
    Json row = {{"name", name}, {"views", sources_.designs[index].real.views.size()}};
    row["scores"] = found == scores_.end() ? Json(nullptr) : both_scores_json(found->second);
    row["inspection"] = seen_json(seen_[index]);
    return row;
  }

  /// The refit scene of each design as a file, and all designs scored with it.
  Json refit(const fs::path& stage) {
    const DesignRefit refit = refit_of(findings_, budget_);
    for (const ValidatedDesign& design : sources_.designs) {
      write_file(stage / design.name / "refit.toml",
                 to_toml(write_scene(refitted_scene(store_, design.scene, refit, design.name))));
    }
    Json json = change_json(refit.change);
    json["exposures"] = refit.exposures;
    json["rescored"] =
        sources_.study
            ? rescore_designs(
                  store_, *sources_.study, options_.run, written_designs(sources_), refit)
            : Json(nullptr);
    if (json["rescored"].is_null()) {
      sources_.notes.emplace_back(
          "Whether the refit changes the winner cannot be decided without a study that has an "
          "objective");
    } else if (auto text = json["rescored"]["text"].get<std::string>(); !text.empty()) {
      sources_.notes.push_back(std::move(text));
    }
    return json;
  }

  void write_all(const fs::path& stage, const Json& result) const {
    write_file(stage / "result.json", result.dump(2) + "\n");
    write_file(stage / "report.html", validate_page(result, pages_, before_pages_));
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kValidate);
    run["designs"] = sources_.designs.size();
    run["pictures"] = views_.size();
    run["source"] = sources_seen_from(out_, {options_.run, options_.pictures});
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds_since(start_)}};
    write_file(stage / "run.json", run.dump(2) + "\n");
  }

  const ValidateOptions& options_;
  fs::path out_;
  ThreadPool pool_;
  SceneStore store_;
  ValidationSources sources_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::optional<Progress> bar_;
  std::int64_t done_ = 0;
  GeometryBudget budget_;
  ValidationFindings findings_;
  Json pairs_ = Json::array();
  Json before_ = Json::array();
  std::vector<PagePair> pages_;
  std::vector<PagePair> before_pages_;
  std::vector<ViewEdges> edges_;
  std::vector<View> views_;
  std::vector<SeenContrasts> seen_;  ///< of each design
  std::vector<double> distances_;
  std::vector<double> textures_;
  std::vector<double> blurs_;
  RankingSheet sheet_{sources_.study};
  std::map<std::string, std::vector<BothScores>> scores_;
};

}  // namespace

Json validate_run(const ValidateOptions& options) {
  return ValidateRun(options).execute();
}

}  // namespace glint
