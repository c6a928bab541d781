// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/space.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "core/config/keys.h"
#include "core/error.h"
#include "core/text.h"

namespace glint {

namespace {

using Kind = Variable::Kind;

/// Steps that miss the range's end by rounding only still count.
constexpr double kStepSlack = 1e-9;

double step_of(const Variable& variable) {
  return variable.kind == Kind::kInteger && variable.step <= 0.0 ? 1.0 : variable.step;
}

/// low + k * step, with k limited to what the range holds.
double stepped(const Variable& variable, double k) {
  const double last = num_values(variable) - 1.0;
  const double value = variable.low + std::clamp(k, 0.0, last) * step_of(variable);
  return std::min(value, variable.high) + 0.0;
}

/// Logarithmic integers get half a step of margin on both sides, so that the end values are as
/// likely as their neighbours.
double log_integer_low(const Variable& variable) {
  return std::max(variable.low - 0.5 * step_of(variable), 0.5 * variable.low);
}

double log_integer_high(const Variable& variable) {
  return variable.high + 0.5 * step_of(variable);
}

double integer_from_unit(const Variable& variable, double unit) {
  if (!variable.is_log) {
    return stepped(variable, std::floor(unit * num_values(variable)));
  }
  const double low = std::log(log_integer_low(variable));
  const double high = std::log(log_integer_high(variable));
  const double value = std::exp(low + unit * (high - low));
  return stepped(variable, std::round((value - variable.low) / step_of(variable)));
}

double float_from_unit(const Variable& variable, double unit) {
  double value = variable.low + unit * (variable.high - variable.low);
  if (variable.is_log) {
    const double low = std::log(variable.low);
    value = std::exp(low + unit * (std::log(variable.high) - low));
  }
  if (unit <= 0.0) {
    value = variable.low;
  } else if (unit >= 1.0) {
    value = variable.high;
  }
  if (variable.step > 0.0) {
    return stepped(variable, std::round((value - variable.low) / variable.step));
  }
  return std::clamp(value, variable.low, variable.high) + 0.0;
}

double value_from_unit(const Variable& variable, double unit) {
  unit = std::isnan(unit) ? 0.5 : std::clamp(unit, 0.0, 1.0);
  switch (variable.kind) {
    case Kind::kChoice:
      return std::min(std::floor(unit * num_values(variable)), num_values(variable) - 1.0);
    case Kind::kInteger:
      return integer_from_unit(variable, unit);
    case Kind::kFloat:
      break;
  }
  return float_from_unit(variable, unit);
}

double unit_from_value(const Variable& variable, double value) {
  if (variable.kind == Kind::kChoice) {
    return (value + 0.5) / num_values(variable);
  }
  if (variable.high <= variable.low) {
    return 0.5;
  }
  double unit = 0.0;
  if (variable.kind == Kind::kInteger && variable.is_log) {
    const double low = std::log(log_integer_low(variable));
    unit = (std::log(value) - low) / (std::log(log_integer_high(variable)) - low);
  } else if (variable.kind == Kind::kInteger) {
    unit = ((value - variable.low) / step_of(variable) + 0.5) / num_values(variable);
  } else if (variable.is_log) {
    const double low = std::log(variable.low);
    unit = (std::log(value) - low) / (std::log(variable.high) - low);
  } else {
    unit = (value - variable.low) / (variable.high - variable.low);
  }
  return std::isnan(unit) ? 0.5 : std::clamp(unit, 0.0, 1.0);
}

/// The allowed value next to a given one.
double nearest_value(const Variable& variable, double value) {
  if (std::isnan(value)) {
    return value_from_unit(variable, 0.5);
  }
  if (variable.kind == Kind::kChoice) {
    return std::clamp(std::round(value), 0.0, num_values(variable) - 1.0) + 0.0;
  }
  value = std::clamp(value, variable.low, variable.high);
  if (step_of(variable) > 0.0) {
    return stepped(variable, std::round((value - variable.low) / step_of(variable)));
  }
  return value + 0.0;
}

const Variable* find_variable(const SearchSpace& space, const std::string& name) {
  const auto it = std::ranges::find(space.variables, name, &Variable::name);
  return it == space.variables.end() ? nullptr : &*it;
}

std::size_t index_in(const SearchSpace& space, const Variable& variable) {
  return static_cast<std::size_t>(&variable - space.variables.data());
}

std::optional<double> number_from_text(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) {
    return std::nullopt;
  }
  return value;
}

/// The value that a condition's text means; empty when the variable cannot have it.
std::optional<double> condition_value(const Variable& variable, const std::string& text) {
  if (variable.kind == Kind::kChoice) {
    const auto it = std::ranges::find(variable.choices, text);
    if (it == variable.choices.end()) {
      return std::nullopt;
    }
    return static_cast<double>(it - variable.choices.begin());
  }
  const std::optional<double> value = number_from_text(text);
  if (!value || !(*value >= variable.low && *value <= variable.high)) {
    return std::nullopt;
  }
  const double nearest = nearest_value(variable, *value);
  const bool is_same = std::abs(nearest - *value) <= kStepSlack * (1.0 + std::abs(*value));
  return is_same ? std::optional<double>(nearest) : std::nullopt;
}

/// All values with which a variable is active, as they are written.
std::vector<std::string> condition_texts(const Variable& variable) {
  std::vector<std::string> texts = {variable.when_value};
  texts.insert(texts.end(), variable.when_others.begin(), variable.when_others.end());
  return texts;
}

bool condition_holds(const Variable& variable, const Variable& parent, double value) {
  return std::ranges::any_of(condition_texts(variable), [&](const std::string& text) {
    return condition_value(parent, text) == value;
  });
}

/// Collects what is wrong with a space, one line per problem.
class SpaceChecker {
 public:
  explicit SpaceChecker(const SearchSpace& space) : space_(space) {}

