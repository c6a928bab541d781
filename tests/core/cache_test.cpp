// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/cache.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using ::testing::ThrowsMessage;

using Numbers = Cache<std::string, int>;

/// Each value takes as many bytes as it is large.
std::size_t own_size(const std::string&, int value) {
  return static_cast<std::size_t>(value);
}

bool has(Numbers& cache, const std::string& key) {
  return cache.find(key) != nullptr;
}

TEST(Cache, MakesAValueOnceForEachKey) {
  Numbers cache({});
  int calls = 0;
  const auto make = [&] { return ++calls; };
  EXPECT_EQ(*cache.get("a", make), 1);
  EXPECT_EQ(*cache.get("b", make), 2);
  EXPECT_EQ(*cache.get("a", make), 1);
  EXPECT_EQ(cache.get("b", make), cache.find("b"));
  EXPECT_EQ(cache.find("c"), nullptr);
  EXPECT_EQ(cache.num_made(), 2);
}

TEST(Cache, DropsWhatWasUsedLongestAgo) {
  Numbers cache({.max_values = 2});
  cache.put("a", 1);
  cache.put("b", 2);
  EXPECT_TRUE(has(cache, "a"));  // b is now the older one
  cache.put("c", 3);
  EXPECT_TRUE(has(cache, "a"));
  EXPECT_FALSE(has(cache, "b"));
  EXPECT_TRUE(has(cache, "c"));
}

TEST(Cache, DropsByBytesButForTheLast) {
  Numbers cache({.max_bytes = 10}, own_size);
  cache.put("a", 4);
  cache.put("b", 6);
  EXPECT_EQ(cache.bytes(), 10U);
  cache.put("c", 1);  // 11 with a
  EXPECT_FALSE(has(cache, "a"));
  EXPECT_EQ(cache.bytes(), 7U);
  cache.put("d", 50);
  EXPECT_EQ(cache.bytes(), 50U);
  cache.set_max_bytes(100);
  cache.put("e", 50);
  EXPECT_TRUE(has(cache, "d"));
}

TEST(Cache, KeepsAsManyAsItMustAndNoneIfItNeedNot) {
  Numbers two({.max_bytes = 1, .min_values = 2}, own_size);
  Numbers none({.max_bytes = 1, .min_values = 0}, own_size);
  for (const char* key : {"a", "b", "c"}) {
    two.put(key, 5);
    EXPECT_EQ(*none.get(key, [] { return 5; }), 5);  // and yet the caller has it
  }
  EXPECT_EQ(two.bytes(), 10U);
  EXPECT_EQ(none.bytes(), 0U);
}

TEST(Cache, PutTakesThePlaceOfTheOldValue) {
  Numbers cache({}, own_size);
  cache.put("a", 3);
  const auto old = cache.find("a");
  cache.put("a", 4);
  EXPECT_EQ(*cache.find("a"), 4);
  EXPECT_EQ(*old, 3);
  EXPECT_EQ(cache.bytes(), 4U);
  EXPECT_EQ(cache.num_made(), 0);
}

TEST(Cache, ErasesByKey) {
  Cache<int, int> cache({});
  for (int i = 0; i < 10; ++i) {
    cache.put(i, i);
  }
  cache.erase_if([](int key) { return key % 2 == 0; });
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(cache.find(i) != nullptr, i % 2 == 1);
  }
}

TEST(Cache, KeepsNothingOfAValueThatCouldNotBeMade) {
  Numbers cache({});
  EXPECT_THAT([&] { cache.get("a", []() -> int { throw std::runtime_error("no"); }); },
              ThrowsMessage<std::runtime_error>("no"));
  EXPECT_FALSE(has(cache, "a"));
  EXPECT_EQ(cache.num_made(), 0);
  EXPECT_EQ(*cache.get("a", [] { return 7; }), 7);  // nobody waits for ever
}

TEST(Cache, MakesAValueOnceForAllThreadsThatWaitForIt) {
  Numbers cache({});
  std::atomic<int> calls = 0;
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&] {
        right += *cache.get("a", [&] {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          return ++calls;
        }) == 1;
      });
    }
  }
  EXPECT_EQ(calls.load(), 1);
  EXPECT_EQ(right.load(), 8);
}

// The first thread makes "a" until the second has made "b".
TEST(Cache, MakesValuesOfSeveralKeysAtOnce) {
  Numbers cache({});
  std::atomic<bool> has_begun = false;
  std::atomic<bool> has_b = false;
  std::jthread first([&] {
    cache.get("a", [&] {
      has_begun = true;
      has_begun.notify_all();
      has_b.wait(false);
      return 1;
    });
  });
  has_begun.wait(false);
  EXPECT_EQ(*cache.get("b", [] { return 2; }), 2);
  EXPECT_FALSE(has(cache, "a"));
  has_b = true;
  has_b.notify_all();
  EXPECT_EQ(*cache.get("a", [] { return 3; }), 1);  // waits for the first thread
}

TEST(Cache, ThreadsThatWaitedForAFailureTryByThemselves) {
  Numbers cache({});
  std::atomic<int> calls = 0;
  std::atomic<int> failures = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        try {
          cache.get("a", [&] {
            const int call = ++calls;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            if (call <= 2) {
              throw std::runtime_error("not yet");
            }
            return call;
          });
        } catch (const std::runtime_error&) {
          ++failures;
        }
      });
    }
  }
  EXPECT_EQ(failures.load(), 2);
  EXPECT_EQ(calls.load(), 3);
  EXPECT_EQ(*cache.find("a"), 3);
}

// Against a plain list of the last three keys.
TEST(Cache, KeepsTheLastOnesOfAnySequence) {
  Cache<std::int64_t, std::int64_t> cache({.max_values = 3});
  std::vector<std::int64_t> last;
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 2000; ++i) {
    const auto key = static_cast<std::int64_t>(rng.next_u32() % 6);
    const bool is_known = std::ranges::find(last, key) != last.end();
    const int before = cache.num_made();
    EXPECT_EQ(*cache.get(key, [&] { return 10 * key; }), 10 * key);
    ASSERT_EQ(cache.num_made() == before, is_known);
    std::erase(last, key);
    last.insert(last.begin(), key);
    last.resize(std::min<std::size_t>(last.size(), 3));
  }
}

}  // namespace
}  // namespace glint
