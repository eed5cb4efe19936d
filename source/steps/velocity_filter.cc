// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/steps/velocity_filter.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Points that cross the kinks of linear functions excite the filtered modes
    // more.
    constexpr double more_if_linear = 5.;



    /// Return the scaled weights of the p + 2 coefficients of each run in the
    /// jump of the p-th derivative across the knot that their functions share,
    /// entry by entry.
    std::vector<double>
    make_differences(const KnotVector &knots, const unsigned int n_functions)
    {
      const unsigned int p      = knots.degree();
      const auto        &t      = knots.knots();
      const unsigned int n_runs = n_functions > p + 1 ? n_functions - p - 1 : 0;
      std::vector<double> result(std::size_t(n_runs) * (p + 2));
      for (unsigned int run = 0; run < n_runs; ++run)
        {
          // Row i contains the weights of the run's coefficients in coefficient
          // run + i of the kth derivative.
          std::vector<std::vector<double>> rows(p + 2,
                                                std::vector<double>(p + 2));
          for (unsigned int i = 0; i < p + 2; ++i)
            rows[i][i] = 1.;
          for (unsigned int k = 1; k <= p; ++k)
            for (unsigned int i = 0; i + k < p + 2; ++i)
              for (unsigned int j = 0; j < p + 2; ++j)
                rows[i][j] = (rows[i + 1][j] - rows[i][j]) /
                             (t[run + i + p + 1] - t[run + i + k]);
          double sum = 0.;
          for (unsigned int j = 0; j < p + 2; ++j)
            {
              rows[0][j] = rows[1][j] - rows[0][j];
              sum += std::abs(rows[0][j]);
            }
          for (unsigned int j = 0; j < p + 2; ++j)
            result[std::size_t(j) * n_runs + run] =
              std::ldexp(rows[0][j] / sum, p + 1);
        }
      return result;
    }



    /// Multi-indices of functions and of their periodic images. In a periodic
    /// direction with n functions, they are in [-reach, n + reach). The shift
    /// makes them nonnegative.
    template <int dim>
    struct UnwrappedFunctions
    {
      MultiIndex<dim> extents, shift, all;

      /// Return the position in the space.
      std::uint64_t
      position(MultiIndex<dim> i) const
      {
        for (unsigned int d = 0; d < dim; ++d)
          i[d] = (i[d] + extents[d] - shift[d]) % extents[d];
        return lexicographic<dim>(i, extents);
      }

      bool
      is_image(const unsigned int k, const unsigned int direction) const
      {
        return k < shift[direction] ||
               k >= shift[direction] + extents[direction];
      }
    };



    /// Append the other functions in the runs of the given owned functions:
    /// images and functions of other processes.
    template <int dim>
    void
    append_rest_of_runs(std::vector<MultiIndex<dim>>  &functions,
                        const SplineSpace<dim>        &space,
                        const UnwrappedFunctions<dim> &unwrapped,
                        const int                      reach)
    {
      const auto                &all   = unwrapped.all;
      const auto                &owned = space.owned_functions();
      std::vector<std::uint64_t> near;
      for (const auto &i : functions)
        for (unsigned int d = 0; d < dim; ++d)
          {
            auto      j    = i;
            const int last = std::min(int(i[d]) + reach, int(all[d]) - 1);
            for (int k = std::max(int(i[d]) - reach, 0); k <= last; ++k)
              {
                j[d]                         = k;
                const std::uint64_t position = unwrapped.position(j);
                if (unwrapped.is_image(k, d) ||
                    (!std::binary_search(owned.begin(),
                                         owned.end(),
                                         position) &&
                     space.exists(position)))
                  near.push_back(lexicographic<dim>(j, all));
              }
          }
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (const std::uint64_t k : near)
        functions.push_back(multi_index<dim>(k, all));
    }
  } // namespace



  template <int dim>
  void
  VelocityFilter<dim>::reinit(const SplineSpace<dim> &new_space)
  {
    space               = &new_space;
    const int   reach   = space->degree() + 1;
    const auto &extents = space->n_functions();
    const auto &owned   = space->owned_functions();

    UnwrappedFunctions<dim> unwrapped;
    unwrapped.extents = extents;
    auto &shift       = unwrapped.shift;
    auto &all         = unwrapped.all;
    for (unsigned int d = 0; d < dim; ++d)
      {
        shift[d]       = space->is_periodic(d) ? reach : 0;
        all[d]         = extents[d] + 2 * shift[d];
        differences[d] = make_differences(
          space->is_periodic(d)
            ? KnotVector::periodic_uniform(space->degree(), all[d], 0., all[d])
            : space->knots(d),
          all[d]);
        cell_sizes[d].clear();
        for (unsigned int i = 0; i < all[d]; ++i)
          cell_sizes[d].push_back(
            space->smallest_cell_of((i + extents[d] - shift[d]) % extents[d],
                                    d));
      }

    std::vector<MultiIndex<dim>> functions;
    for (const std::uint64_t position : owned)
      {
        auto i = multi_index<dim>(position, extents);
        for (unsigned int d = 0; d < dim; ++d)
          i[d] += shift[d];
        functions.push_back(i);
      }
    append_rest_of_runs<dim>(functions, *space, unwrapped, reach);

    std::vector<std::uint64_t> positions;
    for (std::size_t k = owned.size(); k < functions.size(); ++k)
      positions.push_back(unwrapped.position(functions[k]));
    const auto numbers = space->global_numbers(positions);
    auto       ghosts  = numbers;
    std::sort(ghosts.begin(), ghosts.end());
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
    IndexSet ghost_set(space->n_dofs());
    ghost_set.add_indices(ghosts.begin(), ghosts.end());
    partitioner = std::make_shared<const Utilities::MPI::Partitioner>(
      space->locally_owned_dofs(), ghost_set, space->communicator());
    exchanged.reinit(partitioner);

    set_lines(functions);
    function_places.clear();
    copies.clear();
    for (std::size_t k = 0; k < functions.size(); ++k)
      {
        const auto        &i     = functions[k];
        const unsigned int place = line_of(i).place + int(i[0]);
        if (k < owned.size())
          function_places.push_back(place);
        else
          copies.emplace_back(
            place, partitioner->global_to_local(numbers[k - owned.size()]));
      }

    inverse_mass = ZeroedArray<double>(n_places);
    for (unsigned int d = 0; d < dim; ++d)
      run_mass[d] = ZeroedArray<double>(n_places);
    jumps.resize(all[0]);
    strengths.resize(all[0]);
  }



  template <int dim>
  void
  VelocityFilter<dim>::set_lines(const std::vector<MultiIndex<dim>> &functions)
  {
    const int reach = space->degree() + 1;
    // The box of lines around the functions, with space for runs that leave it.
    std::array<int, dim> low, high;
    low.fill(std::numeric_limits<int>::max());
    high.fill(0);
    for (const auto &i : functions)
      for (unsigned int d = 0; d < dim; ++d)
        {
          low[d]  = std::min(low[d], int(i[d]));
          high[d] = std::max(high[d], int(i[d]));
        }
    lines.clear();
    if (!functions.empty())
      {
        low_y         = low[1];
        low_z         = dim == 3 ? low[dim - 1] : 0;
        n_lines_y     = high[1] - low_y + 1 + reach;
        const int n_z = dim == 3 ? high[dim - 1] - low_z + 1 + reach : 1;
        lines.resize(std::size_t(n_lines_y) * n_z);
      }
    for (const auto &i : functions)
      {
        Line &line = line_of(i);
        if (line.begin == line.end)
          line.begin = line.end = i[0];
        line.begin = std::min(line.begin, int(i[0]));
        line.end   = std::max(line.end, int(i[0]) + 1);
      }
    n_places = 0;
    for (Line &line : lines)
      {
        line.place = int(n_places) - line.begin;
        n_places += line.end - line.begin;
        Require(n_places < std::size_t(std::numeric_limits<int>::max()),
                "A process has more coefficients than an integer can count.");
      }
  }



  template <int dim>
  void
  VelocityFilter<dim>::to_places(const ZeroedArray<double> &values,
                                 const VectorType          &vector) const
  {
    exchanged.copy_locally_owned_data_from(vector);
    exchanged.update_ghost_values();
    for (unsigned int f = 0; f < function_places.size(); ++f)
      values[function_places[f]] = exchanged.local_element(f);
    for (const auto &[place, source] : copies)
      values[place] = exchanged.local_element(source);
    exchanged.zero_out_ghost_values();
  }



  template <int dim>
  void
  VelocityFilter<dim>::set_mass(const VectorType &lumped)
  {
    const int                 length = space->degree() + 2;
    const ZeroedArray<double> mass(n_places);
    to_places(mass, lumped);
    for (unsigned int l = 0; l < lines.size(); ++l)
      {
        Line &line = lines[l];
        for (int x = line.begin; x < line.end; ++x)
          {
            const double m               = mass[line.place + x];
            inverse_mass[line.place + x] = m > 0. ? 1. / m : 0.;
          }
        for (unsigned int d = 0; d < dim; ++d)
          {
            // The range of x in which the process has all functions of a run.
            int begin = line.begin, end = line.end - (d == 0 ? length - 1 : 0);
            for (int k = 1; k < length && d > 0; ++k)
              {
                const std::size_t other = l + std::size_t(k) * line_step(d);
                const Line       *next =
                  other < lines.size() ? &lines[other] : nullptr;
                begin = next ? std::max(begin, next->begin) : begin;
                end   = next ? std::min(end, next->end) : begin;
              }
            end              = std::max(begin, end);
            double *smallest = run_mass[d].data() + line.place;
            std::copy(mass.data() + line.place + begin,
                      mass.data() + line.place + end,
                      smallest + begin);
            for (int k = 1; k < length && begin < end; ++k)
              {
                const double *other = mass.data() +
                                      lines[l + k * line_step(d)].place +
                                      (d == 0 ? k : 0);
                for (int x = begin; x < end; ++x)
                  smallest[x] = std::min(smallest[x], other[x]);
              }
            while (begin < end && !(smallest[begin] > 0.))
              ++begin;
            while (begin < end && !(smallest[end - 1] > 0.))
              --end;
            line.first_run[d]   = begin;
            line.end_of_runs[d] = end;
          }
      }
  }



  template <int dim>
  void
  VelocityFilter<dim>::apply(std::array<VectorType, dim>       &z,
                             const std::array<VectorType, dim> &velocity,
                             const double                       strength,
                             const double                       dt) const
  {
    const int                            p = space->degree(), length = p + 2;
    const ZeroedArray<double>            crossings(n_places);
    std::array<ZeroedArray<double>, dim> velocities, results;
    for (unsigned int c = 0; c < dim; ++c)
      {
        velocities[c] = ZeroedArray<double>(n_places);
        results[c]    = ZeroedArray<double>(n_places);
        to_places(velocities[c], velocity[c]);
        const double factor = (p == 1 ? more_if_linear : 1.) * strength * dt;
        for (unsigned int l = 0; l < lines.size(); ++l)
          {
            const Line &line = lines[l];
            // Lines beyond the grid have no functions.
            if (line.begin == line.end)
              continue;
            const double *v    = velocities[c].data() + line.place;
            double       *sums = crossings.data() + line.place;
            if (c == 0 && !space->is_uniform())
              {
                for (int x = line.begin; x < line.end; ++x)
                  sums[x] += factor / cell_sizes[0][x] * std::abs(v[x]);
                continue;
              }
            const double of_line =
              factor / cell_sizes[c][c == 0 ? 0 : index_of_line(l, c)];
            for (int x = line.begin; x < line.end; ++x)
              sums[x] += of_line * std::abs(v[x]);
          }
      }

    for (unsigned int d = 0; d < dim; ++d)
      {
        const int         step   = line_step(d);
        const std::size_t n_runs = differences[d].size() / length;
        for (unsigned int l = 0; l < lines.size(); ++l)
          {
            const Line &line  = lines[l];
            const int   begin = line.first_run[d], end = line.end_of_runs[d];
            if (begin >= end)
              continue;
            // In x, each run has its own differences; in other directions, all
            // runs of a line share them.
            const int  first    = d == 0 ? 0 : index_of_line(l, d);
            const auto place_of = [&](const int k) {
              return d == 0 ? line.place + k : lines[l + k * step].place;
            };
            const auto difference = [&](const int k) {
              return differences[d].data() + k * n_runs + first;
            };
            double *theta = strengths.data();
            for (int x = begin; x < end; ++x)
              theta[x] = 0.;
            for (int k = 0; k < length; ++k)
              {
                const double *from = crossings.data() + place_of(k);
                for (int x = begin; x < end; ++x)
                  theta[x] = std::max(theta[x], from[x]);
              }
            for (int x = begin; x < end; ++x)
              theta[x] =
                std::min(theta[x], 1. / dim) * run_mass[d][line.place + x];
            for (unsigned int c = 0; c < dim; ++c)
              {
                for (int x = begin; x < end; ++x)
                  jumps[x] = 0.;
                for (int k = 0; k < length; ++k)
                  {
                    const double *g    = difference(k);
                    const double *from = velocities[c].data() + place_of(k);
                    for (int x = begin; x < end; ++x)
                      jumps[x] += (d == 0 ? g[x] : *g) * from[x];
                  }
                for (int x = begin; x < end; ++x)
                  jumps[x] *= theta[x];
                for (int k = 0; k < length; ++k)
                  {
                    const double *g  = difference(k);
                    double       *to = results[c].data() + place_of(k);
                    for (int x = begin; x < end; ++x)
                      to[x] += (d == 0 ? g[x] : *g) * jumps[x];
                  }
              }
          }
      }
    const double scale = -std::ldexp(1., -2 * (p + 1));
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int f = 0; f < z[c].locally_owned_size(); ++f)
        z[c].local_element(f) = scale * inverse_mass[function_places[f]] *
                                results[c][function_places[f]];
  }



  GREVILLE_INSTANTIATE_CLASS(VelocityFilter);
} // namespace greville
