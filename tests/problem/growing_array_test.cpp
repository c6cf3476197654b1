// The array of a pool holds the same values as a std::vector, whatever the values do when they are moved.
#include <cstdint>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/problem/growing_array.hpp>

namespace {

/// Counts those that are alive; the copy that is due throws.
struct Throwing {
  static inline int alive = 0;
  static inline int copies_until_throw = -1;
  std::string text;

  explicit Throwing(std::string t) : text(std::move(t)) { ++alive; }
  Throwing(const Throwing& other) : text(other.text) {
    if (copies_until_throw >= 0 && copies_until_throw-- == 0) throw std::runtime_error("copied");
    ++alive;
  }
  ~Throwing() { --alive; }
  Throwing& operator=(const Throwing&) = delete;
};

struct alignas(64) Aligned {
  std::unique_ptr<int> number;
};

TEST(GrowingArray, HoldsWhatAVectorDoes) {
  std::mt19937_64 random(1);
  slom::GrowingArray<std::unique_ptr<std::string>> array;
  std::vector<std::string> expected;
  for (int k = 0; k < 3000; ++k) {
    if (expected.empty() || random() % 5 < 3) {
      expected.push_back(std::to_string(k) + std::string(random() % 40, '.'));
      array.push(std::make_unique<std::string>(expected.back()));
    } else {
      const std::size_t i = random() % expected.size();
      expected[i] = expected.back();
      expected.pop_back();
      array.moveLastTo(i);
    }
    for (std::size_t i = 0; i < expected.size(); i += 1 + random() % 7) ASSERT_EQ(*array[i], expected[i]);
  }
  EXPECT_GT(expected.size(), 100u);
}

TEST(GrowingArray, IsAsItWasWhereACopyThrows) {
  {
    slom::GrowingArray<Throwing> array;
    int held = 0;
    for (int k = 0; k < 200; ++k) {
      Throwing value(std::to_string(held));
      Throwing::copies_until_throw =
          k % 3 == 0 ? k % (held + 2) : -1;  // while it grows, at the new value, or not at all
      try {
        array.push(std::move(value));
        ++held;
      } catch (const std::runtime_error&) {
      }
      Throwing::copies_until_throw = -1;
      ASSERT_EQ(Throwing::alive, held + 1);
      for (int i = 0; i < held; ++i) ASSERT_EQ(array[static_cast<std::size_t>(i)].text, std::to_string(i));
    }
    EXPECT_GT(held, 100);
  }
  EXPECT_EQ(Throwing::alive, 0);
}

TEST(GrowingArray, KeepsTheAlignment) {
  slom::GrowingArray<Aligned> array;
  for (int k = 0; k < 20; ++k) {
    array.push(Aligned{std::make_unique<int>(k)});
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0u);
    for (int i = 0; i <= k; ++i) EXPECT_EQ(*array[static_cast<std::size_t>(i)].number, i);
  }
}

}  // namespace
