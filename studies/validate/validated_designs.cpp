// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validated_designs.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/acquire/light_difference.h"
#include "studies/definition/scene_file.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"
#include "studies/validate/validated_scene.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kWinner = "winner";
constexpr const char* kBaseline = "baseline";
constexpr const char* kFront = "front";

/// All designs of the run: the winner first, the baseline last.
std::vector<std::string> designs_in(const fs::path& run) {
  std::vector<std::string> names;
  for (const fs::path& entry : sorted_entries(run)) {
    const std::string name = entry.filename().string();
    if (!name.starts_with(".") && name != kWinner && name != kBaseline &&
        is_there(entry / "scene.toml")) {
      names.push_back(name);
    }
  }
  if (is_there(run / kWinner / "scene.toml")) {
    names.insert(names.begin(), kWinner);
  }
  if (is_there(run / kBaseline / "scene.toml")) {
    names.emplace_back(kBaseline);
  }
  return names;
}

/// "front/NAME" of a design of several objectives' front.
bool is_of_front(const fs::path& run, const std::string& name) {
  const fs::path path(name);
  return path.parent_path() == kFront && path.filename() != ".." &&
         is_there(run / path / "scene.toml");
}

std::vector<std::string> front_designs_in(const fs::path& run) {
  std::vector<std::string> names;
  for (const fs::path& entry : sorted_entries(run / kFront)) {
    const std::string name = (kFront / entry.filename()).string();
    if (!entry.filename().string().starts_with(".") && is_of_front(run, name)) {
      names.push_back(name);
    }
  }
  return names;
}

std::string told(const std::vector<std::string>& names) {
  return names.empty() ? "none" : join(names, ", ");
}

/// A name in a result.json that may be the end of a path.
bool is_path_below(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::ranges::none_of(name, [](const fs::path& part) { return part == ".."; });
}

/// Of one folder: what was rendered, and its pairs. @param pairs  rows with the name of the view
void add_written(const fs::path& folder,
                 const nlohmann::ordered_json& pairs,
                 std::vector<fs::path>& written) {
  written.push_back(folder / "simulated");
  for (const auto& pair : pairs) {
    const fs::path view = pair.at("view").get<std::string>();
    for (const char* file : {"overlay.png", "simulated.png", "difference.exr"}) {
      if (is_path_below(view)) {
        written.push_back(folder / view / file);
      }
    }
  }
}

/// A file that says where the camera is by drawing, alone, calibrates nothing.
bool tells_camera(const fs::path& calibration) {
  return !calibration.empty() && load_toml(calibration).find("camera") != nullptr;
}

class Finder {
 public:
  Finder(fs::path run, fs::path pictures, fs::path calibration, SceneStore& store)
      : run_(std::move(run)),
        pictures_(std::move(pictures)),
        calibration_(std::move(calibration)),
        store_(store) {}

  ValidationSources find(const std::string& designs) {
    if (!is_there(run_)) {
      throw IoError(run_.string() + ": there is no such folder");
    }
    if (!is_there(pictures_)) {
      throw IoError(pictures_.string() + ": there is no such folder");
    }
    sources_.run_designs = designs_in(run_);
    if (sources_.run_designs.empty()) {
      throw ConfigError(run_.string() +
                        ": holds no design; give the folder of a glint run, with winner/ or "
                        "prototypes");
    }
    read_study();
    for (const std::string& name : wanted(designs)) {
      add(name);
    }
    if (sources_.designs.empty() && !sources_.left_out.empty()) {
      throw ConfigError(sources_.left_out.front().reason);
    }
    if (sources_.designs.empty()) {
      throw ConfigError(
          fmt::format("{}: holds no pictures of any design: looked for the folders {}",
                      pictures_.string(),
                      told(sources_.run_designs)));
    }
    return std::move(sources_);
  }

 private:
  void read_study() {
    const fs::path file = run_ / "study.resolved.toml";
    if (is_there(file)) {
      sources_.study = load_study(file, {});
      if (has_several_objectives(sources_.study->goal)) {
        sources_.front_designs = front_designs_in(run_);
      }
    }
  }

  /// Names that were chosen must have pictures, others may.
  std::vector<std::string> wanted(const std::string& designs) {
    std::string list = designs;
    if (list.empty()) {
      const SceneSettings scene = load_scene(run_ / sources_.run_designs.front() / "scene.toml");
      list = scene.validate ? scene.validate->designs : "";
    }
    std::vector<std::string> names = names_in(list);
    is_chosen_ = !names.empty();
    if (!is_chosen_) {
      names = sources_.run_designs;
      if (names.size() > 1 && names.back() == kBaseline && !is_there(pictures_ / kBaseline)) {
        names.pop_back();
      }
    }
    for (const std::string& name : names) {
      if (std::ranges::find(sources_.run_designs, name) == sources_.run_designs.end() &&
          !is_of_front(run_, name)) {
        throw ConfigError("designs",
                          fmt::format("there is no design {} in {}, there are {}; of a front's "
                                      "designs the name is front/NAME",
                                      name,
                                      run_.string(),
                                      told(sources_.run_designs)));
      }
    }
    return names;
  }

  /// Others go on without it.
  void leave_out(const std::string& name, const std::string& reason) {
    sources_.left_out.push_back({.name = name, .reason = reason});
    sources_.notes.push_back(fmt::format("{} is left out: {}", name, reason));
  }

