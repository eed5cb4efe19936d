// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/multigrid/nested_knots.h>

#include <algorithm>

namespace greville
{
  NestedKnots::NestedKnots(const unsigned int         degree,
                           const unsigned int         n_cells,
                           const bool                 periodic,
                           const std::vector<double> &edges)
    : p(degree)
    , periodic(periodic)
    , is_uniform(edges.empty())
    , breakpoints(edges)
  {
    for (unsigned int k = 0; k <= n_cells && edges.empty(); ++k)
      breakpoints.push_back(k);
  }



  NestedKnots::NestedKnots(const std::vector<NestedKnots>  &levels,
                           const std::vector<unsigned int> &begin)
    : p(levels[0].degree())
    , is_uniform(false)
    , breakpoints(levels.back().breakpoints)
    , levels(std::make_shared<const std::vector<NestedKnots>>(levels))
    , begin_of_levels(begin)
    , end_of_levels(begin.back() + levels.back().n_functions())
  {
    AssertThrow(levels.size() > 1, dealii::ExcLowerRange(levels.size(), 2));
  }



  NestedKnots
  NestedKnots::coarser() const
  {
    if (levels && levels->size() == 2)
      return levels->front();
    if (levels)
      return {{levels->begin(), levels->end() - 1},
              {begin_of_levels.begin(), begin_of_levels.end() - 1}};
    const int n = n_cells(), n_coarse = (n + 1) / 2;
    if (n == 1 || (periodic && n_coarse < p + 1))
      return *this;
    NestedKnots result = *this;
    result.breakpoints.clear();
    // Join only the small cells of graded knots: neighbours then differ less.
    constexpr double most   = 1.5;
    double           length = breakpoints.back() - breakpoints.front();
    for (int k = 0; k + 2 <= n && !is_uniform; ++k)
      length = std::min(length, most * (breakpoints[k + 2] - breakpoints[k]));
    for (int k = 0; k < n;)
      {
        result.breakpoints.push_back(breakpoints[k]);
        const bool joins =
          is_uniform ||
          (k + 2 <= n && breakpoints[k + 2] - breakpoints[k] <= length);
        k += joins ? 2 : 1;
      }
    result.breakpoints.push_back(breakpoints.back());
    return result;
  }



  double
  NestedKnots::knot(const int k) const
  {
    const int n = n_cells();
    if (!periodic)
      return breakpoints[std::clamp(k, 0, n)];
    const int period = k >= 0 ? k / n : -((n - 1 - k) / n);
    return breakpoints[k - period * n] +
           period * (breakpoints.back() - breakpoints.front());
  }



  std::pair<unsigned int, double>
  NestedKnots::greville_point(const int i) const
  {
    AssertThrow(!levels, dealii::ExcInternalError());
    double x = 0.;
    for (int k = 1; k <= p; ++k)
      x += knot(i - p + k) / p;
    const double period = breakpoints.back() - breakpoints.front();
    if (periodic && x < breakpoints.front())
      x += period;
    const auto next =
      std::upper_bound(breakpoints.begin(), breakpoints.end(), x);
    const unsigned int cell = next - breakpoints.begin() - 1;
    if (next == breakpoints.end())
      return {periodic ? 0 : cell, 0.};
    return {cell, (x - next[-1]) / (next[0] - next[-1])};
  }



  NestedKnots::Row
  NestedKnots::insertion(const int i, const NestedKnots &coarse) const
  {
    if (levels)
      {
        const unsigned int l        = level(i);
        const int          of_level = i - int(begin_of_levels[l]);
        if (of_level >= (*levels)[l].n_functions())
          return {0, {}};
        if (l < coarse.n_levels())
          return {i, {1.f}};
        if (!coarse.levels)
          return (*levels)[l].insertion(of_level, coarse);
        Row result = (*levels)[l].insertion(of_level, coarse.levels->back());
        result.first += coarse.begin_of_levels.back();
        return result;
      }
    // The Oslo algorithm. Knots of functions are counted from -p on.
    const auto fine_knot   = [&](const int k) { return knot(k - p); };
    const auto coarse_knot = [&](const int k) { return coarse.knot(k - p); };
    // The last coarse cell that begins at or before the first knot of i.
    const int period =
      periodic ? (i >= 0 ? i / n_cells() : -((n_cells() - 1 - i) / n_cells()))
               : 0;
    int last = p + (periodic ? (period - 1 - p) * coarse.n_cells() : 0);
    while (coarse_knot(last + 1) <= fine_knot(i) &&
           (periodic || last + 1 < coarse.n_cells() + p))
      ++last;
    const int          first = last - p;
    std::vector<float> a(p + 2, 0.f), b(p + 2, 0.f); // from first on
    a[p] = 1.f;
    for (int k = 1; k <= p; ++k)
      {
        const double t = fine_knot(i + k);
        for (int j = first; j <= last; ++j)
          {
            const double low = coarse_knot(j), high = coarse_knot(j + k);
            const double low_next  = coarse_knot(j + 1),
                         high_next = coarse_knot(j + k + 1);
            const float own        = high > low ? (t - low) / (high - low) : 0.;
            const float next       = high_next > low_next
                                       ? (high_next - t) / (high_next - low_next)
                                       : 0.;
            b[j - first] = own * a[j - first] + next * a[j - first + 1];
          }
        a = b;
      }
    int begin = 0, end = p + 1;
    while (begin + 1 < end && a[begin] == 0.f)
      ++begin;
    while (begin + 1 < end && a[end - 1] == 0.f)
      --end;
    return {first + begin, {a.begin() + begin, a.begin() + end}};
  }
} // namespace greville
