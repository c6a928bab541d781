// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "core/text.h"
#include "studies/report/report_page.h"
#include "studies/report/report_ranking.h"
#include "studies/report/report_verdict.h"
#include "studies/report/report_wording.h"
#include "studies/report/score_words.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::member;
using report_detail::text_of;

void describe_scores(const Json& scores, Json& info) {
  if (!scores.is_object()) {
    return;
  }
  for (const auto& [name, value] : scores.items()) {
    if (!info.contains(name)) {
      info[name] = report_detail::score_words(name);
    }
  }
}

void describe_all_scores(Json& data) {
  Json info = member(data, "score_info").is_object() ? data["score_info"] : Json::object();
  Json named = Json::object();
  named[text_of(member(data, "objective"), "name")] = nullptr;
  for (const Json& constraint : member(data, "constraints")) {
    named[text_of(constraint, "name")] = nullptr;
  }
  for (const Json& objective : member(member(data, "front"), "objectives")) {
    named[text_of(objective, "score")] = nullptr;
  }
  named.erase("");
  describe_scores(named, info);
  describe_scores(member(member(data, "rendered"), "scores"), info);
  for (const char* list : {"designs", "trials", "runs"}) {
    for (const Json& entry : member(data, list)) {
      describe_scores(member(entry, "scores"), info);
      describe_scores(member(entry, "rescored"), info);
      for (const Json& defect : member(entry, "closeups")) {
        describe_scores(member(defect, "scores"), info);
      }
    }
  }
  data["score_info"] = std::move(info);
}

std::string number_text(const Json& row, const char* name, const report_detail::Wording& wording) {
  const auto value = report_detail::number_of(row, name);
  return value ? wording.text(*value) : std::string("\u2013");
}

/// A section with the ranking of designs, after sections that are there.
void add_ranking_panel(Json& data) {
  const report_detail::Wording wording(data);
  Json rows = Json::array();
  for (const Json& row : data["ranking"]) {
    std::vector<std::string> missed;
    for (const Json& text : row["missed"]) {
      missed.push_back(text.get<std::string>());
    }
    const auto chance = report_detail::number_of(row, "probability_best");
    rows.push_back({std::to_string(rows.size() + 1),
                    text_of(row, "title"),
                    number_text(row, "value", wording),
                    number_text(row, "low", wording) + " to " + number_text(row, "high", wording),
                    chance ? fmt::format("{:.0f} %", 100.0 * *chance) : std::string("\u2013"),
                    missed.empty() ? std::string("none") : join(missed, "; ")});
  }
  if (!member(data, "panels").is_array()) {
    data["panels"] = Json::array();
  }
  data["panels"].push_back(
      {{"id", "ranking"},
       {"title", "Ranking"},
       {"lead",
        "All designs are scanned with the same noise, several times over: mean of these scans, its "
        "95 % interval, and how often the design would be the best of those that miss no limit."},
       {"tables",
        {{{"caption", ""},
          {"head", {"place", "design", wording.label(), "interval", "best", "limits missed"}},
          {"rows", rows}}}}});
}

/// Designs that nothing was searched for are ranked.
void add_ranking(Json& data) {
  if (data.contains("ranking") || data.contains("front") || !member(data, "trials").empty() ||
      !member(data, "runs").empty() || member(data, "designs").size() < 2) {
    return;
  }
  const Json ranking = report_detail::ranking_of(data);
  if (!ranking.empty()) {
    data["ranking"] = ranking;
    add_ranking_panel(data);
  }
}

/// Which of the designs that were scanned repeatedly is the best, for any run.
/// @return whether the verdict is to say it: a front has its own words
bool add_probability_best(Json& data) {
  if (data.contains("front") || !member(data, "runs").empty() ||
      member(data, "designs").size() < 2) {
    return false;
  }
  if (data.contains("probability_best")) {
    return true;  // of the race of a search's finalists
  }
  Json list = Json::array();
  for (const Json& row : report_detail::ranking_of(data)) {
    if (row.contains("probability_best")) {
      list.push_back(
          {{"key", row["key"]}, {"title", row["title"]}, {"probability", row["probability_best"]}});
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const Json& a, const Json& b) {
    return a["probability"].get<double>() > b["probability"].get<double>();
  });
  if (!list.empty()) {
    data["probability_best"] = std::move(list);
  }
  return data.contains("probability_best");
}

