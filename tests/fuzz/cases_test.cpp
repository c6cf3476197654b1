// All targets on all cases of the repository, and on some spoilt ones: with SLOM_FUZZ_MUTANTS=100000 on as
// many of each case.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "fuzz/target.hpp"
#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"
#include "support/temporary_folder.hpp"

namespace slom::fuzz {
namespace {

std::filesystem::path casesOf(const Target& target) {
  return slom::testing::sourcePath("tests/fuzz/cases") / target.name;
}

std::map<std::string, std::string> contents(const Target& target) {
  std::map<std::string, std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(casesOf(target)))
    result[entry.path().filename()] = slom::testing::readFile(entry.path());
  return result;
}

void expectEndsWell(const Target& target, const std::string& name, const std::string& input) {
  try {
    target.run(input);
  } catch (const std::exception& error) {
    std::string shown;
    for (const char c : input.substr(0, 2000))
      shown += c == '\n' || (c >= ' ' && c <= '~') ? std::string(1, c) : "?";
    ADD_FAILURE() << target.name << ", " << name << ": " << error.what() << "\n" << shown;
  }
}

/// Damages a text as files are damaged: bytes, numbers, lines.
std::string spoilt(std::string text, std::mt19937& random) {
  static const char* const pieces[] = {"nan",        "-inf", "1e999", "1e155",
                                       "-1e-320",    "0",    "-1",    "99999999999999999999",
                                       "2147483647", "\"",   ",",     ":",
                                       "=",          "|",    "#",     "\n",
                                       "\r\n",       "\t",   "\xFF",  "\xEF\xBB\xBF",
                                       "3,5",        "0x10", "end"};
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n)(random); };
  for (std::size_t change = 0; change <= below(3); ++change) {
    const std::size_t at = below(text.size());
    switch (below(6)) {
      case 0:
        if (at < text.size()) text[at] = char(below(255));
        break;
      case 1:
        text.erase(at, 1 + below(5));
        break;
      case 2:
        text.insert(at, pieces[below(std::size(pieces) - 1)]);
        break;
      case 3:
        text.resize(at);
        break;
      case 4: {  // a word
        const std::size_t end = std::min(text.find_first_of(" ,\n|=", at), text.size());
        text.replace(at, end - at, pieces[below(std::size(pieces) - 1)]);
        break;
      }
      default: {  // a line twice, or elsewhere
        const std::size_t begin = text.rfind('\n', at) == std::string::npos ? 0 : text.rfind('\n', at) + 1;
        text.insert(below(1) == 0 ? begin : below(text.size()),
                    text.substr(begin, std::min(text.find('\n', begin), text.size()) - begin) + "\n");
      }
    }
  }
  return text;
}

TEST(Fuzz, EveryTargetHasCases) {
  EXPECT_EQ(targets().size(), 9u);
  for (const Target& target : targets()) EXPECT_TRUE(std::filesystem::exists(casesOf(target))) << target.name;
}

TEST(Fuzz, CasesEndWell) {
  for (const Target& target : targets()) {
    for (const auto& [name, input] : contents(target)) expectEndsWell(target, name, input);
  }
}

/// Seeds are there to be accepted, or their mutants reach no code.
TEST(Fuzz, SpoiltCasesEndWell) {
  const char* const wanted = std::getenv("SLOM_FUZZ_MUTANTS");
  // Under the sanitizers the fuzzers themselves go on from here.
  const int usual = slom::testing::hasSanitizers() ? 20 : 200;
  const int mutants = wanted == nullptr ? usual : std::atoi(wanted);
  for (const Target& target : targets()) {
    std::mt19937 random(1);
    for (const auto& [name, input] : contents(target)) {
      for (int i = 0; i < mutants && !HasFailure(); ++i)
        expectEndsWell(target, name + ", spoilt", spoilt(input, random));
    }
  }
}

}  // namespace
}  // namespace slom::fuzz
