// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/full_matrix.h>

#include <greville/points/reconstruction.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The part of a layer of cells at the edge of the grid, next to a cell,
    // from which on it counts as filled. It is the mean of several cells, since
    // points move along the edge from one to the other.
    constexpr double filled_layer = 0.6;



    /**
     * The polynomials psi of a cell that its points can tell apart.
     */
    template <int dim>
    class Polynomials
    {
    public:
      Polynomials(const std::vector<Tensor<1, dim>> &positions)
      {
        // The variance of t, and what it leaves unexplained of that of t^2,
        // relative to those of a uniform distribution.
        for (unsigned int d = 0; d < dim; ++d)
          {
            double m[5] = {};
            for (const auto &t : positions)
              for (unsigned int k = 1; k < 5; ++k)
                m[k] += std::pow(t[d], k) / positions.size();
            const double variance   = m[2] - m[1] * m[1];
            const double covariance = m[3] - m[1] * m[2];
            linear[d]               = variance > 1e-2 / 12.;
            quadratic[d]            = linear[d] && m[4] - m[2] * m[2] -
                                            covariance * covariance / variance >
                                          1e-2 / 180.;
          }
      }

      unsigned int
      size() const
      {
        unsigned int n = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            n += linear[d] + quadratic[d];
            for (unsigned int e = 0; e < d; ++e)
              n += linear[d] && linear[e];
          }
        return n;
      }

      void
      evaluate(const Tensor<1, dim> &t, std::vector<double> &values) const
      {
        unsigned int k = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            if (linear[d])
              values[k++] = t[d];
            if (quadratic[d])
              values[k++] = t[d] * t[d] - 1. / 12.;
            for (unsigned int e = 0; e < d; ++e)
              if (linear[d] && linear[e])
                values[k++] = t[d] * t[e];
          }
      }

    private:
      std::array<bool, dim> linear, quadratic;
    };
    /**
     * Invert a symmetric matrix with a positive diagonal. Returns false where
     * it is singular up to 1e-8 of that.
     */
    bool
    invert(FullMatrix<double> &matrix)
    {
      // Pivots of the factorization L D L^T
      const unsigned int n = matrix.m();
      FullMatrix<double> L(matrix);
      for (unsigned int k = 0; k < n; ++k)
        {
          if (!(L(k, k) > 1e-8 * matrix(k, k)))
            return false;
          for (unsigned int i = k + 1; i < n; ++i)
            for (unsigned int j = k + 1; j < n; ++j)
              L(i, j) -= L(i, k) * L(k, j) / L(k, k);
        }
      if (n > 0)
        matrix.gauss_jordan();
      return true;
    }
  } // namespace



  template <int dim>
  std::vector<bool>
  Reconstruction<dim>::inner_cells(const MaterialPoints<dim> &points) const
  {
    const SplineSpace<dim> &space = points.space();
    if (spline_space != &space)
      {
        spline_space = &space;
        neighbors.reinit(space);
      }
    const auto &positions = neighbors.positions();
    const auto &extents   = space.lattice().n_cells();

    const PointLayout<dim> &layout      = points.layout();
    const double            cell_volume = space.lattice().cell_volume();
    std::vector<double>     filling(positions.size(), 0.);
    points.for_each([&](const unsigned int cell, ConstPointRef<dim> p) {
      filling[cell] +=
        p.volume() / layout.thickness(p.position()) / cell_volume;
    });
    neighbors.exchange(filling);

    MultiIndex<dim> three;
    three.fill(3);
    std::vector<bool> result(space.owned_cells().size(), false);
    for (const unsigned int cell : points.cells())
      {
        const auto index    = multi_index<dim>(positions[cell], extents);
        bool       is_inner = true;
        // Sums over the layers of cells at each edge of the grid.
        std::array<double, dim>       sums{};
        std::array<unsigned int, dim> counts{};
        for (int k = 0; k < Utilities::pow(3, dim); ++k)
          {
            const auto      offset = multi_index<dim>(k, three);
            MultiIndex<dim> neighbor;
            for (unsigned int d = 0; d < dim; ++d)
              neighbor[d] = index[d] + offset[d] - 1;
            if (!space.lattice().wrap(neighbor))
              continue;
            const unsigned int n =
              neighbors.find(lexicographic<dim>(neighbor, extents));
            AssertThrow(n != dealii::numbers::invalid_unsigned_int,
                        ExcInternalError());
            is_inner = is_inner && filling[n] > 0.;
            for (unsigned int d = 0; d < dim; ++d)
              if (offset[d] == 1)
                {
                  sums[d] += filling[n];
                  ++counts[d];
                }
          }
        for (unsigned int d = 0; d < dim; ++d)
          if (!space.lattice().is_periodic(d) &&
              (index[d] == 0 || index[d] + 1 == extents[d]))
            is_inner = is_inner && sums[d] >= filled_layer * counts[d];
        result[cell] = is_inner;
      }
    return result;
  }



  template <int dim>
  void
  Reconstruction<dim>::reconstruct(const MaterialPoints<dim> &points,
                                   MaterialPoints<dim>       &result) const
  {
    using Layout                     = PointLayout<dim>;
    const SplineSpace<dim> &space    = points.space();
    const auto             &lattice  = space.lattice();
    const Layout            from     = points.layout();
    const bool              has_load = from.find("load");
    Layout                  to;
    if (has_load)
      to.add("load", dim);
    if (from.is_axisymmetric())
      to.add_radius0();
    // All densities of axisymmetric points are those per area.
    const auto volume_of = [&](const ConstPointRef<dim> p) {
      return p.volume() / from.thickness(p.position());
    };
    const unsigned int from_load = has_load ? from.first("load") : 0;
    const unsigned int to_load   = has_load ? to.first("load") : 0;
    result.reinit(space, to);

    const double           cell_volume = lattice.cell_volume();
    const QGauss<dim>      quadrature(n_q);
    constexpr unsigned int n_stress = Layout::n_stress;
    const unsigned int     n_fields = 1 + dim + n_stress + (has_load ? dim : 0);

    std::vector<double>             values(to.size), psi;
    const PointRef<dim>             result_point(values.data());
    std::vector<ConstPointRef<dim>> members;
    std::vector<Tensor<1, dim>>     positions;
    std::vector<unsigned int>       full_cells;
    const std::vector<bool>         is_inner = inner_cells(points);
    for (const unsigned int cell : points.cells())
      {
        const auto center = lattice.cell_center(
          multi_index<dim>(space.owned_cells()[cell], lattice.n_cells()));
        members.clear();
        positions.clear();
        double       volume = 0.;
        unsigned int n      = points.n_in_first_group(cell);
        for (unsigned int g = points.first_group(cell);
             g != MaterialPoints<dim>::none;
             g = points.next_group(g), n = points.width)
          for (unsigned int lane = 0; lane < n; ++lane)
            {
              const ConstPointRef<dim> p = points.point(g, lane);
              members.push_back(p);
              Tensor<1, dim> t;
              for (unsigned int d = 0; d < dim; ++d)
                t[d] = (p.position(d) - center[d]) / lattice.cell_size(d);
              positions.push_back(t);
              volume += volume_of(p);
            }

        // Values of the quantities at the points, per volume, and their means.
        const auto field = [&](const ConstPointRef<dim> p,
                               const unsigned int       f) {
          const double V   = volume_of(p);
          const double rho = p.mass() / V;
          if (f == 0)
            return rho;
          if (f <= dim)
            return rho * p.velocity(f - 1);
          if (f <= dim + n_stress)
            return p.stress(f - 1 - dim);
          return rho * p[from_load + f - 1 - dim - n_stress];
        };

        const auto fits_constant = [&](const unsigned int f) {
          return !conserves_in_cells || (f > dim && f <= dim + n_stress);
        };

        const Polynomials<dim> polynomials(positions);
        const unsigned int     n_psi = polynomials.size();
        bool is_full = is_inner[cell] && volume >= full * cell_volume &&
                       members.size() > n_psi;
        FullMatrix<double> coefficients(n_fields, n_psi + 1);
        if (is_full)
          {
            psi.resize(n_psi);
            for (const ConstPointRef<dim> p : members)
              for (unsigned int f = 0; f < n_fields; ++f)
                coefficients(f, n_psi) +=
                  field(p, f) * volume_of(p) / cell_volume;
            // With positions and values relative to their means, the
            // constant is fitted as well.
            std::vector<double> mean_psi(n_psi, 0.), mean_field(n_fields, 0.);
            for (unsigned int k = 0; k < members.size(); ++k)
              {
                polynomials.evaluate(positions[k], psi);
                for (unsigned int i = 0; i < n_psi; ++i)
                  mean_psi[i] += psi[i] / members.size();
                for (unsigned int f = 0; f < n_fields; ++f)
                  mean_field[f] += field(members[k], f) / members.size();
              }
            FullMatrix<double> normal(n_psi, n_psi), centered(n_psi, n_psi),
              right(n_psi, n_fields);
            for (unsigned int k = 0; k < members.size(); ++k)
              {
                polynomials.evaluate(positions[k], psi);
                for (unsigned int i = 0; i < n_psi; ++i)
                  {
                    const double centered_psi = psi[i] - mean_psi[i];
                    for (unsigned int j = 0; j < n_psi; ++j)
                      {
                        normal(i, j) += psi[i] * psi[j];
                        centered(i, j) += centered_psi * (psi[j] - mean_psi[j]);
                      }
                    for (unsigned int f = 0; f < n_fields; ++f)
                      right(i, f) +=
                        fits_constant(f)
                          ? centered_psi *
                              (field(members[k], f) - mean_field[f])
                          : psi[i] *
                              (field(members[k], f) - coefficients(f, n_psi));
                  }
              }
            is_full = invert(normal) && invert(centered);
            for (unsigned int f = 0; f < n_fields; ++f)
              {
                if (fits_constant(f))
                  coefficients(f, n_psi) = mean_field[f];
                for (unsigned int i = 0; i < n_psi; ++i)
                  {
                    for (unsigned int j = 0; j < n_psi; ++j)
                      coefficients(f, i) +=
                        (fits_constant(f) ? centered : normal)(i, j) *
                        right(j, f);
                    if (fits_constant(f))
                      coefficients(f, n_psi) -=
                        coefficients(f, i) * mean_psi[i];
                  }
              }

            // All densities have to be positive.
            for (unsigned int q = 0; is_full && q < quadrature.size(); ++q)
              {
                Tensor<1, dim> t;
                for (unsigned int d = 0; d < dim; ++d)
                  t[d] = quadrature.point(q)[d] - 0.5;
                polynomials.evaluate(t, psi);
                double density = coefficients(0, n_psi);
                for (unsigned int i = 0; i < n_psi; ++i)
                  density += coefficients(0, i) * psi[i];
                is_full = is_full && density > 0.;
              }
          }

        std::fill(values.begin(), values.end(), 0.);
        result_point.set_F(unit_symmetric_tensor<3>());
        if (!is_full)
          for (const ConstPointRef<dim> p : members)
            {
              for (unsigned int k = 0; k < Layout::n_fixed; ++k)
                values[k] = p[k];
              if (has_load)
                for (unsigned int d = 0; d < dim; ++d)
                  values[to_load + d] = p[from_load + d];
              if (to.is_axisymmetric())
                values[to.radius0] = p[from.radius0];
              result.insert(cell, make_array_view(values));
            }
        else
          {
            full_cells.push_back(cell);
            for (unsigned int q = 0; q < quadrature.size(); ++q)
              {
                Tensor<1, dim> t;
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    t[d] = quadrature.point(q)[d] - 0.5;
                    result_point.position(d) =
                      center[d] + t[d] * lattice.cell_size(d);
                  }
                polynomials.evaluate(t, psi);
                std::vector<double> fields(n_fields);
                for (unsigned int f = 0; f < n_fields; ++f)
                  {
                    fields[f] = coefficients(f, n_psi);
                    for (unsigned int i = 0; i < n_psi; ++i)
                      fields[f] += coefficients(f, i) * psi[i];
                  }
                result_point.volume0() = quadrature.weight(q) * cell_volume;
                result_point.J()       = 1.;
                result_point.mass()    = fields[0] * result_point.volume0();
                result_point.volume0() *=
                  from.thickness(result_point.position());
                if (to.is_axisymmetric())
                  values[to.radius0] = result_point.position(0);
                for (unsigned int d = 0; d < dim; ++d)
                  result_point.velocity(d) = fields[1 + d] / fields[0];
                for (unsigned int k = 0; k < n_stress; ++k)
                  result_point.stress(k) = fields[1 + dim + k];
                if (has_load)
                  for (unsigned int d = 0; d < dim; ++d)
                    values[to_load + d] =
                      fields[1 + dim + n_stress + d] / fields[0];
                result.insert(cell, make_array_view(values));
              }
          }
      }
    if (!conserves_in_cells)
      conserve(points, full_cells, result);
  }



  template <int dim>
  void
  Reconstruction<dim>::conserve(const MaterialPoints<dim>       &points,
                                const std::vector<unsigned int> &cells,
                                MaterialPoints<dim>             &result) const
  {
    std::vector<bool> is_full(points.space().owned_cells().size(), false);
    for (const unsigned int cell : cells)
      is_full[cell] = true;

    // Mass and momentum of the points and of the Gauss points
    std::vector<double> sums(2 * (dim + 1), 0.);
    const auto          add = [&](const unsigned int       cell,
                         const ConstPointRef<dim> p,
                         const unsigned int       first) {
      if (!is_full[cell])
        return;
      const double m = p.mass();
      sums[first] += m;
      for (unsigned int d = 0; d < dim; ++d)
        sums[first + 1 + d] += m * p.velocity(d);
    };
    points.for_each(
      [&](const unsigned int cell, ConstPointRef<dim> p) { add(cell, p, 0); });
    result.for_each(
      [&](const unsigned int cell, PointRef<dim> p) { add(cell, p, dim + 1); });
    Utilities::MPI::sum(sums, points.space().communicator(), sums);
    if (!(sums[dim + 1] > 0.))
      return;
    const double factor = sums[0] / sums[dim + 1];
    result.for_each([&](const unsigned int cell, PointRef<dim> p) {
      if (!is_full[cell])
        return;
      p.mass() *= factor;
      for (unsigned int d = 0; d < dim; ++d)
        p.velocity(d) += (sums[1 + d] - factor * sums[dim + 2 + d]) / sums[0];
    });
  }



  template class Reconstruction<2>;
  template class Reconstruction<3>;
} // namespace greville
