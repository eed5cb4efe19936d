#include <greville/multigrid/mass_level.h>

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
    apply_matrix  = apply;
    mass_operator = std::make_unique<MassOperator<dim>>(*spline_space,
                                                        density_weights,
                                                        wall_constraints);
    // The pattern of the matrix serves all weights.
    if (!(with_matrix || apply))
      mass_matrix.reset();
    else if (mass_matrix)
      mass_matrix->assemble(density_weights, wall_constraints);
    else
      mass_matrix = std::make_unique<MassMatrix<dim>>(*spline_space,
                                                      density_weights,
                                                      wall_constraints);
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
