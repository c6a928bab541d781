// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/plan_digest.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text.h"
#include "studies/acquire/journal.h"
#include "studies/acquire/mounted_prototypes.h"
#include "studies/cell/pose_numbers.h"
#include "studies/cell_camera/cell_camera.h"
#include "studies/definition/study.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// All but the powers of the lights.
Json work_json(const AcquireWork& work, const AcquireSource& source, const Cell& cell) {
  Json json = {{"positions", work.num_positions}, {"step_mm", work.steps.to_next_mm}};
  if (work.steps.to_first_mm != 0.0) {
    json["offset_mm"] = work.steps.to_first_mm;
  }
  for (const TourPoint& point : work.plan.tour) {
    json["tour"].push_back({point.name, joints_deg(point.joints_rad)});
  }
  for (const ViewTask& task : work.plan.tasks) {
    json["tasks"].push_back({task.name, task.point, task.lights, task.exposure_us});
  }
  const CellCamera& camera = camera_of(cell);
  json["camera"] = {
      static_cast<int>(camera.pixel_format), camera.gain_db.value_or(0.0), camera.region_px};
  if (camera.gain_raw) {
    json["camera"].push_back(*camera.gain_raw);
  }
  if (source.scene) {
    json["built_lights"] = built_lights(*source.scene);
  }
  return json;
}

bool has_powers_of(const fs::path& scene, const SceneSettings& wanted) {
  try {
    return set_lights(load_study(scene, {}).scene) == set_lights(wanted);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::string plan_digest(const AcquireWork& work, const AcquireSource& source, const Cell& cell) {
  Json json = work_json(work, source, cell);
  if (source.scene) {
    json["set_lights"] = set_lights(*source.scene);
  }
  return sha256_hex(json.dump());
}

std::string digest_in(const fs::path& folder,
                      const AcquireWork& work,
                      const AcquireSource& source,
                      const Cell& cell) {
  std::string now = plan_digest(work, source, cell);
  const std::string known = recorded_digest(folder);
  if (!source.scene || known.empty() || known == now) {
    return now;
  }
  const std::string former = sha256_hex(work_json(work, source, cell).dump());
  // Each later session of that program wrote its scene over that of the pictures.
  const bool is_same = known == former && recorded_sessions(folder) == 1 &&
                       has_powers_of(folder / "scene.toml", *source.scene);
  return is_same ? former : now;
}

}  // namespace glint
