// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/sensor_calibration/sensor_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json point(double x, double y) {
  return Json::array({x, y});
}

/// Measured levels of one kind.
Json marks(std::span<const LevelStatistics> levels,
           const char* name,
           bool is_dark,
           double LevelStatistics::*x,
           double LevelStatistics::*y) {
  Json points = Json::array();
  for (const LevelStatistics& level : levels) {
    if (level.is_dark == is_dark) {
      points.push_back(point(level.*x, level.*y));
    }
  }
  return {{"name", name}, {"points", points}};
}

Json line(const char* name, const LineFit& fit, double to) {
  return {
      {"name", name},
      {"is_line", true},
      {"points", {point(0.0, std::max(0.0, fit.offset)), point(to, fit.offset + fit.slope * to)}}};
}

Json transfer_chart(std::span<const LevelStatistics> levels, const PhotonTransfer& transfer) {
  return {{"kind", "curves"},
          {"title", "Photon transfer"},
          {"x", "mean (DN)"},
          {"y", "temporal variance (DN\u00b2)"},
          {"series",
           {marks(levels,
                  "bright",
                  false,
                  &LevelStatistics::mean_dn,
                  &LevelStatistics::temporal_variance_dn2),
            marks(levels,
                  "dark",
                  true,
                  &LevelStatistics::mean_dn,
                  &LevelStatistics::temporal_variance_dn2),
            line("weighted affine fit", transfer.fit, transfer.saturation_dn)}}};
}

Json response_chart(std::span<const LevelStatistics> levels, const PhotonTransfer& transfer) {
  double longest = 0.0;
  for (const LevelStatistics& level : levels) {
    longest = std::max(longest, level.exposure);
  }
  LineFit fit = transfer.response;
  fit.offset += transfer.dark_mean_dn;
  if (fit.slope > 0.0) {
    longest = std::min(longest, (transfer.saturation_dn - fit.offset) / fit.slope);
  }
  Json series = {
      marks(levels, "bright", false, &LevelStatistics::exposure, &LevelStatistics::mean_dn),
      marks(levels, "dark", true, &LevelStatistics::exposure, &LevelStatistics::mean_dn)};
  if (transfer.linearity_error) {
    series.push_back(line("fit from 5 to 95 % of saturation", fit, longest));
  }
  return {{"kind", "curves"},
          {"title", "Linearity"},
          {"x", "exposure"},
          {"y", "mean (DN)"},
          {"series", std::move(series)}};
}

/// Four digits, without a power of ten where a person would write none.
std::string plain(double value) {
  return value >= 1000.0 && value < 1e7 ? fmt::format("{:.0f}", value)
                                        : fmt::format("{:.4g}", value);
}

std::string share(double value) {
  return fmt::format("{:.3g} %", 100.0 * value);
}

std::string with_unit(const Json& value, const char* unit) {
  return value.is_number() ? fmt::format("{} {}", plain(value.get<double>()), unit)
                           : std::string("not known");
}

/// The figures of a data sheet after EMVA 1288.
Json figures_table(const Json& result, const PhotonTransfer& transfer) {
  const Json& efficiency = result["quantum_efficiency"];
  return {
      {"caption", ""},
      {"head", {"figure", "value", "what it is"}},
      {"rows",
       {{"system gain",
         fmt::format("{:.4g} \u00b1 {:.2g} DN", transfer.fit.slope, transfer.fit.slope_sigma),
         "per electron; slope of the weighted affine fit"},
        {"dark noise",
         with_unit(result["dark_noise_e"], "e"),
         "of one picture, rounding taken out"},
        {"dark signal", with_unit(result["dark_mean_dn"], "DN"), "mean of the dark levels"},
        {"growth of the dark signal",
         with_unit(result["dark_rate_dn_per_exposure"], "DN"),
         "per unit of exposure"},
        {"saturation", with_unit(result["saturation_e"], "e"), "of light; largest variance"},
        {"largest signal to noise", with_unit(result["largest_snr"], ""), "at saturation"},
        {"dynamic range",
         with_unit(result["dynamic_range"], ""),
         "saturation over the least signal"},
        {"responsivity", with_unit(result["responsivity_dn_per_photon"], "DN"), "per photon"},
        {"quantum efficiency",
         efficiency.is_number() ? share(efficiency.get<double>()) : std::string("not known"),
         "electrons per photon"},
        {"linearity error",
         transfer.linearity_error ? share(*transfer.linearity_error) : std::string("not known"),
         "mean deviation from the fitted line"},
        {"PRNU",
         share(transfer.photo_response_nonuniformity),
         "spread of the response over the pixels, shading of lamp and lens included"},
        {"DSNU", with_unit(result["dsnu_e"], "e"), "spread of the dark signal over the pixels"}}}};
}

