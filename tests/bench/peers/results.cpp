// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/results.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"

namespace glint::peers {
namespace {

using nlohmann::json;

/// Three digits, without an exponent in the range that times and ratios have.
std::string number(double value) {
  if (value <= 0.0) {
    return "-";
  }
  const int before = static_cast<int>(std::floor(std::log10(value))) + 1;
  return before >= 3 ? fmt::format("{:.0f}", value) : fmt::format("{:.{}f}", value, 3 - before);
}

std::string error_text(double rmse) {
  return fmt::format("{:.4f}", rmse);
}

/// One cell per column; the last column is the setting, which may be long.
void append_row(std::string& out,
                const std::vector<std::string>& cells,
                const std::string& tool,
                const std::string& setting) {
  for (const std::string& cell : cells) {
    fmt::format_to(std::back_inserter(out), "{:>10} ", cell);
  }
  fmt::format_to(std::back_inserter(out), " {:<8} {}\n", tool, setting);
}

std::vector<std::string> cells_of(const Result& result,
                                  const Result& glint,
                                  const Reference& reference) {
  std::vector<std::string> cells = {
      number(result.warm_s / glint.warm_s),
      number(result.cold_s / glint.cold_s),
      number(result.frame_s),
      number(result.warm_s),
      number(result.cold_s),
  };
  if (result.frame.empty()) {
    cells.insert(cells.end(), {"", ""});
  } else {
    const FrameError error = compare(result.frame, reference);
    cells.insert(cells.end(), {error_text(error.rmse), error_text(error.rmse_inside)});
  }
  return cells;
}

json json_of(const Result& result, const Result& glint, const Reference& reference) {
  json row = {{"tool", result.tool},
              {"setting", result.setting},
              {"notes", result.notes},
              {"settings", result.settings},
              {"samples_s", result.samples_s}};
  const auto add_times = [&](const std::string& which, double seconds, double glint_s) {
    if (seconds > 0.0) {
      row["cpu_s_" + which] = seconds;
      row[which + "_ratio_to_glint"] = seconds / glint_s;
    }
  };
  add_times("frame", result.frame_s, glint.frame_s);
  add_times("warm", result.warm_s, glint.warm_s);
  add_times("cold", result.cold_s, glint.cold_s);
  if (!result.frame.empty()) {
    const FrameError error = compare(result.frame, reference);
    row["frame_rmse"] = error.rmse;
    row["frame_rmse_away_from_slot"] = error.rmse_inside;
    row["frame_mean"] = error.mean;
  }
  return row;
}

}  // namespace

FrameError compare(const ImageF& frame, const Reference& reference) {
  if (frame.width() != reference.frame.width() || frame.height() != reference.frame.height()) {
    throw Error(fmt::format("a peer's frame has {} x {} px, expected are {} x {} px",
                            frame.width(),
                            frame.height(),
                            reference.frame.width(),
                            reference.frame.height()));
  }
  double sum = 0.0;
  double sum_inside = 0.0;
  double mean = 0.0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const double value = static_cast<double>(frame.values()[i]);
    const double difference = value - static_cast<double>(reference.frame.values()[i]);
    mean += value;
    sum += difference * difference;
    if (reference.inside.values()[i] != 0) {
      sum_inside += difference * difference;
      ++inside;
    }
  }
  const auto count = static_cast<double>(frame.size());
  return {.rmse = std::sqrt(sum / count),
          .rmse_inside = inside == 0 ? 0.0 : std::sqrt(sum_inside / static_cast<double>(inside)),
          .mean = mean / count};
}

std::string to_table(const std::vector<Result>& results, const Reference& reference) {
  GLINT_CHECK(!results.empty(), "the first row is what the others are compared with");
  std::string out;
  append_row(out, {"warm", "cold", "CPU s", "CPU s", "CPU s", "RMSE", "RMSE off"}, "", "");
  append_row(out,
             {"/ Glint", "/ Glint", "a frame", "warm", "cold", "frame 0", "the slot"},
             "tool",
             "setting");
  for (const Result& result : results) {
    append_row(out, cells_of(result, results.front(), reference), result.tool, result.setting);
  }
  fmt::format_to(std::back_inserter(out),
                 "\nRMSE against {} rays a pixel of Glint. What was measured:\n",
                 reference.rays_per_pixel);
  for (const Result& result : results) {
    fmt::format_to(
        std::back_inserter(out), "  {} {}: {}\n", result.tool, result.setting, result.notes);
  }
  out += "\nSettings:\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    // Rows of one tool stand together; what they share is said once.
    if (i > 0 && results[i].settings == results[i - 1].settings) {
      continue;
    }
    for (const std::string& line : results[i].settings) {
      fmt::format_to(std::back_inserter(out), "  {}: {}\n", results[i].tool, line);
    }
  }
  return out;
}

void write_json(const std::filesystem::path& path,
                const std::vector<Result>& results,
                const Reference& reference) {
  GLINT_CHECK(!results.empty(), "the first row is what the others are compared with");
  json rows = json::array();
  for (const Result& result : results) {
    rows.push_back(json_of(result, results.front(), reference));
  }
  const json all = {{"reference_rays_per_pixel", reference.rays_per_pixel}, {"rows", rows}};
  write_file(path, all.dump(2) + "\n");
}

}  // namespace glint::peers
