// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_hencky_law_h
#define greville_materials_hencky_law_h

#include <greville/materials/elastic_constants.h>

namespace greville
{
  /**
   * What laws in logarithmic elastic strains eps share: elastic constants, the
   * stored energy, and the way from strains to stresses in principal axes,
   * which takes as many points at once as Lanes hold.
   *
   * A @p Law has
   *   dealii::SymmetricTensor<2, 3> trial(const MaterialPoint &point) const,
   * the elastic left Cauchy-Green tensor less the identity, b - 1, at the end
   * of a step without plastic flow;
   *   dealii::SymmetricTensor<2, 3> current(const MaterialPoint &point) const,
   * that of a point whose state is up to date; and
   *   std::array<Lanes, 3>
   *   respond(MaterialPoint *points, unsigned int count,
   *           const SpectralDecomposition<Lanes> &spectrum,
   *           const std::array<Lanes, 6> &e, std::array<Lanes, 3> eps) const,
   * which updates the state of @p count points from the trial tensor e, its
   * spectrum and its strains eps and returns the principal Kirchhoff stresses.
   */
  template <typename Law>
  class HenckyLaw : public Material
  {
  public:
    void
    declare(dealii::ParameterHandler &prm) override
    {
      Material::declare(prm);
      elastic.declare(prm);
    }

    void
    reinit(const std::string &section) override
    {
      elastic.reinit(section);
    }

    void
    update(const dealii::ArrayView<MaterialPoint> &points) const final
    {
      for (std::size_t first = 0; first < points.size(); first += n_lanes)
        update_lanes(points.begin() + first,
                     std::min<std::size_t>(n_lanes, points.size() - first));
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      return elastic.energy(
        logarithmic_strains(Spectrum(law().current(point)).values));
    }

    Moduli
    moduli() const override
    {
      return elastic.moduli();
    }

  protected:
    const Law &
    law() const
    {
      return static_cast<const Law &>(*this);
    }

    ElasticConstants elastic;

  private:
    void
    update_lanes(MaterialPoint *points, const unsigned int count) const
    {
      // Lanes without a point are stress-free.
      double entries[6][n_lanes] = {}, volumes[n_lanes];
      std::fill_n(volumes, n_lanes, 1.);
      for (unsigned int lane = 0; lane < count; ++lane)
        {
          const dealii::SymmetricTensor<2, 3> e = law().trial(points[lane]);
          for (unsigned int i = 0; i < 6; ++i)
            entries[i][lane] = e.access_raw_entry(i);
          volumes[lane] = points[lane].J;
        }
      using std::experimental::element_aligned;
      std::array<Lanes, 6> e;
      for (unsigned int i = 0; i < 6; ++i)
        e[i].copy_from(entries[i], element_aligned);
      Lanes J;
      J.copy_from(volumes, element_aligned);

      const SpectralDecomposition<Lanes> spectrum(e);
      std::array<Lanes, 3>               tau = law().respond(
        points, count, spectrum, e, logarithmic_strains(spectrum.values));
      // b = F F^T does not see the sign of J.
      const Lanes inverse_J =
        choose(J > 0., 1. / J, Lanes(std::numeric_limits<double>::quiet_NaN()));
      const Lanes modulus = elastic.wave_modulus(tau, inverse_J);
      for (Lanes &t : tau)
        t *= inverse_J;
      const std::array<Lanes, 6> stress = spectrum.assemble(tau);
      for (unsigned int i = 0; i < 6; ++i)
        stress[i].copy_to(entries[i], element_aligned);
      for (unsigned int lane = 0; lane < count; ++lane)
        {
          for (unsigned int i = 0; i < 6; ++i)
            points[lane].stress.access_raw_entry(i) = entries[i][lane];
          points[lane].wave_modulus = modulus[lane];
        }
    }
  };
} // namespace greville

#endif
