// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 4

// Checks the linear systems of implicit steps: the operator is the derivative
// of the force, and p-multigrid needs few iterations for any mesh, order and
// position of the surface in its cells.
#include <greville/base/index_limits.h>
#include <greville/linear_algebra/krylov.h>
#include <greville/steps/grid_mass.h>
#include <greville/stiffness/tangent_system.h>

#include "simulation.h"

namespace
{
  template <int dim>
  class Systems
  {
  public:
    Systems(const Text &text, const TangentParameters &tangent = {})
      : parameters(tangent)
      , simulated(text)
      , walls(simulated.parameters.walls)
      , orders(simulated->grid().triangulation(),
               simulated.parameters.grid.degree,
               parameters.multigrid.coarsening)
      , system(
          orders,
          [this](const SplineSpace<dim> &space) {
            return constrained_components_at_walls(space, walls);
          },
          parameters,
          0.55,
          false,
          simulated->grid().volume_projection())
    {
      for (const Body<dim> &body : simulated->bodies())
        bodies.push_back({&body.points, body.material, body.name, 1.});
      system.set_points(bodies);
      for (auto *field : {&u, &force})
        for (VectorType &component : *field)
          system.space().initialize_vector(component);
      for (auto *vector : {&x, &b})
        system.initialize(*vector);
    }

    /// A vector of unknowns that does not depend on the number of processes.
    void
    fill(VectorType &vector, const double scale) const
    {
      const auto &owned = system.space().owned_functions();
      const auto &functions =
        system.finest().extended().unknowns().unknown_functions();
      for (unsigned int i = 0; i < functions.size(); ++i)
        for (unsigned int c = 0; c < dim; ++c)
          vector.local_element(i * dim + c) =
            scale * std::sin(12.9898 * (owned[functions[i]] % 104729) + c);
    }

    void
    residual(VectorType &rows, const VectorType &at)
    {
      system.extend(u, at);
      system.evaluate(bodies, u, 0.1, stress, false, force);
      for (VectorType &component : u)
        component *= mass_factor;
      system.restrict(rows, force, &u);
    }

    /// The derivative in one direction, against differences.
    double
    derivative_error()
    {
      VectorType direction = x, high = x, low = x, product = x;
      fill(x, 0.01 / system.space().n_functions()[0]);
      fill(direction, 1.);
      system.extend(u, direction);
      system.read(direction, u);
      const double eps = 1e-7;
      b                = x;
      b.add(eps, direction);
      residual(high, b);
      b.add(-2. * eps, direction);
      residual(low, b);
      high -= low;
      high *= 0.5 / eps;
      system.extend(u, x);
      system.evaluate(bodies, u, 0.1, stress, true, force);
      system.set_operator(mass_factor, true);
      system.multiply(product, direction);
      const double size = high.l2_norm();
      high -= product;
      return high.l2_norm() / size;
    }

    unsigned int
    iterations(const double factor)
    {
      for (VectorType &component : u)
        component = 0.;
      system.evaluate(bodies, u, 1., StepStress::end, true, force);
      system.set_operator(factor, true);
      fill(x, 1.);
      system.extend(u, x);
      system.restrict(b, u, nullptr);
      const SolveResult result = system.solve(x, b, 1e-8);
      return result.converged ? *result.iterations : 1000;
    }

