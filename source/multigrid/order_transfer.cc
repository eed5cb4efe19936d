// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/multigrid/order_transfer.h>

#include <map>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Replace x by 1 / x, and 0 by 0.
    void
    invert(VectorType &x)
    {
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        {
          double &entry = x.local_element(i);
          entry         = entry != 0. ? 1. / entry : 0.;
        }
    }



    template <int dim>
    std::map<std::string, MakeInverseMass<dim>> &
    inverse_masses()
    {
      static std::map<std::string, MakeInverseMass<dim>> list;
      return list;
    }



    /// Return the names of the list, each after a '|'.
    template <int dim>
    std::string
    names_of_inverses()
    {
      std::string names;
      for (const auto &entry : inverse_masses<dim>())
        names += "|" + entry.first;
      return names;
    }
  } // namespace



  template <int dim>
  void
  add_inverse_mass(const std::string &name, const MakeInverseMass<dim> &make)
  {
    inverse_masses<dim>()[name] = make;
  }



  template <int dim>
  std::string
  OrderTransfer<dim>::prolongations()
  {
    return "lumped-l2" + names_of_inverses<dim>() + "|ic0-l2";
  }



  template <int dim>
  std::string
  OrderTransfer<dim>::restrictions()
  {
    return "lumped-l2" + names_of_inverses<dim>() + "|transpose";
  }



  template <int dim>
  typename OrderTransfer<dim>::Kind
  OrderTransfer<dim>::kind_of(const std::string &name)
  {
    return inverse_masses<dim>().count(name) > 0 ? Kind::inverse
           : name == "ic0-l2"                    ? Kind::ic0
           : name == "transpose"                 ? Kind::transpose
                                                 : Kind::lumped;
  }



  template <int dim>
  OrderTransfer<dim>::OrderTransfer(
    const std::vector<const LevelOperator<dim> *> &levels,
    const std::string                             &p,
    const std::string                             &r,
    const TransferWeight                           weight)
    : steps(levels.size() - 1)
    , prolongation(kind_of(p))
    , restriction(kind_of(r))
    , inverses(levels.size())
  {
    const bool is_unit = weight == TransferWeight::unit;
    for (unsigned int l = 1; l < levels.size(); ++l)
      {
        const LevelOperator<dim>  &fine    = *levels[l];
        const LevelOperator<dim>  &coarse  = *levels[l - 1];
        const DensityWeights<dim> *density = fine.transfer_weights();
        Step                      &step    = steps[l - 1];
        AssertThrow(fine.n_components() == coarse.n_components(),
                    ExcDimensionMismatch(fine.n_components(),
                                         coarse.n_components()));
        step.fine_level   = &fine;
        step.coarse_level = &coarse;

        if (is_unit || !density)
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
        // With unit weights, the sums do not depend on which functions are
        // inactive.
        for (const unsigned int i : fine.inactive())
          step.inverse_row_sums.local_element(i) = 0.;
        for (const unsigned int i : coarse.inactive())
          step.inverse_column_sums.local_element(i) = 0.;
        invert(step.inverse_row_sums);
        invert(step.inverse_column_sums);
      }

    const auto make_inverse = [&](const std::string &name,
                                  const unsigned int l) {
      return inverse_masses<dim>().at(
        name)(*levels[l], is_unit || !levels[l]->transfer_weights());
    };
    for (unsigned int l = 0; l < levels.size(); ++l)
      if (prolongation == Kind::inverse && l > 0)
        inverses[l] = make_inverse(p, l);
      else if (restriction == Kind::inverse && l + 1 < levels.size())
        inverses[l] = make_inverse(r, l);
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
    if (prolongation == Kind::inverse)
      inverses[to_level]->vmult(dst, dst);
    else if (prolongation == Kind::lumped)
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
    if (restriction == Kind::transpose)
      {
        if (prolongation == Kind::inverse)
          inverses[from_level]->vmult(step.fine, step.fine);
        else if (prolongation == Kind::lumped)
          step.fine.scale(step.inverse_row_sums);
        else
          step.fine_level->distribute(step.fine, component);
        step.cross.Tvmult(dst, step.fine);
        step.coarse_level->condense(dst, component);
        return;
      }
    step.fine_level->distribute(step.fine, component);
    step.cross.Tvmult(dst, step.fine);
    if (restriction == Kind::inverse)
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
    if (prolongation == Kind::ic0)
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
    if (prolongation == Kind::ic0 && restriction == Kind::transpose)
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



  GREVILLE_INSTANTIATE_CLASS(OrderTransfer);
  GREVILLE_INSTANTIATE(add_inverse_mass);
} // namespace greville
