// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values that were asked for last, found again by their keys.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <limits>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace glint {

/// What a cache keeps: the values that were used last, up to both limits.
struct CacheLimits {
  std::size_t max_values = std::numeric_limits<std::size_t>::max();
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
  std::size_t min_values = 1;  ///< kept whatever they take; <= max_values
};

/// Safe to use from several threads. Whoever holds a value keeps it alive, also when the cache has
/// dropped it. Keys are compared with ==.
template <class Key, class Value>
class Cache {
 public:
  using Pointer = std::shared_ptr<const Value>;

  /// What a value takes with its key.
  using Bytes = std::function<std::size_t(const Key&, const Value&)>;

  /// @param bytes_of  empty: values take nothing
  explicit Cache(const CacheLimits& limits, Bytes bytes_of = {})
      : limits_(limits), bytes_of_(std::move(bytes_of)) {}

  /// The value of that key, kept or made.
  /// @param make  called without a lock, by one thread for each key; others that ask for the same
  ///              key wait. What it throws goes to its caller alone, and nothing is kept. It must
  ///              not ask this cache for the key it makes, nor in a circle with other keys
  template <class Make>
  Pointer get(const Key& key, const Make& make) {
    if (Pointer known = find_or_begin(key)) {
      return known;
    }
    const Making making(*this, key);
    auto value = std::make_shared<const Value>(make());
    const std::scoped_lock lock(mutex_);
    ++num_made_;
    keep(key, value);
    return value;
  }

  /// The kept value of that key; nullptr: none.
  Pointer find(const Key& key) {
    const std::scoped_lock lock(mutex_);
    return touch(key);
  }

  /// Keeps a value that was made elsewhere, in place of the one of that key.
  void put(const Key& key, Value value) {
    auto kept = std::make_shared<const Value>(std::move(value));
    const std::scoped_lock lock(mutex_);
    keep(key, std::move(kept));
  }

  /// Drops the values of some keys. @param is_unwanted  of a key
  template <class Predicate>
  void erase_if(const Predicate& is_unwanted) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(entries_, [&](const Entry& entry) { return is_unwanted(entry.key); });
  }

  /// Holds from the next value on.
  void set_max_bytes(std::size_t max_bytes) {
    const std::scoped_lock lock(mutex_);
    limits_.max_bytes = max_bytes;
  }

  /// What all kept values take.
  std::size_t bytes() const {
    const std::scoped_lock lock(mutex_);
    return kept_bytes();
  }

  /// How often get() has made a value.
  int num_made() const {
    const std::scoped_lock lock(mutex_);
    return num_made_;
  }

 private:
  struct Entry {
    Key key;
    Pointer value;
    std::size_t bytes = 0;
  };

  /// While it lives, others wait for the key.
  class Making {
   public:
    Making(Cache& cache, const Key& key) : cache_(cache), key_(key) {}

    ~Making() {
      {
        const std::scoped_lock lock(cache_.mutex_);
        cache_.making_.erase(std::ranges::find(cache_.making_, key_));
      }
      cache_.finished_.notify_all();
    }

    Making(const Making&) = delete;
    Making& operator=(const Making&) = delete;

   private:
    Cache& cache_;
    const Key& key_;
  };

  /// nullptr: the caller makes it.
  Pointer find_or_begin(const Key& key) {
    std::unique_lock lock(mutex_);
    finished_.wait(lock, [&] { return std::ranges::find(making_, key) == making_.end(); });
    Pointer known = touch(key);
    if (!known) {
      making_.push_back(key);
    }
    return known;
  }

  /// The mutex must be held, here and below.
  Pointer touch(const Key& key) {
    const auto found = std::ranges::find(entries_, key, &Entry::key);
    if (found == entries_.end()) {
      return nullptr;
    }
    entries_.splice(entries_.begin(), entries_, found);
    return entries_.front().value;
  }

  std::size_t kept_bytes() const {
    std::size_t sum = 0;
    for (const Entry& entry : entries_) {
      sum += entry.bytes;
    }
    return sum;
  }

  void keep(const Key& key, Pointer value) {
    const std::size_t value_bytes = bytes_of_ ? bytes_of_(key, *value) : 0;
    std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
    entries_.push_front({key, std::move(value), value_bytes});
    std::size_t sum = kept_bytes();
    while (entries_.size() > limits_.min_values &&
           (entries_.size() > limits_.max_values || sum > limits_.max_bytes)) {
      sum -= entries_.back().bytes;
      entries_.pop_back();
    }
  }

  CacheLimits limits_;
  Bytes bytes_of_;
  mutable std::mutex mutex_;
  std::condition_variable finished_;
  std::list<Entry> entries_;  ///< most recently used first
  std::vector<Key> making_;
  int num_made_ = 0;
};

}  // namespace glint
