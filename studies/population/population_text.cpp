// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/population_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/report/report_wording.h"

namespace glint::population_detail {

using PartJson = nlohmann::ordered_json;
using report_detail::measured;

std::string share_text(const PartJson& estimate) {
  return fmt::format("{:.1f} % ({:.1f} to {:.1f} %)",
                     100.0 * estimate["value"].get<double>(),
                     100.0 * estimate["low"].get<double>(),
                     100.0 * estimate["high"].get<double>());
}

std::string rate_text(const PartJson& alarms) {
  const PartJson& rate = alarms["per_part"];
  return fmt::format("{} ({} to {})",
                     measured(rate["value"].get<double>()),
                     measured(rate["low"].get<double>()),
                     measured(rate["high"].get<double>()));
}

double largest_size(const PartJson& design) {
  return design["levels"].back()["size"].get<double>();
}

std::string size_text(const PartJson& size, double largest) {
  if (size.is_null()) {
    return "-";
  }
  const auto value = size.get<double>();
  return value > largest ? "> " + measured(largest) : measured(value);
}

std::string a90_text(const PartJson& fit, double largest) {
  if (fit.is_null()) {
    return "-";
  }
  const PartJson& a90 = fit["a90"];
  const std::string value = size_text(a90["value"], largest);
  return value.starts_with('>') ? value
                                : fmt::format("{} ({} to {})",
                                              value,
                                              size_text(a90["low"], largest),
                                              size_text(a90["high"], largest));
}

}  // namespace glint::population_detail
