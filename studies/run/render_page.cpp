// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_page.h"

#include <cmath>

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "core/text.h"
#include "studies/output/provenance.h"
#include "studies/run/render_maps.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kErrorEnd = ".error";

constexpr std::string_view kStyle = R"(
:root { --ink: #1d252c; --soft: #55606a; --line: #dde2e6; --blue: #0072b2; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1320px; padding: 0 32px 64px; color: var(--ink); background: #fff;
  font: 15px/1.5 "Inter", system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
h1, h2, p { margin: 0; }
h1 { font-size: 32px; line-height: 1.2; letter-spacing: -0.02em; overflow-wrap: anywhere; }
h2 { font-size: 21px; padding-top: 40px; }
.brand { padding-top: 36px; font-weight: 700; color: var(--blue); }
.sentence { font-size: 23px; line-height: 1.35; max-width: 46em; margin: 10px 0; }
.lead { color: var(--soft); max-width: 90ch; }
.notes { color: var(--soft); max-width: 90ch; font-size: 14px; padding-left: 18px; margin: 6px 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; margin-top: 10px; }
th { text-align: left; font-size: 13px; color: var(--soft); vertical-align: bottom; }
td, th { padding: 5px 16px 5px 0; border-bottom: 1px solid var(--line); }
td.n, th.n { text-align: right; }
img { max-width: 100%; height: auto; display: block; margin-top: 10px; }
figure { margin: 22px 0 0; }
figcaption { color: var(--soft); font-size: 14px; }
.side { display: flex; flex-wrap: wrap; gap: 8px 48px; align-items: flex-start; }
.views { display: grid; grid-template-columns: repeat(auto-fill, minmax(520px, 1fr)); gap: 0 24px; }
.key { display: inline-block; width: 14px; height: 11px; margin: 0 6px 0 0; }
.legend span { margin-right: 18px; white-space: nowrap; }
pre { padding: 14px 16px; overflow-x: auto; background: #f5f7f8; border: 1px solid var(--line);
  font: 12.5px/1.5 ui-monospace, Menlo, Consolas, monospace; }
summary { cursor: pointer; color: var(--soft); font-size: 13px; margin-top: 12px; }
)";

std::string plural(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

/// Four digits, and as many as needed of whole numbers.
std::string number(double value) {
  return std::abs(value) >= 1e4 && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value)
                                                          : fmt::format("{:.4g}", value);
}

std::string image(const std::string& png, int width_px, int height_px, std::string_view what) {
  return fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">",
                     width_px,
                     height_px,
                     markup_text(what),
                     base64(png));
}

std::string sentence(const RenderPage& page) {
  const Json& result = page.result;
  const bool has_light = result["views"].empty() || result["views"][0].contains("relative_error");
  std::string text = fmt::format("{} of {} x {} pixels",
                                 plural(result["views"].size(), "view"),
                                 result["width_px"].get<int>(),
                                 result["height_px"].get<int>());
  text += has_light ? " by path tracing." : ": masks and geometry, no light was sampled.";
  if (result["status"] == "interrupted") {
    text += " The rendering was interrupted; this is what there is.";
  }
  return text;
}

std::string legend(const RenderPage& page) {
  const auto entry = [](std::string_view colour, std::string_view what) {
    return fmt::format(
        "<span><i class=\"key\" style=\"background:{}\"></i>{}</span>", colour, what);
  };
  std::string text = "<p class=\"lead legend\">Defect map: ";
  for (const DefectType type : page.types) {
    text += entry(defect_colour_css(type), type_name(type));
  }
  return text + entry("#ced4d9", "sound surface") + entry("#282e34", "beside the part") + "</p>\n";
}

std::string caption(const Json& row) {
  const Json& rays = row["rays"];
  std::string text = fmt::format(
      "{}: {:.0f} samples a pixel, {} camera, {} shadow and {} reflected "
      "rays",
      markup_text(row["folder"].get<std::string>()),
      row["mean_samples"].get<double>(),
      rays["camera"].get<std::int64_t>(),
      rays["shadow"].get<std::int64_t>(),
      rays["bounce"].get<std::int64_t>());
  if (row.contains("relative_error") && row["relative_error"].is_number()) {
    text += fmt::format("; standard error of a pixel {:.2g} % of the brightness",
                        100.0 * row["relative_error"].get<double>());
  }
  return text +
         fmt::format("; {} in view.", plural(row["defects_seen"].get<std::size_t>(), "defect"));
}

