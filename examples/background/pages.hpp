#pragma once
#include <ostream>
#include <string>

/// A page of docs/background: what it prints, and its picture as SVG.
struct Page {
  const char* name;
  void (*print)(std::ostream&);
  std::string (*picture)();
};

extern const Page kMeasurement, kLine, kNonlinear, kAngles, kTangent, kSparse, kUncertainty, kUndetermined,
    kOutliers, kDerivatives, kMotion;
