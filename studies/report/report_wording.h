// SPDX-License-Identifier: GPL-3.0-or-later
//
// Words about a score of report data: how a value and a difference of it are written, what is
// better, and how large its noise is. Private to the module.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace glint::report_detail {

/// What was measured, as the page writes it (measured() of web/format.js): three significant
/// digits (unless told), also where the last are zeros, never fewer than the whole number has;
/// "13.0", "0.380", "1235", from a million on and below 0.0001 "8.61 x 10^-5" with a times sign and
/// superscripts.
std::string measured(double value, int significant = 3);

/// How one score of the designs is read and written.
class Wording {
 public:
  /// Of the objective.
  explicit Wording(const nlohmann::ordered_json& data);

  /// Of any score.
  Wording(const nlohmann::ordered_json& data, std::string score, bool is_maximised);

  /// Of a score that no report data describe; more is better.
  static Wording of_score(const std::string& score);

  const std::string& score() const { return score_; }

  const std::string& label() const { return label_; }

  bool is_maximised() const { return is_maximised_; }

  /// Fresh seeds first: the search's own number is the best of many and so a little too good.
  std::optional<double> value(const nlohmann::ordered_json& design) const;

  /// With the seeds of the search.
  std::optional<double> searched(const nlohmann::ordered_json& design) const;

  /// The same design scored again and again, each time with other noise; empty: it was not.
  std::vector<double> repeated(const nlohmann::ordered_json& design) const;

  /// Half the width of the 95 % interval of value(); empty: it has none.
  std::optional<double> noise(const nlohmann::ordered_json& design) const;

  /// The same of the difference of two designs, which share their noise where both are repeated.
  std::optional<double> noise(const nlohmann::ordered_json& design,
                              const nlohmann::ordered_json& other) const;

  bool is_better(double a, double b) const { return is_maximised_ ? a > b : a < b; }

  /// Whether two values print as one.
  bool is_level(double a, double b) const;

  /// "74.5 %", "0.63 %", "12.8": percent() and measured() of web/format.js.
  /// @param more  digits than there
  std::string text(double value, int more = 0) const;

  /// What was set: four digits, "5", "12.35", "71.25 %".
  /// @param more  digits than text() has
  std::string limit(double value, int more = 0) const;

  /// How many digits more than text() has tell a value from another.
  int digits_apart(double value, double limit) const;

  std::string size(double gap) const;  ///< of a difference: "6.4 points", "0.02 points", "0.12"

  std::string noise_text(double noise) const;  ///< as a size, "none" for 0

  /// "6.4 points better than", "level with".
  std::string against(double value, double other) const;

 private:
  std::string score_;
  std::string label_;
  bool is_maximised_ = true;
  bool is_percent_ = false;
};

/// "winner", "baseline" or "prototype".
std::string role_of(const nlohmann::ordered_json& design);

/// Its title, or else its key.
std::string title_of(const nlohmann::ordered_json& design);

/// The best of the designs with that role ("" = any) that has a value, feasible ones first; nullptr
/// when there is none.
const nlohmann::ordered_json* best_design(const nlohmann::ordered_json& designs,
                                          const Wording& wording,
                                          std::string_view role);

/// Whether a value keeps the limits of an entry of `constraints`; a missing one does not.
bool meets(const nlohmann::ordered_json& constraint, const std::optional<double>& value);

/// "smallest CNR is 2.10, must be at least 3", "smallest CNR is 4.998, must be at least 5": of a
/// value that does not keep the limits, with as many digits as show that.
std::string missed_text(const nlohmann::ordered_json& constraint,
                        const Wording& wording,
                        double value);

/// What a design lacks: "smallest CNR is 2.10, must be at least 3", one for each limit that it
/// misses, by the seeds of the search. Empty where nothing is missed, or nothing is known.
std::vector<std::string> missed_limits(const nlohmann::ordered_json& data,
                                       const nlohmann::ordered_json& design);

}  // namespace glint::report_detail
