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
  OrderTransfer<dim>::OrderTransfer(const std::vector<MassLevel<dim> *> &levels,
                                    const std::string                   &p,
                                    const std::string                   &r,
                                    const std::string &weighting)
    : steps(levels.size() - 1)
    , inverses(levels.size())
    , prolongation(p)
    , restriction(r)
  {
    for (unsigned int l = 1; l < levels.size(); ++l)
      {
        const MassLevel<dim> &fine   = *levels[l];
        const MassLevel<dim> &coarse = *levels[l - 1];
        Step                 &step   = steps[l - 1];
        step.fine_mass               = &fine.mass();
        step.coarse_mass             = &coarse.mass();

        if (weighting == "unit")
          step.unit_weights = std::make_unique<DensityWeights<dim>>(
            fine.space(),
            fine.space().degree() + 1,
            Functions::ConstantFunction<dim>(1.));
        step.cross =
          CrossMassOperator<dim>(fine.space(),
                                 coarse.space(),
                                 step.unit_weights ? *step.unit_weights
                                                   : fine.weights());
        for (VectorType *v : {&step.fine, &step.inverse_row_sums})
          fine.space().initialize_vector(*v);
        for (VectorType *v : {&step.coarse, &step.inverse_column_sums})
          coarse.space().initialize_vector(*v);

        step.coarse = 1.;
        step.cross.vmult(step.inverse_row_sums, step.coarse);
        step.fine = 1.;
        step.cross.Tvmult(step.inverse_column_sums, step.fine);
        // With unit weights the sums do not see the holes.
        for (const unsigned int i : fine.mass().inactive())
          step.inverse_row_sums.local_element(i) = 0.;
        for (const unsigned int i : coarse.mass().inactive())
          step.inverse_column_sums.local_element(i) = 0.;
        invert(step.inverse_row_sums);
        invert(step.inverse_column_sums);
      }

    for (unsigned int l = 0; l < levels.size(); ++l)
      if ((prolongation == "exact-l2" && l > 0) ||
          (restriction == "exact-l2" && l + 1 < levels.size()))
        {
          inverses[l]           = std::make_unique<Inverse>();
          inverses[l]->solver   = TensorProductSolver<dim>(levels[l]->space());
          inverses[l]->inactive = levels[l]->mass().inactive();
          if (weighting == "density")
            inverses[l]->weighted =
              std::make_unique<TensorProductPreconditioner<dim>>(
                inverses[l]->solver, levels[l]->mass());
        }
  }



  template <int dim>
  void
  OrderTransfer<dim>::Inverse::apply(VectorType &x) const
  {
    // Zero before and after, which keeps the transpose the transpose.
    const auto clear_inactive = [&]() {
      for (const unsigned int i : inactive)
        x.local_element(i) = 0.;
    };
    clear_inactive();
    if (weighted)
      weighted->vmult(x, x);
    else
      solver.solve(x);
    clear_inactive();
  }



  template <int dim>
  void
  OrderTransfer<dim>::prolongate(const unsigned int to_level,
                                 VectorType        &dst,
                                 const VectorType  &src) const
  {
    const Step &step = steps[to_level - 1];
    if (step.coarse_mass->expansion().has_extended())
      {
        step.coarse = src;
        step.coarse_mass->distribute(step.coarse);
        step.cross.vmult(dst, step.coarse);
      }
    else
      step.cross.vmult(dst, src);
    if (prolongation == "exact-l2")
      inverses[to_level]->apply(dst);
    else
      dst.scale(step.inverse_row_sums);
  }



  template <int dim>
  void
  OrderTransfer<dim>::prolongate_and_add(const unsigned int to_level,
                                         VectorType        &dst,
                                         const VectorType  &src) const
  {
    VectorType &correction = steps[to_level - 1].fine;
    prolongate(to_level, correction, src);
    dst += correction;
  }



  template <int dim>
  void
  OrderTransfer<dim>::restrict_and_add(const unsigned int from_level,
                                       VectorType        &dst,
                                       const VectorType  &src) const
  {
    const Step &step = steps[from_level - 1];
    if (restriction == "transpose")
      {
        step.fine = src;
        if (prolongation == "exact-l2")
          inverses[from_level]->apply(step.fine);
        else
          step.fine.scale(step.inverse_row_sums);
        step.cross.Tvmult(step.coarse, step.fine);
        if (step.coarse_mass->expansion().has_extended())
          step.coarse_mass->condense(step.coarse);
      }
    else
      {
        if (step.fine_mass->expansion().has_extended())
          {
            step.fine = src;
            step.fine_mass->distribute(step.fine);
            step.cross.Tvmult(step.coarse, step.fine);
          }
        else
          step.cross.Tvmult(step.coarse, src);
        if (restriction == "exact-l2")
          inverses[from_level - 1]->apply(step.coarse);
        else
          step.coarse.scale(step.inverse_column_sums);
      }
    dst += step.coarse;
  }



  template <int dim>
  std::size_t
  OrderTransfer<dim>::memory_consumption() const
  {
    std::size_t n = 0;
    for (const Step &step : steps)
      n += 2 * (step.inverse_row_sums.memory_consumption() +
                step.inverse_column_sums.memory_consumption());
    for (const auto &inverse : inverses)
      if (inverse)
        n += inverse->solver.memory_consumption();
    return n;
  }



  template class OrderTransfer<2>;
  template class OrderTransfer<3>;
} // namespace greville
