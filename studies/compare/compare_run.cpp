// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compare_run.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "core/wall_clock.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/compare/compare_page.h"
#include "studies/compare/compare_result.h"
#include "studies/compare/compared_pair.h"
#include "studies/compare/earlier_pairs.h"
#include "studies/compare/geometry_passes.h"
#include "studies/compare/inspected_pair.h"
#include "studies/compare/refined_scene.h"
#include "studies/compare/surface_edges.h"
#include "studies/compare/yardstick.h"
#include "studies/definition/scene_file.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/run_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

fs::path default_folder(const CompareInputs& inputs) {
  const std::string name = name_within_run(inputs.simulated);
  return default_result_folder(name.empty() ? "comparison" : name, ResultKind::kCompare);
}

/// Of photographs the folder of the first: more of them may come.
std::vector<fs::path> sources_of(const CompareInputs& inputs) {
  std::error_code ignored;
  const fs::path& real = inputs.reals.front();
  return {inputs.simulated,
          fs::is_directory(real, ignored) ? real : fs::absolute(real).parent_path()};
}

/// A pair and why its pictures differ.
struct Explained {
  ComparedPair pair;
  std::string missing = {};  ///< of the geometry that tells why; empty: nothing
  PairCauses causes = {};
};

class CompareRun {
 public:
  explicit CompareRun(const CompareOptions& options)
      : options_(options),
        out_(options.out.empty() ? default_folder(options.inputs) : options.out),
        pool_(options.threads) {}

  Json execute() {
    plan_ = plan_comparison(options_.inputs);
    add_scene();
    check_scene_is_there();
    passes_.emplace(store_, plan_.pairs);
    check_folder();
    pair_options_ = {
        .real_mask = options_.mask,
        .outline = outline_choice(options_.outline),
        .exposure = options_.has_offset ? ExposureModel::kGainAndOffset : ExposureModel::kGain};
    camera_.is_lens_known = options_.is_lens_known;
    if (!options_.calibration.empty()) {
      camera_.calibrated = intrinsics_of(read_calibrated_scene(options_.calibration));
    }
    OutputFolder folder(out_);
    remove_stale_stages(out_);
    StagedFolder stage(out_, "");
    compare_all(stage.path());
    Json result = result_json();
    write_all(stage.path(), result);
    const std::vector<fs::path> stale = stale_files(out_, stage.path());
    stage.commit();
    remove_stale_files(out_, stale);
    folder.keep();
    result["report"] = (out_ / "report.html").string();
    result["folder"] = out_.string();
    result["timings"] = timings();
    return result;
  }

 private:
  /// Pictures that were given without what they were rendered from take --scene.
  void add_scene() {
    if (options_.scene.empty()) {
      return;
    }
    const SceneSettings scene = load_scene(options_.scene);
    if (scene.viewpoints.size() != 1 || scene.viewpoint_set.source != ViewpointSource::kListed) {
      throw ConfigError(fmt::format("--scene {}: must have one [[viewpoint]], that of the picture",
                                    options_.scene.string()));
    }
    bool is_used = false;
    for (ComparePair& pair : plan_.pairs) {
      if (!pair.simulated.is_rendered()) {
        pair.simulated.scene = options_.scene;
        is_used = true;
      }
    }
    if (!is_used) {
      throw ConfigError("--scene: all simulated pictures come with a scene of their own");
    }
  }

  /// Options that tell of a scene, where there is none, would change nothing.
  void check_scene_is_there() const {
    const auto is_rendered = [](const ComparePair& pair) { return pair.simulated.is_rendered(); };
    if (std::ranges::any_of(plan_.pairs, is_rendered)) {
      return;
    }
    if (!options_.calibration.empty() || options_.has_roughness || options_.is_lens_known) {
      throw ConfigError(fmt::format(
          "{}: no simulated picture is known with its scene; give the run's folder or --scene",
          !options_.calibration.empty() ? "--calibration"
          : options_.has_roughness      ? "--roughness"
                                        : "--calibrated"));
    }
  }

