// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/source_files.h"

#include "core/error.h"
#include "studies/output/run_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kPlan = "plan.json";
constexpr const char* kScene = "scene.toml";

/// What a plan tells; nothing for a file that is none, which whoever reads the plan complains of.
PlanOrigin told_by(const fs::path& plan) {
  try {
    return fs::exists(plan) ? read_plan(plan).origin : PlanOrigin{};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

SourceFiles files_of(const fs::path& source) {
  if (source.empty()) {
    return {};
  }
  if (source.extension() == ".json") {
    const fs::path scene = source.parent_path() / kScene;
    return {.plan = source, .scene = fs::exists(scene) ? scene : fs::path()};
  }
  if (fs::exists(source / kPlan)) {
    const fs::path scene = source / kScene;
    return {.plan = source / kPlan, .scene = fs::exists(scene) ? scene : fs::path()};
  }
  return {.plan = {}, .scene = fs::is_directory(source) ? source / kScene : source};
}

PlanOrigin origin_of(const fs::path& source) {
  const SourceFiles files = files_of(source);
  const fs::path& file = files.scene.empty() ? files.plan : files.scene;
  if (file.empty()) {
    return {};
  }
  const fs::path whole = fs::absolute(file).lexically_normal();
  const bool is_copy = whole.filename() == kScene || !files.plan.empty();
  PlanOrigin origin = is_copy
                          ? told_by(files.plan.empty() ? whole.parent_path() / kPlan : files.plan)
                          : PlanOrigin{};
  if (origin.scene.empty()) {
    origin.scene = whole;
  }
  if (origin.run.empty()) {
    origin.run = run_above(whole);
  }
  return origin;
}

}  // namespace glint
