// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/row_sums.h>
#include <greville/points/volume_projection.h>

#include "group_lanes.h"
#include "window_functions.h"
#include <cmath>
#include <sstream>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * What grid_to_points() does in one pass: Kick changes velocities, Move
     * positions and Deform F, J, stress and state. SameVelocity: w is v.
     */
    template <bool kick_, bool move_, bool deform_, bool same_, bool apic_>
    struct Pass
    {
      static constexpr bool kick   = kick_;
      static constexpr bool move   = move_;
      static constexpr bool deform = deform_;
      static constexpr bool apic   = apic_;
      // Fields that a function of the grid has: v, w and a.
      static constexpr bool has_v = kick || move || same_;
      static constexpr bool has_w = deform && !same_;
      static constexpr bool has_a = kick && !apic;
    };



    /**
     * Name what is wrong with a point of a group, if it is the first.
     */
    template <int dim>
    void
    report_bad_point(const MaterialPoints<dim> &points,
                     const unsigned int         cell,
                     const unsigned int         g,
                     const unsigned int         count,
                     PointReport               &report)
    {
      for (unsigned int lane = 0; lane < count && report.bad_point < 0; ++lane)
        {
          const ConstPointRef<dim> p   = points.point(g, lane);
          const double             J   = p.J();
          double                   sum = 0.;
          for (unsigned int k = 0; k < PointLayout<dim>::n_fixed; ++k)
            sum += p[k];
          if (J > 0. && std::isfinite(sum))
            continue;
          report.bad_point = std::int64_t(p.id());
          std::ostringstream reason;
          if (J <= 0.)
            reason << "its volume has become negative (J = " << J << ")";
          else
            reason << "its state is infinite or NaN (J = " << J << ", velocity "
                   << p.velocity(0) << " m/s in x)";
          reason << "; it is "
                 << describe_place<dim>(points.space(),
                                        cell,
                                        p.position(),
                                        "from");
          report.bad_reason = reason.str();
        }
    }



    /**
     * A bound of the square of the speed that waves have in the reference
     * configuration over that in the current one, from F^-1: the largest sum of
     * a row of F^-1 F^-T.
     */
    template <int dim>
    Simd
    square_of_stretch(const Simd (&inverse)[dim][dim])
    {
      Simd B[dim][dim], largest = 0.;
      multiply_transposed<dim>(inverse, inverse, B);
      for (int i = 0; i < dim; ++i)
        {
          Simd sum = 0.;
          for (int j = 0; j < dim; ++j)
            sum += abs(B[i][j]);
          largest = max(largest, sum);
        }
      return largest;
    }



    /**
     * Set F_zz of a group of axisymmetric points to r / radius0, and return by
     * how much it grows.
     */
    template <int dim>
    Simd
    stretch_hoop(const PointLayout<dim> &layout, double *group)
    {
      using Layout = PointLayout<dim>;
      double *const F =
        group + (Layout::F + Layout::F_index(2, 2)) * simd_width;
      const Simd before = load(F);
      const Simd after  = load(group + Layout::position * simd_width) /
                         load(group + layout.radius0 * simd_width);
      store(after, F);
      return after / before;
    }



    /**
     * Give the sums of a row the velocities, and with APIC the affine matrices
     * C from number @p first_affine on and the diagonals D, of a group between
     * those that it has and new ones.
     */
    template <int dim, bool apic>
    __attribute__((noinline)) void
    add_motion(const PointUpdate<dim> &update,
               const double           *group,
               const unsigned int      count,
               const Simd (&v)[dim],
               const unsigned int first_affine,
               const Simd (&C)[dim][dim],
               const Simd (&D)[dim])
    {
      const double f = update.row_fraction;
      double       velocities[dim * simd_width];
      for (int i = 0; i < dim; ++i)
        {
          const Simd before =
            load(group + (PointLayout<dim>::velocity + i) * simd_width);
          store(before + f * (v[i] - before), velocities + i * simd_width);
        }
      if constexpr (apic)
        {
          double matrices[dim * dim * simd_width], diagonals[dim * simd_width];
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              {
                const unsigned int k = i * dim + j;
                const Simd         before =
                  load(group + (first_affine + k) * simd_width);
                store(before + f * (C[i][j] - before),
                      matrices + k * simd_width);
              }
          for (int j = 0; j < dim; ++j)
            store(D[j], diagonals + j * simd_width);
          update.row->add_motion(group, count, velocities, matrices, diagonals);
        }
      else
        update.row->add_motion(group, count, velocities);
    }



    template <int dim, int n, typename Kind>
    void
    update_points(MaterialPoints<dim>         &points,
                  const SpacePolynomials<dim> &tables,
                  const CellWindows<dim>      *windows,
                  const PointUpdate<dim>      &update,
                  const double                *projected,
                  const double                *buffer,
                  PointReport                 &report)
    {
      using Layout = PointLayout<dim>;
      const unsigned int first_affine =
        Kind::apic ? points.layout().first("affine") : 0;
      constexpr int  first_w        = Kind::has_v ? dim : 0;
      constexpr int  first_a        = first_w + (Kind::has_w ? dim : 0);
      constexpr int  n_fields       = first_a + (Kind::has_a ? dim : 0);
      constexpr int  first_gradient = Kind::has_w ? first_w : 0;
      constexpr int  n_functions    = power(n, dim);
      constexpr int  n_z            = dim == 3 ? n : 1;
      constexpr bool derivatives    = Kind::deform;
      Simd           fastest = 0., fastest_wave = 0.;
      Simd           mass = 0., crossed = 0.;
      Simd           momentum[dim];
      Simd           smallest_J = report.sums.smallest_J, largest_J = 0.;
      std::fill_n(momentum, dim, Simd(0.));
      const bool         total = points.layout().is_total_lagrangian();
      const bool         is_axisymmetric = points.layout().is_axisymmetric();
      const unsigned int initial_F       = points.layout().initial_F;
      const unsigned int projected_J     = points.layout().projected_J;
      // Nothing behind the mass is read where nothing deforms, and nothing
      // behind F without fields.
      const unsigned int n_read =
        total || points.layout().size > Layout::n_fixed
          ? points.layout().size
          : (Kind::deform ? Layout::reference : Layout::volume0);
      // Where the fields of windows lie.
      constexpr int stride = field_stride<dim>;
      using OfWindow =
        Sums<n_field_vectors<dim>(n_fields / dim),
             derivatives ? first_gradient / dim * stride / 4 : -1>;
      WindowFunctions<dim, n> functions(points, tables, windows);

      const std::vector<unsigned int> &cells = points.cells();
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          const unsigned int         cell = cells[c];
          const CellGeometry<dim, n> geometry(tables, cell);
          double                     coefficients[n_functions * n_fields];
          if (!windows && c + 1 < cells.size())
            prefetch_functions<n_functions>(
              tables.space->cell_functions(cells[c + 1]).data(),
              buffer,
              n_fields);
          if (windows)
            functions.begin(geometry, cell);
          for (int a = 0; a < (windows ? 0 : n_functions); ++a)
            for (int k = 0; k < n_fields; ++k)
              coefficients[a * n_fields + k] =
                buffer[std::size_t(geometry.functions[a]) * n_fields + k];

          bool         left  = false;
          unsigned int count = points.n_in_first_group(cell);
          for (unsigned int g = points.first_group(cell);
               g != MaterialPoints<dim>::none;
               g = points.next_group(g), count = simd_width)
            {
              prefetch_next(points, c, g, n_read);
              double *group = points.group(g);
              if constexpr (Kind::kick)
                if (update.row)
                  update.row->add_group(points, group, count);
              Simd x[dim];
              load_basis_positions(points, group, x);
              ShapeValues<dim, n> shape;
              if (!windows)
                shape.template evaluate<derivatives>(geometry, x);

              Simd fields[n_fields], gradient[dim][dim], B[dim][dim];
              Simd inverse[dim][dim]; // of F
              for (int k = 0; k < n_fields; ++k)
                fields[k] = 0.;
              for (int i = 0; i < dim; ++i)
                for (int j = 0; j < dim; ++j)
                  {
                    gradient[i][j] = 0.;
                    B[i][j]        = 0.;
                  }

              const double *c = coefficients;
              for (int a_z = 0; a_z < (windows ? 0 : n_z); ++a_z)
                for (int a_y = 0; a_y < n; ++a_y)
                  {
                    Simd rows[n_fields], slopes[dim], first_moments[dim];
                    for (int k = 0; k < n_fields; ++k)
                      rows[k] = 0.;
                    for (int i = 0; i < dim; ++i)
                      {
                        slopes[i]        = 0.;
                        first_moments[i] = 0.;
                      }
                    for (int a = 0; a < n; ++a, c += n_fields)
                      {
                        for (int k = 0; k < n_fields; ++k)
                          rows[k] += shape.N[0][a] * c[k];
                        if constexpr (derivatives)
                          for (int i = 0; i < dim; ++i)
                            slopes[i] += shape.dN[0][a] * c[first_gradient + i];
                        if constexpr (Kind::apic)
                          for (int i = 0; i < dim; ++i)
                            first_moments[i] +=
                              shape.N[0][a] * c[i] * geometry.offsets[0][a];
                      }
                    Simd N_yz = shape.N[1][a_y];
                    if constexpr (dim == 3)
                      N_yz *= shape.N[dim - 1][a_z];
                    for (int k = 0; k < n_fields; ++k)
                      fields[k] += N_yz * rows[k];
                    if constexpr (derivatives)
                      {
                        Simd dy = shape.dN[1][a_y], dz = 0.;
                        if constexpr (dim == 3)
                          {
                            dy *= shape.N[dim - 1][a_z];
                            dz = shape.N[1][a_y] * shape.dN[dim - 1][a_z];
                          }
                        for (int i = 0; i < dim; ++i)
                          {
                            gradient[i][0] += N_yz * slopes[i];
                            gradient[i][1] += dy * rows[first_gradient + i];
                            if constexpr (dim == 3)
                              gradient[i][dim - 1] +=
                                dz * rows[first_gradient + i];
                          }
                      }
                    if constexpr (Kind::apic)
                      for (int i = 0; i < dim; ++i)
                        {
                          B[i][0] += N_yz * first_moments[i];
                          B[i][1] += N_yz * rows[i] * geometry.offsets[1][a_y];
                          if constexpr (dim == 3)
                            B[i][dim - 1] +=
                              N_yz * rows[i] * geometry.offsets[dim - 1][a_z];
                        }
                  }

              if (windows)
                {
                  Simd sums[OfWindow::n_all(dim) * simd_width];
                  functions.template gather<OfWindow>(
                    group, count, x, buffer, sums);
                  for (int k = 0; k < n_fields; ++k)
                    fields[k] = sums[k / dim * stride + k % dim];
                  if constexpr (derivatives)
                    for (int i = 0; i < dim; ++i)
                      for (int j = 0; j < dim; ++j)
                        gradient[i][j] =
                          sums[OfWindow::n_numbers + j * 4 +
                               first_gradient / dim * stride % 4 + i];
                }

              // Lanes without a point stay where they are.
              Simd lane_is_used;
              for (unsigned int lane = 0; lane < simd_width; ++lane)
                lane_is_used[lane] = lane < count ? 1. : 0.;
              Simd v[dim];

              if constexpr (Kind::kick)
                {
                  Simd D[dim] = {};
                  if constexpr (Kind::apic)
                    {
                      for (int i = 0; i < dim; ++i)
                        v[i] = fields[i];
                      for (int j = 0; j < dim; ++j)
                        {
                          // xi - x is the offset minus the distance of x from
                          // the centre; D as in the documentation.
                          const Simd t = x[j] - geometry.center[j];
                          D[j]         = 0.;
                          for (int a = 0; a < n; ++a)
                            {
                              const Simd distance = geometry.offsets[j][a] - t;
                              D[j] += shape.N[j][a] * distance * distance;
                            }
                          const double smallest =
                            1e-12 /
                            (geometry.inverse_h[j] * geometry.inverse_h[j]);
                          where(D[j] < smallest, D[j]) = smallest;
                          for (int i = 0; i < dim; ++i)
                            B[i][j] =
                              lane_is_used * (B[i][j] - t * fields[i]) / D[j];
                        }
                    }
                  else
                    {
                      load_numbers<dim>(group, Layout::velocity, v);
                      for (int i = 0; i < dim; ++i)
                        v[i] = update.flip * (v[i] + update.velocity_step *
                                                       fields[first_a + i]) +
                               (1. - update.flip) * fields[i];
                    }
                  for (int i = 0; i < dim; ++i)
                    v[i] *= lane_is_used;
                  if (update.row)
                    add_motion<dim, Kind::apic>(
                      update, group, count, v, first_affine, B, D);
                  store_numbers<dim>(v, Layout::velocity, group);
                  if constexpr (Kind::apic)
                    for (int i = 0; i < dim; ++i)
                      store_numbers<dim>(B[i], first_affine + i * dim, group);
                }

              if constexpr (Kind::move)
                {
                  if (total)
                    load_numbers<dim>(group, Layout::position, x);
                  if constexpr (!Kind::kick)
                    load_numbers<dim>(group, Layout::velocity, v);
                  const Simd m =
                    lane_is_used * load(group + Layout::mass * simd_width);
                  mass += m;
                  for (int i = 0; i < dim; ++i)
                    {
                      const Simd way = update.step * lane_is_used * fields[i];
                      momentum[i] += m * v[i];
                      crossed = max(crossed, abs(way) * geometry.inverse_h[i]);
                      x[i] += way;
                      const Simd t =
                        (x[i] - geometry.center[i]) * geometry.inverse_h[i];
                      left = left || (!total && !all_of(abs(t) < 0.5));
                    }
                  store_numbers<dim>(x, Layout::position, group);
                }

              if constexpr (Kind::deform)
                {
                  Simd increment[dim][dim], F[dim][dim], new_F[dim][dim];
                  // Of F_zz: 1 in plane strain, else that to r / radius0.
                  Simd hoop_increment = 1.;
                  if (is_axisymmetric)
                    hoop_increment = stretch_hoop<dim>(points.layout(), group);
                  if (total)
                    {
                      Simd reference[dim][dim];
                      std::copy_n(gradient[0], dim * dim, reference[0]);
                      load_inverse_F<dim>(group, initial_F, inverse);
                      multiply<dim>(reference, inverse, gradient);
                    }
                  for (int i = 0; i < dim; ++i)
                    {
                      load_numbers<dim>(group, Layout::F + i * dim, F[i]);
                      for (int j = 0; j < dim; ++j)
                        increment[i][j] =
                          update.step * lane_is_used * gradient[i][j] +
                          (i == j ? 1. : 0.);
                    }
                  multiply<dim>(increment, F, new_F);
                  for (int i = 0; i < dim; ++i)
                    store_numbers<dim>(new_F[i], Layout::F + i * dim, group);
                  Simd det = increment[0][0] * increment[1][1] -
                             increment[0][1] * increment[1][0];
                  if constexpr (dim == 3)
                    det = det * increment[2][2] +
                          increment[0][1] * increment[1][2] * increment[2][0] +
                          increment[0][2] * increment[1][0] * increment[2][1] -
                          increment[0][2] * increment[1][1] * increment[2][0] -
                          increment[0][0] * increment[1][2] * increment[2][1];
                  if (is_axisymmetric)
                    det *= hoop_increment;
                  const Simd J = det * load(group + Layout::J * simd_width);
                  store(J, group + Layout::J * simd_width);
                  Simd used_J                      = J;
                  where(lane_is_used < 1., used_J) = 1.;
                  smallest_J                       = min(smallest_J, used_J);
                  largest_J                        = max(largest_J, used_J);

                  if (projected_J != 0)
                    {
                      double    *address = group + projected_J * simd_width;
                      const Simd before  = load(address);
                      Simd       after = J, factor = 1.;
                      for (unsigned int lane = 0; lane < count; ++lane)
                        {
                          if (projected)
                            after[lane] = *projected++;
                          const double ratio =
                            after[lane] / before[lane] / det[lane];
                          factor[lane] = dim == 2 && !is_axisymmetric
                                           ? std::sqrt(ratio)
                                           : std::cbrt(ratio);
                        }
                      if (is_axisymmetric)
                        hoop_increment *= factor;
                      store(after, address);
                      for (int i = 0; i < dim; ++i)
                        for (int j = 0; j < dim; ++j)
                          increment[i][j] *= factor;
                    }

                  if ((update.material && !update_material(points,
                                                           g,
                                                           count,
                                                           increment,
                                                           hoop_increment,
                                                           update)) ||
                      !all_of(used_J > 0.))
                    report_bad_point(points, cell, g, count, report);

                  // c^2 = modulus / density
                  Simd v2 = 0.;
                  if (!total)
                    {
                      load_numbers<dim>(group, Layout::velocity, v);
                      for (int i = 0; i < dim; ++i)
                        v2 += v[i] * v[i];
                    }
                  Simd m            = load(group + Layout::mass * simd_width);
                  where(m <= 0., m) = 1.;
                  Simd c2 = load(group + Layout::wave_modulus * simd_width) *
                            J * load(group + Layout::volume0 * simd_width) / m;
                  if (total)
                    c2 *= square_of_stretch<dim>(inverse);
                  fastest_wave = max(fastest_wave, sqrt(c2));
                  fastest      = max(fastest, sqrt(c2) + sqrt(v2));
                }
            }
          if (left)
            report.left_cells.push_back(cell);
        }
      report.fastest_signal = hmax(fastest);
      report.fastest_wave   = hmax(fastest_wave);
      report.sums.mass      = reduce(mass);
      for (int i = 0; i < dim; ++i)
        report.sums.momentum[i] = reduce(momentum[i]);
      report.sums.crossed    = hmax(crossed);
      report.sums.smallest_J = hmin(smallest_J);
      report.sums.largest_J  = hmax(largest_J);
    }
  } // namespace



  template <int dim>
  PointReport
  PointTransfer<dim>::grid_to_points(MaterialPoints<dim>    &points,
                                     const PointUpdate<dim> &update)
  {
    const bool                  kick    = update.acceleration != nullptr;
    const bool                  deform  = update.deformation != nullptr;
    const bool                  same    = update.deformation == update.velocity;
    [[maybe_unused]] const bool is_flip = !update.apic && update.flip == 1.;
    AssertThrow(update.velocity || !(update.move || (kick && !is_flip)),
                ExcMessage(
                  "Points that move, and kicks of PIC and APIC, need a "
                  "velocity of the grid."));
    AssertThrow(!update.apic || points.layout().find("affine"),
                ExcInternalError());
    AssertThrow(!update.apic || !windows,
                ExcMessage("APIC does not go with domains."));

    std::vector<const VectorField<dim> *> fields;
    // A kick of FLIP does not look at it, but at its place in the buffer.
    if (kick || update.move || (deform && same))
      fields.push_back(update.velocity ? update.velocity : update.acceleration);
    if (deform && !same)
      fields.push_back(update.deformation);
    if (kick && !update.apic)
      fields.push_back(update.acceleration);

    const unsigned int stride = windows ? field_stride<dim> : dim;
    resize_numbers(windows ? n_field_vectors<dim>(fields.size()) * simd_width
                           : fields.size() * dim);
    if (windows)
      std::fill(numbers.begin(), numbers.end(), 0.);
    for (unsigned int f = 0; f < fields.size(); ++f)
      for (unsigned int d = 0; d < dim; ++d)
        read_number((*fields[f])[d], f * stride + d);

    const double *projected = deform && update.projection
                                ? update.projection
                                    ->project(points,
                                              *update.deformation,
                                              update.step,
                                              nullptr,
                                              update.move)
                                    .data()
                                : nullptr;
    PointReport   report;
    with_order(tables.space->degree(), [&](const auto size) {
      constexpr int n   = decltype(size)::value;
      const auto    run = [&](const auto kind) {
        update_points<dim, n, std::decay_t<decltype(kind)>>(
          points, tables, windows, update, projected, numbers.data(), report);
      };
      if (kick && update.move && deform && same)
        update.apic ? run(Pass<true, true, true, true, true>())
                    : run(Pass<true, true, true, true, false>());
      else if (kick && update.move && !deform)
        update.apic ? run(Pass<true, true, false, false, true>())
                    : run(Pass<true, true, false, false, false>());
      else if (kick && !update.move && !deform)
        update.apic ? run(Pass<true, false, false, false, true>())
                    : run(Pass<true, false, false, false, false>());
      else if (!kick && update.move && deform && !same)
        run(Pass<false, true, true, false, false>());
      else if (!kick && update.move && deform && same)
        run(Pass<false, true, true, true, false>());
      else if (!kick && !update.move && deform)
        // The velocity is not needed: w takes its place.
        run(Pass<false, false, true, false, false>());
      else if (!kick && update.move && !deform)
        run(Pass<false, true, false, false, false>());
      else
        AssertThrow(false,
                    ExcMessage("No pass over points has this combination of "
                               "updates."));
    });
    return report;
  }



  template class PointTransfer<2>;
  template class PointTransfer<3>;
} // namespace greville
