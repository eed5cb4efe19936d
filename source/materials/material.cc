// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/materials/bingham.h>
#include <greville/materials/decoupled_neo_hookean.h>
#include <greville/materials/drucker_prager.h>
#include <greville/materials/linear_elastic.h>
#include <greville/materials/modified_cam_clay.h>
#include <greville/materials/mohr_coulomb.h>
#include <greville/materials/neo_hookean.h>
#include <greville/materials/newtonian_fluid.h>
#include <greville/materials/nor_sand.h>
#include <greville/materials/umat.h>
#include <greville/materials/von_mises.h>

#include <algorithm>
#include <cctype>

namespace greville
{
  using namespace dealii;

  namespace
  {
    struct Entry
    {
      std::string  name;
      MakeMaterial make;
    };

    // The list of all materials, one line each.
    std::vector<Entry> &
    materials()
    {
      static std::vector<Entry> list = {
        {LinearElastic::name, new_material<LinearElastic>},
        {NeoHookean::name, new_material<NeoHookean>},
        {DecoupledNeoHookean::name, new_material<DecoupledNeoHookean>},
        {VonMises::name, new_material<VonMises>},
        {DruckerPrager::name, new_material<DruckerPrager>},
        {MohrCoulomb::name, new_material<MohrCoulomb>},
        {ModifiedCamClay::name, new_material<ModifiedCamClay>},
        {NorSand::name, new_material<NorSand>},
        {NewtonianFluid::name, new_material<NewtonianFluid>},
        {Bingham::name, new_material<Bingham>},
        {Umat::name, new_material<Umat>}};
      return list;
    }
  } // namespace



  EnergyLanes
  Material::energies(const MaterialLanes &points) const
  {
    EnergyLanes result;
    for (unsigned int lane = 0; lane < points.count; ++lane)
      {
        MaterialPoint point;
        for (unsigned int i = 0; i < 9; ++i)
          point.F[i / 3][i % 3] = points.F[i][lane];
        point.J = points.J[lane];
        for (unsigned int i = 0; i < 6; ++i)
          point.stress.access_raw_entry(i) = points.stress[i][lane];
        for (unsigned int i = 0; i < 3; ++i)
          point.increment[i][i] = 1.;
        point.state.resize(points.n_state);
        for (unsigned int k = 0; k < points.n_state; ++k)
          point.state[k] = points.state[k][lane];
        result.strain[lane]      = strain_energy(point);
        result.dissipation[lane] = dissipation(point);
      }
    return result;
  }



  void
  add_material(const std::string &name, const MakeMaterial make)
  {
    const bool is_word =
      !name.empty() &&
      std::all_of(name.begin(), name.end(), [](const unsigned char c) {
        return std::isalnum(c) || c == '-' || c == '_';
      });
    Require(is_word,
            "A material law has the name '" + name +
              "', which has to consist of letters, digits, - and _.");
    for (const Entry &material : materials())
      Require(material.name != name,
              "A material law '" + name +
                "' exists already: choose another name.");
    materials().push_back({name, make});
  }



  void
  Material::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Density", density, positive())(
      "Density in the stress-free state. Unit: kg / m^3.");
    add_parameter(prm, "Porosity", porosity)(
      "Fraction of the volume that water fills in the stress-free state, with "
      "'Simulation/Pore water'. 'Density' is then the density of soil and "
      "water together. Unit: none.");
    add_parameter(prm, "Hydraulic conductivity", conductivity)(
      "Darcy's coefficient with 'Simulation/Pore water': the flow of water per "
      "area at a hydraulic gradient of 1, with g = 9.81 m / s^2. Unit: m / s.");
    add_choice<bool>(prm,
                     "Conductivity law",
                     has_kozeny_carman,
                     {{false, "constant"}, {true, "kozeny-carman"}})(
      "Dependence of the hydraulic conductivity on the void ratio e: none "
      "(constant), or e^3 / (1 + e) (kozeny-carman); 'Hydraulic conductivity' "
      "is then its value in the stress-free state.");
  }



  void
  Material::tangents(const ArrayView<const MaterialPoint> &points,
                     const ArrayView<MaterialTangent>     &result,
                     const unsigned int                    dim) const
  {
    AssertThrow(points.size() == result.size(),
                ExcDimensionMismatch(points.size(), result.size()));
    // Small compared with the strains at which laws are nonlinear, and large
    // enough for rounding errors of f to be 1e-9 of the step. A power of two
    // adds no rounding error.
    const double                  size = std::ldexp(1., -23);
    std::array<MaterialPoint, 18> moved;
    for (std::size_t p = 0; p < points.size(); ++p)
      {
        unsigned int n = 0;
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            for (const double change : {size, -size})
              {
                MaterialPoint &point = moved[n++];
                point                = points[p];
                point.increment[k] += change * points[p].increment[l];
                point.F[k] += change * points[p].F[l];
                if (k == l)
                  point.J *= 1. + change;
              }
        update(ArrayView<MaterialPoint>(moved.data(), n));

        result[p] = 0.;
        n         = 0;
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l, n += 2)
            for (unsigned int i = 0; i < 3; ++i)
              for (unsigned int j = 0; j < 3; ++j)
                result[p][i][j][k][l] =
                  (moved[n].stress[i][j] - moved[n + 1].stress[i][j]) /
                  (2. * size);
      }
  }



  std::string
  material_names()
  {
    std::string names;
    for (const Entry &material : materials())
      names += (names.empty() ? "" : "|") + material.name;
    return names;
  }



  std::unique_ptr<Material>
  make_material(const std::string &name, const std::string &parameter)
  {
    for (const Entry &material : materials())
      if (name == material.name)
        return material.make();
    Require(false,
            "The parameter '" + parameter + "' is '" + name +
              "'; it has to be one of " + material_names() + ".");
    return nullptr;
  }
} // namespace greville
