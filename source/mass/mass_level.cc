#include <greville/mass/mass_level.h>

namespace greville
{
  template <int dim>
  MassLevel<dim>::MassLevel(const SplineSpace<dim>      &space,
                            const dealii::Function<dim> &density)
    : spline_space(&space)
    , density_weights(space, space.degree() + 1, density)
  {}



  template <int dim>
  MassLevel<dim>::MassLevel(const SplineSpace<dim> &space,
                            DensityWeights<dim>     weights)
    : spline_space(&space)
    , density_weights(std::move(weights))
  {}



  template <int dim>
  void
  MassLevel<dim>::assemble(const bool with_matrix, const bool apply)
  {
    apply_matrix = apply;
    // The pattern of the matrix serves all weights.
    if (!(with_matrix || apply))
      mass_matrix.reset();
    else
      {
        if (!mass_matrix)
          {
            mass_matrix = std::make_unique<MassMatrix<dim>>();
            mass_matrix->reinit(*spline_space);
          }
        mass_matrix->assemble(density_weights, constraints, lumped);
      }
    mass_operator = std::make_unique<MassOperator<dim>>();
    if (mass_matrix && mass_matrix->is_extended())
      {
        // Its diagonal is cheap where the matrix is there.
        const VectorType diagonal = mass_matrix->active_diagonal();
        mass_operator->reinit(
          *spline_space, density_weights, constraints, lumped, &diagonal);
      }
    else
      mass_operator->reinit(*spline_space,
                            density_weights,
                            constraints,
                            lumped);
  }



  template <int dim>
  void
  MassLevel<dim>::constrain(const Constraints    &held,
                            const Extension<dim> &extension)
  {
    constraints = merge_constraints(extension, held);
    lumped.clear();
    for (unsigned int i = 0; i < spline_space->n_locally_owned_dofs(); ++i)
      if (extension[i] == Extension<dim>::lumped)
        lumped.push_back(i);
  }



  template <int dim>
  void
  MassLevel<dim>::clear()
  {
    mass_operator.reset();
    mass_matrix.reset();
    apply_matrix = false;
  }



  template <int dim>
  std::size_t
  MassLevel<dim>::memory_consumption() const
  {
    return (mass_operator ? mass_operator->memory_consumption() : 0) +
           (mass_matrix ? mass_matrix->memory_consumption() : 0);
  }



  template class MassLevel<2>;
  template class MassLevel<3>;
} // namespace greville
