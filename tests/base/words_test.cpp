// Words and numbers of messages.
#include "../../src/base/words.hpp"

#include <clocale>
#include <limits>

#include <gtest/gtest.h>

namespace slom {
namespace {

TEST(Words, OfCountsAndLists) {
  EXPECT_EQ(counted(0, "pose"), "0 poses");
  EXPECT_EQ(counted(1, "pose"), "1 pose");
  EXPECT_EQ(counted(2, "pose"), "2 poses");
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b"}), "a and b");
  EXPECT_EQ(listed({"a", "b", "c", "d"}), "a, b, c and d");
  EXPECT_EQ(listed({"a", "b", "c", "d", "e", "f"}), "a, b, c and 3 more");
  EXPECT_EQ(listed({"a", "b", "c"}, 2), "a and 2 more");
  EXPECT_EQ(abridged({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(abridged({"a", "b", "c", "d", "e"}), "a, b, ..., e");
}

TEST(Words, OfNumbersDoNotDependOnTheLocale) {
  const char* const comma = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // null where it is not installed
  EXPECT_EQ(number(0.125), "0.125");
  EXPECT_EQ(number(1234567, 3), "1.23e+06");
  EXPECT_EQ(number(-0.5, 1), "-0.5");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "nan");
  if (comma != nullptr) std::setlocale(LC_NUMERIC, "C");
}

}  // namespace
}  // namespace slom