  std::vector<Problem> run() {
    std::set<std::string> names;
    for (const Variable& variable : space_.variables) {
      if (variable.name.empty()) {
        add(variable, "a variable needs a name");
      } else if (!names.insert(variable.name).second) {
        add(variable, "is declared twice");
      }
      if (variable.kind == Kind::kChoice) {
        check_choices(variable);
      } else {
        check_numbers(variable);
      }
      check_condition(variable);
    }
    return errors_;
  }

 private:
  void add(const Variable& variable, const std::string& text) {
    errors_.push_back({.key = "variable \"" + variable.name + "\"", .text = text});
  }

  void check_choices(const Variable& variable) {
    if (variable.choices.empty()) {
      add(variable, "choices is empty, at least one is needed");
    }
    const std::set<std::string> unique(variable.choices.begin(), variable.choices.end());
    if (unique.size() != variable.choices.size()) {
      add(variable, "a choice is listed twice");
    }
  }

  void check_numbers(const Variable& variable) {
    const double low = variable.low;
    const double high = variable.high;
    if (!std::isfinite(low) || !std::isfinite(high)) {
      add(variable, "min and max must be finite");
      return;
    }
    if (low > high) {
      add(variable, "min " + shortest(low) + " is above max " + shortest(high));
      return;
    }
    if (variable.is_log && low <= 0.0) {
      add(variable, "log needs min > 0, min is " + shortest(low));
    }
    if (!(variable.step >= 0.0) || (high > low && variable.step > high - low)) {
      add(variable,
          "step " + shortest(variable.step) + " must be positive and at most the range " +
              shortest(high - low));
    }
    const bool is_whole = low == std::floor(low) && high == std::floor(high) &&
                          variable.step == std::floor(variable.step);
    if (variable.kind == Kind::kInteger && !is_whole) {
      add(variable, "an integer needs whole numbers as min, max and step");
    }
  }

