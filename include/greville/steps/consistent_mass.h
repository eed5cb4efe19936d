// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/multigrid/extended_mass_solver.h>
#include <greville/multigrid/extended_multigrid.h>
#include <greville/steps/grid_mass.h>

namespace greville
{
  /// The consistent mass matrix M_ij = sum_p m_p N_i(x_p) N_j(x_p) of the
  /// points on extended B-splines, see Extension and ExtendedMass. All
  /// components of the fields are solved together by an ExtendedMassSolver.
  /// Cells with points of surfaces, but without points of their bodies, count
  /// as outside of the body. Functions are extended to them, so that no part of
  /// a load is lost.
  template <int dim>
  class ConsistentMass : public GridMass<dim>
  {
  public:
    /// Collective. Orders, parameters and walls are kept by reference.
    ConsistentMass(const OrderHierarchy<dim>  &orders,
                   const SimulationParameters &parameters,
                   const Walls<dim>           &walls);

    std::string
    solver() const override
    {
      return parameters.solver.method;
    }

    bool
    is_exact() const override
    {
      return true;
    }

    bool
    is_diagonal() const override
    {
      return false;
    }

    void
    update(const VectorType                               &lumped,
           const std::vector<const MaterialPoints<dim> *> &bodies,
           const std::vector<const MaterialPoints<dim> *> &surfaces,
           const PointTransfer<dim>                       &transfer) override;

    void
    solve(const std::vector<VectorField<dim> *>       &x,
          const std::vector<const VectorField<dim> *> &b,
          const std::vector<double>                   &shares = {}) override;

    void
    constrained_rows(VectorField<dim>       &rows,
                     const VectorField<dim> &x,
                     const VectorField<dim> &b,
                     const unsigned int) const override
    {
      extended_mass.constrained_rows(rows, x, b);
    }

    void
    extend(VectorField<dim> &field) const override
    {
      extended_mass.unknowns().extend(field, this->lumped_mass);
    }

    /// Domains and surfaces also use extended functions whose support contains
    /// no points of a body.
    bool
    has_points(const unsigned int function) const override
    {
      return GridMass<dim>::has_points(function) ||
             spline_extension[function] == Extension<dim>::extended;
    }

    void
    set_windows(CellWindows<dim> *given) override
    {
      windows = given;
    }

    bool
    has_windows() const override
    {
      return windows;
    }

    bool
    is_stable(const unsigned int function) const override
    {
      return spline_extension[function] == Extension<dim>::stable;
    }

    typename Extension<dim>::Counts
    counts() const override
    {
      return spline_extension.counts();
    }

    std::uint64_t
    n_fragments() const override
    {
      return filling.n_fragments();
    }

    double
    fragment_fraction() const override;

    std::vector<double> *
    filled_parts() override
    {
      return &filled_part;
    }

    void
    forget() override
    {
      mass_solver->forget();
    }

    unsigned int
    n_factorizations() const override
    {
      return mass_solver->n_factorizations();
    }

  private:
    /// Make the preconditioner of Solver/Method; empty for "cg-ic0".
    ColumnPreconditioner
    make_preconditioner();

    void
    update_constrained() override
    {
      if (!has_matrix)
        return;
      extended_mass.unknowns().constrain(this->constrained);
      mass_solver->forget();
    }

    void
    multiply_constrained_rows(VectorField<dim>       &rows,
                              const VectorField<dim> &x,
                              const std::array<bool, dim> &) const override
    {
      extended_mass.multiply_constrained_rows(rows, x);
    }

    /// Collective. Assemble the matrix, and update its solver.
    void
    assemble();

    const SimulationParameters              &parameters;
    SolverParameters                         solver_parameters;
    const Walls<dim>                        &walls;
    std::vector<double>                      filled_part; // of owned cells
    CellFilling<dim>                         filling;
    Extension<dim>                           spline_extension;
    CellWindows<dim>                        *windows = nullptr;
    ExtendedMass<dim>                        extended_mass;
    VectorType                               diagonal;  // for "cg-jacobi"
    std::unique_ptr<ExtendedMultigrid<dim>>  multigrid; // "cg-p-multigrid"
    std::unique_ptr<ExtendedMassSolver<dim>> mass_solver;
    // Implicit steps use another mass, so this matrix is assembled only when a
    // solve needs it. The bodies of the last update() belong to the current
    // state.
    bool has_matrix = false, is_assembled = false;
    bool has_new_unknowns                                      = false;
    const std::vector<const MaterialPoints<dim> *> *bodies     = nullptr;
    const PointTransfer<dim>                       *transfer   = nullptr;
    double                                          total_mass = 0.;
  };
} // namespace greville
