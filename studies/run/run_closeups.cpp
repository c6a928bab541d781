// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_closeups.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "studies/output/read_json.h"
#include "studies/report/report.h"
#include "studies/run/results/scene_facts.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kHalf_px = 20;      ///< of the smallest close-up
constexpr int kMaxHalf_px = 100;  ///< of the largest
constexpr std::size_t kMaxCloseups = 8;
constexpr double kDarkShare = 0.005;  ///< of the pixels may be blacker than black, as many whiter

/// The picture a close-up is cut from.
struct Source {
  ImageF image;
  std::string name;
};

/// In defects.json, the frame that decides about a score of single frames; empty: no such score.
std::string frame_key(const std::string& objective) {
  const std::string score = objective.substr(objective.rfind('.') + 1);
  if (score.ends_with("best_frame")) {
    return "difference";
  }
  return score.ends_with("change") || score.ends_with("union") ? "change" : "";
}

Source source_of(const Json& defect,
                 const fs::path& folder,
                 const ImageF& aspect,
                 const std::string& objective) {
  const std::string key = frame_key(objective);
  const int frame = defect.value("best_frames", Json::object()).value(key, -1);
  const fs::path file = folder / "sequence" / fmt::format("frame_{:03}.png", frame);
  if (key.empty() || frame < 0 || !fs::exists(file)) {
    return {.image = aspect, .name = "mean image"};
  }
  return {.image = read_image(file), .name = fmt::format("image {}", frame + 1)};
}

/// What is black and what is white in a stretched picture.
std::pair<float, float> stretch_of(const ImageF& image) {
  std::vector<float> values(image.values().begin(), image.values().end());
  std::ranges::sort(values);
  const auto aside = static_cast<std::size_t>(kDarkShare * static_cast<double>(values.size()));
  return {values[aside], values[values.size() - 1 - aside]};
}

Json closeup_of(const Json& defect, const Source& source) {
  const Json& window = defect["window_px"];
  const int width = window[2].get<int>();
  const int height = window[3].get<int>();
  const int half = std::clamp(std::max(width, height) / 2, kHalf_px, kMaxHalf_px);
  const ImageF square = closeup(
      source.image, window[0].get<int>() + width / 2, window[1].get<int>() + height / 2, half);
  const auto [low, high] = stretch_of(square);
  Json json = {{"label", defect["label"]},
               {"size", defect_size_text(defect)},
               {"image", report_png(stretched(square, low, high), square.width())},
               {"picture", source.name},
               {"low", low},
               {"high", high},
               {"size_px", {square.width(), square.height()}},
               {"scores", defect["scores"]}};
  if (defect.contains("pixel_mm")) {
    json["pixel_mm"] = defect["pixel_mm"];
  }
  return json;
}

}  // namespace

Json closeups_of(const fs::path& folder, const ImageF& aspect, const std::string& objective) {
  const Json file = read_json(folder / "defects.json");
  std::vector<Json> defects(file["defects"].begin(), file["defects"].end());
  if (defects.size() > kMaxCloseups) {
    std::ranges::stable_sort(
        defects, {}, [](const Json& defect) { return defect["scores"]["cnr"].get<double>(); });
    defects.resize(kMaxCloseups);
  }
  Json list = Json::array();
  for (const Json& defect : defects) {
    list.push_back(closeup_of(defect, source_of(defect, folder, aspect, objective)));
  }
  return list;
}

Json defect_widths(const fs::path& folder) {
  const Json file = read_json(folder / "defects.json");
  Json list = Json::array();
  for (const Json& defect : file["defects"]) {
    if (defect.contains("width_px")) {  // older runs do not have it
      list.push_back({{"label", defect["label"]}, {"width_px", defect["width_px"]}});
    }
  }
  return list;
}

}  // namespace glint
