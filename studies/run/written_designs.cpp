// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/written_designs.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/file.h"
#include "core/log.h"
#include "studies/run/repeated_scores.h"
#include "studies/run/results/judged_limits.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

DesignWriter::DesignWriter(const WritingTask& task, Progress::Style progress)
    : task_(task), progress_(task.study.name + ": writing", num_steps(), progress) {}

Json DesignWriter::write(const std::string& key,
                         const SceneSettings& scene,
                         const Json& head,
                         bool is_repeated) {
  const Study& study = task_.study;
  log(LogLevel::kInfo, "writing {}", key);
  Json json;
  DesignWatch watch = watch_of(key, scene);
  const int trial = head.value("trial", 0);
  watch.on_rescored = [&](const Outcome& outcome) {
    task_.fresh.keep(rescored_label(scene), trial, outcome);
  };
  try {
    json = write_design(
        task_.store, scene, head, task_.out / key, true, wanted_by(study.goal), &watch);
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
  rescoring_cpu_s_ += watch.rescoring_cpu_s;
  ++num_written_;
  if (!study.has_objective) {
    return json;
  }
  judge_limits(study.goal, task_.race, key, json);
  if (task_.is_repeated && is_repeated) {
    add_repeated(scene, trial, json);
  }
  write_file(task_.out / key / "scores.json", json.dump(2) + "\n");
  return json;
}

/// Shows how far the design is, a step for each frame and one for re-scoring; designs have as many
/// frames as the baseline, about.
DesignWatch DesignWriter::watch_of(const std::string& key, const SceneSettings& scene) {
  const int frames = scene.scan.positions;
  const auto show = [this, key, frames](int done, const std::string& what) {
    const std::int64_t before = std::int64_t{num_written_} * (frames + 1);
    progress_.update(before + done, fmt::format("{}: {}", key, what));
  };
  return {.on_frame = [show](int done) { show(done, fmt::format("frame {}", done)); },
          .on_rescoring = [show, frames] { show(frames, "re-scoring"); }};
}

/// One step more than there are, so that short work is not told.
std::int64_t DesignWriter::num_steps() const {
  const Study& study = task_.study;
  const int frames = study.scene.scan.positions;
  const auto designs = static_cast<std::int64_t>(study.prototypes.size()) +
                       (study.has_search() ? 2 : 1) + task_.front_designs;
  return designs * (frames + 1) + 1;
}

void DesignWriter::add_repeated(const SceneSettings& scene, int trial, Json& design) {
  const double start = process_cpu_s();
  const auto keep = [&](int index, const Outcome& outcome) {
    task_.fresh.keep(repeated_label(scene, index), trial, outcome);
  };
  design["repeated"] = repeated_scores(task_.store,
                                       first_view(task_.store, scene),
                                       wanted_of_repeats(task_.study),
                                       task_.study.goal,
                                       keep);
  rescoring_cpu_s_ += process_cpu_s() - start;
}

}  // namespace glint
