// expect: mtk: `component_names` must have one name for each degree of freedom
#include <array>
#include <string_view>

#include <mtk/mtk.hpp>

struct Camera : mtk::vect<3> {
#ifdef MUST_FAIL
  static constexpr std::array<std::string_view, 2> component_names{"f", "cx"};
#else
  static constexpr std::array<std::string_view, 3> component_names{"f", "cx", "cy"};
#endif
};

inline auto names(const Camera& camera) { return mtk::componentNames(camera); }
