// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/precondition.h>

#include <greville/base/errors.h>
#include <greville/linear_algebra/petsc_preconditioner.h>
#include <greville/multigrid/schwarz.h>
#include <greville/multigrid/smoother.h>
#include <greville/multigrid/tensor_product_solver.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace greville
{
  using namespace dealii;

  void
  SmootherParameters::declare(ParameterHandler &prm)
  {
    declare_for_operators(prm);
    prm.add_parameter("Drop tolerance",
                      drop_tolerance,
                      "ilut: entries below this fraction of the norm of their "
                      "row are dropped. Unit: none.",
                      Patterns::Double(0., 1.));
    prm.add_parameter("Fill factor",
                      fill_factor,
                      "ilut: entries kept in a row of L and of U, as a "
                      "multiple of those of the matrix. Unit: none.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Reuse",
      reuse,
      "cg-ic0 in simulations: a factorization serves following steps, too, "
      "until the iterations that they need more than the first solve add up to "
      "this number, or more unknowns than that have come and gone. 0: each "
      "step factorizes. Unit: iterations.",
      Patterns::Integer(0));
    prm.add_parameter(
      "Overlap",
      overlap,
      "ilut, ilu0, ic0: overlap of the domains of processes, in "
      "layers of the matrix's graph (p coefficients each). In simulations with "
      "'Solver/Method' = cg-ic0 it has no effect. Unit: "
      "layers.",
      Patterns::Integer(0, 10));
    prm.add_parameter("Ordering",
                      ordering,
                      "ilut, ilu0, ic0: order of the unknowns of a process. "
                      "All but lexicographic are orderings of PETSc.",
                      Patterns::Selection("lexicographic|rcm|amd|nd|qmd|1wd"));
    prm.add_parameter("Combination",
                      combination,
                      "ilut, ilu0, ic0: how overlapping corrections "
                      "are put together; automatic is symmetric in a symmetric "
                      "cycle (restriction = transpose), else restricted.",
                      Patterns::Selection("automatic|restricted|symmetric"));
  }



  void
  SmootherParameters::declare_for_operators(ParameterHandler &prm)
  {
    prm.add_parameter("Shift",
                      shift,
                      "ilu0, ic0: added to the diagonal of the scaled matrix "
                      "(which is 1) before the factorization. (ic0 raises "
                      "pivots that fail all the same, and shifts by up to 4e-3 "
                      "where its factors are nearly singular.) Unit: none.",
                      Patterns::Double(0.));
    prm.add_parameter(
      "Damping",
      damping,
      "jacobi: the factor omega in units of 1 / lambda_max(D^-1 M), which is "
      "estimated; below 2 for convergence. Unit: none.",
      Patterns::Double(0.));
    prm.add_parameter("Chebyshev degree",
                      chebyshev_degree,
                      "chebyshev, chebyshev-ic0 and chebyshev-component-ic0: "
                      "degree of the polynomial. Unit: none.",
                      Patterns::Integer(1, 100));
    prm.add_parameter(
      "Chebyshev range",
      chebyshev_range,
      "The same: eigenvalues of D^-1 M (with the IC(0) in place of D) between "
      "lambda_max / range and lambda_max are smoothed. Unit: "
      "none.",
      Patterns::Double(1.));
    prm.add_parameter(
      "PETSc options",
      petsc_options,
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
        AssertThrow(is_option || !is_value,
                    ExcMessage("The parameter 'Smoother/PETSc options' is <" +
                               petsc_options + ">, in which <" + word +
                               "> is neither an option, which begins with a "
                               "dash, nor the value of one."));
        is_value = !is_option;
      }
    AssertThrow(n > 0,
                ExcMessage("The parameter 'Smoother/PETSc options' is empty; "
                           "it takes options like -pc_type bjacobi."));
  }



  namespace
  {
    /**
     * omega D^-1 with omega = damping / lambda_max(D^-1 M).
     */
    template <int dim>
    class JacobiSmoother : public DiagonalPreconditioner
    {
    public:
      JacobiSmoother(const LevelOperator<dim> &level, const double damping)
        : DiagonalPreconditioner(level.diagonal())
      {
        // Some power steps. The start is a function of the position only, so
        // that the estimate does not depend on the number of processes.
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
            y.scale(inverse_diagonal);
            lambda = y.l2_norm() / x.l2_norm();
            x.equ(1. / y.l2_norm(), y);
          }
        inverse_diagonal *= damping / lambda;
      }
    };



    /**
     * The inverse of the diagonal.
     */
    template <int dim>
    std::shared_ptr<Preconditioner>
    make_diagonal(const LevelOperator<dim> &level)
    {
      return std::make_shared<DiagonalPreconditioner>(level.diagonal());
    }



    /**
     * Factorizations of the components or one for all of them: those of the
     * level, or IC(0) of its matrix, which stands for all.
     */
    template <int dim>
    std::unique_ptr<Preconditioner>
    make_factorization(const SmootherParameters &p,
                       const LevelOperator<dim> &level,
                       const bool                symmetric,
                       const bool                by_components = false);



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
        // All processes have the same norms, and stop where one is NaN.
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
      /**
       * A level in the form that deal.II's class wants.
       */
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



    /**
     * Forward, and backward as its transpose; process by process.
     */
    class GaussSeidelSmoother : public Preconditioner
    {
    public:
      GaussSeidelSmoother(const Mat matrix)
        : forward(matrix, "-pc_type sor -pc_sor_local_forward")
        , backward(matrix, "-pc_type sor -pc_sor_local_backward")
      {}

      void
      vmult(VectorType &dst, const VectorType &src) const override
      {
        forward.vmult(dst, src);
      }

      void
      Tvmult(VectorType &dst, const VectorType &src) const override
      {
        backward.vmult(dst, src);
      }

    private:
      PetscPreconditioner forward, backward;
    };



    /**
     * A smoother of one component for each of several.
     */
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



    /**
     * Additive Schwarz with make(matrix, parameters).
     */
    template <int dim>
    MakeSmoother<dim>
    schwarz_with(
      const std::function<LocalSolver(const Mat, const SmootherParameters &)>
        &make)
    {
      return [make](const SmootherParameters &p,
                    const LevelOperator<dim> &level,
                    const bool                symmetric) {
        const bool is_symmetric = p.combination == "symmetric" ||
                                  (p.combination == "automatic" && symmetric);
        return std::make_unique<AdditiveSchwarz<dim>>(
          level, p.overlap, is_symmetric, p.ordering, [&](const Mat matrix) {
            return make(matrix, p);
          });
      };
    }



    template <int dim>
    std::unique_ptr<Preconditioner>
    make_factorization(const SmootherParameters &p,
                       const LevelOperator<dim> &level,
                       const bool                symmetric,
                       const bool                by_components)
    {
      if (auto factorization = level.factorization(p.shift, by_components))
        return factorization;
      auto one =
        schwarz_with<dim>([](const Mat m, const SmootherParameters &q) {
          return make_ic0(m, q.shift);
        })(p, level, symmetric);
      if (level.n_components() == 1)
        return one;
      return std::make_unique<SmootherByComponents<dim>>(std::move(one), level);
    }



    template <int dim>
    struct Entry
    {
      std::string       name;
      bool              needs_matrix;
      bool              by_components;
      MakeSmoother<dim> make;
    };



    /**
     * The list of smoothers. A new one is a line here.
     */
    template <int dim>
    std::vector<Entry<dim>> &
    smoothers()
    {
      using P         = const SmootherParameters &;
      using L         = const LevelOperator<dim> &;
      const auto ilut = [](const Mat m, P p) {
        return make_ilut(m, p.drop_tolerance, p.fill_factor);
      };
      const auto ilu0 = [](const Mat m, P p) { return make_ilu0(m, p.shift); };
      const auto ic0  = [](P p, L level, const bool symmetric) {
        return make_factorization<dim>(p, level, symmetric);
      };
      const auto jacobi = [](P p, L level, const bool) {
        return std::make_unique<JacobiSmoother<dim>>(level, p.damping);
      };
      const auto gauss_seidel = [](P, L level, const bool) {
        return std::make_unique<GaussSeidelSmoother>(level.matrix());
      };
      const auto symmetric_gauss_seidel = [](P, L level, const bool) {
        return std::make_unique<PetscPreconditioner>(
          level.matrix(), "-pc_type sor -pc_sor_local_symmetric");
      };
      const auto chebyshev = [](P p, L level, const bool) {
        return std::make_unique<ChebyshevSmoother<dim>>(
          level, p, make_diagonal<dim>(level));
      };
      const auto chebyshev_ic0 = [](P p, L level, const bool symmetric) {
        return std::make_unique<ChebyshevSmoother<dim>>(
          level, p, make_factorization<dim>(p, level, symmetric));
      };
      const auto chebyshev_component_ic0 =
        [](P p, L level, const bool symmetric) {
          return std::make_unique<ChebyshevSmoother<dim>>(
            level, p, make_factorization<dim>(p, level, symmetric, true));
        };
      const auto tensor_product = [](P, L level, const bool) {
        return std::make_unique<TensorProductPreconditioner<dim>>(
          level.space(), level.diagonal(), level.inactive());
      };
      const auto petsc =
        [](P p, L level, const bool) -> std::unique_ptr<Preconditioner> {
        if (auto whole = level.petsc_preconditioner(p.petsc_options))
          return whole;
        return std::make_unique<PetscPreconditioner>(level.matrix(),
                                                     p.petsc_options);
      };
      static std::vector<Entry<dim>> list = {
        {"ilut", true, true, schwarz_with<dim>(ilut)},
        {"ilu0", true, true, schwarz_with<dim>(ilu0)},
        {"ic0", true, false, ic0},
        {"jacobi", false, false, jacobi},
        {"gauss-seidel", true, true, gauss_seidel},
        {"symmetric-gauss-seidel", true, true, symmetric_gauss_seidel},
        {"chebyshev", false, false, chebyshev},
        {"chebyshev-ic0", true, false, chebyshev_ic0},
        {"chebyshev-component-ic0", true, false, chebyshev_component_ic0},
        {"tensor-product", false, true, tensor_product},
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
      AssertThrow(found != list.end(),
                  ExcMessage("The smoother <" + name + "> is none of " +
                             smoother_names() + "."));
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
    smoothers<dim>().push_back({name, needs_matrix, by_components, make});
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
  make_smoother(const std::string        &name,
                const SmootherParameters &parameters,
                const LevelOperator<dim> &level,
                const bool                symmetric)
  {
    const Entry<dim> &entry    = find_smoother<dim>(name);
    auto              smoother = entry.make(parameters, level, symmetric);
    if (level.n_components() == 1 || !entry.by_components)
      return smoother;
    return std::make_unique<SmootherByComponents<dim>>(std::move(smoother),
                                                       level);
  }



#define INSTANTIATE(dim)                                                            \
  template void                            add_smoother(const std::string &,        \
                                                        const bool,                 \
                                                        const bool,                 \
                                                        const MakeSmoother<dim> &); \
  template std::unique_ptr<Preconditioner> make_smoother<dim>(                      \
    const std::string &,                                                            \
    const SmootherParameters &,                                                     \
    const LevelOperator<dim> &,                                                     \
    const bool)
  INSTANTIATE(2);
  INSTANTIATE(3);
} // namespace greville
