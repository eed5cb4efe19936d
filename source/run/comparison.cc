// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/comparison.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <filesystem>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim, int n>
    void
    read(VectorExpression<n> &formulas,
         const std::string   &text,
         const std::string   &name)
    {
      if (!text.empty())
        formulas = {text, "Exact solution/" + name, variables_of<dim>("Xt")};
    }



    /// Return the errors of @p n values per point, which @p value returns.
    template <int dim, int n, typename Value>
    std::optional<Errors>
    errors_of(const VectorExpression<n> &formulas,
              const BodyList<dim>       &bodies,
              const double               t,
              const MPI_Comm             comm,
              const Value               &value)
    {
      if (formulas.is_zero())
        return {};
      double error = 0., norm = 0., volume = 0., max_error = 0., max_norm = 0.;
      const auto add = [&](const Body<dim> &body) {
        body.points.for_each([&](ConstPointRef<dim> p) {
          const double V0    = p.volume0();
          Tensor<1, n> exact = formulas(p.reference(), t);
          const double u2    = exact.norm_square();
          for (unsigned int k = 0; k < n; ++k)
            exact[k] -= value(p, k);
          const double e2 = exact.norm_square();
          error += V0 * e2;
          norm += V0 * u2;
          volume += V0;
          max_error = std::max(max_error, e2);
          max_norm  = std::max(max_norm, u2);
        });
      };
      // A formula can fail on one process only.
      run_on_all(comm, [&]() {
        for (const Body<dim> &body : bodies)
          add(body);
      });
      error               = Utilities::MPI::sum(error, comm);
      norm                = Utilities::MPI::sum(norm, comm);
      volume              = Utilities::MPI::sum(volume, comm);
      max_error           = Utilities::MPI::max(max_error, comm);
      max_norm            = Utilities::MPI::max(max_norm, comm);
      const bool relative = max_norm > 0.;
      return Errors{std::sqrt(error / (relative ? norm : volume)),
                    std::sqrt(relative ? max_error / max_norm : max_error)};
    }
  } // namespace



  template <int dim>
  ExactSolution<dim>::ExactSolution(const ExactParameters &parameters)
  {
    read<dim>(displacement, parameters.displacement, "Displacement");
    read<dim>(velocity, parameters.velocity, "Velocity");
    read<dim>(stress, parameters.stress, "Stress");
  }



  template <int dim>
  ExactErrors
  ExactSolution<dim>::errors(const BodyList<dim> &bodies,
                             const double         t,
                             const double         t_velocity,
                             const MPI_Comm       comm) const
  {
    using Ref    = const ConstPointRef<dim>;
    const auto u = [](Ref p, const unsigned int d) {
      return p.position(d) - p.reference(d);
    };
    const auto v = [](Ref p, const unsigned int d) { return p.velocity(d); };
    const auto s = [](Ref p, const unsigned int k) { return p.stress(k); };
    return {errors_of<dim>(displacement, bodies, t, comm, u),
            errors_of<dim>(velocity, bodies, t_velocity, comm, v),
            errors_of<dim>(stress, bodies, t, comm, s)};
  }



  template <int dim>
  void
  check_reference(const ReferenceParameters &parameters)
  {
    for (const auto &[file, name] :
         {std::pair(parameters.surface_file, "Surface file"),
          std::pair(parameters.failure_line_file, "Failure line file"),
          std::pair(parameters.series_file, "Series file")})
      {
        std::error_code error;
        Require(file.empty() || std::filesystem::exists(file, error),
                "There is no file <" + file + "> of the parameter 'Reference/" +
                  name + "'.");
      }
    Require(
      dim == 2 || parameters.failure_line_file.empty(),
      "The parameter 'Reference/Failure line file' is for simulations in 2D.");
    const auto names = Statistics<dim>::names();
    if (!parameters.series_file.empty())
      check_known(parameters.series_quantity,
                  "Reference/Series quantity",
                  names,
                  boost::algorithm::join(names, ", "));
  }



  GREVILLE_INSTANTIATE_CLASS(ExactSolution);
  GREVILLE_INSTANTIATE(check_reference);
} // namespace greville
