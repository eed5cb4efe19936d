// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2
// All: 3 4

// Checks that the matrix-free and the assembled operator agree, are symmetric
// and do not depend on the number of processes. The sum of all entries is the
// mass, and the entries of the smallest case agree with a finer quadrature.

#include <greville/paper/assembled_mass_level.h>

#include <density.h>

template <int dim>
void
test(const MultiIndex<dim> &cells,
     const unsigned int     p,
     const std::string     &name)
{
  Box<dim>                  box(cells), own(cells, MPI_COMM_SELF);
  const SplineSpace<dim>    space(box.mesh, p), own_space(own.mesh, p);
  const auto                rho = density<dim>(name);
  const DensityWeights<dim> weights(space, p + 1, *rho);
  const DensityWeights<dim> own_weights(own_space, p + 1, *rho);
  const MassOperator<dim>   mass(space, weights);
  const MassOperator<dim>   own_mass(own_space, own_weights);
  AssembledMassLevel<dim>   level(space, weights);
  level.assemble(true, true);

  const VectorType x = pseudo_random_vector(space);
  VectorType       y(x), z(x);
  mass.vmult(y, x);
  level.vmult(z, x);
  double error = difference(y, z);
  // A second assembly gives the same matrix.
  level.assemble(true, true);
  level.vmult(z, x);
  error = std::max(error, difference(y, z));

  // Entry by entry against one process.
  VectorType own_x = pseudo_random_vector(own_space), own_y(own_x);
  own_mass.vmult(own_y, own_x);
  double other_processes = 0;
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    other_processes =
      std::max(other_processes,
               std::abs(y.local_element(i) -
                        own_y.local_element(space.owned_functions()[i])));
  other_processes = max_all(other_processes) / own_y.linfty_norm();

  const VectorType u = pseudo_random_vector(space);
  VectorType       v(u);
  for (unsigned int i = 0; i < v.locally_owned_size(); ++i)
    v.local_element(i) = std::cos(3. * u.local_element(i));
  VectorType Mv(v);
  mass.vmult(Mv, v);
  const double symmetry =
    std::abs(y * v - x * Mv) / (y.l2_norm() * v.l2_norm());

  const auto n_active =
    space.n_dofs() -
    Utilities::MPI::sum(mass.inactive().size(), MPI_COMM_WORLD);
  print() << dim << "D, p = " << p << ", " << name << ", cells "
          << box.mesh.n_global_active_cells() << ", active " << n_active
          << ", mass ";
  y = 1.;
  mass.cross_mass().vmult(z, y);
  print() << std::setprecision(10) << z * y << std::endl;
  VectorType sums(z);
  mass.cross_mass().row_sums(sums);
  check("  matrix-free and assembled", error, 1e-13);
  check("  other numbers of processes", other_processes, 1e-13);
  check("  symmetry, row sums", std::max(symmetry, difference(sums, z)), 1e-13);
}



// The cross matrix of two orders against the Kronecker product of 1D ones.
template <int dim>
void
test_cross(const unsigned int p, const unsigned int q)
{
  Box<dim>                     box(cube<dim>(3), MPI_COMM_SELF);
  const SplineSpace<dim>       fine(box.mesh, p), coarse(box.mesh, q);
  const DensityWeights<dim>    weights(fine,
                                    p + 1,
                                    Functions::ConstantFunction<dim>(2.));
  const CrossMassOperator<dim> cross(fine, coarse, weights);
  const VectorType             x = pseudo_random_vector(coarse);
  VectorType                   y, z;
  fine.initialize_vector(y);
  fine.initialize_vector(z);
  cross.vmult(y, x);
  std::array<BandedMatrix, dim> P;
  for (unsigned int d = 0; d < dim; ++d)
    P[d] = cross_matrix(fine.knots(d), coarse.knots(d));
  for (unsigned int i = 0; i < fine.n_dofs(); ++i)
    for (unsigned int j = 0; j < coarse.n_dofs(); ++j)
      {
        const auto a     = multi_index<dim>(i, fine.n_functions());
        const auto b     = multi_index<dim>(j, coarse.n_functions());
        double     entry = 2. * x.local_element(j);
        for (unsigned int d = 0; d < dim; ++d)
          entry *= P[d](a[d], b[d]);
        z.local_element(i) += entry;
      }
  VectorType back(x);
  cross.Tvmult(back, y);
  check(std::to_string(dim) + "D, cross matrix of orders " + std::to_string(p) +
          " and " + std::to_string(q),
        std::max(difference(y, z), std::abs(back * x - y * y) / (y * y)),
        1e-13);
}



void
test_main()
{
  for (const std::string name : {"constant", "smooth", "holes"})
    {
      for (unsigned int p = 1; p <= 5; ++p)
        {
          test<2>({{16, 12}}, p, name);
          test<2>({{5, 7}}, p, name);
        }
      for (unsigned int p = 1; p <= 3; ++p)
        test<3>({{4, 6, 4}}, p, name);
    }
  test<2>({{2, 1}}, 5, "constant");
  test<3>({{9, 2, 3}}, 4, "smooth");
  test<3>({{2, 2, 2}}, 5, "smooth");
  for (unsigned int p = 2; p <= 5; ++p)
    for (unsigned int q = 1; q < p; ++q)
      if (q == 1 || p - q <= 2)
        test_cross<2>(p, q);
  test_cross<3>(2, 1);
  test_cross<3>(3, 1);

  for (const std::string expression : {"x-0.5", "1/(x-x)", "0"})
    try
      {
        Box<2>                  box(MultiIndex<2>{{4, 4}});
        const SplineSpace<2>    space(box.mesh, 2);
        const DensityWeights<2> weights(space,
                                        3,
                                        *make_function<2>(expression, "rho"));
        MassOperator<2>(space, weights);
        print() << "accepted" << std::endl;
      }
    catch (const std::exception &error)
      {
        // The first point depends on the partition.
        print() << message_of(error).substr(0, 48) << std::endl;
      }
}
