#ifndef greville_materials_hencky_plasticity_h
#define greville_materials_hencky_plasticity_h

#include <greville/materials/elastic_constants.h>

namespace greville
{
  /**
   * Isotropic elastoplasticity with F = F_e F_p, Hencky's elastic law and the
   * exponential map (de Souza Neto, Peric, Owen, Computational Methods for
   * Plasticity, section 14.4): the return in principal axes is the one of
   * small strains.
   *   b_e = f b_e f^T (trial), eps = ln(b_e) / 2,
   *   tau = lambda tr(eps) 1 + 2 G eps,
   *   eps = eps(trial) - sum_i dgamma_i dg_i / dtau,
   *   sigma = tau / J.
   * Yield functions take the Kirchhoff stress tau, Pa (per stress-free area
   * and volume), so that the strength in Cauchy stress is divided by J.
   *
   * State: the elastic left Cauchy-Green tensor less the identity, b_e - 1
   * (all zeros are the stress-free state); the accumulated equivalent plastic
   * strain, d alpha = sqrt(2 / 3 dev(d eps_p) : dev(d eps_p)); the plastic work
   * tau : d eps_p per volume of the stress-free state, J / m^3, all of which is
   * taken for heat.
   *
   * A @p Law has
   *   static constexpr const char *name, *yield_condition;
   *   double yield_function(const Principal &tau, double alpha) const,
   * positive where the stress is not possible, Pa, and
   *   bool return_map(Principal &tau, double &alpha) const,
   * which leaves an elastic trial stress alone and returns false, or else
   * returns it to the yield surface and adds to alpha.
   */
  template <typename Law>
  class HenckyPlasticity : public MaterialLaw<Law>
  {
  public:
    HenckyPlasticity(const std::string &section)
      : MaterialLaw<Law>(section)
    {
      elastic.declare(*this);
    }

    void
    reinit() override
    {
      elastic.reinit(this->get_section_name());
    }

    std::vector<std::string>
    state_names() const override
    {
      return {"b_xx",
              "b_yy",
              "b_zz",
              "b_xy",
              "b_xz",
              "b_yz",
              "plastic_strain",
              "dissipation"};
    }

    /**
     * Throws dealii::ExcMessage for a stress outside of the yield surface by
     * more than 1e-10 of its norm.
     */
    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      dealii::SymmetricTensor<2, 3> e;
      const Principal tau = elastic.invert_hencky(point, e, stress, Law::name);
      const double    f   = law().yield_function(tau, 0.);
      check_stress(f <= 1e-10 * point.J * stress.norm(),
                   Law::name,
                   stress,
                   std::string("the yield function ") + Law::yield_condition +
                     " of J times this stress is " + to_text(f) +
                     " Pa and has to be at most 0");
      point.state.fill(0.);
      set_elastic(point, e);
    }

    void
    update_point(MaterialPoint &point) const
    {
      dealii::SymmetricTensor<2, 3> e =
        push_forward(point.increment, elastic_of(point));
      const SpectralDecomposition spectrum(e);
      const Principal             trial = logarithmic_strains(spectrum.values);
      Principal                   tau   = elastic.stress(trial);
      if (law().return_map(tau, point.state[plastic_strain]))
        {
          const Principal strain = elastic.strain(tau);
          for (unsigned int a = 0; a < 3; ++a)
            point.state[work] += tau[a] * (trial[a] - strain[a]);
          e = spectrum.assemble(stretches_less_one(strain));
        }
      set_elastic(point, e);

      const double inverse_J = inverse_of_volume(point.J);
      point.wave_modulus     = elastic.wave_modulus(tau, inverse_J);
      for (double &t : tau)
        t *= inverse_J;
      point.stress = spectrum.assemble(tau);
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      const SpectralDecomposition spectrum(elastic_of(point));
      return elastic.energy(logarithmic_strains(spectrum.values));
    }

    double
    dissipation(const MaterialPoint &point) const override
    {
      return point.state[work];
    }

    Moduli
    moduli() const override
    {
      return elastic.moduli();
    }

  protected:
    /**
     * The equivalent plastic strain of a return from one Kirchhoff stress to
     * another: 2 G dev(d eps_p) = dev(trial - returned).
     */
    double
    equivalent_strain(const Principal &trial, const Principal &returned) const
    {
      const double a = trial[0] - returned[0], b = trial[1] - returned[1],
                   c = trial[2] - returned[2];
      return std::sqrt((a - b) * (a - b) + (b - c) * (b - c) +
                       (c - a) * (c - a)) *
             (std::sqrt(2.) / 6.) / elastic.shear;
    }

    ElasticConstants elastic;

  private:
    static constexpr unsigned int plastic_strain = 6, work = 7;

    const Law &
    law() const
    {
      return static_cast<const Law &>(*this);
    }

    static dealii::SymmetricTensor<2, 3>
    elastic_of(const MaterialPoint &point)
    {
      dealii::SymmetricTensor<2, 3> e;
      for (unsigned int i = 0; i < 6; ++i)
        e.access_raw_entry(i) = point.state[i];
      return e;
    }

    static void
    set_elastic(MaterialPoint &point, const dealii::SymmetricTensor<2, 3> &e)
    {
      for (unsigned int i = 0; i < 6; ++i)
        point.state[i] = e.access_raw_entry(i);
    }
  };



  /**
   * (tau_1 + tau_2 + tau_3) / 3.
   */
  inline double
  mean_of(const Principal &tau)
  {
    return (tau[0] + tau[1] + tau[2]) / 3.;
  }



  /**
   * J2 = dev(tau) : dev(tau) / 2.
   */
  inline double
  second_invariant(const Principal &tau)
  {
    const double a = tau[0] - tau[1], b = tau[1] - tau[2], c = tau[2] - tau[0];
    return (a * a + b * b + c * c) / 6.;
  }



  /**
   * Scale the deviator of @p tau and set the mean stress to @p mean.
   */
  inline void
  scale_deviator(Principal &tau, const double factor, const double mean)
  {
    const double shift = mean - factor * mean_of(tau);
    for (double &t : tau)
      t = factor * t + shift;
  }
} // namespace greville

#endif
