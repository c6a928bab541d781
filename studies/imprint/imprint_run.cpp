// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_run.h"
#include "studies/definition/study_text.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/rng.h"
#include "core/wall_clock.h"
#include "studies/imprint/imprint_files.h"
#include "studies/imprint/imprint_folder.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/read_json.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// Beyond every index that defects draw from.
constexpr std::uint64_t kPartSeedIndex = std::uint64_t{1} << 62;

constexpr const char* kIndex = "parts.json";

/// Thrown out of the making of a part.
struct Interrupted {};

/// The scene with open realisations settled: meshes go to programs whose pictures are not known.
SceneSettings imprinted_scene(SceneSettings scene) {
  for (auto& [name, group] : scene.defects) {
    if (group.realisation == Realisation::kAuto) {
      group.realisation = Realisation::kImprinted;
    }
  }
  return scene;
}

/// The most defects there can be, for the progress bar.
int max_defects(const SceneSettings& scene) {
  if (scene.imprint.count.max > 0.0) {
    return static_cast<int>(scene.imprint.count.max);
  }
  std::size_t maximum = 0;
  for (const auto& [name, group] : scene.defects) {
    maximum += max_defects(group, scene.imprint);
  }
  return std::max(1, static_cast<int>(maximum));
}

/// Sums over the parts.
Json totals_of(const Json& rows) {
  Json totals = {{"made", 0}, {"given_up", 0}, {"retries", 0}, {"jitters", 0}};
  double removed_mm3 = 0.0;
  for (const Json& row : rows) {
    for (auto& [name, total] : totals.items()) {
      total = total.get<int>() + row[name].get<int>();
    }
    removed_mm3 += row["removed_volume_mm3"].get<double>();
  }
  totals["removed_volume_mm3"] = removed_mm3;
  return totals;
}

class ImprintRun {
 public:
  ImprintRun(const Study& study, const ImprintOptions& options)
      : study_(study),
        options_(options),
        scene_(imprinted_scene(study.scene)),
        marked_scene_(marked_scene_text(study, options.count > 0)),
        pool_(options.threads) {}

  Json execute() {
    if (scene_.defects.empty()) {
      throw ConfigError(study_.root.place.file +
                        ": defects: no table [defects.<name>], there is nothing to imprint");
    }
    check_imprint_folder(options_.out, study_, options_.count);
    check_inputs_kept(input_files(study_), options_.out, names_of_imprint(options_.count));
    prepare();
    OutputFolder folder(options_.out);
    remove_stale_stages(options_.out);
    return options_.count > 0 ? make_many(folder) : make_one(folder);
  }