std::string views_section(const RenderPage& page) {
  std::string text = "<h2>Pictures</h2>\n";
  text += legend(page);
  if (!page.sheet_png.empty()) {
    text +=
        fmt::format("<figure><img alt=\"all views\" src=\"data:image/png;base64,{}\"></figure>\n",
                    base64(page.sheet_png));
  }
  text += page.views.size() > 1 ? "<div class=\"views\">\n" : "<div>\n";
  for (const PageView& view : page.views) {
    text += fmt::format(
        "<figure>{}<figcaption>{}</figcaption></figure>\n",
        image(view.png, view.width_px, view.height_px, view.row["folder"].get<std::string>()),
        caption(view.row));
  }
  return text + "</div>\n";
}

/// Scores of a single defect: "defects.dent_1.cnr".
bool is_of_one_defect(const std::string& name) {
  constexpr std::string_view kDefects = "defects.";
  return name.starts_with(kDefects) && name.find('.', kDefects.size()) != std::string::npos;
}

std::string scores_table(const Json& scores, bool of_defects) {
  std::string text =
      "<div class=\"scroll\"><table>\n<tr><th>score</th><th class=\"n\">value</th><th "
      "class=\"n\">standard error</th></tr>\n";
  for (const auto& [name, value] : scores.items()) {
    if (name.ends_with(kErrorEnd) || !value.is_number() || is_of_one_defect(name) != of_defects) {
      continue;
    }
    const auto error = scores.find(name + std::string(kErrorEnd));
    const bool has_error = error != scores.end() && error->is_number();
    text += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                        markup_text(name),
                        number(value.get<double>()),
                        has_error ? number(error->get<double>()) : std::string());
  }
  return text + "</table></div>\n";
}

std::string scores_section(const Json& result) {
  if (!result.contains("scores")) {
    return "";
  }
  const Json& scores = result["scores"];
  return "<h2>Scores of the first view</h2>\n" + scores_table(scores, false) +
         "<details><summary>Each defect</summary>\n" + scores_table(scores, true) + "</details>\n";
}

std::string lighting_section(const RenderPage& page) {
  return fmt::format("<h2>Lighting</h2>\n<div class=\"side\"><div>{}</div></div>\n", page.drawing);
}

std::string notes_list(const Json& notes) {
  if (notes.empty()) {
    return "";
  }
  std::string text = "<ul class=\"notes\">\n";
  for (const Json& note : notes) {
    text += "<li>" + markup_text(note.get<std::string>()) + "</li>\n";
  }
  return text + "</ul>\n";
}

std::string origin_section(const std::string& toml) {
  std::string text =
      "<h2>Scene and provenance</h2>\n<details><summary>Scene (TOML)</summary><pre>" +
      markup_text(toml) + "</pre></details>\n<table>\n";
  const Json origin = provenance();
  for (const auto& [name, value] : origin.items()) {
    if (name != "cores") {
      text += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n",
                          markup_text(name),
                          markup_text(value.is_string() ? value.get<std::string>() : value.dump()));
    }
  }
  return text + "</table>\n";
}

}  // namespace

std::string render_page(const RenderPage& page) {
  const std::string title = markup_text(page.title);
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
      "name=\"generator\" content=\"Glint\">\n<meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n"
      "<title>{0} - Glint</title>\n<style>{1}</style>\n</head>\n<body>\n"
      "<p class=\"brand\">Glint</p>\n<h1>{0}</h1>\n<p class=\"sentence\">{2}</p>\n",
      title,
      kStyle,
      sentence(page));
  text += notes_list(page.result["notes"]);
  text += views_section(page);
  text += lighting_section(page);
  text += scores_section(page.result);
  return text + origin_section(page.toml) + "</body>\n</html>\n";
}

}  // namespace glint
