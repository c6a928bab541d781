// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_front.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

/// With fresh seeds where it was scored again.
std::optional<double> value_of(const Json& design, const std::string& score) {
  const auto fresh = number_of(member(design, "rescored"), score);
  return fresh ? fresh : number_of(member(design, "scores"), score);
}

/// "h (rms) from 70.0 % to 81.2 %"
std::string range_text(const Json& data, const Json& objective) {
  const std::string score = text_of(objective, "score");
  const Wording wording(data, score, text_of(objective, "direction") == "maximise");
  std::vector<double> values;
  for (const Json& design : member(member(data, "front"), "designs")) {
    if (const auto value = value_of(design, score)) {
      values.push_back(*value);
    }
  }
  if (values.empty()) {
    return wording.label() + " unknown";
  }
  const auto [low, high] = std::ranges::minmax(values);
  return fmt::format("{} from {} to {}", wording.label(), wording.text(low), wording.text(high));
}

/// "evaluation 5", "evaluations 5 and 12"
std::string evaluations_text(const std::vector<std::string>& numbers) {
  const std::vector<std::string> first(numbers.begin(), numbers.end() - 1);
  return numbers.size() == 1 ? "evaluation " + numbers.front()
                             : "evaluations " + join(first, ", ") + " and " + numbers.back();
}

/// "2 of the 12 designs scored again ..."
void say_fresh(const Json& front, std::vector<Finding>& findings) {
  const Json& summary = member(front, "rescored");
  const auto count = number_of(summary, "designs");
  if (!count || *count < 2.0) {
    return;
  }
  std::vector<std::string> beaten;
  std::vector<std::string> lost;
  for (const Json& design : member(front, "designs")) {
    const std::string number = member(design, "trial").dump();
    if (design.contains("dominated_by")) {
      beaten.push_back(number);
    } else if (member(design, "keeps_limits") == Json(false)) {
      lost.push_back(number);
    }
  }
  const std::string of =
      fmt::format("Scored again with fresh seeds, of {:.0f} designs of the front ", *count);
  std::vector<std::string> parts;
  if (!beaten.empty()) {
    parts.push_back(fmt::format("{} {} by another one ({})",
                                beaten.size(),
                                beaten.size() == 1 ? "is beaten" : "are beaten",
                                evaluations_text(beaten)));
  }
  if (!lost.empty()) {
    parts.push_back(fmt::format("{} {} a limit ({})",
                                lost.size(),
                                lost.size() == 1 ? "misses" : "miss",
                                evaluations_text(lost)));
  }
  findings.push_back(parts.empty() ? Finding{"front_holds", of + "none is beaten by another one."}
                                   : Finding{"front_shrinks", of + join(parts, ", ") + "."});
}

void say_compromise(const Json& front, std::vector<Finding>& findings) {
  const Json& chosen = member(member(front, "chosen"), "trial");
  for (const Json& design : member(front, "designs")) {
    if (member(design, "trial") == chosen && design.contains("dominated_by")) {
      findings.push_back(
          {"compromise_dominated",
           fmt::format("The compromise itself is one of them: evaluation {} is nowhere worse and "
                       "somewhere better. They may differ by noise alone; look at both.",
                       design["dominated_by"].dump())});
    }
  }
}

}  // namespace

std::vector<Finding> findings_on_front(const Json& data) {
  const Json& front = member(data, "front");
  const std::size_t count = member(front, "designs").size();
  std::vector<Finding> findings;
  std::vector<std::string> ranges;
  for (const Json& objective : member(front, "objectives")) {
    ranges.push_back(range_text(data, objective));
  }
  if (count > 1) {
    findings.push_back(
        {"front_range", fmt::format("The front has {} designs, {}.", count, join(ranges, ", "))});
  }
  if (member(front, "is_expected") == Json(true)) {
    findings.push_back({"front_expected",
                        "As single evaluations are noisy, the front is of what the search's model "
                        "expects of its designs, not of what was seen of them."});
  }
  say_fresh(front, findings);
  say_compromise(front, findings);
  if (const auto outside = number_of(front, "outside"); outside && *outside > 0.0) {
    findings.push_back(
        {"reference_inside",
         fmt::format("The reference lies inside the front: {:.0f} of its {} designs are not better "
                     "than it in every objective and add nothing to the hypervolume.",
                     *outside,
                     count)});
  }
  return findings;
}

}  // namespace glint::report_detail