 private:
  /// Everything about the scene that can be refused before anything is written.
  void prepare() {
    try {
      clean_ = std::make_shared<const BuiltPart>(build_part_with_bvh(scene_.part));
      maker_.emplace(defect_maker(scene_, clean_));
      if (options_.has_previews) {
        files_.views = study_.root.find("viewpoint") != nullptr
                           ? std::vector{camera_view(scene_.camera, scene_.viewpoint())}
                           : automatic_views(clean_->part.mesh);
      }
      files_.has_previews = options_.has_previews;
      files_.scene = study_.root;
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  bool is_interrupted() const { return options_.interrupt != nullptr && *options_.interrupt > 0; }

  BuiltDefects build(std::uint64_t seed, const std::function<void(int)>& progress) const {
    try {
      return build_defects(scene_, clean_, *maker_, seed, [&](int done) {
        if (is_interrupted()) {
          throw Interrupted();
        }
        progress(done);
      });
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  /// @return timings
  Json make_part(const fs::path& folder,
                 std::uint64_t seed,
                 ThreadPool& pool,
                 const std::function<void(int)>& progress) const {
    ImprintSeconds seconds;
    const auto start = Clock::now();
    const BuiltDefects part = build(seed, progress);
    seconds.make_s = seconds_since(start);
    write_imprint_files(folder, scene_, part, seed, files_, pool, seconds);
    return timings_json(seconds, part.made);
  }

  Json make_one(OutputFolder& folder) {
    const auto seed = static_cast<std::uint64_t>(scene_.imprint.seed);
    Json result = {{"schema", 1}, {"status", "done"}, {"name", study_.name}, {"seed", seed}};
    try {
      StagedFolder stage(options_.out, "");
      const int maximum = max_defects(scene_);
      Progress bar(study_.name, maximum, options_.progress);
      const Json timings = make_part(
          stage.path(), seed, pool_, [&](int done) { bar.update(std::min(done, maximum)); });
      bar.update(maximum);
      write_file(stage.path() / kResolvedScene, marked_scene_);
      write_run_json(stage.path(), timings);
      add_metadata(result, read_json(stage.path() / kImprintMetadata));
      result["files"] = files_in(stage.path());
      stage.commit();
    } catch (const Interrupted&) {
      result["status"] = "interrupted";
      return result;
    }
    folder.keep();
    result["folder"] = options_.out.string();
    return result;
  }

  static void add_metadata(Json& result, const Json& metadata) {
    result.update(imprint_summary(metadata));
    result["defects"] = metadata["defects"];
    result["refusals"] = metadata["refusals"];
    result["notes"] = metadata["notes"];
  }

  static Json files_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }

  Json make_many(OutputFolder& folder) {
    std::vector<int> missing;
    std::error_code ignored;
    for (int part = 0; part < options_.count; ++part) {
      if (!fs::exists(options_.out / part_name(part) / kImprintMetadata, ignored)) {
        missing.push_back(part);
      }
    }
    write_file(options_.out / kResolvedScene, marked_scene_);
    make_missing(missing, folder);
    Json result = index_json();
    const std::size_t present = result["parts"].size();
    if (present == static_cast<std::size_t>(options_.count)) {
      write_file(options_.out / kIndex, result.dump(2) + "\n");
    } else {
      result["status"] = "interrupted";
    }
    write_run_json(options_.out,
                   {{"this_run_s", seconds_since(start_)},
                    {"kept_parts", static_cast<std::size_t>(options_.count) - missing.size()}});
    folder.keep();
    result["folder"] = options_.out.string();
    result["index"] = (options_.out / kIndex).string();
    return result;
  }

  void make_missing(const std::vector<int>& missing, OutputFolder& folder) {
    const int kept = options_.count - static_cast<int>(missing.size());
    Progress bar(study_.name, options_.count, options_.progress);
    bar.update(kept);
    std::mutex mutex;
    int done = kept;
    pool_.for_each(static_cast<std::int64_t>(missing.size()), [&](std::int64_t i) {
      if (is_interrupted() || !make_numbered(missing[static_cast<std::size_t>(i)])) {
        return;
      }
      const std::lock_guard lock(mutex);
      folder.keep();  // what is made is not thrown away
      bar.update(++done);
    });
  }

  /// @return false when it was interrupted
  bool make_numbered(int part) const {
    const std::uint64_t seed = part_seed(static_cast<std::uint64_t>(scene_.imprint.seed), part);
    try {
      StagedFolder stage(options_.out, part_name(part));
      ThreadPool alone(1);
      const Json timings = make_part(stage.path(), seed, alone, [](int) {});
      write_run_json(stage.path(), timings);
      stage.commit();
    } catch (const Interrupted&) {
      return false;
    } catch (const ConfigError& error) {
      throw in_context(error, part_name(part));
    }
    return true;
  }

  Json index_json() const {
    Json rows = Json::array();
    int noted = 0;
    std::error_code ignored;
    for (int part = 0; part < options_.count; ++part) {
      const fs::path file = options_.out / part_name(part) / kImprintMetadata;
      if (!fs::exists(file, ignored)) {
        continue;
      }
      const Json metadata = read_json(file);
      Json row = {{"name", part_name(part)},
                  {"seed", part_seed(static_cast<std::uint64_t>(scene_.imprint.seed), part)}};
      row.update(imprint_summary(metadata));
      rows.push_back(row);
      noted += metadata["notes"].empty() ? 0 : 1;
    }
    Json result = {{"schema", 1},
                   {"status", "done"},
                   {"name", study_.name},
                   {"seed", scene_.imprint.seed},
                   {"count", options_.count}};
    result.update(totals_of(rows));
    result["notes"] = Json::array();
    if (noted > 0) {
      result["notes"].push_back(fmt::format("{} parts have notes in their defects.json", noted));
    }
    result["parts"] = rows;
    return result;
  }

  void write_run_json(const fs::path& folder, const Json& timings) const {
    Json json = provenance();
    json["verb"] = command_of(ResultKind::kImprint);
    json["study"] = study_.name;
    json["source"] = source_seen_from(options_.out, study_.root.place.file);
    json["seed"] = scene_.imprint.seed;
    json["threads"] = options_.threads;
    json["timings"] = timings;
    json["configuration"] = resolved_text(study_);
    write_file(folder / "run.json", json.dump(2) + "\n");
  }

  const Study& study_;
  const ImprintOptions& options_;
  SceneSettings scene_;
  std::string marked_scene_;
  ThreadPool pool_;
  Clock::time_point start_ = Clock::now();
  std::shared_ptr<const BuiltPart> clean_;
  std::optional<DefectMaker> maker_;
  ImprintFileOptions files_;
};

}  // namespace

std::uint64_t part_seed(std::uint64_t seed, int part) {
  Rng rng(seed, Stream::kDefects, kPartSeedIndex + static_cast<std::uint64_t>(part));
  const std::uint64_t high = rng.next_u32();
  return (high << 21) | (rng.next_u32() >> 11);
}

Json imprint_scene(const Study& study, const ImprintOptions& options) {
  return ImprintRun(study, options).execute();
}

}  // namespace glint
