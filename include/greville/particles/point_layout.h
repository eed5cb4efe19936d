#ifndef greville_particles_point_layout_h
#define greville_particles_point_layout_h

namespace greville
{
  /**
   * Where the numbers of a material point lie. Each is counted in doubles from
   * the begin of the point; symmetric tensors are stored as xx, yy, zz, xy (in
   * 3D then xz, yz), the deformation gradient row by row, in 2D followed by
   * F_zz.
   */
  template <int dim>
  struct PointLayout
  {
    static constexpr unsigned int n_stress = dim == 2 ? 4 : 6;
    static constexpr unsigned int n_F      = dim == 2 ? 5 : 9;

    /// x, m.
    static constexpr unsigned int position = 0;
    /// v, m / s.
    static constexpr unsigned int velocity = position + dim;
    /// m, kg (in 2D per metre of thickness).
    static constexpr unsigned int mass = velocity + dim;
    /// V0, volume of the stress-free state, m^3 (in 2D m^2).
    static constexpr unsigned int volume0 = mass + 1;
    /// J = V / V0.
    static constexpr unsigned int J = volume0 + 1;
    /// Cauchy stress, Pa.
    static constexpr unsigned int stress = J + 1;
    /// rho c^2 of the fastest wave, Pa (MaterialPoint::wave_modulus).
    static constexpr unsigned int wave_modulus = stress + n_stress;
    /// Deformation gradient from the stress-free state.
    static constexpr unsigned int F = wave_modulus + 1;
    /// The initial position, m.
    static constexpr unsigned int reference = F + n_F;
    /// A number that no other point of the body has.
    static constexpr unsigned int id = reference + dim;
    /// Number of doubles that every point has.
    static constexpr unsigned int n_fixed = id + 1;

    /**
     * Where entry (i, j) of a stress, or of the deformation gradient, lies
     * behind its begin.
     */
    static constexpr unsigned int
    stress_index(const unsigned int i, const unsigned int j)
    {
      return i == j ? i : (dim == 2 ? 3 : 2 + i + j);
    }

    static constexpr unsigned int
    F_index(const unsigned int i, const unsigned int j)
    {
      return dim == 2 && i == 2 && j == 2 ? 4 : i * dim + j;
    }

    PointLayout() = default;

    /**
     * @p n_state history variables, and where asked for the affine matrix of
     * APIC (dim x dim, row by row, 1 / s) and an acceleration by loads (dim
     * numbers, m / s^2).
     */
    PointLayout(const unsigned int n_state,
                const bool         has_affine,
                const bool         has_load);

    unsigned int n_state    = 0;
    bool         has_affine = false;
    bool         has_load   = false;
    unsigned int state      = n_fixed;
    unsigned int affine     = n_fixed;
    unsigned int load       = n_fixed;
    /// Number of doubles of a point.
    unsigned int size = n_fixed;
  };
} // namespace greville

#endif
