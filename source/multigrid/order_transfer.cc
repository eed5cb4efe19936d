// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/order_transfer.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * 1 / x, and 0 for 0.
     */
    void
    invert(VectorType &x)
    {
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        {
          double &entry = x.local_element(i);
          entry         = entry != 0. ? 1. / entry : 0.;
        }
    }
  } // namespace



  template <int dim>
  OrderTransfer<dim>::OrderTransfer(
    const std::vector<const LevelOperator<dim> *> &levels,
    const std::string                             &p,
    const std::string                             &r,
    const std::string                             &weighting)
    : steps(levels.size() - 1)
    , prolongation(p)
    , restriction(r)
    , inverses(levels.size())
  {
    for (unsigned int l = 1; l < levels.size(); ++l)
      {
        const LevelOperator<dim>  &fine    = *levels[l];
        const LevelOperator<dim>  &coarse  = *levels[l - 1];
        const DensityWeights<dim> *density = fine.transfer_weights();
        Step                      &step    = steps[l - 1];
        AssertDimension(fine.n_components(), coarse.n_components());
        step.fine_level   = &fine;
        step.coarse_level = &coarse;

        if (weighting == "unit" || !density)
          step.unit_weights = std::make_unique<DensityWeights<dim>>(
            fine.space(),
            fine.space().degree() + 1,
            Functions::ConstantFunction<dim>(1.));
        step.cross =
          CrossMassOperator<dim>(fine.space(),
                                 coarse.space(),
                                 step.unit_weights ? *step.unit_weights
                                                   : *density);
        for (VectorType *v :
             {&step.fine, &step.from_fine, &step.inverse_row_sums})
          fine.space().initialize_vector(*v);
        for (VectorType *v :
             {&step.coarse, &step.from_coarse, &step.inverse_column_sums})
          coarse.space().initialize_vector(*v);
        initialize_vector(step.fine_sum, fine);
        initialize_vector(step.coarse_sum, coarse);

        step.coarse = 1.;
        step.cross.vmult(step.inverse_row_sums, step.coarse);
        step.fine = 1.;
        step.cross.Tvmult(step.inverse_column_sums, step.fine);
        // With unit weights the sums do not see the holes.
        for (const unsigned int i : fine.inactive())
          step.inverse_row_sums.local_element(i) = 0.;
        for (const unsigned int i : coarse.inactive())
          step.inverse_column_sums.local_element(i) = 0.;
        invert(step.inverse_row_sums);
        invert(step.inverse_column_sums);
      }

    for (unsigned int l = 0; l < levels.size(); ++l)
      if ((prolongation == "exact-l2" && l > 0) ||
          (restriction == "exact-l2" && l + 1 < levels.size()))
        {
          const LevelOperator<dim>      &level = *levels[l];
          const TensorProductSolver<dim> solver(level.space());
          VectorType                     diagonal(level.diagonal());
          if (weighting == "unit" || !level.transfer_weights())
            {
              level.space().initialize_vector(diagonal);
              for (unsigned int i = 0; i < solver.n_unknowns(); ++i)
                diagonal.local_element(i) = solver.diagonal(i);
            }
          inverses[l] = std::make_unique<TensorProductPreconditioner<dim>>(
            solver, diagonal, level.inactive());
        }
  }



  template <int dim>
  void
  OrderTransfer<dim>::prolongate_component(const unsigned int to_level,
                                           VectorType        &dst,
                                           const VectorType  &src,
                                           const unsigned int component) const
  {
    const Step &step = steps[to_level - 1];
    step.coarse      = src;
    step.coarse_level->distribute(step.coarse, component);
    step.cross.vmult(dst, step.coarse);
    if (prolongation == "exact-l2")
      inverses[to_level]->vmult(dst, dst);
    else if (prolongation == "lumped-l2")
      dst.scale(step.inverse_row_sums);
    else
      step.fine_level->condense(dst, component);
  }



  template <int dim>
  void
  OrderTransfer<dim>::restrict_component(const unsigned int from_level,
                                         VectorType        &dst,
                                         const VectorType  &src,
                                         const unsigned int component) const
  {
    const Step &step = steps[from_level - 1];
    step.fine        = src;
    if (restriction == "transpose")
      {
        if (prolongation == "exact-l2")
          inverses[from_level]->vmult(step.fine, step.fine);
        else if (prolongation == "lumped-l2")
          step.fine.scale(step.inverse_row_sums);
        else
          step.fine_level->distribute(step.fine, component);
        step.cross.Tvmult(dst, step.fine);
        step.coarse_level->condense(dst, component);
        return;
      }
    step.fine_level->distribute(step.fine, component);
    step.cross.Tvmult(dst, step.fine);
    if (restriction == "exact-l2")
      inverses[from_level - 1]->vmult(dst, dst);
    else
      dst.scale(step.inverse_column_sums);
  }



  template <int dim>
  void
  OrderTransfer<dim>::prolongate(const unsigned int to_level,
                                 VectorType        &dst,
                                 const VectorType  &src) const
  {
    const Step &step = steps[to_level - 1];
    apply_by_components(step.fine_level->n_components(),
                        dst,
                        src,
                        step.fine,
                        step.from_coarse,
                        [&](VectorType        &to,
                            const VectorType  &from,
                            const unsigned int component) {
                          prolongate_component(to_level, to, from, component);
                        });
    if (prolongation == "ic0-l2")
      step.fine_level->apply_inverse_mass(dst);
  }



  template <int dim>
  void
  OrderTransfer<dim>::restrict_and_add(const unsigned int from_level,
                                       VectorType        &dst,
                                       const VectorType  &src) const
  {
    const Step       &step = steps[from_level - 1];
    const VectorType *from = &src;
    if (prolongation == "ic0-l2" && restriction == "transpose")
      {
        step.fine_sum = src;
        step.fine_level->apply_inverse_mass(step.fine_sum);
        from = &step.fine_sum;
      }
    apply_by_components(step.fine_level->n_components(),
                        step.coarse_sum,
                        *from,
                        step.coarse,
                        step.from_fine,
                        [&](VectorType        &to,
                            const VectorType  &x,
                            const unsigned int component) {
                          restrict_component(from_level, to, x, component);
                        });
    dst += step.coarse_sum;
  }



  template class OrderTransfer<2>;
  template class OrderTransfer<3>;
} // namespace greville
