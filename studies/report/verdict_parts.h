// SPDX-License-Identifier: GPL-3.0-or-later
//
// What verdicts of every kind are made of. Private to the module.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report_findings.h"

namespace glint::report_detail {

/// A verdict in the making.
struct Verdict {
  const char* tone = "neutral";
  std::vector<Finding> headline = {};
  std::vector<Finding> details = {};

  void say(const char* code, const std::string& text) { headline.push_back({code, text}); }

  void add(std::vector<Finding> more);

  /// Good where it gains and nothing makes that doubtful, else neutral.
  void judge(bool is_gain);

 private:
  /// Whether a defect shows less or not at all, a limit is lost, or chance decides.
  bool is_doubtful() const;
};

/// Whether a design meets the limits, and which it does not.
void say_limits(const nlohmann::ordered_json& data,
                const nlohmann::ordered_json& design,
                Verdict& verdict);

/// The lead of one design over another beside the noise of both.
struct Lead {
  double lead = 0.0;   ///< negative: it is behind
  double noise = 0.0;  ///< half the interval of the difference

  bool is_sure() const { return lead > noise; }
};

/// Empty where a score has no interval.
std::optional<Lead> lead_over(const nlohmann::ordered_json* other,
                              const nlohmann::ordered_json& design,
                              const Wording& wording);

/// Whether a design is better than another by more than their noise, or, where that is not known,
/// by more than is printed.
bool is_ahead(const nlohmann::ordered_json& other,
              const nlohmann::ordered_json& design,
              const Wording& wording);

}  // namespace glint::report_detail
