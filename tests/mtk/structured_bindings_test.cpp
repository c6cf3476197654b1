// Structured bindings of vectors and of types derived from them.
#include <tuple>
#include <type_traits>

#include <gtest/gtest.h>

#include <mtk/mtk.hpp>

namespace {

struct BoundCamera : mtk::vect<4> {
  using mtk::vect<4>::vect;
  static constexpr std::array<std::string_view, 4> component_names{"fx", "fy", "cx", "cy"};
};
template <class S>
struct BoundLens : mtk::vect<2, S> {
  using mtk::vect<2, S>::vect;
};
struct BoundFisheye : BoundLens<double> {
  using BoundLens<double>::BoundLens;
};

TEST(StructuredBindings, OfWhatDerivesFromAVector) {
  const BoundCamera camera(500, 510, 320, 240);
  const auto& [fx, fy, cx, cy] = camera;
  EXPECT_EQ(&fx, &camera[0]) << "a reference, not a copy";
  EXPECT_EQ(fy, 510);
  EXPECT_EQ(cx, 320);
  EXPECT_EQ(cy, 240);
  const auto [k1, k2] = BoundFisheye(1, 2);
  EXPECT_EQ(k1, 1);
  EXPECT_EQ(k2, 2);
  static_assert(std::tuple_size_v<BoundCamera> == 4 && std::tuple_size_v<const BoundCamera> == 4);
  static_assert(std::is_same_v<std::tuple_element_t<2, BoundCamera>, double>);
}

TEST(StructuredBindings, OfDualNumbersKeepTheirDerivatives) {
  using D = mtk::Dual<double, 2>;
  D first, second;
  first.seed(3, 0);
  second.seed(4, 1);
  const BoundLens<D> lens(first, second);
  const auto& [a, b] = lens;
  const D product = a * b;
  EXPECT_EQ(product.value(), 12);
  EXPECT_EQ(product.partials().get(0), 4);
  EXPECT_EQ(product.partials().get(1), 3);
}

TEST(StructuredBindings, LeaveOtherTypesAlone) {
  struct Plain {
    int a, b;
  };
  const auto& [a, b] = Plain{1, 2};
  EXPECT_EQ(a + b, 3);
  static_assert(std::tuple_size_v<std::tuple<int, BoundCamera>> == 2);
  static_assert(std::tuple_size_v<mtk::vect<3>> == 3);
  static_assert(mtk::Manifold<BoundCamera> && mtk::DOF_v<BoundCamera> == 4);
}

}  // namespace
