/*
 * CGAL tests the rounding of the processor when a library that uses it is
 * loaded, and deal.II is such a library. Valgrind always rounds to the nearest,
 * so that this test would end the program. To be loaded by LD_PRELOAD; valgrind
 * then takes these functions in place of the tests.
 */

#include <valgrind/valgrind.h>

#define SKIP(tester)                                          \
  void I_REPLACE_SONAME_FNNAME_ZU(Za, tester)(void *object)   \
  {                                                           \
    (void)object;                                             \
  }                                                           \
  void I_REPLACE_SONAME_FNNAME_ZU(NONE, tester)(void *object) \
  {                                                           \
    (void)object;                                             \
  }

SKIP(_ZN4CGAL11Interval_ntILb0EE27Test_runtime_rounding_modesC1Ev)
SKIP(_ZN4CGAL11Interval_ntILb0EE27Test_runtime_rounding_modesC2Ev)
SKIP(_ZN4CGAL11Interval_ntILb1EE27Test_runtime_rounding_modesC1Ev)
SKIP(_ZN4CGAL11Interval_ntILb1EE27Test_runtime_rounding_modesC2Ev)
