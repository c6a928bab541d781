// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/cell_pictures.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"

namespace glint {
namespace {

constexpr std::size_t kKeptPictures = 4;

/// A scan counts as two pictures, however many positions it has.
std::size_t kept_share(const std::string& /*key*/, const std::vector<SensorPicture>& pictures) {
  return pictures.size() > 1 ? kKeptPictures / 2 : 1;
}

}  // namespace

CellPictures::CellPictures(CellRenderer& renderer, const TwinCellState& state)
    : renderer_(renderer),
      announced_(state),
      stands_(state),
      kept_({.max_bytes = kKeptPictures}, kept_share) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::string CellPictures::key_of_both(const TwinCellState& state, const CaptureSettings& settings) {
  TwinCellState of_all_positions = state;
  of_all_positions.stage_position = 0;
  return fmt::format("{} {} {} {} {}",
                     key_of(of_all_positions),
                     settings.exposure_us,
                     settings.gain_db,
                     settings.black_level,
                     settings.bits);
}

void CellPictures::want(const TwinCellState& state) {
  announced_ = state;
  const std::string key = key_of_both(state, settings_);
  if (kept_.find(key) == nullptr) {
    wanted_ = Wanted{.state = state, .settings = settings_, .key = key};
    changed_.notify_all();
  }
}

void CellPictures::announce(const TwinCellState& state) {
  const std::scoped_lock lock(mutex_);
  want(state);
}

void CellPictures::arrive(const TwinCellState& state) {
  const std::scoped_lock lock(mutex_);
  stands_ = state;
  if (key_of(state) != key_of(announced_)) {
    want(state);
  }
}

void CellPictures::leave() {
  const std::scoped_lock lock(mutex_);
  stands_.reset();
}

bool CellPictures::wait_until_finished(std::chrono::milliseconds within,
                                       const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, stop, within, [&] { return !wanted_ && !is_rendering_; }) &&
         error_.empty();
}

std::string CellPictures::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

int CellPictures::num_rendered() const {
  const std::scoped_lock lock(mutex_);
  return num_rendered_;
}

void CellPictures::prepare(const CaptureSettings& settings) {
  const std::scoped_lock lock(mutex_);
  settings_ = settings;
  want(announced_);
}

SensorPicture CellPictures::finished(const CaptureSettings& settings, std::uint64_t /*shot*/) {
  const std::optional<TwinCellState> live = live_ ? live_() : std::nullopt;
  const std::scoped_lock lock(mutex_);
  const std::optional<TwinCellState>& state = live_ ? live : stands_;
  const auto kept = state ? kept_.find(key_of_both(*state, settings)) : nullptr;
  if (kept == nullptr) {
    return nullptr;
  }
  const auto position = static_cast<std::size_t>(std::max(0, state->stage_position));
  return kept->at(std::min(position, kept->size() - 1));
}

bool CellPictures::is_finished(const CaptureSettings& settings) {
  const std::scoped_lock lock(mutex_);
  return kept_.find(key_of_both(announced_, settings)) != nullptr;
}

void CellPictures::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return wanted_.has_value(); })) {
    const Wanted wanted = *wanted_;
    wanted_.reset();
    is_rendering_ = true;
    lock.unlock();
    std::vector<SensorPicture> pictures;
    std::string error;
    try {
      for (auto& codes : renderer_.render_all(wanted.state, wanted.settings)) {
        pictures.push_back(std::make_shared<const Image<std::uint16_t>>(std::move(codes)));
      }
    } catch (const Error& failure) {
      error = failure.what();
      log(LogLevel::kError, "the simulated camera's picture: {}", error);
    }
    lock.lock();
    is_rendering_ = false;
    error_ = error;
    if (!pictures.empty()) {
      ++num_rendered_;
      kept_.put(wanted.key, std::move(pictures));
    }
    changed_.notify_all();
  }
}

}  // namespace glint
