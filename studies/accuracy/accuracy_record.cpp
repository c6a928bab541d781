// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_record.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

constexpr const char* kTrialName = "trial ";  ///< and its number

std::string key_of(const std::string& rung, const std::string& design) {
  return fmt::format("{} | {}", rung, design);
}

}  // namespace

AccuracyRecord::AccuracyRecord(Storage* storage) : storage_(storage) {
  if (storage_ == nullptr) {
    return;
  }
  for (const Trial& trial : storage_->trials(TrialKind::kPart)) {
    last_number_ = std::max(last_number_, trial.number);
    if (trial.outcome) {
      known_[trial.name] = *trial.outcome;
    }
  }
}

std::optional<Event> AccuracyRecord::begun() const {
  if (storage_ == nullptr) {
    return std::nullopt;
  }
  const std::vector<Event> events = storage_->events();
  const auto found = std::ranges::find(events, EventKind::kRules, &Event::kind);
  return found != events.end() ? std::optional(*found) : std::nullopt;
}

void AccuracyRecord::check_rules(bool is_begun) const {
  const std::optional<Event> noted = begun();
  if (storage_ == nullptr || (!noted && !is_begun)) {
    return;
  }
  const double rules = noted ? noted->value : 1.0;
  if (noted && begun_rules() > kCombinedRules) {
    throw ConfigError(
        fmt::format("this study was begun by a newer Glint (accuracy rules {:g}, this program "
                    "knows {})",
                    rules,
                    kPixelRules));
  }
  if (rules < kAccuracyRules) {
    throw ConfigError(fmt::format(
        "this study cannot be resumed: its [accuracy] was chosen by accuracy rules {:g}, whose "
        "bounds were too narrow, or its accuracy.sqlite is missing; this program chooses by "
        "rules {} and might take another way to render. Run into a new folder; the old best "
        "design can be given as a start point",
        rules,
        kAccuracyRules));
  }
}

void AccuracyRecord::begin_search(const std::string& rung, int rules, bool has_sampled_checks) {
  if (storage_ == nullptr) {
    return;
  }
  const std::optional<Event> noted = begun();
  if (!noted) {
    Event event = {.kind = EventKind::kRules, .value = static_cast<double>(rules), .text = rung};
    if (has_sampled_checks) {
      event.value = static_cast<double>(kPixelRules);
      event.objectives = {static_cast<double>(rules)};
    }
    storage_->append(std::vector<Event>{event});
  } else if (noted->text != rung) {
    throw ConfigError(fmt::format(
        "this study cannot be resumed: its search began with \"{}\" and would now begin with "
        "\"{}\"; the program, a library or the machine changed since. Run into a new folder",
        noted->text,
        rung));
  }
}

std::optional<std::string> AccuracyRecord::begun_rung() const {
  const std::optional<Event> noted = begun();
  return noted ? std::optional(noted->text) : std::nullopt;
}

std::optional<int> AccuracyRecord::begun_rules() const {
  const std::optional<Event> noted = begun();
  if (!noted) {
    return std::nullopt;
  }
  const bool has_both = noted->value == kPixelRules && !noted->objectives.empty();
  return static_cast<int>(has_both ? noted->objectives.front() : noted->value);
}

std::optional<bool> AccuracyRecord::begun_with_sampled_checks() const {
  const std::optional<Event> noted = begun();
  return noted ? std::optional(noted->value == kPixelRules) : std::nullopt;
}

const Outcome* AccuracyRecord::find(const std::string& rung, const std::string& design) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(key_of(rung, design));
  return found != known_.end() ? &found->second : nullptr;
}

void AccuracyRecord::keep(const std::string& rung,
                          const std::string& design,
                          const Point& point,
                          const Outcome& outcome) {
  const std::lock_guard lock(mutex_);
  const std::string key = key_of(rung, design);
  if (!known_.try_emplace(key, outcome).second) {
    return;
  }
  if (storage_ != nullptr) {
    storage_->put_trial({.kind = TrialKind::kPart,
                         .number = ++last_number_,
                         .name = key,
                         .point = point,
                         .outcome = outcome});
  }
  hand_on(key, outcome);
}

void AccuracyRecord::follow(OnTrialOutcome on_outcome) {
  const std::lock_guard lock(mutex_);
  on_outcome_ = std::move(on_outcome);
  for (const auto& [key, outcome] : known_) {
    hand_on(key, outcome);
  }
}

void AccuracyRecord::hand_on(const std::string& key, const Outcome& outcome) const {
  const std::string before_number = key_of("", kTrialName);
  const std::size_t at = key.rfind(before_number);
  if (!on_outcome_ || at == std::string::npos) {
    return;
  }
  const char* end = key.data() + key.size();
  int trial = 0;
  const auto [rest, error] = std::from_chars(key.data() + at + before_number.size(), end, trial);
  if (error == std::errc() && rest == end) {
    on_outcome_(key.substr(0, at), trial, outcome);
  }
}

std::string trial_name(int number) {
  return fmt::format("{}{}", kTrialName, number);
}

}  // namespace glint