  void check_condition(const Variable& variable) {
    if (variable.when_name.empty()) {
      return;
    }
    const Variable* parent = find_variable(space_, variable.when_name);
    if (parent == nullptr) {
      std::vector<std::string> names;
      for (const Variable& other : space_.variables) {
        names.push_back(other.name);
      }
      add(variable,
          "when names the unknown variable \"" + variable.when_name + "\", did you mean \"" +
              nearest(variable.when_name, names) + "\"?");
    } else if (parent == &variable) {
      add(variable, "when looks at the variable itself");
    } else if (parent->kind == Kind::kFloat && parent->step <= 0.0) {
      add(variable, "when needs a choice, an integer or a number with a step");
    } else if (is_in_circle(variable)) {
      add(variable, "its conditions run in a circle");
    } else {
      check_condition_values(variable, *parent);
    }
  }

  void check_condition_values(const Variable& variable, const Variable& parent) {
    for (const std::string& text : condition_texts(variable)) {
      if (!condition_value(parent, text)) {
        add(variable,
            "when compares with \"" + text + "\", which \"" + parent.name + "\" never is" +
                allowed_values(parent));
      }
    }
  }

  static std::string allowed_values(const Variable& variable) {
    return variable.choices.empty() ? "" : ", allowed: " + join(variable.choices, ", ");
  }

  bool is_in_circle(const Variable& start) const {
    const Variable* at = &start;
    for (std::size_t i = 0; i <= space_.variables.size(); ++i) {
      at = find_variable(space_, at->when_name);
      if (at == nullptr || at->when_name.empty()) {
        return false;
      }
    }
    return true;
  }

  const SearchSpace& space_;
  std::vector<Problem> errors_;
};

void set_inactive_to_middle(const SearchSpace& space, Point& point) {
  std::vector<bool> active(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    active[i] = is_active(space, point, i);
  }
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (!active[i]) {
      point[i] = value_from_unit(space.variables[i], 0.5);
    }
  }
}

void check_size(const SearchSpace& space, std::span<const double> values) {
  GLINT_CHECK(values.size() == space.variables.size(), "a point needs one value per variable");
}

}  // namespace

void check(const SearchSpace& space) {
  throw_if_any(SpaceChecker(space).run());
}

double num_values(const Variable& variable) {
  if (variable.kind == Kind::kChoice) {
    return static_cast<double>(variable.choices.size());
  }
  if (variable.high <= variable.low) {
    return 1.0;
  }
  const double step = step_of(variable);
  if (step <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return std::floor((variable.high - variable.low) / step + kStepSlack) + 1.0;
}

bool is_active(const SearchSpace& space, std::span<const double> point, std::size_t index) {
  const Variable* variable = &space.variables[index];
  // A chain is at most as long as the space; check() refuses circles.
  for (std::size_t i = 0; i < space.variables.size() && !variable->when_name.empty(); ++i) {
    const Variable* parent = find_variable(space, variable->when_name);
    GLINT_CHECK(parent != nullptr, "check() the space first");
    if (!condition_holds(*variable, *parent, point[index_in(space, *parent)])) {
      return false;
    }
    variable = parent;
  }
  return true;
}

Point point_from_unit(const SearchSpace& space, std::span<const double> unit) {
  check_size(space, unit);
  Point point(unit.size());
  for (std::size_t i = 0; i < unit.size(); ++i) {
    point[i] = value_from_unit(space.variables[i], unit[i]);
  }
  set_inactive_to_middle(space, point);
  return point;
}

std::vector<double> unit_from_point(const SearchSpace& space, std::span<const double> point) {
  check_size(space, point);
  std::vector<double> unit(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    unit[i] = unit_from_value(space.variables[i], point[i]);
  }
  return unit;
}

Point canonical(const SearchSpace& space, std::span<const double> point) {
  check_size(space, point);
  Point result(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    result[i] = nearest_value(space.variables[i], point[i]);
  }
  set_inactive_to_middle(space, result);
  return result;
}

double derivative_at(const SearchSpace& space, std::span<const double> point, std::size_t index) {
  check_size(space, point);
  const Variable& variable = space.variables[index];
  if (std::isfinite(num_values(variable)) || !is_active(space, point, index)) {
    return 0.0;
  }
  return variable.is_log ? point[index] * (std::log(variable.high) - std::log(variable.low))
                         : variable.high - variable.low;
}

bool is_continuous(const Variable& variable) {
  return variable.kind == Kind::kFloat;
}

}  // namespace glint
