// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks Bezier extraction to an ordinary deal.II field: the cell matrix
// against the spline's values, and a polynomial of order p, given by its
// blossom and recovered by deal.II's integration.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/numerics/data_out.h>
#include <deal.II/numerics/vector_tools.h>

#include <tests.h>

// (0.5 + x) to the power p in each direction.
template <int dim>
class Polynomial : public Function<dim>
{
public:
  explicit Polynomial(const unsigned int p)
    : p(p)
  {}

  double
  value(const Point<dim> &x, const unsigned int) const override
  {
    double product = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      product *= std::pow(0.5 + x[d], p);
    return product;
  }

  Tensor<1, dim>
  gradient(const Point<dim> &x, const unsigned int c) const override
  {
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = p * value(x, c) / (0.5 + x[d]);
    return result;
  }

private:
  const unsigned int p;
};



template <int dim>
void
test(const MultiIndex<dim> &cells, const unsigned int p)
{
  Box<dim>               box(cells);
  const SplineSpace<dim> space(box.mesh, p);

  // The blossom of (0.5 + x)^p is the product of 0.5 + u_k.
  VectorType x;
  space.initialize_vector(x);
  for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
    {
      const auto index =
        multi_index<dim>(space.owned_functions()[i], space.n_functions());
      double product = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 1; k <= p; ++k)
          product *= 0.5 + space.knots(d).knots()[index[d] + k];
      x.local_element(i) = product;
    }

  DoFHandler<dim> dof_handler(box.mesh);
  dof_handler.distribute_dofs(space.fe());
  const IndexSet relevant =
    DoFTools::extract_locally_relevant_dofs(dof_handler);
  VectorType field(dof_handler.locally_owned_dofs(), relevant, MPI_COMM_WORLD);
  space.extract(x, dof_handler, field);

  const Polynomial<dim> exact(p);
  const QGauss<dim>     quadrature(p + 1);
  Vector<double>        errors(box.mesh.n_active_cells());
  double                norms[2];
  for (const auto norm : {VectorTools::L2_norm, VectorTools::H1_seminorm})
    {
      VectorTools::integrate_difference(
        dof_handler, field, exact, errors, quadrature, norm);
      norms[norm == VectorTools::H1_seminorm] =
        VectorTools::compute_global_error(box.mesh, errors, norm);
    }
  const std::string name = std::to_string(dim) + "D, p = " + std::to_string(p);
  check(name + ", values", norms[0], 1e-11);
  check(name + ", gradients", norms[1], 1e-9);

  // The cell matrix gives the same Bernstein coefficients.
  double                               error = 0;
  std::vector<types::global_dof_index> dofs, bernstein_dofs;
  const auto                           order =
    dynamic_cast<const FE_Poly<dim> *>(&space.fe().base_element(0))
      ->get_poly_space_numbering();
  x.update_ghost_values();
  for (const auto &cell : dof_handler.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        const FullMatrix<double> C = space.extraction(cell);
        space.cell_dof_indices(cell, dofs);
        bernstein_dofs.resize(dofs.size());
        cell->get_dof_indices(bernstein_dofs);
        for (unsigned int b = 0; b < dofs.size(); ++b)
          {
            double sum = -field(bernstein_dofs[b]);
            for (unsigned int a = 0; a < dofs.size(); ++a)
              sum += C(a, order[b]) * x(dofs[a]);
            error = std::max(error, std::abs(sum));
          }
      }
  check(name + ", cell matrices", max_all(error), 1e-11);

  // DataOut takes the field as it is.
  DataOut<dim> data_out;
  data_out.attach_dof_handler(dof_handler);
  data_out.add_data_vector(field, "u");
  data_out.build_patches(p);
  std::ostringstream vtu;
  data_out.write_vtu(vtu);
  check(name + ", output", vtu.str().size() > 100);
}



void
test_main()
{
  for (unsigned int p = 1; p <= 5; ++p)
    test<2>({{4, 6}}, p);
  for (unsigned int p = 1; p <= 3; ++p)
    test<3>({{2, 3, 4}}, p);
}
