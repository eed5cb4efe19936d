// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

// Times of the benchmarks in this folder.

inline double
cpu_seconds()
{
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}



// Return the CPU seconds of square roots, each dependent on the previous one.
inline double
reference_loop(const unsigned int n_roots)
{
  const double    start = cpu_seconds();
  volatile double last  = 2.;
  double          x     = last;
  for (unsigned int i = 0; i < n_roots; ++i)
    x = std::sqrt(x + 1.);
  last = x;
  return cpu_seconds() - start;
}



inline double
median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}
