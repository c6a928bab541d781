// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/front/front_page.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/output/read_json.h"
#include "studies/report/report.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kAspectWidth_px = 700;

/// `aspect` or `thumbnail`, `drawing`, `closeups` and `notes` of each design that has a folder.
void add_pictures(const fs::path& run, const Closeups& closeups, Json& front) {
  for (Json& design : front["designs"]) {
    const fs::path folder = run / design.value("folder", std::string("none"));
    if (!design.contains("folder") || !fs::exists(folder / "cross_section.svg")) {
      continue;
    }
    design["drawing"] = read_file(folder / "cross_section.svg");
    if (fs::exists(folder / "thumbnail.png")) {
      design["thumbnail"] = base64(read_file(folder / "thumbnail.png"));
      continue;
    }
    const ImageF aspect = read_image(folder / "aspect.exr");
    design["aspect"] = report_png(aspect, kAspectWidth_px);
    design["closeups"] = closeups(folder, aspect);
    design["notes"] = read_json(folder / "scores.json").value("notes", Json::array());
  }
}

/// Bytes that it takes as a text, hardly less.
std::size_t text_bytes(const Json& json) {
  constexpr std::size_t kNumber = 20;
  constexpr std::size_t kMarks = 4;
  if (json.is_string()) {
    return json.get_ref<const std::string&>().size() + kMarks;
  }
  std::size_t sum = json.is_structured() ? kMarks : kNumber;
  if (json.is_object()) {
    for (const auto& [key, item] : json.items()) {
      sum += key.size() + kMarks + text_bytes(item);
    }
  } else if (json.is_array()) {
    for (const Json& item : json) {
      sum += text_bytes(item);
    }
  }
  return sum;
}

/// @return whether a sequence became shorter
bool halve_sequences(Json& designs) {
  bool is_shorter = false;
  for (Json& design : designs) {
    const Json frames = design.value("frames", Json::array());
    if (frames.size() < 2) {
      continue;
    }
    Json kept = Json::array();
    for (std::size_t k = 0; k < frames.size(); k += 2) {
      kept.push_back(frames[k]);
    }
    design["frames"] = std::move(kept);
    is_shorter = true;
  }
  return is_shorter;
}

/// Designs with a small picture, the one that adds least to the hypervolume first.
std::vector<Json*> by_contribution(Json& front) {
  std::vector<Json*> designs;
  for (Json& design : front["designs"]) {
    if (design.contains("thumbnail")) {
      designs.push_back(&design);
    }
  }
  std::ranges::stable_sort(
      designs, {}, [](const Json* design) { return (*design)["contribution"].get<double>(); });
  return designs;
}

/// @return how many designs lost their small picture and drawing
int drop_thumbnails(Json& data, std::size_t max_bytes) {
  std::size_t bytes = text_bytes(data);
  int dropped = 0;
  if (bytes <= max_bytes || !data.contains("front")) {
    return dropped;
  }
  for (Json* design : by_contribution(data["front"])) {
    if (bytes <= max_bytes) {
      break;
    }
    const std::size_t before = text_bytes(*design);
    design->erase("thumbnail");
    design->erase("drawing");
    bytes -= before - text_bytes(*design);
    ++dropped;
  }
  return dropped;
}

/// The database holds what was seen, not what a model expected of it. @param kept  kOfExpected
void take_front_of_run(const Json& result, const Json& kept, Json& front) {
  front["designs"] = result["front"];
  for (const char* name : {"hypervolume", "reference", "chosen"}) {
    front[name] = result[name];
  }
  for (const char* name : kOfExpected) {
    front[name] = kept[name];
  }
}

}  // namespace

void add_front_to_page(const fs::path& run,
                       const Json& result,
                       const Closeups& closeups,
                       Json& front) {
  if (result.contains("front_expected")) {
    take_front_of_run(result, result["front_expected"], front);
    front["is_expected"] = true;
  } else if (result.contains("front_likely")) {
    take_front_of_run(result, result["front_likely"], front);
  }
  for (Json& design : front["designs"]) {
    for (const Json& told : result.value("front", Json::array())) {
      if (told["trial"] == design["trial"] &&
          (told.contains("rescored") || told.contains("expected"))) {
        design = told;
      }
    }
  }
  front["rescored"] = result.value("front_rescored", Json());
  for (const char* name : {"probability_best", "probability_best_unknown"}) {
    if (result.contains(name)) {
      front[name] = result[name];
    }
  }
  add_pictures(run, closeups, front);
}

void limit_sequences(Json& data, std::size_t max_bytes) {
  int step = 1;
  while (text_bytes(data) > max_bytes && halve_sequences(data["designs"])) {
    step *= 2;
  }
  if (step > 1) {
    data["methods"].push_back(
        fmt::format("Of each sequence every {} image is shown, so that this page stays small; the "
                    "folders of the designs hold all.",
                    step == 2 ? "second" : fmt::format("{}th", step)));
  }
  if (const int dropped = drop_thumbnails(data, max_bytes); dropped > 0) {
    data["methods"].push_back(
        fmt::format("The pictures of {} designs of the front that add least to the hypervolume are "
                    "left out, so that this page stays small; their folders hold them.",
                    dropped));
  }
}

}  // namespace glint
