// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3

// Checks lattices of twice the size below the mass of a ball that ends anywhere
// in the grid, on extended B-splines: the product of a coarse matrix is that of
// the finer one with interpolated vectors, also where extended functions couple
// coarse functions beyond stencils, at walls, across periodic directions, and
// between levels of refined grids. Cycles solve in a few iterations.

#include <deal.II/lac/solver_cg.h>

#include <greville/multigrid/lattice_cycle.h>
#include <greville/multigrid/mass_level.h>

#include <density.h>
#include <refined_box.h>

namespace
{
  void
  initialize(SingleVector &vector, const InterleavedLayout &layout)
  {
    vector.reinit(layout.partitioner(1));
  }



  // x^T A x.
  template <int dim>
  double
  energy(const LatticeLevel<dim> &level, SingleVector &x)
  {
    SingleVector y;
    initialize(y, level.layout());
    level.multiply(y, x);
    return double(x * y) / level.unit();
  }



  template <int dim>
  void
  fill(SingleVector &x, const LatticeLevel<dim> &level)
  {
    const auto positions   = level.unknown_positions();
    const auto constrained = level.constrained_unknowns();
    for (unsigned int u = 0; u < positions.size(); ++u)
      x.local_element(u) = constrained[u] != 0
                             ? 0.f
                             : 1.f + 0.5f * std::sin(1.7f * positions[u][0] +
                                                     2.3f * positions[u][1] +
                                                     3.1f * positions[u][2]);
  }



  // Inserted knots reproduce 1 and x, whose coefficients are Greville points.
  void
  test_insertion(const unsigned int degree)
  {
    const std::vector<double> edges{
      0., 0.1, 0.15, 0.5, 0.6, 1.4, 1.5, 2.5, 2.6, 2.65};
    NestedKnots  fine(degree, edges.size() - 1, false, edges);
    unsigned int n_levels = 0;
    for (; fine.n_cells() > 1; ++n_levels)
      {
        const NestedKnots coarse = fine.coarser();
        const KnotVector  knots  = KnotVector::open(degree, fine.edges()),
                         coarse_knots =
                           KnotVector::open(degree, coarse.edges());
        double error = 0.;
        for (int i = 0; i < fine.n_functions(); ++i)
          {
            const NestedKnots::Row row = fine.insertion(i, coarse);
            double                 one = -1., x = -knots.greville_abscissa(i);
            for (unsigned int k = 0; k < row.weights.size(); ++k)
              {
                one += row.weights[k];
                x += row.weights[k] *
                     coarse_knots.greville_abscissa(row.first + k);
              }
            error = std::max({error, std::abs(one), std::abs(x)});
          }
        check("order " + std::to_string(degree) + ", insertion", error, 1e-6);
        fine = coarse;
      }
    check_range("levels of uneven cells", n_levels, 4, 7);
  }



