#ifndef greville_materials_linear_elastic_h
#define greville_materials_linear_elastic_h

#include <greville/materials/elastic_constants.h>

namespace greville
{
  /**
   * Linear elasticity in logarithmic strains (H. Hencky 1928):
   *   eps = ln(F F^T) / 2,
   *   tau = lambda tr(eps) 1 + 2 G eps = dW / d eps,
   *   W = lambda tr(eps)^2 / 2 + G eps : eps,
   *   sigma = tau / J
   * with the Kirchhoff stress tau and the Cauchy stress sigma, Pa. Small
   * strains give Hooke's law; large ones are hyperelastic. In tension the
   * Cauchy stress has a maximum (mean stress K / exp(1) at ln J = 1).
   *
   * reinit() throws dealii::ExcMessage for a Poisson's ratio outside of (-1,
   * 0.5), initialize() for a mean stress of K / exp(1) and more.
   */
  class LinearElastic : public MaterialLaw<LinearElastic>
  {
  public:
    static constexpr const char *name = "linear-elastic";

    LinearElastic(const std::string &section)
      : MaterialLaw<LinearElastic>(section)
    {
      elastic.declare(*this);
    }

    void
    reinit() override
    {
      elastic.reinit(get_section_name());
    }

    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      dealii::SymmetricTensor<2, 3> e;
      elastic.invert_hencky(point, e, stress, name);
    }

    void
    update_point(MaterialPoint &point) const
    {
      const SpectralDecomposition spectrum(left_cauchy_green_less_one(point.F));
      Principal    tau = elastic.stress(logarithmic_strains(spectrum.values));
      const double inverse_J = inverse_of_volume(point.J);
      point.wave_modulus     = elastic.wave_modulus(tau, inverse_J);
      for (double &t : tau)
        t *= inverse_J;
      point.stress = spectrum.assemble(tau);
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      const SpectralDecomposition spectrum(left_cauchy_green_less_one(point.F));
      return elastic.energy(logarithmic_strains(spectrum.values));
    }

    Moduli
    moduli() const override
    {
      return elastic.moduli();
    }

  private:
    ElasticConstants elastic;
  };
} // namespace greville

#endif
