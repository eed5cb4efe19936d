// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/precondition.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/multigrid/smoother.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace greville
{
  using namespace dealii;

  void
  SmootherParameters::declare(ParameterHandler &prm)
  {
    add_parameter(prm, "Shift", shift, Patterns::Double(0.))(
      "Of incomplete factorizations: added to the diagonal of the scaled "
      "matrix (which is 1) before the factorization. (ic0 raises pivots that "
      "fail all the same, and shifts by up to 4e-3 where its factors are "
      "nearly singular; the smallest shift of ict is 0.01 for orders 1 and 2, "
      "0.003 for 3, 1e-4 for 4 and 3e-5 for 5.) Unit: none.");
    add_parameter(prm,
                  "Chebyshev degree",
                  chebyshev_degree,
                  Patterns::Integer(1, 100))(
      "chebyshev, chebyshev-ic0 and chebyshev-component-ic0: degree of the "
      "polynomial. Unit: none.");
    add_parameter(prm,
                  "Chebyshev range",
                  chebyshev_range,
                  Patterns::Double(1.))(
      "The same: eigenvalues of D^-1 M (with the IC(0) in place of D) between "
      "lambda_max / range and lambda_max are smoothed. Unit: none.");
    add_parameter(prm, "PETSc options", petsc_options)(
      "petsc: the preconditioner, in PETSc's options without prefix.");
  }



  void
  SmootherParameters::check() const
  {
    std::istringstream words(petsc_options);
    std::string        word;
    bool               is_value = true; // of the option before
    unsigned int       n        = 0;
    for (; words >> word; ++n)
      {
        const bool is_option =
          word.size() > 1 && word[0] == '-' &&
          std::isalpha(static_cast<unsigned char>(word[1]));
        Require(is_option || !is_value,
                "The parameter 'Smoother/PETSc options' is <" + petsc_options +
                  ">, in which <" + word +
                  "> is neither an option, which begins with a dash, nor the "
                  "value of one.");
        is_value = !is_option;
      }
    Require(n > 0,
            "The parameter 'Smoother/PETSc options' is empty; it takes options "
            "like -pc_type bjacobi.");
  }



  namespace
  {
    /// Return the largest eigenvalue of B A for a level A, from below, by power
    /// iterations. apply(y) computes y = B y.
    template <int dim, typename Apply>
    double
    largest_eigenvalue_with(const LevelOperator<dim> &level, const Apply &apply)
    {
      // The start is a function of the position, so that the estimate does not
      // depend on the number of processes.
      VectorType x, y;
      initialize_vector(x, level);
      initialize_vector(y, level);
      const auto        &positions = level.space().owned_functions();
      const unsigned int n         = level.n_components();
      for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
        x.local_element(i) =
          1. + 0.5 * std::sin(12.9898 * (positions[i / n] % 104729) + i % n);
      double lambda = 1.;
      for (unsigned int step = 0; step < 15; ++step)
        {
          level.vmult(y, x);
          apply(y);
          lambda = y.l2_norm() / x.l2_norm();
          x.equ(1. / y.l2_norm(), y);
        }
      return lambda;
    }



    /// omega D^-1 with omega = damping / lambda_max(D^-1 M).
    template <int dim>
    class JacobiSmoother : public DiagonalPreconditioner
    {
    public:
      JacobiSmoother(const LevelOperator<dim> &level, const double damping)
        : DiagonalPreconditioner(level.diagonal())
      {
        inverse_diagonal *=
          damping / largest_eigenvalue_with(level, [&](VectorType &y) {
            y.scale(inverse_diagonal);
          });
      }
    };



    /// A factorization B, scaled on several processes: B A may have eigenvalues
    /// above 2 where domains overlap, but two smoothing steps, 2 B - B A B,
    /// must be positive definite.
    template <int dim>
    class ScaledFactorization : public Preconditioner
    {
    public:
      ScaledFactorization(const LevelOperator<dim>             &level,
                          std::unique_ptr<const Preconditioner> given)
        : factorization(std::move(given))
      {
        constexpr double largest = 1.7;
        if (Utilities::MPI::n_mpi_processes(level.space().communicator()) > 1)
          scale = std::min(1.,
                           largest /
                             largest_eigenvalue_with(level, [&](VectorType &y) {
                               VectorType z(y);
                               factorization->vmult(y, z);
                             }));
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        factorization->vmult(dst, src);
        if (scale < 1.)
          dst *= scale;
      }

    private:
      std::unique_ptr<const Preconditioner> factorization;
      double                                scale = 1.;
    };



    /// Return the inverse of the diagonal.
    template <int dim>
    std::shared_ptr<Preconditioner>
    make_diagonal(const LevelOperator<dim> &level)
    {
      return std::make_shared<DiagonalPreconditioner>(level.diagonal());
    }



    template <int dim>
    class ChebyshevSmoother : public Preconditioner
    {
    public:
      ChebyshevSmoother(const LevelOperator<dim>              &level,
                        const SmootherParameters              &parameters,
                        const std::shared_ptr<Preconditioner> &inner)
        : matrix(level)
      {
        typename Chebyshev::AdditionalData data;
        data.degree              = parameters.chebyshev_degree;
        data.smoothing_range     = parameters.chebyshev_range;
        data.eig_cg_n_iterations = 15;
        data.preconditioner      = inner;
        chebyshev.initialize(matrix, data);
        VectorType vector;
        initialize_vector(vector, level);
        // The norms are equal on all processes, so all stop if one is NaN.
        try
          {
            chebyshev.estimate_eigenvalues(vector);
          }
        catch (const SolverControl::NoConvergence &)
          {
            AssertThrow(false,
                        ErrorOnAll("the eigenvalues of the smoother are "
                                   "infinite or NaN"));
          }
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        chebyshev.vmult(dst, src);
      }

    private:
      /// An adapter of a level to deal.II's class.
      struct Matrix : public Observable
      {
        Matrix(const LevelOperator<dim> &level)
          : level(level)
        {}

        void
        vmult(VectorType &dst, const VectorType &src) const
        {
          level.vmult_in_cycle(dst, src);
        }

        const LevelOperator<dim> &level;
      };

      using Chebyshev =
        PreconditionChebyshev<Matrix, VectorType, Preconditioner>;
      Matrix    matrix;
      Chebyshev chebyshev;
    };



    /// A smoother of one component, applied to each of several components.
    template <int dim>
    class SmootherByComponents : public Preconditioner
    {
    public:
      SmootherByComponents(std::unique_ptr<Preconditioner> smoother,
                           const LevelOperator<dim>       &level)
        : smoother(std::move(smoother))
        , n_components(level.n_components())
      {
        level.space().initialize_vector(to);
        level.space().initialize_vector(from);
      }

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        apply(dst, src, &Preconditioner::vmult);
      }

      void
      Tvmult(VectorType &dst, const VectorType &src) const override
      {
        apply(dst, src, &Preconditioner::Tvmult);
      }

    private:
      void
      apply(VectorType       &dst,
            const VectorType &src,
            void (Preconditioner::*action)(VectorType &, const VectorType &)
              const) const
      {
        apply_by_components(n_components,
                            dst,
                            src,
                            to,
                            from,
                            [&](VectorType       &y,
                                const VectorType &x,
                                const unsigned int) {
                              (*smoother.*action)(y, x);
                            });
      }

      const std::unique_ptr<Preconditioner> smoother;
      const unsigned int                    n_components;
      mutable VectorType                    to, from;
    };



    template <int dim>
    struct Entry
    {
      std::string       name;
      bool              needs_matrix;
      bool              by_components;
      MakeSmoother<dim> make;
    };



    /// The list of smoothers, one line each.
    template <int dim>
    std::vector<Entry<dim>> &
    smoothers()
    {
      using P                       = const SmootherParameters &;
      using L                       = const LevelOperator<dim> &;
      const auto factorization_with = [](L                         level,
                                         const CholeskyParameters &parameters) {
        auto factorization = make_factorization(level, parameters);
        Require(factorization,
                "The parameter 'Smoother' needs a factorization, which this "
                "operator does not provide: take chebyshev or jacobi.");
        return factorization;
      };
      const auto ict = [=](P p, L level, const bool) {
        CholeskyParameters parameters = ict_parameters(level.space().degree());
        parameters.shift              = std::max(parameters.shift, p.shift);
        return factorization_with(level, parameters);
      };
      const auto ic0 = [=](P p, L level, const bool) {
        return factorization_with(level, {p.shift, 0.});
      };
      const auto jacobi = [](P p, L level, const bool) {
        return std::make_unique<JacobiSmoother<dim>>(level, p.damping);
      };
      const auto chebyshev = [](P p, L level, const bool) {
        return std::make_unique<ChebyshevSmoother<dim>>(
          level, p, make_diagonal<dim>(level));
      };
      // Chebyshev's method has its own estimate of eigenvalues.
      const auto chebyshev_with = [](P          p,
                                     L          level,
                                     const bool symmetric,
                                     const bool by_components) {
        auto factorization = level.factorization({p.shift, 0.}, by_components);
        if (!factorization)
          factorization = make_smoother<dim>("ic0", p, level, symmetric);
        return std::make_unique<ChebyshevSmoother<dim>>(
          level, p, std::move(factorization));
      };
      const auto chebyshev_ic0 = [=](P p, L level, const bool symmetric) {
        return chebyshev_with(p, level, symmetric, false);
      };
      const auto chebyshev_component_ic0 =
        [=](P p, L level, const bool symmetric) {
          return chebyshev_with(p, level, symmetric, true);
        };
      const auto petsc =
        [](P p, L level, const bool) -> std::unique_ptr<Preconditioner> {
        if (auto whole = level.petsc_preconditioner(p.petsc_options))
          return whole;
        return std::make_unique<PetscPreconditioner>(level.matrix(),
                                                     p.petsc_options);
      };
      static std::vector<Entry<dim>> list = {
        {"ict", false, false, ict},
        {"ic0", true, false, ic0},
        {"jacobi", false, false, jacobi},
        {"chebyshev", false, false, chebyshev},
        {"chebyshev-ic0", true, false, chebyshev_ic0},
        {"chebyshev-component-ic0", true, false, chebyshev_component_ic0},
        {"petsc", true, false, petsc}};
      return list;
    }



    template <int dim>
    const Entry<dim> &
    find_smoother(const std::string &name)
    {
      const auto &list = smoothers<dim>();
      const auto  found =
        std::find_if(list.begin(), list.end(), [&](const Entry<dim> &entry) {
          return entry.name == name;
        });
      Require(found != list.end(),
              "The smoother <" + name + "> is none of " + smoother_names() +
                ".");
      return *found;
    }
  } // namespace



  template <int dim>
  void
  add_smoother(const std::string       &name,
               const bool               needs_matrix,
               const bool               by_components,
               const MakeSmoother<dim> &make)
  {
    auto      &list = smoothers<dim>();
    const auto same =
      std::find_if(list.begin(), list.end(), [&](const Entry<dim> &entry) {
        return entry.name == name;
      });
    const Entry<dim> entry{name, needs_matrix, by_components, make};
    if (same == list.end())
      list.push_back(entry);
    else
      *same = entry;
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  make_by_components(std::unique_ptr<Preconditioner> smoother,
                     const LevelOperator<dim>       &level)
  {
    if (level.n_components() == 1)
      return smoother;
    return std::make_unique<SmootherByComponents<dim>>(std::move(smoother),
                                                       level);
  }



  std::string
  smoother_names()
  {
    std::string names;
    for (const auto &entry : smoothers<2>())
      names += (names.empty() ? "" : "|") + entry.name;
    return names;
  }



  bool
  smoother_needs_matrix(const std::string &name)
  {
    return find_smoother<2>(name).needs_matrix;
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  make_factorization(const LevelOperator<dim> &level,
                     const CholeskyParameters &parameters)
  {
    auto factorization = level.factorization(parameters, false);
    if (!factorization)
      return nullptr;
    return std::make_unique<ScaledFactorization<dim>>(level,
                                                      std::move(factorization));
  }



  template <int dim>
  std::unique_ptr<Preconditioner>
  make_smoother(const std::string        &name,
                const SmootherParameters &parameters,
                const LevelOperator<dim> &level,
                const bool                symmetric)
  {
    const Entry<dim> &entry    = find_smoother<dim>(name);
    auto              smoother = entry.make(parameters, level, symmetric);
    return entry.by_components
             ? make_by_components<dim>(std::move(smoother), level)
             : std::move(smoother);
  }



  GREVILLE_INSTANTIATE(add_smoother);
  GREVILLE_INSTANTIATE(make_by_components);
  GREVILLE_INSTANTIATE(make_factorization);
  GREVILLE_INSTANTIATE(make_smoother);
} // namespace greville