    /// The same for two copies of the body, whose unknowns at a height are
    /// coupled by springs along (0.6, 0.8), as stiff as the largest diagonal
    /// entry times @p spring. The copies get opposite loads, so that the system
    /// (A + 2 C) x = b of one of them is solved.
    unsigned int
    coupled_iterations(const double spring, const int height)
    {
      for (VectorType &component : u)
        component = 0.;
      system.set_coupled(true);
      system.evaluate(bodies, u, 1., StepStress::end, true, force);
      system.set_operator(0., true);
      typename LatticeCycle<dim>::Parts parts;
      for (unsigned int copy = 0; copy < 2; ++copy)
        parts.push_back(system.lattice_part().finest);
      const LatticeCycleParameters cycle_parameters =
        system.lattice_part().parameters;
      const InterleavedLayout &layout      = parts[0]->layout();
      const auto               constrained = parts[0]->constrained_unknowns();
      const auto               positions   = parts[0]->unknown_positions();
      Tensor<1, dim>           n;
      n[0] = 0.6;
      n[1] = 0.8;
      std::vector<Tensor<2, dim>> keys;
      std::vector<unsigned int>   of_keys;
      for (unsigned int k = 0; k < positions.size(); ++k)
        if (positions[k][dim - 1] == height)
          {
            keys.push_back(spring * parts[0]->unit() * outer_product(n, n));
            of_keys.push_back(k);
          }
      const std::uint64_t first =
        sum_before(keys.size(), layout.communicator());
      std::vector<typename LatticeCoupling<dim>::Weight> weights;
      for (unsigned int k = 0; k < keys.size(); ++k)
        weights.push_back({first + k,
                           layout.global_number(of_keys[k]),
                           1.,
                           constrained[of_keys[k]]});
      LatticeCoupling<dim> coupling;
      coupling.add_keys(keys);
      for (const double sign : {1., -1.})
        coupling.add_weights(sign > 0. ? 0 : 1,
                             layout,
                             weights,
                             std::vector<double>(keys.size(), sign));
      const LatticeCycle<dim> cycle(
        std::move(parts), cycle_parameters, &coupling, true, true);
      fill(x, 1.);
      system.extend(u, x);
      system.restrict(b, u, nullptr);
      VectorType        minus = b, unused = b;
      const SolveResult result = solve_krylov(
        {1e-6, 100},
        [&](VectorType &dst, const VectorType &src) {
          system.multiply(dst, src);
          for (unsigned int k = 0; k < keys.size(); ++k)
            {
              const unsigned int i = of_keys[k] * dim;
              Tensor<1, dim>     moved;
              for (unsigned int c = 0; c < dim; ++c)
                moved[c] = src.local_element(i + c);
              const Tensor<1, dim> push = 2. * (keys[k] * moved);
              for (unsigned int c = 0; c < dim; ++c)
                dst.local_element(i + c) += push[c];
            }
        },
        [&](VectorType &dst, const VectorType &src) {
          minus.equ(-1., src);
          cycle.vmult({&dst, &unused}, {&src, &minus});
        },
        x,
        b);
      system.set_coupled(false);
      return result.converged ? *result.iterations : 1000;
    }

    /// Set-ups of several systems with these mass factors.
    unsigned int
    n_set_ups(const std::vector<double> &factors)
    {
      const unsigned int before = system.n_set_ups();
      for (const double factor : factors)
        iterations(factor);
      return system.n_set_ups() - before;
    }

    void
    forget()
    {
      system.forget();
    }

    // Of the size of the stiffness.
    const double mass_factor = 3e4;
    StepStress   stress      = StepStress::end;

  private:
    const TangentParameters     parameters;
    Simulated<dim>              simulated;
    const Walls<dim>            walls;
    const OrderHierarchy<dim>   orders;
    TangentSystem<dim>          system;
    std::vector<TrialBody<dim>> bodies;
    VectorField<dim>            u, force;
    VectorType                  x, b;
  };



  Text
  column_2d(const unsigned int n, const unsigned int p)
  {
    return block_2d("box(0.21, 0, 0.73, 0.83)", n)
      .with("Grid", {"Order = " + std::to_string(p)})
      .with("Body body", {"Points per direction = 3", "Jitter = 0.3"})
      .with("Walls", {"Bottom = fixed"});
  }

  Text
  dome_2d(const unsigned int n, const unsigned int p)
  {
    return column_2d(n, p).with("Body body",
                                {"Shape = ball(0.5, 0, 0.43)",
                                 "Clip at the grid = true"});
  }

  Text
  column_3d(const unsigned int n, const unsigned int p)
  {
    return block_3d("box(0.21, 0.17, 0, 0.73, 0.77, 0.83)", n)
      .with("Grid", {"Order = " + std::to_string(p)})
      .with("Body body", {"Points per direction = 2", "Jitter = 0.3"})
      .with("Walls", {"Back = fixed"});
  }



  Text
  with_poissons_ratio(Text text, const std::string &ratio)
  {
    return text.with("Material solid", {"Poisson ratio = " + ratio});
  }



