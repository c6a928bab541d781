// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_record.h"

#include <algorithm>

#include <fmt/format.h>

namespace glint {
namespace {

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
  if (!known_.try_emplace(key, outcome).second || storage_ == nullptr) {
    return;
  }
  storage_->put_trial({.kind = TrialKind::kPart,
                       .number = ++last_number_,
                       .name = key,
                       .point = point,
                       .outcome = outcome});
}

std::string trial_name(int number) {
  return fmt::format("trial {}", number);
}

}  // namespace glint