  void check_folder() const {
    const std::vector<std::string> files = {
        "result.json", "report.html", "run.json", "refined.toml"};
    std::vector<std::string> pairs;
    for (std::size_t i = 0; i < plan_.pairs.size(); ++i) {
      pairs.push_back(pair_folder(i));
    }
    std::vector<std::string> names = files;
    names.insert(names.end(), pairs.begin(), pairs.end());
    check_result_folder(out_, ResultKind::kCompare, names);
    const std::vector<std::string> earlier = earlier_pairs(out_);  // removed or replaced
    pairs.insert(pairs.end(), earlier.begin(), earlier.end());
    std::vector<fs::path> inputs = {
        options_.mask, options_.inputs.pairs, options_.calibration, options_.scene};
    for (const ComparePair& pair : plan_.pairs) {
      inputs.insert(inputs.end(), {pair.simulated.picture, pair.real.picture, pair.real_mask});
    }
    check_inputs_kept(inputs, out_, files);
    check_inputs_kept_in_pairs(inputs, out_, pairs);
    if (options_.out.empty()) {
      check_source_of_folder(out_, sources_of(options_.inputs));
    }
  }

  /// Pictures are large: as many pairs at a time as there are threads, each given up when its files
  /// are written.
  void compare_all(const fs::path& stage) {
    const std::size_t count = plan_.pairs.size();
    Progress bar("compare", static_cast<std::int64_t>(count), options_.progress);
    const auto at_once = static_cast<std::size_t>(pool_.num_threads());
    for (std::size_t begin = 0; begin < count; begin += at_once) {
      std::vector<Explained> compared = compared_from(begin, std::min(at_once, count - begin));
      for (std::size_t i = 0; i < compared.size(); ++i) {
        add_roughness_to(compared[i]);
        keep(compared[i], stage / pair_folder(begin + i));
        bar.update(static_cast<std::int64_t>(begin + i + 1), compared[i].pair.real.source.name);
      }
    }
    joint_ = joint_scene();
  }

  std::vector<Explained> compared_from(std::size_t begin, std::size_t size) {
    const auto count = static_cast<std::int64_t>(size);
    auto compared = pool_.map<Explained>(count, [&](std::int64_t i) {
      const ComparePair& pair = plan_.pairs[begin + static_cast<std::size_t>(i)];
      Explained result = {.pair = compare_pair(pair, pair_options_)};
      check_shows_part(result.pair);
      return result;
    });
    for (Explained& explained : compared) {  // each by all threads
      explained.missing = passes_->complete(explained.pair);
    }
    pool_.for_each(count, [&](std::int64_t i) { explain(compared[static_cast<std::size_t>(i)]); });
    for (Explained& explained : compared) {
      passes_->release(explained.pair);
    }
    return compared;
  }

  void explain(Explained& explained) const {
    explained.causes = find_causes(explained.pair, camera_);
    if (!explained.missing.empty()) {
      explained.causes.notes.push_back(explained.missing);
    }
    ListedEdges listed = surface_edges(explained.pair);
    explained.pair.geometry.edges = std::move(listed.edges);
    explained.pair.geometry.unlisted = listed.unlisted;
  }

  /// Each picture is rendered by all threads.
  void add_roughness_to(Explained& explained) {
    if (options_.has_roughness) {
      const auto start = std::chrono::steady_clock::now();
      add_roughness(explained.pair, store_, explained.causes);
      roughness_s_ += seconds_since(start);
    } else {
      note_unsought_roughness(explained.pair, explained.causes);
    }
  }

  /// What rendering took, beside what comparing did.
  Json timings() const {
    const double all_s = seconds_since(start_);
    const double render_s = passes_->render_s() + roughness_s_;
    return {{"this_run_s", all_s}, {"render_s", render_s}, {"compare_s", all_s - render_s}};
  }

  void keep(const Explained& explained, const fs::path& folder) {
    const ComparedPair& pair = explained.pair;
    make_folder(folder);
    write_exr(folder / "difference.exr", residual_picture(pair.exposed, pair.real.grey));
    write_png(folder / "simulated.png", pair.exposed, PixelDepth::k16Bit);
    write_file(folder / "overlay.png", png_bytes(overlay_of(pair)));
    const bool is_changed = !explained.causes.told.empty() || explained.causes.calibrated;
    if (options_.is_refining && is_changed && pair.simulated.source.is_rendered()) {
      write_file(folder / "refined.toml",
                 refined_toml(pair.simulated.source, explained.causes, store_));
      ++num_refined_;
    }
    if (options_.is_refining && pair.simulated.source.is_rendered()) {
      views_.push_back({.scene = refinable_scene(pair.simulated.source, explained.causes, store_),
                        .causes = explained.causes});
    }
    pages_.push_back(page_pair(pair));
    Json row = pair_json(pair, explained.causes);
    add_inspection(pair, row);
    pairs_.push_back(std::move(row));
    samples_.add(pair);
  }

