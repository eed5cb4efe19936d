#ifndef greville_mass_mass_level_h
#define greville_mass_mass_level_h

#include <greville/mass/mass_matrix.h>
#include <greville/mass/mass_operator.h>

namespace greville
{
  /**
   * The mass matrix of one order of the hierarchy, discretized anew from the
   * density: matrix-free, and assembled where somebody needs the entries.
   */
  template <int dim>
  class MassLevel
  {
  public:
    /**
     * Collective. Evaluates @p density at p + 1 Gauss points per direction; no
     * operator is made yet. The space is kept by reference.
     */
    MassLevel(const SplineSpace<dim>      &space,
              const dealii::Function<dim> &density);

    /**
     * As above with @p weights, which the caller fills before assemble().
     */
    MassLevel(const SplineSpace<dim> &space, DensityWeights<dim> weights);

    DensityWeights<dim> &
    weights()
    {
      return density_weights;
    }

    /**
     * The coefficients that are held at zero from the next assemble() on.
     */
    void
    constrain(Constraints held)
    {
      constraints = std::move(held);
      lumped.clear();
    }

    /**
     * Collective. Extended B-splines from the next assemble() on, besides
     * coefficients that are @p held. The extension is not needed afterwards.
     */
    void
    constrain(const Constraints &held, const Extension<dim> &extension);

    /**
     * Collective. Make the operators. vmult() works on the assembled matrix if
     * @p apply_matrix, which implies @p with_matrix.
     */
    void
    assemble(const bool with_matrix, const bool apply_matrix);

    /**
     * Free the operators.
     */
    void
    clear();

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    const DensityWeights<dim> &
    weights() const
    {
      return density_weights;
    }

    const MassOperator<dim> &
    mass() const
    {
      Assert(mass_operator, dealii::ExcNotInitialized());
      return *mass_operator;
    }

    const MassMatrix<dim> &
    matrix() const
    {
      Assert(mass_matrix, dealii::ExcNotInitialized());
      return *mass_matrix;
    }

    void
    vmult(VectorType &dst, const VectorType &src) const
    {
      if (apply_matrix)
        mass_matrix->vmult(dst, src);
      else
        mass_operator->vmult(dst, src);
    }

    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }

    std::size_t
    memory_consumption() const;

  private:
    const SplineSpace<dim>            *spline_space;
    DensityWeights<dim>                density_weights;
    Constraints                        constraints;
    std::vector<unsigned int>          lumped;
    std::unique_ptr<MassOperator<dim>> mass_operator;
    std::unique_ptr<MassMatrix<dim>>   mass_matrix;
    bool                               apply_matrix = false;
  };
} // namespace greville

#endif
