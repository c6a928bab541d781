// SPDX-License-Identifier: GPL-3.0-or-later
//
// What simulated lines of path-traced parts have rendered, at power 1 of every light: a search over
// powers renders each part once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/render/path_tracing/path_sums.h"
#include "studies/imaging/path_picture.h"

namespace glint {

/// The flawless part, rendered twice with half of the samples each.
struct FlawlessRendering {
  std::array<PathBatch, 2> halves;
  SurfaceImages surface;
  CoverageImages coverage;

  std::size_t bytes() const;
};

/// What the defects of a part add to the radiance, in the pixels where they add anything.
struct RenderedChanges {
  std::vector<std::size_t> pixels;
  /// Of both halves; channel c of group g in pixels[i]: at (g * channels + c) * pixels.size() + i.
  std::array<std::vector<float>, 2> values;

  std::size_t bytes() const;
};

/// Everything that tells the detail of one part from that of others.
std::string digest_of(const SurfaceDetail& detail);

/// The values that were asked for last, by their keys. Safe to use from several threads; equal keys
/// give equal values, so that it does not matter who made one.
template <class Value>
class RecentValues {
 public:
  /// @param most_bytes  that they take together; the last one is kept in any case
  explicit RecentValues(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// The value of that key, kept or made. @param make  called without any lock
  template <class Make>
  std::shared_ptr<const Value> get(const std::string& key, const Make& make) {
    if (auto known = find(key)) {
      return known;
    }
    auto value = std::make_shared<const Value>(make());
    keep(key, value);
    return value;
  }

  int num_made() const {
    const std::scoped_lock lock(mutex_);
    return num_made_;
  }

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
  };

  std::shared_ptr<const Value> find(const std::string& key) {
    const std::scoped_lock lock(mutex_);
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->key == key) {
        entries_.splice(entries_.begin(), entries_, entry);
        return entries_.front().value;
      }
    }
    return nullptr;
  }

  void keep(const std::string& key, std::shared_ptr<const Value> value) {
    const std::scoped_lock lock(mutex_);
    ++num_made_;
    bytes_ += value->bytes() + key.size();
    entries_.push_front({key, std::move(value)});
    while (bytes_ > most_bytes_ && entries_.size() > 1) {
      bytes_ -= entries_.back().value->bytes() + entries_.back().key.size();
      entries_.pop_back();
    }
  }

  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< most recently used first
  std::size_t bytes_ = 0;
  std::size_t most_bytes_;
  int num_made_ = 0;
};

struct LineStore {
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20U;  ///< of each kind

  RecentValues<FlawlessRendering> flawless = RecentValues<FlawlessRendering>(kMostBytes);
  RecentValues<RenderedChanges> changes = RecentValues<RenderedChanges>(kMostBytes);
};

}  // namespace glint
