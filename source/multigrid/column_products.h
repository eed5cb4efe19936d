// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/simd.h>
#include <greville/mass/extended_unknowns.h>

#include <array>

/// Operations with interleaved vectors of several columns. To be included in
/// sources.
namespace greville
{
  namespace internal
  {
    template <int width>
    using Columns = std::array<double, width>;

    /// Collective. Sum arrays of columns over the processes.
    template <typename Sums>
    void
    add_up(Sums &sums, const MPI_Comm comm)
    {
      if (dealii::Utilities::MPI::n_mpi_processes(comm) > 1)
        dealii::Utilities::MPI::sum(
          dealii::ArrayView<const double>(sums[0].data(),
                                          sums.size() * sums[0].size()),
          comm,
          dealii::ArrayView<double>(sums[0].data(),
                                    sums.size() * sums[0].size()));
    }



    // Scalar products of the vectors of an iteration.
    enum Dot
    {
      r_u,
      u_w,
      u_s,
      r_w,
      w_w,
      w_s,
      r_s,
      r_r,
      n_dots
    };

    // Interleaved vectors are processed as vectors of this size.
    constexpr unsigned int n_at_once = 16;
    using Floats                     = FixedSimd<float, n_at_once>;

    template <typename Number>
    inline void
    add_products(Number (&sums)[n_dots],
                 const Number &r,
                 const Number &u,
                 const Number &w,
                 const Number &s)
    {
      sums[r_u] += r * u;
      sums[u_w] += u * w;
      sums[u_s] += u * s;
      sums[r_w] += r * w;
      sums[w_w] += w * w;
      sums[w_s] += w * s;
      sums[r_s] += r * s;
      sums[r_r] += r * r;
    }



    template <int width>
    std::array<Columns<width>, n_dots>
    dots(const VectorOf<float> &r,
         const VectorOf<float> &u,
         const VectorOf<float> &w,
         const VectorOf<float> &s,
         const MPI_Comm         comm)
    {
      std::array<Columns<width>, n_dots> result{};

      const float *r_i = r.begin(), *u_i = u.begin(), *w_i = w.begin(),
                  *s_i    = s.begin();
      const std::size_t n = r.locally_owned_size();
      // Sums in single precision must have few terms.
      constexpr std::size_t block = 64 * n_at_once;
      std::size_t           i     = 0;
      while (i + n_at_once <= n)
        {
          const std::size_t end =
            std::min(i + block, n / n_at_once * n_at_once);
          Floats sums[n_dots];
          for (Floats &sum : sums)
            sum = 0.f;
          for (; i < end; i += n_at_once)
            add_products(sums,
                         load<Floats>(r_i + i),
                         load<Floats>(u_i + i),
                         load<Floats>(w_i + i),
                         load<Floats>(s_i + i));
          for (unsigned int k = 0; k < n_dots; ++k)
            for (unsigned int lane = 0; lane < n_at_once; ++lane)
              result[k][lane % width] += sums[k][lane];
        }
      for (; i < n; ++i)
        {
          double sums[n_dots] = {};
          add_products<double>(sums, r_i[i], u_i[i], w_i[i], s_i[i]);
          for (unsigned int k = 0; k < n_dots; ++k)
            result[k][i % width] += sums[k];
        }
      add_up(result, comm);
      return result;
    }



    /// p = u + beta p, s = w + beta s, x += alpha p, r -= alpha s.
    template <int width>
    void
    make_step(VectorOf<float>       &x,
              VectorOf<float>       &r,
              VectorOf<float>       &p,
              VectorOf<float>       &s,
              const VectorOf<float> &u,
              const VectorOf<float> &w,
              const Columns<width>  &alpha,
              const Columns<width>  &beta)
    {
      Floats alphas, betas;
      for (unsigned int lane = 0; lane < n_at_once; ++lane)
        {
          alphas[lane] = float(alpha[lane % width]);
          betas[lane]  = float(beta[lane % width]);
        }
      float *x_i = x.begin(), *r_i = r.begin(), *p_i = p.begin(),
            *s_i            = s.begin();
      const float      *u_i = u.begin(), *w_i = w.begin();
      const std::size_t n = r.locally_owned_size();
      std::size_t       i = 0;
      for (; i + n_at_once <= n; i += n_at_once)
        {
          const Floats new_p =
            load<Floats>(u_i + i) + betas * load<Floats>(p_i + i);
          const Floats new_s =
            load<Floats>(w_i + i) + betas * load<Floats>(s_i + i);
          store(new_p, p_i + i);
          store(new_s, s_i + i);
          store(load<Floats>(x_i + i) + alphas * new_p, x_i + i);
          store(load<Floats>(r_i + i) - alphas * new_s, r_i + i);
        }
      for (; i < n; ++i)
        {
          const unsigned int c = i % width;
          p_i[i]               = u_i[i] + float(beta[c]) * p_i[i];
          s_i[i]               = w_i[i] + float(beta[c]) * s_i[i];
          x_i[i] += float(alpha[c]) * p_i[i];
          r_i[i] -= float(alpha[c]) * s_i[i];
        }
    }
  } // namespace internal
} // namespace greville
