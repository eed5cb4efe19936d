// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/stiffness/tangent_system.h>

#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  TangentSystem<dim>::TangentSystem(const OrderHierarchy<dim>  &orders,
                                    const ConstrainedFunctions &constrained,
                                    const TangentParameters    &parameters,
                                    const double           filling_threshold,
                                    const bool             lump,
                                    VolumeProjection<dim> *projection,
                                    CellWindows<dim>      *windows)
    : parameters(parameters)
    , filling_threshold(filling_threshold)
    , lump(lump)
    , orders(orders)
    , transfers(orders.n_levels())
    , tables(orders.n_levels())
    , projection(projection)
    , windows(windows)
  {
    filling.reinit(orders.finest(), {}, windows != nullptr);
    trial.reinit(orders.finest(), windows);
    sums.reinit(orders.finest(), windows);
    tangents.reinit(orders.finest());
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        transfers[l].reinit(orders[l]);
        tables[l].reinit(orders[l]);
        levels.push_back(std::make_unique<TangentLevel<dim>>(
          orders[l],
          constrained ? constrained(orders[l]) : std::vector<unsigned char>()));
      }
    levels.back()->set_product(
      [this](double *y, const double *x) { multiply_at_places(y, x); });
    if (space().degree() == 1)
      entries.reinit(levels.back()->mass());
    of_surfaces.reinit(orders);
  }



  template <int dim>
  void
  TangentSystem<dim>::set_points(const std::vector<TrialBody<dim>> &bodies,
                                 const std::vector<Surface<dim>>   &surfaces,
                                 const bool                         is_static)
  {
    std::vector<const MaterialPoints<dim> *> points;
    for (const TrialBody<dim> &body : bodies)
      points.push_back(body.points);
    transfers.back().filling(points, filled_part);
    // In static steps, the springs of a surface determine the functions in its
    // cells, as points of a body would.
    for (const Surface<dim> &surface : surfaces)
      for (const unsigned int cell : surface.points.cells())
        if (filled_part[cell] <= 0.)
          filled_part[cell] =
            is_static && surface.stiffness > 0. && surface.contact.empty()
              ? std::numeric_limits<double>::min()
              : -1.;
    const bool changed =
      filling.update(filled_part, filling_threshold, is_static) || is_first;
    is_first = false;
    if (changed)
      forget();
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        levels[l]->begin(filling, changed);
        transfers[l].add_mass_matrix(points, levels[l]->mass());
        levels[l]->finish_mass(lump);
        transfers[l].mass_weights(points, levels[l]->weights());
      }
    if (windows && changed)
      windows->update(finest().extension());
    finest().extended().unknowns().initialize_vector(unknowns, dim);
  }



  namespace
  {
    /// Return the sums of the compression and shear moduli, A_iiii and A_ijij,
    /// times the volumes.
    template <int dim>
    std::array<double, 2>
    sum_moduli(const std::vector<TrialGroup<dim>> &groups)
    {
      Lanes compression = 0., shear = 0.;
      for (const TrialGroup<dim> &group : groups)
        {
          compression += group.compression;
          shear += group.shear;
        }
      return {{reduce(compression), reduce(shear)}};
    }



    /// Append the derivative of V P of a group by the logarithm of J hat, for
    /// an isotropic expansion of 1 / dim in each direction (1 / 3 in
    /// axisymmetry). The dependence of f on J hat is excluded. A share of the
    /// derivative remains in the derivative by f, a full matrix of @p n_used
    /// pairs.
    template <int dim>
    void
    take_volume_stiffness(const int           n_used,
                          TrialGroup<dim>    &group,
                          ProjectedBody<dim> &projected)
    {
      const double n    = n_used == TrialGroup<dim>::n_pairs ? 3 : 2;
      const double rest = 1. - projected.share;
      typename TrialGroup<dim>::Pairs derivative;
      derivative.fill(0.);
      for (int r = 0; r < n_used; ++r)
        {
          double *row = group.tangent + r * n_used * n_lanes;
          Lanes   sum = (1. - n) * group.stress[r];
          for (int s = 0; s < n_used; ++s)
            sum += load<Lanes>(row + s * n_lanes) * group.expansion[s];
          sum *= 1. / n;
          for (int s = 0; s < n_used; ++s)
            store(Lanes(load<Lanes>(row + s * n_lanes) -
                        rest * sum * group.dual[s]),
                  row + s * n_lanes);
          if (r < dim * dim)
            group.compression -= rest / dim * sum * group.expansion[r];
          derivative[r] = sum;
        }
      projected.derivatives.push_back(derivative);
    }



    /// Return the fraction of the volumetric stiffness that is not much larger
    /// than the shear stiffness.
    double
    share_of_volume_stiffness(const Moduli &moduli)
    {
      constexpr double largest_ratio = 2.;
      return moduli.shear > 0.
               ? std::min(1., largest_ratio * moduli.shear / moduli.bulk)
               : 1.;
    }

  } // namespace



  template <int dim>
  std::string
  TangentSystem<dim>::evaluate(const std::vector<TrialBody<dim>> &bodies,
                               const VectorField<dim>            &u,
                               const double                       dt,
                               const StepStress                   stress,
                               const bool        with_stiffness,
                               VectorField<dim> &force)
  {
    std::string problem;
    // Sums over cells of the compression and shear moduli of K, see
    // sum_moduli(), and of the square of each cell's compression modulus before
    // take_volume_stiffness().
    std::vector<double> sums_of_moduli(3);
    sums.clear();
    if (with_stiffness)
      {
        bool are_symmetric = stress == StepStress::end && !projection;
        for (const TrialBody<dim> &body : bodies)
          are_symmetric =
            are_symmetric && body.material->has_symmetric_tangent();
        tangents.clear(are_symmetric,
                       !bodies.empty() &&
                         bodies[0].points->layout().is_axisymmetric());
        std::size_t n_groups = 0;
        for (const TrialBody<dim> &body : bodies)
          for (const unsigned int cell : body.points->cells())
            n_groups +=
              (body.points->n_points(cell) + MaterialPoints<dim>::width - 1) /
              MaterialPoints<dim>::width;
        tangents.reserve(n_groups);
        of_surfaces.clear_stiffness();
        if (projection)
          displacement = u;
        projected_bodies.clear();
        domains.clear();
      }
    for (const TrialBody<dim> &body : bodies)
      {
        PointReport        report;
        ProjectedBody<dim> projected{body.points,
                                     share_of_volume_stiffness(
                                       body.material->moduli()),
                                     {},
                                     {}};
        if (projection)
          projected.J_hat = projection->project(*body.points, u, 1.);
        // A law may throw on one process; all processes then continue with the
        // next body.
        try
          {
            report =
              trial.evaluate(*body.points,
                             *body.material,
                             u,
                             dt,
                             body.time,
                             body.strength_reduction,
                             stress,
                             with_stiffness ? &tangents : nullptr,
                             projection ? projected.J_hat.data() : nullptr,
                             [&](const unsigned int cell, auto &groups) {
                               sums.add_force(cell, groups);
                               if (!with_stiffness)
                                 return;
                               auto of_cell = sum_moduli<dim>(groups);
                               sums_of_moduli[2] += of_cell[0] * of_cell[0];
                               if (projection)
                                 {
                                   for (TrialGroup<dim> &group : groups)
                                     take_volume_stiffness(tangents.n_pairs(),
                                                           group,
                                                           projected);
                                   of_cell = sum_moduli<dim>(groups);
                                 }
                               sums_of_moduli[0] += of_cell[0];
                               sums_of_moduli[1] += of_cell[1];
                               if (windows && windows->reaches(cell))
                                 domains.emplace_back(cell, groups);
                             });
          }
        catch (const std::exception &error)
          {
            if (problem.empty())
              problem = "the law of the body '" + body.name +
                        "' has failed: " + message_of(error);
          }
        if (report.bad_point >= 0 && problem.empty())
          problem = "point " + std::to_string(report.bad_point) +
                    " of the body '" + body.name + "': " + report.bad_reason;
        if (with_stiffness && projection)
          projected_bodies.push_back(std::move(projected));
      }
    sums.take_force(force);
    if (with_stiffness)
      {
        Utilities::MPI::sum(sums_of_moduli,
                            space().communicator(),
                            sums_of_moduli);
        moduli = {{sums_of_moduli[0], sums_of_moduli[1]}};
        force_of_strain =
          std::sqrt(sums_of_moduli[2]) / space().smallest_cell_size();
      }
    return problem;
  }



  template <int dim>
  bool
  TangentSystem<dim>::needs_levels(const double mass_factor) const
  {
    if (levels_fail)
      return false;
    if (parameters.always_takes_levels())
      return true;
    if (parameters.never_takes_levels() ||
        !parameters.multigrid.has_coarse_levels())
      return false;
    unsigned int n_long = 0;
    for (unsigned int d = 0; d < dim; ++d)
      n_long += space().cells_per_direction()[d] > 1;
    if (n_long <= 1)
      return false;
    if (mass_factor == 0.)
      return true;
    // Compare the largest entries of K and c M in the last finish_tangent().
    constexpr double    stiff = 30.;
    std::vector<double> sums{finest().largest_diagonal(), 0.};
    double              mass = 0.;
    for (const unsigned int place :
         finest().extended().unknowns().unknown_places())
      if (place != numbers::invalid_unsigned_int)
        mass = std::max(mass, finest().extended().matrix().diagonal(place));
    // The entries belong to the largest cells, of size H. In the smallest
    // cells, of size h, K / M is (H / h)^2 times as large.
    double graded = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      graded =
        std::min(graded,
                 space().cell_size(d) / space().lattice().largest_cell_size(d));
    sums[1] = graded * graded * mass_factor * mass;
    Utilities::MPI::max(sums, space().communicator(), sums);
    return sums[0] > (1. + stiff) * sums[1];
  }



  template <int dim>
  bool
  TangentSystem<dim>::is_reusable(const double mass_factor) const
  {
    constexpr double largest_change = 2.;
    return is_set_up && parameters.reuse > 0 &&
           excess_iterations <= parameters.reuse &&
           mass_factor <= largest_change * mass_factor_of_set_up &&
           mass_factor_of_set_up <= largest_change * mass_factor;
  }



  template <int dim>
  void
  TangentSystem<dim>::assemble(const unsigned int l)
  {
    TangentLevel<dim> &level  = *levels[l];
    const bool         shares = l + 1 == levels.size() && has_entries();
    if (shares)
      level.stiffness().copy(entries);
    else
      {
        level.begin_tangent();
        tangents.template for_each_cell<float>(tables[l],
                                               [&](const unsigned int cell,
                                                   const float       *values,
                                                   const unsigned int stride) {
                                                 level.stiffness().add_cell(
                                                   cell, values, stride);
                                               });
      }
    of_surfaces.assemble(level, l);
    level.finish_tangent(shares ? 0. : mass_factor);
  }



  template <int dim>
  void
  TangentSystem<dim>::set_up()
  {
    static std::uint64_t last_number = 0;

    is_set_up = false;
    assemble(levels.size() - 1);
    has_levels = needs_levels(mass_factor);
    // Tangents of failing bodies are indefinite, and some cannot be factorized.
    try
      {
        for (unsigned int l = 0; has_levels && l + 1 < levels.size(); ++l)
          assemble(l);
        if (!is_coupled)
          make_multigrid();
      }
    catch (const ErrorOnAll &)
      {
        if (!has_levels)
          throw;
        levels_fail = true;
        has_levels  = false;
        make_multigrid();
      }
    is_set_up             = true;
    number_of_set_up      = ++last_number;
    mass_factor_of_set_up = mass_factor;
    excess_iterations     = 0.;
    is_fresh              = true;
    ++set_ups;
  }



  template <int dim>
  void
  TangentSystem<dim>::assemble_entries()
  {
    if (!has_entries())
      return;
    entries.clear();
    tangents.template for_each_cell<double>(tables.back(),
                                            [&](const unsigned int cell,
                                                const double      *values,
                                                const unsigned int stride) {
                                              entries.add_cell(cell,
                                                               values,
                                                               stride);
                                            });
    if (mass_factor != 0.)
      entries.add(mass_factor, finest().extended().matrix());
  }



  template <int dim>
  void
  TangentSystem<dim>::set_operator(const double new_mass_factor,
                                   const bool   is_symmetric)
  {
    symmetric   = is_symmetric;
    mass_factor = new_mass_factor;
    assemble_entries();
    if (!is_reusable(mass_factor))
      set_up();
    else if (wants_entries)
      for (unsigned int l = has_levels ? 0 : levels.size() - 1;
           l < levels.size();
           ++l)
        assemble(l);
    wants_entries = false;
  }



  template <int dim>
  void
  TangentSystem<dim>::multiply_at_places(double *y, const double *x)
  {
    const StencilMatrix<dim> &mass = finest().extended().matrix();
    if (has_entries())
      entries.vmult(y, x);
    else
      {
        if (mass_factor != 0.)
          mass.vmult(y, x, dim);
        mass.for_each_segment(
          [&](const unsigned int begin, const unsigned int end, const auto &) {
            for (std::size_t k = std::size_t(begin) * dim;
                 k < std::size_t(end) * dim;
                 ++k)
              y[k] = mass_factor != 0. ? mass_factor * y[k] : 0.;
          });
        tangents.add_product(y, x, mass);
      }
    of_surfaces.add_product(y, x, mass);
  }



  template <int dim>
  typename PMultigrid<dim>::Levels
  TangentSystem<dim>::make_levels(const double new_mass_factor)
  {
    mass_factor = new_mass_factor;
    forget();
    assemble_entries();
    typename PMultigrid<dim>::Levels result;
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        assemble(l);
        result.push_back(levels[l].get());
      }
    return result;
  }



  template <int dim>
  void TangentSystem<dim>::restrict(VectorType             &rows,
                                    const VectorField<dim> &force,
                                    const VectorField<dim> *field) const
  {
    const ExtendedMass<dim> &mass = finest().extended();
    mass.unknowns().restrict_fields(unknowns, {&force}, dim);
    if (field)
      {
        VectorField<dim> products;
        for (unsigned int c = 0; c < dim; ++c)
          products[c].reinit(force[c], true);
        mass.multiply_field(products, *field);
        const auto &functions = mass.unknowns().unknown_functions();
        for (unsigned int u = 0; u < functions.size(); ++u)
          for (unsigned int c = 0; c < dim; ++c)
            unknowns.local_element(u * dim + c) +=
              products[c].local_element(functions[u]);
        mass.unknowns().zero_constrained_unknowns(unknowns, dim);
      }
    finest().extended().unknowns().write(rows, unknowns, dim);
  }



  template <int dim>
  void
  TangentSystem<dim>::extend(VectorField<dim> &field, const VectorType &x) const
  {
    finest().extended().unknowns().read(unknowns, x, dim);
    finest().extended().unknowns().write_fields({&field}, unknowns, dim);
  }



  template <int dim>
  void
  TangentSystem<dim>::read(VectorType &x, const VectorField<dim> &field) const
  {
    finest().extended().unknowns().read_fields(unknowns, {&field}, dim);
    finest().extended().unknowns().write(x, unknowns, dim);
  }



  template <int dim>
  double
  TangentSystem<dim>::force_scale() const
  {
    return std::sqrt(
      Utilities::MPI::sum(sums.square_of_forces(), space().communicator()));
  }



  template <int dim>
  void
  TangentSystem<dim>::forget()
  {
    multigrid.reset();
    is_set_up   = false;
    levels_fail = false;
  }



  template <int dim>
  void
  TangentSystem<dim>::set_coupled(const bool is)
  {
    if (is != is_coupled)
      forget();
    is_coupled = is;
  }



  template <int dim>
  void
  TangentSystem<dim>::initialize(VectorType &vector) const
  {
    initialize_vector<dim>(vector, finest());
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSystem);
} // namespace greville
