// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks that transfers preserve constants, the exact transfer preserves
// polynomials, "transpose" is the transpose, and all agree with assembled
// matrices.

#include <deal.II/lac/full_matrix.h>

#include <greville/multigrid/order_transfer.h>
#include <greville/paper/assembled_mass_level.h>
#include <greville/paper/paper_parts.h>

#include <density.h>

template <int dim>
void
test(const unsigned int p, const unsigned int q, const std::string &rho_name)
{
  Box<dim>                box(cube<dim>(6));
  const SplineSpace<dim>  coarse(box.mesh, q), fine(box.mesh, p);
  const auto              rho = density<dim>(rho_name);
  AssembledMassLevel<dim> coarse_level(coarse, *rho), fine_level(fine, *rho);
  coarse_level.assemble(false, false);
  fine_level.assemble(false, false);

  for (const auto &[weight, weight_name] : transfer_weights)
    for (const std::string prolongation : {"lumped-l2", "exact-l2"})
      {
        const std::string name = std::to_string(dim) + "D, " +
                                 std::to_string(q) + " to " +
                                 std::to_string(p) + ", " + rho_name + ", " +
                                 weight_name + ", " + prolongation;
        const std::vector<const LevelOperator<dim> *> levels{&coarse_level,
                                                             &fine_level};
        const OrderTransfer<dim>                      transposed(levels,
                                            prolongation,
                                            "transpose",
                                            weight);
        const OrderTransfer<dim>                      own(levels,
                                     prolongation,
                                     prolongation,
                                     weight);
        VectorType e = pseudo_random_vector(coarse), constant(e), r(e);
        VectorType f = pseudo_random_vector(fine), Ie(f), back(f);

        transposed.prolongate(1, Ie, e);
        r = 0.;
        transposed.restrict_and_add(1, r, f);
        check(name + ": transpose",
              std::abs(Ie * f - e * r) / (Ie.l2_norm() * f.l2_norm()),
              1e-13);

        // Twice the same adds up.
        back = Ie;
        transposed.prolongate_and_add(1, back, e);
        back.add(-2., Ie);
        check(name + ": prolongate and add", back.l2_norm(), 1e-12);

        // Constants go up and down unchanged where coefficients are active;
        // the scaled exact inverse keeps them for constant density only.
        if (prolongation == "lumped-l2" || rho_name == "constant")
          {
            constant = 1.;
            own.prolongate(1, Ie, constant);
            for (const unsigned int i : fine_level.inactive())
              Ie.local_element(i) += 1.;
            Ie.add(-1.);
            f = 1.;
            r = 0.;
            own.restrict_and_add(1, r, f);
            for (const unsigned int i : coarse_level.inactive())
              r.local_element(i) += 1.;
            r.add(-1.);
            check(name + ": constants",
                  std::max(Ie.linfty_norm(), r.linfty_norm()),
                  1e-11);
          }
        if (prolongation == "exact-l2" && rho_name == "constant")
          {
            // x is in both spaces.
            const auto greville = [](const SplineSpace<dim> &space,
                                     VectorType             &x) {
              for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
                x.local_element(i) = space.greville_point(i)[0];
            };
            greville(coarse, e);
            greville(fine, f);
            own.prolongate(1, Ie, e);
            check(name + ": keeps x", difference(Ie, f), 1e-11);
          }
      }

  // The lumped pair against matrices, on one process.
  if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
    {
      const CrossMassOperator<dim> cross(fine, coarse, fine_level.weights());
      const unsigned int           m = fine.n_dofs(), n = coarse.n_dofs();
      FullMatrix<double>           P(m, n);
      VectorType                   unit, column;
      coarse.initialize_vector(unit);
      fine.initialize_vector(column);
      for (unsigned int j = 0; j < n; ++j)
        {
          unit                  = 0.;
          unit.local_element(j) = 1.;
          cross.vmult(column, unit);
          for (unsigned int i = 0; i < m; ++i)
            P(i, j) = column.local_element(i);
        }
      const OrderTransfer<dim> transfer({&coarse_level, &fine_level},
                                        "lumped-l2",
                                        "lumped-l2",
                                        TransferWeight::density);
      const VectorType         e = pseudo_random_vector(coarse);
      const VectorType         f = pseudo_random_vector(fine);
      VectorType               up(f), down(e);
      transfer.prolongate(1, up, e);
      down = 0.;
      transfer.restrict_and_add(1, down, f);
      double error = 0;
      for (unsigned int i = 0; i < m; ++i)
        {
          double sum = 0, row = 0;
          for (unsigned int j = 0; j < n; ++j)
            {
              sum += P(i, j) * e.local_element(j);
              row += P(i, j);
            }
          error = std::max(error,
                           std::abs(up.local_element(i) -
                                    (row > 0 ? sum / row : 0.)));
        }
      for (unsigned int j = 0; j < n; ++j)
        {
          double sum = 0, row = 0;
          for (unsigned int i = 0; i < m; ++i)
            {
              sum += P(i, j) * f.local_element(i);
              row += P(i, j);
            }
          error = std::max(error,
                           std::abs(down.local_element(j) -
                                    (row > 0 ? sum / row : 0.)));
        }
      check("assembled", error, 1e-12);
    }
}



void
test_main()
{
  add_paper_parts();
  for (const std::string rho : {"constant", "smooth", "holes"})
    {
      test<2>(2, 1, rho);
      test<2>(3, 2, rho);
      test<2>(5, 3, rho);
      test<2>(5, 1, rho);
      test<3>(2, 1, rho);
    }
}