  template <int dim>
  void
  test_ball_in(const std::string             &of_mesh,
               DistributedTriangulation<dim> &mesh,
               const unsigned int             degree,
               const bool                     has_wall)
  {
    const std::string what =
      std::to_string(dim) + "D, p = " + std::to_string(degree) + of_mesh;
    const SplineSpace<dim> space(mesh, degree);
    Point<dim>             center;
    for (unsigned int d = 0; d < dim; ++d)
      center[d] = 0.1 + 0.2 * d;
    std::vector<double> parts;
    for (unsigned int c = 0; c < space.owned_cells().size(); ++c)
      {
        const double distance = space.box(c).center.distance(center);
        parts.push_back(distance < 0.4 ? 1. : distance < 0.46 ? 0.2 : 0.);
      }
    CellFilling<dim> filling(space);
    filling.update(parts, 0.5);
    MassLevel<dim> mass(
      space, DensityWeights<dim>(space, degree + 1, *density<dim>("smooth")));
    for (unsigned int c = 0; c < parts.size(); ++c)
      for (unsigned int q = 0; q < mass.weights().n_points(); ++q)
        mass.weights().at_cell(c)[q * CellBatches<dim>::width()] *= parts[c];
    std::vector<unsigned char> constrained(space.owned_functions().size() +
                                           space.ghost_functions().size());
    for (unsigned int f = 0; f < constrained.size(); ++f)
      constrained[f] = has_wall && space.greville_point(f)[1] < 1e-6;

    Extension<dim>    extension(space, filling);
    ExtendedMass<dim> matrix;
    matrix.reinit(space);
    matrix.begin(extension, true);
    matrix.unknowns().constrain(constrained);
    add_mass_matrix(matrix.matrix(), mass.weights());
    matrix.finish();
    const ExtendedLattice<dim> finest(matrix, extension, constrained, 1e-3);
    check(what + ", some functions depend on others",
          Utilities::MPI::sum(extension.extended_functions().size(),
                              MPI_COMM_WORLD) > 0);

    // The lattices.
    std::vector<std::unique_ptr<LatticeMatrix<dim>>> lattices;
    const LatticeLevel<dim>                         *last = &finest;
    while (LatticeMatrix<dim>::can_coarsen(*last) && lattices.size() < 4)
      {
        lattices.push_back(std::make_unique<LatticeMatrix<dim>>(*last));
        last = lattices.back().get();
      }
    last = &finest;
    for (unsigned int l = 0; l < lattices.size(); ++l)
      {
        SingleVector coarse, fine;
        initialize(coarse, lattices[l]->layout());
        initialize(fine, last->layout());
        fill(coarse, *lattices[l]);
        const double expected = energy(*lattices[l], coarse);
        fine                  = 0.f;
        lattices[l]->unknowns().prolongate_and_add(fine, coarse);
        check(what + ", energy on lattice " + std::to_string(l + 1),
              energy(*last, fine) / expected - 1.,
              1e-5);
        last = lattices[l].get();
      }

    mass.extend(Extension<dim>(space, filling), constrained);
    mass.assemble();
    const auto cycle = mass.lattice_preconditioner({});
    VectorType b     = pseudo_random_vector(space), x(b);
    for (const unsigned int i : mass.inactive())
      b.local_element(i) = 0.;
    SolverControl control(100, 1e-8 * b.l2_norm());
    x = 0.;
    SolverCG<VectorType>(control).solve(mass, x, b, *cycle);
    check_range(what + ", iterations", control.last_step(), 3, 14);
  }



  template <int dim>
  void
  test_ball(const unsigned int           degree,
            const unsigned int           n_cells,
            const std::array<bool, dim> &periodic,
            const bool                   is_uniform = true)
  {
    Box<dim> box(cube<dim>(n_cells), MPI_COMM_WORLD, periodic, is_uniform);
    test_ball_in<dim>(std::string(periodic[0] ? ", periodic" : "") +
                        (is_uniform ? "" : ", uneven"),
                      box.mesh,
                      degree,
                      !periodic[1]);
  }



  // The ball with smaller cells around a point.
  template <int dim>
  void
  test_refined(const unsigned int degree,
               const unsigned int n_cells,
               const unsigned int n_levels,
               const Point<dim>  &center,
               const double       radius)
  {
    const auto where = [&](const unsigned int l, const Point<dim> &x) {
      return x.distance(center) < radius / (l + 1);
    };
    RefinedBox<dim> box(hierarchy<dim>(n_cells, n_levels, degree, where));
    test_ball_in<dim>(", " + std::to_string(n_levels) + " levels",
                      box.mesh,
                      degree,
                      true);
  }
} // namespace



void
test_main()
{
  for (const unsigned int degree : {1, 2, 3})
    {
      test_insertion(degree);
      test_ball<2>(degree, 21, {{false, false}});
      test_ball<2>(degree, 16, {{true, true}});
      test_ball<2>(degree, 19, {{false, false}}, false);
      test_ball<3>(degree, 11, {{false, false, false}});
      // Without functions of cut cells of two sizes, which are ill-conditioned.
      test_refined<2>(degree, 18, 2, Point<2>(0., 0.3), 0.1);
    }
  test_ball<3>(2, 12, {{true, false, false}});
  test_ball<3>(2, 10, {{true, false, false}}, false);
  for (const unsigned int degree : {1, 2})
    test_refined<2>(degree, 14, 3, Point<2>(0.5, 0.), 0.3);
  test_refined<3>(2, 7, 2, Point<3>(0.5, 0., 0.), 0.3);
}