  void add(const std::string& name) {
    const fs::path folder = pictures_ / name;
    if (!is_there(folder)) {
      if (is_chosen_) {
        throw IoError(folder.string() + ": there is no such folder: the design has no pictures");
      }
      sources_.notes.push_back(fmt::format("{} has no pictures and is left out", name));
      return;
    }
    check_lights(name);
    try {
      add_pictured(name, folder);
    } catch (const NoWholeView& error) {
      leave_out(name, error.what());
    }
  }

  void add_pictured(const std::string& name, const fs::path& folder) {
    // One after the other: GCC 12 destroys `nominal` twice where `.real` throws after a member that
    // was left out between them.
    auto nominal = load_scene(run_ / name / "scene.toml");
    auto real = read_real_design(name, folder);
    ValidatedDesign design = {.name = name, .nominal = std::move(nominal), .real = std::move(real)};
    sources_.notes.insert(sources_.notes.end(), design.real.notes.begin(), design.real.notes.end());
    take_exposure(design);
    design.scene = design.nominal;
    const fs::path calibration = calibration_.empty() ? design.real.calibration : calibration_;
    if (!calibration_.empty() || tells_camera(calibration)) {
      take_calibration(calibration, design.scene);
      sources_.is_calibrated = true;
    }
    const std::vector<Viewpoint> listed =
        viewpoints_of(design.nominal, store_.build(design.nominal)->part);
    design.nominal_views = viewpoints_of_pictures(design.real, design.nominal, listed);
    design.views = viewpoints_of_pictures(design.real, design.scene, listed);
    sources_.designs.push_back(std::move(design));
  }

  /// All views of a design have one exposure.
  void take_exposure(ValidatedDesign& design) {
    if (design.real.is_by_render) {
      design.nominal.expose_to = 0.0;
    }
    design.nominal = exposed_as_acquired(store_, design.nominal, design.name, sources_.notes);
  }

  /// Pictures that another prototype or power was seen by, as of an earlier winner, are none of
  /// this design. Of pictures without their scene nothing is known: they are taken as they are.
  void check_lights(const std::string& name) const {
    const fs::path folder = pictures_ / name;
    if (!is_there(folder / "acquired.json") || !is_there(folder / "scene.toml")) {
      return;
    }
    const fs::path design = run_ / name / "scene.toml";
    const std::string difference = light_difference(folder, load_study(design, {}).scene);
    if (!difference.empty()) {
      throw ConfigError(
          fmt::format("{}: holds pictures of another prototype, or of lights at another power: {} "
                      "in its scene.toml than in {}; take them again into another folder",
                      folder.string(),
                      difference,
                      design.string()));
    }
  }

  fs::path run_;
  fs::path pictures_;
  fs::path calibration_;
  SceneStore& store_;
  ValidationSources sources_;
  bool is_chosen_ = false;
};

}  // namespace

std::vector<std::string> written_designs(const ValidationSources& sources) {
  std::vector<std::string> names = sources.run_designs;
  names.insert(names.end(), sources.front_designs.begin(), sources.front_designs.end());
  return names;
}

fs::path default_validate_folder(const fs::path& run) {
  const std::string name = name_of_source(run);
  return default_result_folder(name.empty() ? "run" : name, ResultKind::kValidate);
}

std::vector<std::string> validation_files(const std::vector<std::string>& designs) {
  std::vector<std::string> names = {"result.json", "report.html", "run.json", kBeforeFolder};
  for (const std::string& design : designs) {
    names.push_back(fs::path(design).begin()->string());
  }
  return names;
}

std::vector<fs::path> earlier_validation(const fs::path& out) {
  const fs::path file = out / "result.json";
  if (result_kind_of(out) != ResultKind::kValidate || !is_there(file)) {
    return {};
  }
  std::vector<fs::path> written;
  try {
    const auto result = nlohmann::ordered_json::parse(read_file(file));
    add_written(kBeforeFolder, result.at("before"), written);
    std::map<std::string, nlohmann::ordered_json> pairs;
    for (const auto& pair : result.at("pairs")) {
      pairs[pair.at("design").get<std::string>()].push_back(pair);
    }
    for (const auto& [design, of_design] : pairs) {
      if (is_path_below(design)) {
        written.push_back(fs::path(design) / "refit.toml");
        add_written(design, of_design, written);
      }
    }
  } catch (const nlohmann::json::exception&) {  // of another form: nothing is known of its files
    written.clear();
  }
  return written;
}

void check_default_validate_folder(const fs::path& run, const fs::path& pictures) {
  check_source_of_folder(default_validate_folder(run), {run, pictures});
}

void check_before_pictures(const fs::path& run,
                           const fs::path& out,
                           const fs::path& calibration,
                           const std::vector<std::string>& designs) {
  const fs::path folder = out.empty() ? default_validate_folder(run) : out;
  const std::vector<std::string> files = validation_files(designs);
  check_result_folder(folder, ResultKind::kValidate, files);
  if (calibration.empty()) {
    return;
  }
  check_inputs_kept(std::vector<fs::path>{calibration}, folder, files);
  for (const std::string& name : designs) {
    SceneSettings scene = load_scene(run / name / "scene.toml");
    take_calibration(calibration, scene);
  }
}

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    std::string name = list.substr(begin, end - begin);
    std::erase(name, ' ');
    if (!name.empty()) {
      names.push_back(name);
    }
    begin = end + 1;
  }
  return names;
}

ValidationSources find_validated(const fs::path& run,
                                 const fs::path& pictures,
                                 const std::string& designs,
                                 const fs::path& calibration,
                                 SceneStore& store) {
  return Finder(run, pictures, calibration, store).find(designs);
}

}  // namespace glint
