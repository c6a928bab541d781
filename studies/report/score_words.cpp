// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/score_words.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "metrics/scores.h"

namespace glint::report_detail {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

/// Last parts of names that are no words, or are less than a reader needs.
constexpr std::array kWords = {Words{"h_rms", "h (rms)"},
                               Words{"h_abs", "h (abs)"},
                               Words{"u0", "U0"},
                               Words{"robust", "h by percentiles"},
                               Words{"residual", "h without shading"},
                               Words{"worst_region", "h of the worst region"},
                               Words{"made", "number of defects"},
                               Words{"cnr", "CNR"},
                               Words{"weber", "Weber contrast"},
                               Words{"michelson", "Michelson contrast"},
                               Words{"rms_contrast", "RMS contrast"},
                               Words{"peak", "peak contrast"},
                               Words{"dprime", "d'"},
                               Words{"signature", "signature area"},
                               Words{"best_frame", "difference in the best frame"},
                               Words{"union", "area that changes"},
                               Words{"auc", "AUC"},
                               Words{"total", "cost"},
                               Words{"pod_a90_um", "a90 (\u00b5m)"}};

constexpr std::array kUnits = {Words{"_mm", "mm"},
                               Words{"_mm3", "mm\u00b3"},
                               Words{"_px", "px"},
                               Words{"_um", "\u00b5m"},
                               Words{"_mrad", "mrad"}};

/// The name without that beginning or end; empty: it has none.
std::optional<std::string> without(std::string_view name,
                                   std::string_view beginning,
                                   std::string_view end) {
  if (name.starts_with(beginning) && name.ends_with(end) &&
      name.size() > beginning.size() + end.size()) {
    name.remove_prefix(beginning.size());
    name.remove_suffix(end.size());
    return std::string(name);
  }
  return std::nullopt;
}

std::string in_capitals(std::string text, std::string_view word) {
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    std::ranges::transform(word, text.begin() + static_cast<std::ptrdiff_t>(at), [](char c) {
      return static_cast<char>(c - 'a' + 'A');
    });
  }
  return text;
}

/// The last part of a score's name in words.
std::string words_of(const std::string& name) {
  const auto known = std::ranges::find(kWords, std::string_view(name), &Words::first);
  if (known != kWords.end()) {
    return std::string(known->second);
  }
  for (const auto& [key, word] : {Words{"min", "smallest"}, {"max", "largest"}, {"mean", "mean"}}) {
    for (const auto& plain :
         {without(name, std::string(key) + "_", ""), without(name, "", "_" + std::string(key))}) {
      if (plain) {
        return fmt::format("{} {}", word, words_of(*plain));
      }
    }
  }
  for (const auto& [end, unit] : kUnits) {
    if (const auto plain = without(name, "", end)) {
      return fmt::format("{} ({})", words_of(*plain), unit);
    }
  }
  std::string text = name;
  std::ranges::replace(text, '_', ' ');
  return in_capitals(in_capitals(in_capitals(text, "cnr"), "snr"), "auc");
}

bool is_share(std::string_view score) {
  const std::string_view name = without_bound(without_error(score));
  return std::ranges::any_of(
      std::array<std::string_view, 7>{
          "h_rms", "h_abs", "share", "contrast", "fraction", "coverage", "rate"},
      [&](std::string_view end) { return name.ends_with(end); });
}

}  // namespace

std::string score_label(const std::string& score) {
  if (is_bound(score)) {
    return fmt::format("{}, {} bound",
                       score_label(std::string(without_bound(score))),
                       score.ends_with(".low") ? "lower" : "upper");
  }
  if (is_error(score)) {
    return fmt::format("{}, standard error", score_label(std::string(without_error(score))));
  }
  const std::vector<std::string> parts = split(score, '.');
  const std::string label = words_of(parts.back());
  const bool is_of_one_defect =
      parts.size() > 2 && (parts.front() == "defects" || parts.front() == "inspection");
  return is_of_one_defect ? parts[parts.size() - 2] + ": " + label : label;
}

nlohmann::ordered_json score_words(const std::string& score) {
  nlohmann::ordered_json words = {{"label", score_label(score)},
                                  {"format", is_share(score) ? "percent" : "number"}};
  const bool is_plain = score.find('.') == std::string::npos;  // of a defect's own list
  if (const auto meaning = explain_score(is_plain ? "defects.any." + score : score)) {
    words["meaning"] = *meaning;
  }
  return words;
}

}  // namespace glint::report_detail
