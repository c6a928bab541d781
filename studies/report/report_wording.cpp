// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_wording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "metrics/scores.h"
#include "metrics/statistics/estimate.h"
#include "studies/report/report_verdict.h"
#include "studies/report/score_words.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDigits = 3;  // of what was measured

/// Half the width of the interval that holds 95 % of single values like these; mean_of() tells
/// that of their mean, which is narrower by the root of their number.
/// @param unit  rounding errors are of its size: what is below them is 0
double spread_of(const std::vector<double>& values, double unit) {
  constexpr double kRounding = 1e-12;
  const Estimate mean = mean_of(values);
  const double spread =
      0.5 * (mean.high - mean.low) * std::sqrt(static_cast<double>(values.size()));
  return spread > kRounding * unit ? spread : 0.0;
}

double largest(const std::vector<double>& values) {
  return std::abs(
      *std::ranges::max_element(values, {}, [](double value) { return std::abs(value); }));
}

/// "-5" as superscripts.
std::string raised(int exponent) {
  constexpr std::array kSuperscripts = {"\u2070",
                                        "\u00b9",
                                        "\u00b2",
                                        "\u00b3",
                                        "\u2074",
                                        "\u2075",
                                        "\u2076",
                                        "\u2077",
                                        "\u2078",
                                        "\u2079"};
  std::string text = exponent < 0 ? "\u207b" : "";
  for (const char digit : std::to_string(std::abs(exponent))) {
    text += kSuperscripts[static_cast<std::size_t>(digit - '0')];
  }
  return text;
}

/// The first digits of a number and its power of ten.
struct RoundedNumber {
  std::string digits;
  int exponent = 0;
};

/// As JavaScript does: a half is rounded away from 0. @param value  > 0
RoundedNumber rounded(double value, std::size_t count) {
  const std::string exact = fmt::format("{:.60e}", value);  // "9.996...e+00"
  const auto mark = exact.find('e');
  RoundedNumber number = {.digits = exact.substr(0, 1) + exact.substr(2, count),
                          .exponent = std::stoi(exact.substr(mark + 1))};
  bool is_up = number.digits.back() >= '5';
  number.digits.pop_back();
  for (std::size_t i = count; is_up && i-- > 0;) {
    is_up = number.digits[i] == '9';
    number.digits[i] = is_up ? '0' : static_cast<char>(number.digits[i] + 1);
  }
  if (is_up) {
    number.digits.insert(0, 1, '1');
    number.digits.pop_back();
    ++number.exponent;
  }
  return number;
}

/// So many decimals as the page has: one, two below 1 %, and some more.
std::string percent_text(double value, int more) {
  constexpr double kFine_percent = 0.995;
  const double size = std::abs(100 * value);
  const int decimals = (size != 0.0 && size < kFine_percent ? 2 : 1) + more;
  return fmt::format("{}{:.{}f} %", value < 0.0 ? "\u2212" : "", size, decimals);
}

/// What was set: without the zeros at the end, "13", "12.35".
std::string set_number(double value, int digits) {
  std::string text = measured(value, digits);
  if (text.find('.') == std::string::npos || text.find("\u00d7") != std::string::npos) {
    return text;
  }
  text.erase(text.find_last_not_of('0') + 1);
  return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
}

/// As percent_text(), with the decimals that the first four digits need.
std::string set_percent(double value, int more) {
  const double size = std::abs(100 * value);
  const std::string digits = set_number(size, 4);
  const auto point = digits.find('.');
  const auto needed = point == std::string::npos ? 0 : static_cast<int>(digits.size() - point) - 1;
  const std::string page = percent_text(value, 0);
  const auto shown = static_cast<int>(page.find(' ') - page.find('.')) - 1;
  return percent_text(value, std::max(more, std::min(needed - shown, 4)));
}

}  // namespace

std::string measured(double value, int significant) {
  if (value == 0.0) {
    return "0";
  }
  const auto [digits, exponent] = rounded(std::abs(value), static_cast<std::size_t>(significant));
  const auto whole = static_cast<std::size_t>(std::max(0, exponent + 1));
  std::string text;
  if (exponent >= 6 || exponent < -4) {
    text = digits.substr(0, 1) + "." + digits.substr(1) + "\u00a0\u00d7\u00a010" + raised(exponent);
  } else if (exponent < 0) {
    text = "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + digits;
  } else if (whole < digits.size()) {
    text = digits.substr(0, whole) + "." + digits.substr(whole);
  } else {
    text = fmt::format("{:.0f}", std::floor(std::abs(value) + 0.5));
  }
  return (value < 0.0 ? "\u2212" : "") + text;
}

Wording::Wording(const Json& data)
    : Wording(data,
              text_of(member(data, "objective"), "name"),
              !text_of(member(data, "objective"), "sense").starts_with("min")) {}

Wording::Wording(const Json& data, std::string score, bool is_maximised)
    : score_(std::move(score)), is_maximised_(is_maximised) {
  const Json& info = member(member(data, "score_info"), score_.c_str());
  label_ = text_of(info, "label").empty() ? score_ : text_of(info, "label");
  is_percent_ = text_of(info, "format") == "percent";
}

Wording Wording::of_score(const std::string& score) {
  Json data;
  data["score_info"][score] = score_words(score);
  return {data, score, true};
}

