// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/water_tangents.h>

#include "group_gradients.h"

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// Set h = grad u at the end of the trial step, and return its trace.
    template <int dim, int n_pairs>
    inline __attribute__((always_inline)) Simd
    gradient_at_end(const Simd (&H)[n_pairs],
                    const Simd (&M)[dim][dim],
                    Simd (&h)[dim][dim])
    {
      Simd trace = 0.;
      for (int i = 0; i < dim; ++i)
        {
          for (int j = 0; j < dim; ++j)
            {
              h[i][j] = H[i * dim] * M[0][j];
              for (int J = 1; J < dim; ++J)
                h[i][j] += H[i * dim + J] * M[J][j];
            }
          trace += h[i][i];
        }
      return trace;
    }



    /// Set T for the force. @p Vp is V p, and @p diagonal is V (q + e p).
    template <int dim, int n_pairs>
    inline __attribute__((always_inline)) void
    set_force(const Simd diagonal,
              const Simd Vp,
              const Simd (&M)[dim][dim],
              const Simd (&h)[dim][dim],
              Simd (&T)[n_pairs])
    {
      for (int i = 0; i < dim; ++i)
        for (int J = 0; J < dim; ++J)
          {
            Simd sum = -diagonal * M[J][i];
            for (int j = 0; j < dim; ++j)
              sum += Vp * h[j][i] * M[J][j];
            T[i * dim + J] = sum;
          }
    }



    /// Set P for the rows by the change of the flow @p w, with @p k = dt V
    /// kappa.
    template <int dim>
    inline __attribute__((always_inline)) void
    set_flow(const Simd k,
             const Simd of_w,
             const Simd (&w)[dim],
             const Tensor<1, dim> &weight_of_water,
             const Simd (&slope_p)[dim + 1],
             const Simd (&M)[dim][dim],
             const Simd (&h)[dim][dim],
             Simd (&P)[dim + 1])
    {
      Simd s[dim];
      for (int j = 0; j < dim; ++j)
        {
          Simd sum = 0.;
          for (int J = 0; J < dim; ++J)
            sum += M[J][j] * slope_p[J];
          for (int i = 0; i < dim; ++i)
            sum -= h[i][j] * (w[i] + weight_of_water[i]) + h[j][i] * w[i];
          s[j] = k * sum + of_w * w[j];
        }
      for (int J = 0; J < dim; ++J)
        {
          P[J] = M[J][0] * s[0];
          for (int j = 1; j < dim; ++j)
            P[J] += M[J][j] * s[j];
        }
    }



    /// Return the sums over lanes.
    template <int size>
    inline __attribute__((always_inline)) std::array<double, size>
    reduce_lanes(const Simd (&sums)[size])
    {
      std::array<double, size> result;
      for (int k = 0; k < size; k += 4)
        store(reduce_four(sums + k), result.data() + k);
      return result;
    }
  } // namespace



  template <int dim>
  void
  WaterTangents<dim>::set(
    const WaterTerms<dim>                              &terms,
    const std::vector<typename WaterTerms<dim>::Point> &points)
  {
    is_axisymmetric = terms.is_axisymmetric;
    weight_of_water = terms.weight;
    cells.clear();
    std::size_t size = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
      {
        if (k == 0 || points[k].cell != points[k - 1].cell)
          cells.push_back({points[k].cell, 0, size});
        if (cells.back().n_points++ % simd_width == 0)
          size += n_numbers * simd_width;
      }
    numbers.assign(size, 0.);
    auto point = points.begin();
    for (const CellPoints &of_cell : cells)
      for (unsigned int q = 0; q < of_cell.n_points; ++q, ++point)
        {
          double *to = numbers.data() + of_cell.first +
                       q / simd_width * n_numbers * simd_width + q % simd_width;
          const auto put = [&](const unsigned int number, const double value) {
            to[number * simd_width] = value;
          };
          const double V = point->volume * point->J;
          const auto   k = terms.mobility(*point);
          for (unsigned int d = 0; d < dim; ++d)
            {
              put(x + d, point->x[d]);
              put(weight + d, point->gradient[d] - terms.weight[d]);
              for (unsigned int e = 0; e < dim; ++e)
                put(map + d * dim + e, point->map[d][e]);
            }
          put(volume, V);
          put(work, V * point->p);
          put(storage, point->storage);
          put(flow, terms.dt * point->J * k.value);
          put(by_J, terms.dt * point->J * k.by_volume);
          put(by_p, terms.dt * point->J * k.by_pressure);
          if (is_axisymmetric)
            put(curvature, 1. / point->end_radius);
          // Empty lanes have a position in the cell.
          if (q + 1 == of_cell.n_points)
            for (unsigned int lane = q % simd_width + 1; lane < simd_width;
                 ++lane)
              for (unsigned int d = 0; d < dim; ++d)
                to[(x + d) * simd_width + lane - q % simd_width] = point->x[d];
        }
  }



  template <int dim>
  template <int n, bool with_hoop>
  void
  WaterTangents<dim>::multiply(const Fields &fields) const
  {
    using ShapeU           = GroupGradients<dim, n, dim, with_hoop>;
    using ShapeP           = GroupGradients<dim, n, 1, true>;
    const bool of_pressure = !fields.u;
    for (const CellPoints &points : cells)
      {
        const CellGeometry<dim, n> of_u(fields.displacements, points.cell);
        const CellGeometry<dim, n> of_p(fields.pressures,
                                        fields.parents[points.cell]);
        double                     u[ShapeU::n_numbers], p[ShapeP::n_numbers];
        Simd                       f[ShapeU::n_padded], r[ShapeP::n_padded];
        for (int a = 0; a < power(n, dim) && !of_pressure; ++a)
          for (int i = 0; i < dim; ++i)
            u[a * dim + i] = fields.u[std::size_t(of_u.functions[a]) * dim + i];
        for (int b = 0; b < ShapeP::n_numbers; ++b)
          p[b] = fields.p[of_p.functions[b]];
        for (Simd &sum : f)
          sum = 0.;
        for (Simd &sum : r)
          sum = 0.;
        const double *group = numbers.data() + points.first;
        for (unsigned int q = 0; q < points.n_points; q += simd_width)
          {
            const auto number = [&](const unsigned int k) {
              return load(group + k * simd_width);
            };
            Simd position[dim], M[dim][dim];
            load_numbers<dim>(group, x, position);
            load_numbers<dim * dim>(group, map, M[0]);
            ShapeU shape_u;
            ShapeP shape_p;
            shape_u.template evaluate<true>(of_u, position);
            shape_p.template evaluate<true>(of_p, position);
            // The gradient and the value of the pressure; T for the force; P
            // for the rows.
            Simd slope_p[dim + 1], T[ShapeU::n_pairs];
            shape_p.gradient(p, slope_p);
            const Simd V = number(volume), change_of_p = slope_p[dim];
            if (of_pressure)
              {
                for (int i = 0; i < dim; ++i)
                  for (int J = 0; J < dim; ++J)
                    T[i * dim + J] = -V * change_of_p * M[J][i];
                if constexpr (with_hoop)
                  T[dim * dim] = -V * change_of_p * number(curvature);
              }
            else
              {
                Simd H[ShapeU::n_pairs], h[dim][dim], P[dim + 1];
                shape_u.gradient(u, H);
                Simd       rate = gradient_at_end(H, M, h);
                const Simd Vp   = number(work);
                if constexpr (with_hoop)
                  {
                    const Simd of_r = number(curvature);
                    T[dim * dim]    = -(V * change_of_p + Vp * rate) * of_r;
                    rate += H[dim * dim] * of_r;
                  }
                set_force(V * change_of_p + Vp * rate, Vp, M, h, T);
                Simd       w[dim];
                const Simd k = number(flow);
                load_numbers<dim>(group, weight, w);
                const Simd of_w =
                  rate * (k + number(by_J)) + number(by_p) * change_of_p;
                set_flow(k, of_w, w, weight_of_water, slope_p, M, h, P);
                P[dim] = V * rate + number(storage) * change_of_p;
                shape_p.add_divergence(P, r);
              }
            shape_u.add_divergence(T, f);
            group += n_numbers * simd_width;
          }
        const auto sums = reduce_lanes(f);
        for (int a = 0; a < power(n, dim); ++a)
          for (int i = 0; i < dim; ++i)
            fields.forces[std::size_t(of_u.functions[a]) * dim + i] +=
              sums[a * dim + i];
        if (!of_pressure)
          {
            const auto of_rows = reduce_lanes(r);
            for (int b = 0; b < ShapeP::n_numbers; ++b)
              fields.rows[of_p.functions[b]] += of_rows[b];
          }
      }
  }



  template <int dim>
  void
  WaterTangents<dim>::add_product(const Fields &fields) const
  {
    with_order_and_hoop<dim>(
      fields.displacements.space->degree(),
      is_axisymmetric,
      [&](const auto order, const auto hoop) {
        multiply<decltype(order)::value, decltype(hoop)::value>(fields);
      });
  }



  GREVILLE_INSTANTIATE_CLASS(WaterTangents);
} // namespace greville
