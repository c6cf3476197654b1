// Lists and lines of text.
#include "text.hpp"

#include <gtest/gtest.h>

namespace slom::app {
namespace {

TEST(Text, ListsWords) {
  EXPECT_EQ(listed({}, ", ", " and "), "");
  EXPECT_EQ(listed({"a"}, ", ", " and "), "a");
  EXPECT_EQ(listed({"a", "b"}, ", ", " and "), "a and b");
  EXPECT_EQ(listed({"a", "b", "c"}, ", ", ", or "), "a, b, or c");
}

TEST(Text, IsBrokenIntoLines) {
  EXPECT_EQ(wrapped("", 5), "");
  EXPECT_EQ(wrapped("one two", 7), "one two");
  EXPECT_EQ(wrapped("one two", 6), "one\ntwo");
  EXPECT_EQ(wrapped("one two three", 7, "  "), "one two\n  three");
  EXPECT_EQ(wrapped("longer than it", 3), "longer\nthan\nit") << "a word is never cut";
  EXPECT_EQ(bulleted("one two"), "  * one two\n");
}

}  // namespace
}  // namespace slom::app