  /// Of all views together; nothing where one of the pairs says nothing of its view.
  std::optional<SceneSettings> joint_scene() const {
    return views_.size() == plan_.pairs.size() ? jointly_refined(views_) : std::nullopt;
  }

  /// What `--refine` has written of several pairs, or why it has written nothing.
  std::string refined_note() const {
    if (views_.empty()) {
      return "Nothing was refined: no simulated picture comes with the scene that it was rendered "
             "from (a view of glint render, a design of glint run, or --scene).";
    }
    if (num_refined_ == 0 && !joint_) {
      const bool is_open = std::ranges::any_of(
          views_, [](const auto& view) { return view.causes.is_roughness_open; });
      return is_open ? "Nothing was refined: how rough the metal is stays open, see the notes of "
                       "the pairs."
                     : "Nothing was refined: no cause was found beyond noise.";
    }
    if (plan_.pairs.size() == 1) {
      return "";
    }
    return joint_
               ? fmt::format(
                     "refined.toml has all {} views, each with its own pose, and one lens that "
                     "fits them together; a pair's own refined.toml is what its view says alone.",
                     views_.size())
               : std::string(
                     "Each pair is refined by itself: its refined.toml has the pose, lens and "
                     "exposure of its view alone.");
  }

  /// A part that cannot be inspected is compared all the same.
  void add_inspection(const ComparedPair& pair, Json& row) {
    try {
      if (const auto inspected = inspect_pair(pair, pool_)) {
        row["inspection"] = inspection_json(*inspected);
      }
    } catch (const ConfigError& error) {
      row["notes"].push_back(fmt::format("Not inspected: {}", error.what()));
    }
  }

  Json result_json() const {
    const std::optional<Yardstick> stick = samples_.measure();
    Json result = {{"schema", 1}, {"status", "done"}};
    result["pairs"] = pairs_;
    result["yardstick"] = yardstick_json(stick);
    result["verdict"] = compare_verdict(result["pairs"], stick);
    result["notes"] = plan_.notes;
    if (const std::string note = options_.is_refining ? refined_note() : ""; !note.empty()) {
      result["notes"].push_back(note);
    }
    for (const std::string& note : samples_.notes()) {
      result["notes"].push_back(note);
    }
    result["report"] = "report.html";
    return result;
  }

  void write_all(const fs::path& stage, const Json& result) const {
    write_file(stage / "result.json", result.dump(2) + "\n");
    write_file(stage / "report.html", compare_page(result, pages_));
    if (joint_) {
      write_file(stage / "refined.toml", to_toml(write_scene(*joint_)));
    }
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kCompare);
    run["pairs"] = plan_.pairs.size();
    run["source"] = sources_seen_from(out_, sources_of(options_.inputs));
    run["threads"] = options_.threads;
    run["timings"] = timings();
    write_file(stage / "run.json", run.dump(2) + "\n");
  }

  const CompareOptions& options_;
  fs::path out_;
  ThreadPool pool_;
  SceneStore store_{pool_};               ///< all designs of a run have the same part
  std::optional<GeometryPasses> passes_;  ///< of the plan
  double roughness_s_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  ComparePlan plan_;
  PairOptions pair_options_;
  KnownCamera camera_;
  Json pairs_ = Json::array();
  std::vector<PagePair> pages_;
  std::vector<RefinedView> views_;  ///< with --refine: of pairs whose simulated side was rendered
  std::size_t num_refined_ = 0;     ///< pairs with a scene of their own
  std::optional<SceneSettings> joint_;
  YardstickPictures samples_;
};

}  // namespace

Json compare_pictures(const CompareOptions& options) {
  return CompareRun(options).execute();
}

}  // namespace glint
