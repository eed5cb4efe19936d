#include <deal.II/lac/lapack_full_matrix.h>

#include <greville/simulation/critical_step.h>

#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    double
    dot(const VectorField<dim> &a, const VectorField<dim> &b)
    {
      double sum = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        sum += a[d] * b[d];
      return sum;
    }



    template <int dim>
    void
    scale_and_add(VectorField<dim>       &x,
                  const double            factor,
                  const double            a,
                  const VectorField<dim> &y)
    {
      for (unsigned int d = 0; d < dim; ++d)
        x[d].sadd(factor, a, y[d]);
    }



    /**
     * The largest eigenvalue of a symmetric tridiagonal matrix.
     */
    double
    largest_eigenvalue(const std::vector<double> &diagonal,
                       const std::vector<double> &side)
    {
      const unsigned int       n = diagonal.size();
      LAPACKFullMatrix<double> matrix(n, n);
      for (unsigned int i = 0; i < n; ++i)
        {
          matrix(i, i) = diagonal[i];
          if (i + 1 < n)
            matrix(i, i + 1) = matrix(i + 1, i) = side[i];
        }
      matrix.compute_eigenvalues();
      double largest = 0.;
      for (unsigned int i = 0; i < n; ++i)
        largest = std::max(largest, matrix.eigenvalue(i).real());
      return largest;
    }
  } // namespace



  template <int dim>
  double
  critical_step(GridMass<dim>                        &mass,
                PointTransfer<dim>                   &transfer,
                const std::vector<const Body<dim> *> &bodies,
                const Walls<dim>                     &walls,
                const std::string                    &stress_update,
                const unsigned int                    max_iterations)
  {
    const SplineSpace<dim> &space = mass.space();
    VectorField<dim>        q, M_q, M_q_old, K_q, w;
    for (auto *field : {&q, &M_q, &M_q_old, &K_q, &w})
      for (VectorType &component : *field)
        space.initialize_vector(component);

    // Held coefficients stay zero; M_q is a force and so arbitrary there.
    VectorField<dim> keep;
    const double     smallest_mass = mass.is_consistent() ? -1.
                                     : space.degree() == 1
                                       ? 0.01 * mass.lumped().linfty_norm()
                                       : 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        space.initialize_vector(keep[d]);
        for (unsigned int i = 0; i < keep[d].locally_owned_size(); ++i)
          keep[d].local_element(i) =
            mass.lumped().local_element(i) > smallest_mass;
        const Constraints held = walls.constraints(space, d);
        for (const auto &line : held.get_lines())
          keep[d](line.index) = 0.;
      }
    VectorField<dim> M_x, y;
    for (auto *field : {&M_x, &y})
      for (VectorType &component : *field)
        space.initialize_vector(component);
    const auto solve_mass = [&](VectorField<dim>       &x,
                                const VectorField<dim> &b) {
      for (VectorType &component : x)
        component = 0.;
      mass.solve({&x}, {&b});
      for (unsigned int d = 0; d < dim; ++d)
        x[d].scale(keep[d]);
    };
    const bool is_usl   = stress_update == "USL";
    const bool is_other = stress_update == "USF" || stress_update == "MUSL";
    const auto solve    = [&](VectorField<dim> &x, const VectorField<dim> &b) {
      solve_mass(x, b);
      if (mass.is_consistent() || !(is_usl || is_other))
        return;
      mass.multiply(M_x, x);
      solve_mass(y, M_x);
      for (unsigned int d = 0; d < dim; ++d)
        if (is_usl)
          x[d].sadd(2., -1., y[d]);
        else
          x[d] = y[d];
    };

    // Begin with a force that has all frequencies and does not depend on the
    // number of processes.
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
        {
          const double x =
            std::sin(12.9898 * (space.owned_functions()[i] % 100003) +
                     78.233 * d + 0.7) *
            43758.5453;
          M_q[d].local_element(i) = mass.lumped().local_element(i) *
                                    keep[d].local_element(i) *
                                    (2. * (x - std::floor(x)) - 1.);
        }
    solve(q, M_q);
    double norm = std::sqrt(dot<dim>(q, M_q));
    if (!(norm > 0.))
      return std::numeric_limits<double>::infinity();
    for (auto *field : {&q, &M_q})
      for (VectorType &component : *field)
        component /= norm;

    double viscous_time = 0.;
    for (const Body<dim> *body : bodies)
      {
        const Moduli moduli  = body->material->moduli();
        const double modulus = moduli.bulk + 4. / 3. * moduli.shear;
        if (modulus > 0.)
          viscous_time =
            std::max(viscous_time, 4. / 3. * moduli.viscosity / modulus);
      }

    std::vector<double> diagonal, side;
    double              eigenvalue = 0.;
    for (unsigned int k = 0; k < max_iterations; ++k)
      {
        bool first = true;
        for (const Body<dim> *body : bodies)
          {
            const Moduli moduli = body->material->moduli();
            if (!body->imposed_velocity.empty() ||
                !(moduli.bulk + 4. / 3. * moduli.shear > 0.))
              continue;
            transfer.add_stiffness(body->points,
                                   moduli.bulk - 2. / 3. * moduli.shear,
                                   moduli.shear,
                                   q,
                                   K_q,
                                   first);
            first = false;
          }
        if (first)
          return std::numeric_limits<double>::infinity();
        for (unsigned int d = 0; d < dim; ++d)
          K_q[d].scale(keep[d]);
        const double alpha = dot<dim>(q, K_q);
        diagonal.push_back(alpha);
        const double last = eigenvalue;
        eigenvalue        = largest_eigenvalue(diagonal, side);
        if (k > 3 && std::abs(eigenvalue - last) < 0.01 * eigenvalue)
          break;

        // M w = K q - alpha M q - beta M q_old
        scale_and_add<dim>(K_q, 1., -alpha, M_q);
        if (!side.empty())
          scale_and_add<dim>(K_q, 1., -side.back(), M_q_old);
        solve(w, K_q);
        const double beta = std::sqrt(std::max(0., dot<dim>(w, K_q)));
        if (!(beta > 1e-10 * std::max(eigenvalue, 1e-300)))
          break;
        side.push_back(beta);
        for (unsigned int d = 0; d < dim; ++d)
          {
            M_q_old[d] = M_q[d];
            M_q[d].equ(1. / beta, K_q[d]);
            q[d].equ(1. / beta, w[d]);
          }
      }
    if (!(eigenvalue > 0.))
      return std::numeric_limits<double>::infinity();
    const double omega = std::sqrt(eigenvalue);
    const double xi    = 0.5 * omega * viscous_time;
    return 2. / omega * (std::sqrt(1. + xi * xi) - xi);
  }



  template double
  critical_step<2>(GridMass<2> &,
                   PointTransfer<2> &,
                   const std::vector<const Body<2> *> &,
                   const Walls<2> &,
                   const std::string &,
                   const unsigned int);
  template double
  critical_step<3>(GridMass<3> &,
                   PointTransfer<3> &,
                   const std::vector<const Body<3> *> &,
                   const Walls<3> &,
                   const std::string &,
                   const unsigned int);
} // namespace greville