/// A sentence of a search's verdict; a ranking has its own.
void say_probability_best(Json& data) {
  std::vector<std::string> parts;
  for (const Json& one : data["probability_best"]) {
    const double percent = 100.0 * one["probability"].get<double>();
    if (percent >= 0.5) {
      parts.push_back(fmt::format(
          "{} {}",
          text_of(one, "title"),
          percent < 99.5 ? fmt::format("{:.0f} %", percent) : std::string("over 99 %")));
    }
  }
  const std::string text =
      "Probability of being the best, by the mean of scans with fresh noise that is the same for "
      "all: " +
      join(parts, ", ") + ".";
  data["verdict"]["details"].push_back(text);
  data["verdict"]["findings"].push_back({{"code", "probability_best"}, {"text", text}});
}

/// JSON that may stand in a script element: there `<` could end the element or open a comment.
std::string script_json(const Json& data) {
  const std::string plain = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(plain.size() + plain.size() / 64);
  for (const char c : plain) {
    c == '<' ? safe += "\\u003c" : safe += c;
  }
  return safe;
}

void replace_mark(std::string& page, std::string_view mark, std::string_view text) {
  const auto at = page.find(mark);
  GLINT_CHECK(at != std::string::npos, "the embedded page lacks a mark");
  page.replace(at, mark.size(), text);
}

}  // namespace

nlohmann::ordered_json complete_report(nlohmann::ordered_json data) {
  describe_all_scores(data);
  add_ranking(data);
  const bool has_probability = add_probability_best(data);
  if (!member(data, "verdict").is_object()) {
    data["verdict"] = report_verdict(data);
    if (has_probability && !data.contains("ranking")) {
      say_probability_best(data);
    }
  }
  return data;
}

std::string render_report(const nlohmann::ordered_json& data) {
  Json complete = complete_report(data);
  const std::string when = text_of(complete, "when");
  complete.erase("when");
  std::string page = report_page();
  const std::string title = text_of(complete, "title");
  replace_mark(page, "@GLINT_WHEN@", markup_text(when));
  // The title comes last: whatever it says cannot be taken for a mark.
  replace_mark(page, "@GLINT_DATA@", script_json(complete));
  replace_mark(
      page,
      "@GLINT_TITLE@",
      markup_text(title.empty() ? std::string("Glint report") : title + " - Glint report"));
  return page;
}

std::string report_png(const ImageF& image, int max_width_px) {
  GLINT_CHECK(max_width_px >= 1, "a picture needs a width");
  const int factor = std::max(1, (image.width() + max_width_px - 1) / max_width_px);
  return base64(png_bytes(factor == 1 ? image : reduce(image, std::min(factor, image.height()))));
}

ImageF closeup(const ImageF& image, int center_x, int center_y, int half_px) {
  const int width = std::min(2 * half_px + 1, image.width());
  const int height = std::min(2 * half_px + 1, image.height());
  const int left = std::clamp(center_x - half_px, 0, image.width() - width);
  const int top = std::clamp(center_y - half_px, 0, image.height() - height);
  ImageF part(width, height);
  for (int y = 0; y < height; ++y) {
    std::copy_n(image.row(top + y) + left, width, part.row(y));
  }
  return part;
}

ImageF stretched(const ImageF& image, float low, float high) {
  if (!(high > low)) {
    return image;
  }
  ImageF result = image;
  for (float& value : result.values()) {
    value = std::clamp((value - low) / (high - low), 0.0F, 1.0F);
  }
  return result;
}

}  // namespace glint
