#ifndef greville_mass_expansion_h
#define greville_mass_expansion_h

#include <deal.II/lac/affine_constraints.h>

#include <greville/mass/density_weights.h>
#include <greville/spline/extension.h>

namespace greville
{
  using Constraints = dealii::AffineConstraints<double>;

  /**
   * The lines of an extension beside the coefficients that @p held holds at
   * zero: held ones win. @p held needs the lines of owned coefficients only.
   * Collective.
   */
  template <int dim>
  Constraints
  merge_constraints(const Extension<dim> &extension, const Constraints &held);



  /**
   * The matrix E that gives all coefficients of a spline from the free ones:
   * the unit matrix, but zero in the rows of coefficients that are held (their
   * constraints have no entries), and with the entries of the constraints in
   * the rows of extended ones. Vectors have all coefficients; free vectors have
   * zeros, or any number that is not looked at, where coefficients are
   * constrained.
   */
  template <int dim>
  class Expansion
  {
  public:
    Expansion() = default;

    /**
     * Collective. The constraints are closed and have the lines of all
     * functions of owned cells, or without entries of the owned ones at least.
     * The space is kept by reference.
     */
    Expansion(const SplineSpace<dim> &space, const Constraints &constraints);

    /**
     * Whether there are extended coefficients on any process. Without them
     * E is a diagonal matrix.
     */
    bool
    has_extended() const
    {
      return is_extended;
    }

    /**
     * x <- E x. Collective.
     */
    void
    distribute(VectorType &x) const;

    /**
     * x <- E^T x. Collective.
     */
    void
    condense(VectorType &x) const;

    /**
     * Collective. Make the @p diagonal of M that of E^T M' E. In M' the owned
     * coefficients @p lumped are lumped, see MassOperator.
     */
    void
    condense_diagonal(VectorType                      &diagonal,
                      const DensityWeights<dim>       &weights,
                      const std::vector<unsigned int> &lumped) const;

    std::size_t
    memory_consumption() const;

  private:
    const SplineSpace<dim>   *space       = nullptr;
    bool                      is_extended = false;
    std::vector<unsigned int> constrained; // owned

    // The rows of extended functions, those of owned ones first; columns are
    // local numbers in exchange, on one process in any vector.
    unsigned int              n_owned_rows = 0;
    std::vector<unsigned int> rows;
    std::vector<std::size_t>  begin{0};
    std::vector<unsigned int> columns;
    std::vector<double>       weights;
    mutable VectorType        exchange;
  };
} // namespace greville

#endif
