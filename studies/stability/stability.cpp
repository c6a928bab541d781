// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/overrides.h"
#include "studies/stability/reference/reference_scene.h"
#include "studies/stability/sliver_plate.h"
#include "studies/stability/stability_pairs.h"

namespace glint::stability {
namespace {

using Json = nlohmann::ordered_json;

/// The reference's surface reflects everything. @throws ConfigError
void check_mirror(const MaterialSettings& material) {
  const bool has_colour = !material.colour_srgb.empty();
  const bool reflects_all =
      std::ranges::all_of(has_colour ? material.colour_srgb : material.reflectance,
                          [&](double value) { return value >= (has_colour ? 255.0 : 1.0); });
  if (material.type != MaterialSettings::Type::kMirror || !material.nk_file.empty() ||
      material.coat.index != 1.0 || !reflects_all) {
    throw ConfigError("material", "is not a mirror that reflects everything, as the reference is");
  }
}

/// The given scene without noise, in at most kMaxPixels.
ConfigNode quiet_scene(const ConfigNode& given) {
  std::vector<Problem> problems;
  SceneSettings scene = read_scene(given, problems);
  if (!problems.empty()) {
    throw ConfigError(problems);
  }
  scene.sensor = without_noise(scene.sensor);
  scene.sensor.bits = 0;
  reduce_camera(scene.camera);
  check_mirror(scene.material);
  reference_scene(scene);  // refuses what it does not model
  return write_scene(scene);
}

class Measuring {
 public:
  explicit Measuring(const StabilityOptions& options)
      : options_(options),
        pool_(options.threads),
        base_(options.base ? quiet_scene(*options.base)
                           : parse_toml(base_scene_text(), "base scene")),
        bar_(parse_toml(bar_scene_text(), "scene of the bar light")) {}

  Stability run(const std::vector<Sweep>& sweeps) {
    Stability stability{.bounds = options_.bounds};
    for (const Sweep& sweep : sweeps) {
      stability.sweeps.push_back(measure(sweep));
    }
    return stability;
  }

 private:
  SweepResult measure(const Sweep& sweep) {
    SceneStore store(pool_);
    harmless_.reset();
    pair_.reset();
    SweepResult result{.sweep = sweep};
    for (const SweepValue& value : sweep.values) {
      if (options_.on_progress && !options_.on_progress(done_, sweep.name)) {
        break;
      }
      result.cells.push_back(cell_of(store, sweep, value));
      ++done_;
    }
    return result;
  }

  Cell cell_of(SceneStore& store, const Sweep& sweep, const SweepValue& value) {
    Cell cell{.value = value.value, .method = value.method};
    try {
      const ConfigNode& base = sweep.is_beside_bar ? bar_ : base_;
      const ConfigNode root = scene_tables_of(base, sweep, value);
      if (sweep.kind == Sweep::Kind::kWinner) {
        compare_pair(store, root, cell);
      } else {
        compare_scene(store, sweep, value.sliver_mm, root, cell);
      }
    } catch (const ConfigError& error) {
      cell.verdict = Verdict::kRefused;
      cell.message = error.what();
      cell.errors.clear();
    }
    return cell;
  }

  void compare_scene(
      SceneStore& store, const Sweep& sweep, double sliver_mm, const ConfigNode& root, Cell& cell) {
    auto outcome = std::make_unique<Outcome>(
        sliver_mm > 0.0 ? evaluated_with_slivers(store, root, sliver_mm) : evaluated(store, root));
    if (sweep.kind == Sweep::Kind::kBar) {
      cell.errors = errors_of_bar(*outcome, options_.bounds);
    } else if (sweep.kind == Sweep::Kind::kTunnel) {
      cell.errors = errors_of_tunnel(*outcome, options_.bounds);
    } else if (harmless_) {
      cell.errors = errors_of_switch(*outcome, *harmless_, options_.bounds);
    }
    judge(*outcome, harmless_.get(), cell);
    if (!harmless_ || sweep.kind == Sweep::Kind::kSwitch) {
      harmless_ = std::move(outcome);
    }
  }