  Text
  with_material(Text text, const std::vector<std::string> &lines)
  {
    const auto place = text.content.find("subsection Material solid");
    text.content.erase(place, text.content.find("end\n", place) + 4 - place);
    return text.add("Material solid", lines);
  }



  /// Poisson's ratio chooses the smoother.
  template <int dim>
  void
  check_nearly_incompressible(const std::string &name, const Text &text)
  {
    TangentParameters one_for_all;
    one_for_all.multigrid.smoother = "chebyshev-ic0";
    for (const auto &[ratio, most] :
         std::map<std::string, unsigned int>{{"0.45", 12}, {"0.49", 19}})
      {
        const Text         stiff = with_poissons_ratio(text, ratio);
        const unsigned int n     = Systems<dim>(stiff).iterations(0.);
        check_range(name + ", Poisson's ratio " + ratio, n, 4, most);
        check(name + ", one factorization for all, " + ratio,
              Systems<dim>(stiff, one_for_all).iterations(0.) > 1.2 * n);
      }
  }



  /// A set-up serves systems that differ little.
  void
  check_reuse()
  {
    const Text        text = column_2d(16, 2);
    TangentParameters never;
    never.reuse = 0;
    Systems<2> systems(text), fresh(text, never);
    check("one set-up", systems.n_set_ups({1e4, 1.1e4, 0.9e4, 1e4}) == 1);
    check("another mass factor", systems.n_set_ups({1e2, 1e2}) == 1);
    check("without mass", systems.n_set_ups({0., 0.}) == 1);
    systems.forget();
    check("forgotten", systems.n_set_ups({0., 0.}) == 1);
    check("without reuse", fresh.n_set_ups({1e4, 1e4, 1e4}) == 3);
  }



  /// A cycle of two bodies that springs of any stiffness couple.
  template <int dim>
  void
  check_coupled(const std::string &name, const Text &text, const int height)
  {
    Systems<dim> systems(text);
    for (const double spring : {1e-3, 1., 30.})
      check_range(name + ", coupled by springs of " + std::to_string(spring),
                  systems.coupled_iterations(spring, height),
                  3,
                  spring > 1. ? 30 : 14);
  }



  template <int dim>
  void
  check_derivative(const std::string &name,
                   const Text        &text,
                   const double       most = 1e-6)
  {
    Systems<dim> systems(text);
    double       error = systems.derivative_error();
    check(name + ": derivative of the force", error < most);
    if (!(error < most))
      print() << error << std::endl;
  }
} // namespace



