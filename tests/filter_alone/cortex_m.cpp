// Start of a program on a Cortex-M4 with floating-point unit: the vector table and the reset handler. Newlib's start code
// then clears the memory, calls constructors and main, and writes by semihosting.
#include <cstdint>

extern "C" {
extern char __stack;
void _start();

void reset() {
  volatile std::uint32_t& coprocessors = *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88);
  coprocessors = coprocessors | (0xFu << 20);  // the floating-point unit, CP10 and CP11
  _start();
}
[[noreturn]] void fault() {
  for (;;) {
  }
}
}

using Handler = void (*)();
struct VectorTable {
  void* stack;
  Handler handlers[15];
};
__attribute__((section(".vectors"), used))
const VectorTable vectors{&__stack,
                          {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
                           fault, fault, fault}};
