// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/source_files.h"

#include <fmt/format.h>

#include "core/error.h"
#include "studies/output/run_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kPlan = "plan.json";

/// What a plan tells; nothing for a file that is none, which whoever reads the plan complains of.
PlanOrigin told_by(const fs::path& plan) {
  try {
    return fs::exists(plan) ? read_plan(plan).origin : PlanOrigin{};
  } catch (const Error&) {
    return {};
  }
}

/// Of a scene or plan as it is named here.
/// @param whole  its full path
/// @param plan   of a planned scene; empty: one that lies beside it
PlanOrigin origin_at(const fs::path& whole, const fs::path& plan) {
  const bool is_copy = whole.filename() == kDesignScene || !plan.empty();
  PlanOrigin origin =
      is_copy ? told_by(plan.empty() ? whole.parent_path() / kPlan : plan) : PlanOrigin{};
  if (origin.scene.empty()) {
    origin.scene = whole;
  }
  if (origin.run.empty()) {
    origin.run = run_above(whole);
  }
  return origin;
}

}  // namespace

SourceFiles files_of(const fs::path& source) {
  if (source.empty()) {
    return {};
  }
  if (source.extension() == ".json") {
    const fs::path scene = source.parent_path() / kDesignScene;
    return {.plan = source, .scene = fs::exists(scene) ? scene : fs::path()};
  }
  if (fs::exists(source / kPlan)) {
    const fs::path scene = source / kDesignScene;
    return {.plan = source / kPlan, .scene = fs::exists(scene) ? scene : fs::path()};
  }
  return {.plan = {}, .scene = fs::is_directory(source) ? source / kDesignScene : source};
}

PlanOrigin origin_of(const fs::path& source) {
  const SourceFiles files = files_of(source);
  const fs::path& file = files.scene.empty() ? files.plan : files.scene;
  if (file.empty()) {
    return {};
  }
  PlanOrigin origin = origin_at(fs::absolute(file).lexically_normal(), files.plan);
  if (origin.run.empty()) {
    const PlanOrigin led_to = origin_at(without_links(file), without_links(files.plan));
    origin = led_to.run.empty() ? origin : led_to;
  }
  if (origin.run.empty() && !origin.is_told) {
    throw ConfigError(
        fmt::format("{}: planned_from: is missing: this plan of an earlier program does not say "
                    "of which design it is, and so not which prototype it needs; plan it again, "
                    "or write null where its scene is of no run",
                    (files.plan.empty() ? file.parent_path() / kPlan : files.plan).string()));
  }
  return origin;
}

}  // namespace glint
