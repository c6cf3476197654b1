// Bytes as choices and numbers, most of them ordinary; after the end all are 0.
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <string_view>

namespace slom::fuzz::fit {

class Bytes {
 public:
  explicit Bytes(std::string_view input) : input_(input) {}

  bool isEmpty() const { return input_.empty(); }
  int byte() {
    if (input_.empty()) return 0;
    const int result = static_cast<unsigned char>(input_.front());
    input_.remove_prefix(1);
    return result;
  }
  int below(int n) { return byte() % n; }
  bool oneIn(int n) { return below(n) == n - 1; }

  /// One of 15 is hostile.
  double number() {
    using Limits = std::numeric_limits<double>;
    static constexpr double hostile[] = {1e300,
                                         -1e300,
                                         1e-300,
                                         1e155,
                                         -1e155,
                                         1e-155,
                                         3e100,
                                         1e-100,
                                         1e16,
                                         1e-16,
                                         1e8,
                                         1e-8,
                                         -1e8,
                                         Limits::infinity(),
                                         -0.0,
                                         Limits::max(),
                                         Limits::min(),
                                         Limits::denorm_min(),
                                         Limits::quiet_NaN(),
                                         -Limits::infinity()};
    const int kind = byte();
    if (kind < 0xA0) return (kind - 0x50) / 8.0;
    if (kind < 0xC0) return (kind - 0xB0) + (byte() - 128) / 256.0;
    if (kind < 0xD0)
      return 1 + (byte() - 128) * Limits::epsilon() * (kind == 0xC0 ? 1 : 1 << (2 * (kind - 0xC0)));
    if (kind < 0xE0) return (byte() - 128) * 1e-9;
    if (kind < 0xEE) return (byte() - 128) * power(kind - 0xE7);
    if (kind < 0xFF) return hostile[below(static_cast<int>(std::size(hostile)))];
    double raw = 0;
    unsigned char bytes[sizeof raw];
    for (unsigned char& b : bytes) b = static_cast<unsigned char>(byte());
    std::memcpy(&raw, bytes, sizeof raw);
    return raw;
  }

 private:
  static double power(int e) {
    double result = 1;
    for (; e > 0; --e) result *= 100;
    for (; e < 0; ++e) result /= 100;
    return result;
  }

  std::string_view input_;
};

}  // namespace slom::fuzz::fit
