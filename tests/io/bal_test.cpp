// Files of BAL: a scene that is read and written again stays the same.
#include <gtest/gtest.h>

#include <slom/io/bal.hpp>

#include "support/message_of.hpp"
#include "support/replaced.hpp"

namespace slom::io {
namespace {

using slom::testing::messageOf;
using slom::testing::replaced;

const std::string small =
    "1 2 2\n0 0 1.5 -2\n0 1 3 0.1\n0\n0\n1.5\n1\n2\n-3\n500\n-0.1\n0.01\n0\n1\n2\n0.25\n1e-300\n-7\n";

TEST(Bal, BalIsWrittenAsItWasRead) { EXPECT_EQ(toBal(parseScene("scene.txt", small)), small); }

TEST(Bal, NumbersMayStandAnywhereBehindTheObservations) {
  std::string other = small;
  for (std::size_t at = other.find("0.1\n") + 4; at < other.size(); ++at) {
    if (other[at] == '\n') other[at] = at % 2 == 0 ? ' ' : '\t';
  }
  EXPECT_EQ(toBal(parseScene("scene.txt", other)), small);
  EXPECT_EQ(toBal(parseScene("scene.txt", "\xEF\xBB\xBF" + replaced(small, "\n", " \r\n\n"))), small);
}

/// Each with the id that programs can branch on; tests/bundle has all texts, as the command shows them.
TEST(Bal, ErrorsHaveIds) {
  const auto refusal = [](const std::string& text) {
    return messageOf([&] { parseScene("scene.txt", text); });
  };
  EXPECT_EQ(
      refusal(""),
      "[slom.io.empty-file] scene.txt: the file is empty; a BAL file begins with a line \"cameras points "
      "observations\"");
  EXPECT_EQ(refusal(replaced(small, "500", "inf")),
            "[slom.io.bad-line] scene.txt:10: f of camera 0 is \"inf\"; write a finite number there");
}

/// Lines of old systems end by a carriage return.
TEST(Bal, LinesThatEndByACarriageReturn) {
  const std::string text =
      "1 2 2\n0 0 1.5 -2\n0 1 3 0.1\n0\n0\n0\n1\n2\n-3\n500\n-0.1\n0.01\n0\n1\n2\n0.25\n0\n-7\n";
  std::string returns = text;
  for (char& c : returns) c = c == '\n' ? '\r' : c;
  EXPECT_EQ(toBal(parseScene("scene.txt", returns)), toBal(parseScene("scene.txt", text)));
  EXPECT_EQ(parseScene("scene.txt", returns).observations[1].line, 3);
}

}  // namespace
}  // namespace slom::io