  void compare_pair(SceneStore& store, const ConfigNode& root, Cell& cell) {
    const DesignPair pair = design_pair(store, root);
    if (!pair_) {
      pair_ = pair;
    }
    cell.errors = {flip_error(*pair_, pair, options_.bounds)};
    cell.verdict =
        cell.errors.front().error <= cell.errors.front().bound ? Verdict::kRight : Verdict::kWrong;
  }

  const StabilityOptions& options_;
  ThreadPool pool_;
  ConfigNode base_;
  ConfigNode bar_;
  std::unique_ptr<Outcome> harmless_;  ///< the sweep's first cell; of switches the one before
  std::optional<DesignPair> pair_;     ///< the undisturbed one
  int done_ = 0;
};

Json errors_json(const Cell& cell) {
  Json errors = Json::object();
  for (const CellError& error : cell.errors) {
    errors[error.quantity] = {{"error", error.error},
                              {"bound", error.bound},
                              {"measured", error.measured},
                              {"reference", error.reference},
                              {"uncertainty", error.uncertainty}};
  }
  return errors;
}

Json cell_json(const Cell& cell) {
  const CellError* worst = worst_of(cell);
  return {{"value", cell.value},
          {"method", cell.method},
          {"quantity", worst != nullptr ? Json(worst->quantity) : Json(nullptr)},
          {"error", worst != nullptr ? Json(worst->error) : Json(nullptr)},
          {"bound", worst != nullptr ? Json(worst->bound) : Json(nullptr)},
          {"verdict", verdict_name(cell.verdict)},
          {"message", cell.message},
          {"errors", errors_json(cell)}};
}

}  // namespace

StabilityTotals Stability::totals() const {
  StabilityTotals totals;
  for (const SweepResult& result : sweeps) {
    for (const Cell& cell : result.cells) {
      totals.right += cell.verdict == Verdict::kRight ? 1 : 0;
      totals.told += cell.verdict == Verdict::kTold ? 1 : 0;
      totals.refused += cell.verdict == Verdict::kRefused ? 1 : 0;
      totals.wrong += cell.verdict == Verdict::kWrong ? 1 : 0;
    }
    totals.left_out += static_cast<int>(result.sweep.values.size() - result.cells.size());
  }
  return totals;
}

int count_cells(const std::vector<Sweep>& sweeps) {
  std::size_t cells = 0;
  for (const Sweep& sweep : sweeps) {
    cells += sweep.values.size();
  }
  return static_cast<int>(cells);
}

Stability measure_stability(const std::vector<Sweep>& sweeps, const StabilityOptions& options) {
  return Measuring(options).run(sweeps);
}

namespace {

Json sweeps_json(const Stability& stability) {
  Json sweeps = Json::array();
  for (const SweepResult& result : stability.sweeps) {
    Json cells = Json::array();
    for (const Cell& cell : result.cells) {
      cells.push_back(cell_json(cell));
    }
    sweeps.push_back({{"name", result.sweep.name},
                      {"swept", result.sweep.swept},
                      {"title", result.sweep.title},
                      {"cells", cells}});
  }
  return sweeps;
}

}  // namespace

Json stability_json(const Stability& stability) {
  const StabilityTotals totals = stability.totals();
  return {{"schema", 1},
          {"status", totals.left_out > 0 ? "budget" : "done"},
          {"bounds",
           {{"h_points", stability.bounds.h_points},
            {"contrast_percent", stability.bounds.contrast_percent},
            {"picture", stability.bounds.picture}}},
          {"sweeps", sweeps_json(stability)},
          {"totals",
           {{"right", totals.right},
            {"told", totals.told},
            {"refused", totals.refused},
            {"silently_wrong", totals.wrong},
            {"left_out", totals.left_out}}},
          {"report", "stability.html"}};
}

}  // namespace glint::stability
