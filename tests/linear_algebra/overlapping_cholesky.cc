// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks OverlappingCholesky with mass matrices of full and jagged bodies: it
// is symmetric, and conjugate gradients need about as many iterations on
// several processes as on one, also if one component is constrained at a wall.
// Without dropped entries on one process it is exact.

#include <greville/linear_algebra/overlapping_cholesky.h>
#include <greville/mass/extended_mass.h>
#include <greville/points/point_transfer.h>

#include <half_full_cells.h>

template <int dim>
Filling<dim>
full()
{
  return [](const MultiIndex<dim> &) { return 1.; };
}



template <int dim>
void
test(const MultiIndex<dim> &cells,
     const unsigned int     p,
     const Filling<dim>    &is_filled,
     const bool             is_constrained,
     const unsigned int     most_iterations,
     const std::string     &name)
{
  print() << dim << "D, p = " << p << ", " << name
          << (is_constrained ? ", held" : "") << std::endl;
  constexpr unsigned int width = dim == 2 ? 2 : 4;
  Box<dim>               box(cells);
  const SplineSpace<dim> space(box.mesh, p);
  CellFilling<dim>       filling(space);
  filling.update(fillings<dim>(space, is_filled), 0.7);
  Extension<dim> extension;
  extension.reinit(space, filling);
  const auto         points = random_points<dim>(space, p, is_filled);
  PointTransfer<dim> transfer;
  transfer.reinit(space);
  ExtendedMass<dim> mass;
  mass.reinit(space);
  mass.begin(extension, true);
  transfer.add_mass_matrix({&points}, mass.matrix());
  mass.finish();

  // Component 1 is constrained at the lower wall in direction 1.
  std::vector<unsigned char> constrained(space.owned_functions().size() +
                                         space.ghost_functions().size());
  for (unsigned int f = 0; f < constrained.size() && is_constrained; ++f)
    if (multi_index<dim>(space.function_position(f), space.n_functions())[1] ==
        0)
      constrained[f] = 2;
  mass.unknowns().constrain(constrained);

  OverlappingCholesky cholesky;
  const auto          factorize = [&](const CholeskyParameters &parameters) {
    cholesky.factorize(mass.local_entries((1 << dim) - 1),
                       *mass.unknowns().unknown_layout(),
                       mass.unknowns().unknown_positions(),
                       p,
                       1,
                       parameters,
                       mass.row_variants(p));
  };
  factorize({0.003, dim == 2 ? 0.01 : 0.003});

  const auto positions  = mass.unknowns().unknown_positions();
  const auto new_vector = [&](const double frequency) {
    VectorType result;
    mass.unknowns().initialize_vector(result, width);
    for (unsigned int u = 0; u < positions.size(); ++u)
      for (unsigned int c = 0; c < dim; ++c)
        result.local_element(u * width + c) =
          std::sin(frequency * (positions[u][0] + 17. * positions[u][1] +
                                71. * positions[u][2] + 5. * c));
    mass.unknowns().zero_constrained_unknowns(result, width);
    return result;
  };
  const auto solve = [&](const VectorType &r) {
    VectorType z(r);
    cholesky.solve(z.begin(), width);
    mass.unknowns().zero_constrained_unknowns(z, width);
    return z;
  };
  const VectorType a = new_vector(1.3), b = new_vector(2.7);
  const VectorType Pa = solve(a), Pb = solve(b);
  check("  symmetric",
        std::abs(a * Pb - b * Pa) / (Pa.l2_norm() * b.l2_norm()),
        1e-5);

  // Conjugate gradients for all columns as one vector.
  const auto n_iterations = [&](const double tolerance) {
    VectorType   r(a), z(solve(a)), d(z), q(a);
    unsigned int n   = 0;
    double       rho = r * z;
    while (r.l2_norm() > tolerance * a.l2_norm() && n < 100)
      {
        mass.vmult(q, d, width);
        r.add(-rho / (d * q), q);
        z                    = solve(r);
        const double new_rho = r * z;
        d.sadd(new_rho / rho, 1., z);
        rho = new_rho;
        ++n;
      }
    return n;
  };
  check_range("  iterations", n_iterations(1e-8), 1, most_iterations);
  const bool is_exact = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
  factorize({0., 1e-9});
  check_range("  iterations without dropped entries",
              n_iterations(is_exact ? 1e-6 : 1e-8),
              1,
              is_exact ? 2 : most_iterations);
}



void
test_main()
{
  for (const bool is_constrained : {false, true})
    {
      test<2>({{32, 24}}, 1, full<2>(), is_constrained, 12, "full");
      test<2>({{32, 24}}, 2, full<2>(), is_constrained, 14, "full");
      test<2>({{32, 24}}, 3, full<2>(), is_constrained, 18, "full");
      test<3>(cube<3>(10), 1, full<3>(), is_constrained, 12, "full");
      test<3>(cube<3>(10), 2, full<3>(), is_constrained, 14, "full");
      test<3>(cube<3>(12), 2, ball<3>(12, 4., 5.3), is_constrained, 25, "ball");
    }
}