std::optional<double> Wording::value(const Json& design) const {
  const auto fresh = number_of(member(design, "rescored"), score_);
  return fresh ? fresh : searched(design);
}

std::optional<double> Wording::searched(const Json& design) const {
  return number_of(member(design, "scores"), score_);
}

std::vector<double> Wording::repeated(const Json& design) const {
  std::vector<double> values;
  for (const Json& value : member(member(design, "repeated"), score_.c_str())) {
    if (!value.is_number()) {
      return {};
    }
    values.push_back(value.get<double>());
  }
  return values;
}

std::optional<double> Wording::noise(const Json& design) const {
  const bool is_fresh = number_of(member(design, "rescored"), score_).has_value();
  const Json& scores = member(design, is_fresh ? "rescored" : "scores");
  const std::string whole(without_bound(score_));
  const auto low = number_of(scores, whole + ".low");
  const auto high = number_of(scores, whole + ".high");
  const auto error = number_of(scores, error_name(whole));
  if (error || (low && high)) {
    return std::hypot(low && high ? 0.5 * (*high - *low) : 0.0, 2.0 * error.value_or(0.0));
  }
  const std::vector<double> values = repeated(design);
  return values.size() < 2 ? std::nullopt : std::optional(spread_of(values, largest(values)));
}

std::optional<double> Wording::noise(const Json& design, const Json& other) const {
  const std::vector<double> here = repeated(design);
  const std::vector<double> there = repeated(other);
  if (here.size() > 1 && here.size() == there.size()) {
    std::vector<double> gaps(here.size());
    std::ranges::transform(here, there, gaps.begin(), std::minus());
    return spread_of(gaps, std::max(largest(here), largest(there)));
  }
  const auto own = noise(design);
  const auto its = noise(other);
  return own && its ? std::optional(std::hypot(*own, *its)) : std::nullopt;
}

bool Wording::is_level(double a, double b) const {
  return text(a) == text(b);
}

std::string Wording::text(double value, int more) const {
  return is_percent_ ? percent_text(value, more) : measured(value, kDigits + more);
}

std::string Wording::limit(double value, int more) const {
  return is_percent_ ? set_percent(value, more) : set_number(value, kDigits + std::max(1, more));
}

int Wording::digits_apart(double value, double limit) const {
  constexpr int kMax = 14;
  int more = 0;
  while (more < kMax && text(value, more) == text(limit, more)) {
    ++more;
  }
  return more;
}

std::string Wording::size(double gap) const {
  if (!is_percent_) {
    return measured(gap);
  }
  constexpr int kMax = 4;
  int decimals = 1;
  for (double least = 0.05; gap > 0.0 && 100 * gap < least && decimals < kMax; least /= 10) {
    ++decimals;
  }
  return fmt::format("{:.{}f} points", 100 * gap, decimals);
}

std::string Wording::noise_text(double noise) const {
  return noise > 0.0 ? size(noise) : "none";
}

std::string Wording::against(double value, double other) const {
  if (is_level(value, other)) {
    return "level with";
  }
  return size(std::abs(value - other)) + (is_better(value, other) ? " better than" : " worse than");
}

std::string role_of(const Json& design) {
  std::string role = text_of(design, "role");
  const std::string key = text_of(design, "key");
  if (!role.empty()) {
    return role;
  }
  return key == "winner" || key == "baseline" ? key : "prototype";
}

std::string title_of(const Json& design) {
  const std::string title = text_of(design, "title");
  return title.empty() ? text_of(design, "key") : title;
}

const Json* best_design(const Json& designs, const Wording& wording, std::string_view role) {
  const Json* best = nullptr;
  for (const Json& design : designs) {
    const auto value = wording.value(design);
    if (!value || (!role.empty() && role_of(design) != role)) {
      continue;
    }
    const bool is_feasible = member(design, "feasible") != Json(false);
    const bool best_is_feasible = best != nullptr && member(*best, "feasible") != Json(false);
    if (best == nullptr || (is_feasible && !best_is_feasible) ||
        (is_feasible == best_is_feasible && wording.is_better(*value, *wording.value(*best)))) {
      best = &design;
    }
  }
  return best;
}

bool meets(const Json& constraint, const std::optional<double>& value) {
  const auto low = number_of(constraint, "min");
  const auto high = number_of(constraint, "max");
  return value && (!low || *value >= *low) && (!high || *value <= *high);
}

std::string missed_text(const Json& constraint, const Wording& wording, double value) {
  const auto low = number_of(constraint, "min");
  const auto high = number_of(constraint, "max");
  const auto missed = low && value < *low ? low : high;
  const int more = missed ? wording.digits_apart(value, *missed) : 0;
  std::vector<std::string> parts;
  if (low) {
    parts.push_back("at least " + wording.limit(*low, more));
  }
  if (high) {
    parts.push_back("at most " + wording.limit(*high, more));
  }
  return fmt::format(
      "{} is {}, must be {}", wording.label(), wording.text(value, more), join(parts, " and "));
}

std::vector<std::string> missed_limits(const Json& data, const Json& design) {
  std::vector<std::string> missed;
  for (const Json& constraint : member(data, "constraints")) {
    const Wording wording(data, text_of(constraint, "name"), true);
    const auto value = wording.searched(design);
    if (value && !meets(constraint, value)) {
      missed.push_back(missed_text(constraint, wording, *value));
    }
  }
  return missed;
}

}  // namespace glint::report_detail