void
test_main()
{
  check_coupled<2>("column of 16 cells", column_2d(16, 2), 12);
  check_coupled<3>("column of 8 cells", column_3d(8, 2), 6);
  for (const std::string model :
       {"linear-elastic", "neo-hookean", "newtonian-fluid"})
    {
      const std::vector<std::string> fluid      = {"Model = newtonian-fluid",
                                                   "Density = 1",
                                                   "Allow tension = true",
                                                   "Viscosity = 3"};
      const auto                     with_model = [&](const Text &text) {
        return model == "newtonian-fluid"
                                     ? with_material(text, fluid)
                                     : text.with("Material solid", {"Model = " + model});
      };
      for (const unsigned int p : {1, 2, 3})
        check_derivative<2>(model + ", p = " + std::to_string(p),
                            with_model(column_2d(8, p)));
      check_derivative<3>(model + " in 3D", with_model(column_3d(6, 2)));
    }

  const auto deformed = [](const Text &text, const std::string &u) {
    return text.with("Scheme", {"Formulation = total Lagrangian"})
      .with("Body body", {"Displacement = " + u})
      .with("Material solid", {"Model = neo-hookean"});
  };
  check_derivative<2>("total Lagrangian",
                      deformed(column_2d(8, 2), "3 * x + y; x * y - 0.2 * y"));
  check_derivative<3>("total Lagrangian in 3D",
                      deformed(column_3d(6, 2), "y + z; x * y; 0.5 * z + y"));

  const auto projected =
    [&](const Text &text, const std::string &u, const std::string &projection) {
      return with_poissons_ratio(deformed(text, u), "0.45")
        .with("Scheme", {"Volumetric projection = " + projection});
    };
  for (const std::string projection : {"order p-1", "coarse mesh"})
    {
      for (const unsigned int p : {1, 2, 3})
        check_derivative<2>(projection + ", p = " + std::to_string(p),
                            projected(column_2d(8, p),
                                      "3 * x + y; x * y - 0.2 * y",
                                      projection));
      check_derivative<3>(
        projection + " in 3D",
        projected(column_3d(6, 2), "0.2 * z; 0.1 * x * z; 0", projection)
          .with("Scheme", {"Formulation = updated Lagrangian"}));
    }

  // At the axis, and away from it.
  const auto axisymmetric = [](const Text &text) {
    return text.with("Grid", {"Geometry = axisymmetric"});
  };
  for (const std::string model :
       {"linear-elastic", "neo-hookean", "von-mises", "mohr-coulomb"})
    for (const unsigned int p : {1, 2, 3})
      for (const std::string shape :
           {"ball(0, 0, 0.53)", "box(0.21, 0, 0.73, 0.83)"})
        {
          Text text = axisymmetric(column_2d(8, p))
                        .with("Body body",
                              {"Shape = " + shape, "Clip at the grid = true"})
                        .with("Material solid", {"Model = " + model});
          if (model == "von-mises")
            text = text.with("Material solid", {"Yield stress = 1"});
          if (model == "mohr-coulomb")
            text = text.with("Material solid", {"Cohesion = 1"});
          check_derivative<2>("axisymmetric, " + model +
                                ", p = " + std::to_string(p) + ", " + shape,
                              text,
                              1e-7);
        }
  // Soils that yield under this pressure.
  const std::vector<std::vector<std::string>> soils = {
    {"Model = drucker-prager",
     "Density = 1",
     "Young modulus = 1e5",
     "Poisson ratio = 0.3",
     "Friction angle = 30",
     "Dilatancy angle = 5",
     "Cohesion = 100"},
    {"Model = modified-cam-clay",
     "Density = 1",
     "Shear modulus = 3e4",
     "Swelling slope = 0.01",
     "Critical stress ratio = 1",
     "Attraction = 10"},
    {"Model = nor-sand",
     "Density = 1",
     "Shear modulus = 3e4",
     "Swelling slope = 0.01",
     "Critical stress ratio = 1.2",
     "State parameter = -0.1",
     "Attraction = 10"}};
  for (const auto &soil : soils)
    for (const std::string shape :
         {"ball(0, 0, 0.53)", "box(0.21, 0, 0.73, 0.83)"})
      check_derivative<2>("axisymmetric, " + soil[0] + ", " + shape,
                          with_material(axisymmetric(column_2d(8, 2)), soil)
                            .with("Body body",
                                  {"Shape = " + shape,
                                   "Clip at the grid = true",
                                   "Stress = -1e3; -1e3; -1e3; 0"}),
                          1e-7);
  check_derivative<2>("axisymmetric, total Lagrangian",
                      axisymmetric(
                        deformed(column_2d(8, 2), "3 * x; x * y - 0.2 * y")));
  for (const std::string projection : {"order p-1", "coarse mesh"})
    check_derivative<2>("axisymmetric, " + projection,
                        axisymmetric(projected(column_2d(8, 2),
                                               "3 * x; x * y - 0.2 * y",
                                               projection)));
  check_range("axisymmetric dome",
              Systems<2>(axisymmetric(dome_2d(32, 2).with(
                           "Body body", {"Shape = ball(0, 0, 0.73)"})))
                .iterations(0.),
              3,
              12);

  for (const unsigned int n : {16, 32})
    for (const unsigned int p : {1, 2, 3})
      {
        const std::string name =
          std::to_string(n) + " cells, p = " + std::to_string(p);
        check_range(name + ", column",
                    Systems<2>(column_2d(n, p)).iterations(0.),
                    1,
                    p == 1 ? 16 : 11);
        check_range(name + ", dome",
                    Systems<2>(dome_2d(n, p)).iterations(0.),
                    1,
                    p == 1 ? 16 : 12);
      }
  check_range("with mass", Systems<2>(column_2d(32, 2)).iterations(1e4), 2, 10);
  check_range("3D", Systems<3>(column_3d(8, 2)).iterations(0.), 3, 14);
  check_nearly_incompressible<2>("2D", column_2d(32, 3));
  check_nearly_incompressible<3>("3D", column_3d(8, 2));
  check_reuse();
}