Json levels_table(std::span<const LevelStatistics> levels, const PhotonTransfer& transfer) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelStatistics& level = levels[i];
    const double modelled = transfer.fit.offset + transfer.fit.slope * level.mean_dn;
    rows.push_back({level.is_dark ? "dark" : "bright",
                    shortest(level.exposure),
                    fmt::format("{:.2f}", level.mean_dn),
                    fmt::format("{:.3f}", level.temporal_variance_dn2),
                    transfer.is_fitted[i] ? fmt::format("{:.3f}", modelled) : std::string("-"),
                    fmt::format("{:.3f}", level.spatial_variance_dn2),
                    share(level.clipped_share)});
  }
  return {{"caption", ""},
          {"head",
           {"level",
            "exposure",
            "mean DN",
            "temporal variance",
            "by the fit",
            "spatial variance",
            "clipped"}},
          {"rows", rows}};
}

Json verdict(const Json& result, const PhotonTransfer& transfer) {
  Json details = Json::array();
  for (const std::string& warning : transfer.warnings) {
    details.push_back("Warning: " + warning);
  }
  const Json& sensor = result["sensor"];
  const auto figure = [](const char* label, double value, const char* unit) {
    return Json{{"label", label}, {"value", plain(value)}, {"unit", unit}};
  };
  return {{"sentence",
           fmt::format("One electron is worth {:.4g} DN; the sensor saturates at {} electrons "
                       "and has {:.3g} electrons of noise in the dark.",
                       transfer.fit.slope,
                       plain(transfer.saturation_e),
                       transfer.dark_noise_e)},
          {"tone", transfer.warnings.empty() ? "good" : "neutral"},
          {"details", details},
          {"figures",
           {figure("full_well_e", sensor["full_well_e"].get<double>(), "e"),
            figure("read_noise_e", sensor["read_noise_e"].get<double>(), "e"),
            figure("dark_e", sensor["dark_e"].get<double>(), "e"),
            figure("bits", sensor["bits"].get<double>(), "")}}};
}

}  // namespace

std::string sensor_page(const Json& result,
                        std::span<const LevelStatistics> levels,
                        const PhotonTransfer& transfer,
                        const std::string& toml,
                        const std::string& when) {
  const Json panels = {
      {{"id", "transfer"},
       {"title", "Photon transfer and linearity"},
       {"lead",
        "Levels up to 70 % of saturation are fitted, and dark ones whose noise is wholly seen."},
       {"charts", {transfer_chart(levels, transfer), response_chart(levels, transfer)}}},
      {{"id", "figures"},
       {"title", "Figures after EMVA 1288"},
       {"tables", {figures_table(result, transfer)}}},
      {{"id", "levels"}, {"title", "Levels"}, {"tables", {levels_table(levels, transfer)}}}};
  return render_report({{"title", "Sensor calibration"},
                        {"when", when},
                        {"verdict", verdict(result, transfer)},
                        {"panels", panels},
                        {"methods",
                         {"Temporal variance is that between pictures of one level, each picture's "
                          "own mean taken off.",
                          "Variance against mean is fitted by a straight line with an offset, each "
                          "level weighed by the "
                          "inverse of its variance (weighted affine).",
                          "The simulated sensor has no black level: dark_e makes the dark mean, "
                          "read_noise_e what is "
                          "left of the dark variance."}},
                        {"config_toml", toml},
                        {"provenance", provenance()}});
}

}  // namespace glint
