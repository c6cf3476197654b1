// The numbers and pictures of docs/background, least squares and manifolds in eleven pages.
//
//   example_background                  prints the numbers of all pages, one after another
//   example_background --picture=NAME   prints the picture of one page as SVG
#include <cstring>
#include <iostream>

#include "pages.hpp"

int main(int argc, char** argv) {
  const Page* const pages[] = {&kMeasurement, &kLine,         &kNonlinear, &kAngles,      &kTangent, &kSparse,
                               &kUncertainty, &kUndetermined, &kOutliers,  &kDerivatives, &kMotion};
  constexpr const char* option = "--picture=";
  for (const Page* page : pages) {
    if (argc < 2) {
      std::cout << "== " << page->name << "\n";
      page->print(std::cout);
    } else if (std::strncmp(argv[1], option, std::strlen(option)) == 0 &&
               std::strcmp(argv[1] + std::strlen(option), page->name) == 0) {
      std::cout << page->picture();
      return 0;
    }
  }
  return argc < 2 ? 0 : 2;
}
