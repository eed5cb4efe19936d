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
    , of_bodies(orders.finest(), projection, windows)
    , windows(windows)
  {
    filling.reinit(orders.finest(), {}, windows != nullptr);
    for (unsigned int l = 0; l < orders.n_levels(); ++l)
      {
        transfers[l].reinit(orders[l]);
        tables[l].reinit(orders[l]);
        levels.push_back(std::make_unique<TangentLevel<dim>>(
          orders[l],
          constrained ? constrained(orders[l]) : std::vector<unsigned char>(),
          orders.n_levels() > 1));
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
        if (levels.size() > 1)
          transfers[l].mass_weights(points, levels[l]->weights());
      }
    if (windows && changed)
      windows->update(finest().extension());
    total_mass = 0.;
    for (const MaterialPoints<dim> *of_body : points)
      of_body->for_each(
        [&](const ConstPointRef<dim> p) { total_mass += p.mass(); });
    total_mass  = Utilities::MPI::sum(total_mass, space().communicator());
    mass_is_new = true;
    finest().extended().unknowns().initialize_vector(unknowns, dim);
  }



  template <int dim>
  std::string
  TangentSystem<dim>::evaluate(const std::vector<TrialBody<dim>> &bodies,
                               const VectorField<dim>            &u,
                               const double                       dt,
                               const StepStress                   stress,
                               const bool        with_stiffness,
                               VectorField<dim> &force)
  {
    if (with_stiffness)
      {
        of_surfaces.clear_stiffness();
        mass_of_entries = 0.;
      }
    return of_bodies.evaluate(bodies,
                              u,
                              dt,
                              stress,
                              with_stiffness,
                              space().degree() == 1 ? &entries : nullptr,
                              force);
  }



  template <int dim>
  bool
  TangentSystem<dim>::needs_levels(const double mass_factor) const
  {
    if (levels_fail)
      return false;
    if (parameters.use_of_levels == TangentParameters::UseOfLevels::always)
      return true;
    if (parameters.use_of_levels == TangentParameters::UseOfLevels::never ||
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
        std::min(graded, space().cell_size(d) / space().largest_cell_size(d));
    sums[1] = graded * graded * mass_factor * mass;
    Utilities::MPI::max(sums, space().communicator(), sums);
    return sums[0] > (1. + stiff) * sums[1];
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
        of_bodies.tangents().template for_each_cell<float>(
          tables[l],
          [&](const unsigned int cell,
              const float       *values,
              const unsigned int stride) {
            level.stiffness().add_cell(cell, values, stride);
          });
      }
    of_surfaces.assemble(level, l);
    level.finish_tangent(shares ? 0. : mass_factor);
  }



  template <int dim>
  void
  TangentSystem<dim>::set_up()
  {
    reuse.end();
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
    reuse.begin(mass_factor);
  }



  template <int dim>
  void
  TangentSystem<dim>::set_mass_factor(const double new_mass_factor)
  {
    mass_factor = new_mass_factor;
    if (!has_entries() || mass_factor == mass_of_entries)
      return;
    entries.add(mass_factor - mass_of_entries, finest().extended().matrix());
    mass_of_entries = mass_factor;
  }



  template <int dim>
  void
  TangentSystem<dim>::set_operator(const double new_mass_factor,
                                   const bool   is_symmetric)
  {
    symmetric = is_symmetric;
    set_mass_factor(new_mass_factor);
    if (!reuse.is_possible(mass_factor, parameters.reuse))
      set_up();
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
        of_bodies.tangents().add_product(y, x, mass);
      }
    of_surfaces.add_product(y, x, mass);
  }



  template <int dim>
  typename PMultigrid<dim>::Levels
  TangentSystem<dim>::make_levels(const double new_mass_factor)
  {
    set_mass_factor(new_mass_factor);
    forget();
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
    mass.unknowns().restrict_fields(rows, {&force}, dim);
    if (field)
      {
        mass.multiply_field(unknowns, *field);
        rows += unknowns;
      }
  }



  template <int dim>
  void
  TangentSystem<dim>::extend(VectorField<dim> &field, const VectorType &x) const
  {
    unknowns.copy_locally_owned_data_from(x);
    finest().extended().unknowns().write_fields({&field}, unknowns, dim);
  }



  template <int dim>
  void
  TangentSystem<dim>::read(VectorType &x, const VectorField<dim> &field) const
  {
    finest().extended().unknowns().read_fields(x, {&field}, dim);
  }



  template <int dim>
  void
  TangentSystem<dim>::forget()
  {
    multigrid.reset();
    reuse.end();
    levels_fail = false;
    if (mass_solver)
      mass_solver->forget();
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
    finest().extended().unknowns().initialize_vector(vector, dim);
  }



  GREVILLE_INSTANTIATE_CLASS(TangentSystem);
} // namespace greville
