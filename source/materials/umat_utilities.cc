// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/eigenvectors.h>
#include <greville/materials/lanes.h>
#include <greville/materials/umat_call.h>
#include <greville/materials/umat_utilities.h>

#include <cctype>
#include <cmath>
#include <iostream>
#include <set>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the position of component k, which counts the present components,
    /// among all six components.
    int
    component(const int k, const int ndi)
    {
      return k < ndi ? k : 3 + k - ndi;
    }



    SymmetricTensor<2, 3>
    tensor_of(const double *s, const int lstr, const int ndi, const int nshr)
    {
      SymmetricTensor<2, 3> result;
      for (int k = 0; k < ndi + nshr; ++k)
        {
          const int c = component(k, ndi);
          result[entry_rows[c]][entry_columns[c]] =
            c > 2 && lstr == 2 ? 0.5 * s[k] : s[k];
        }
      return result;
    }



    /// Return the text with its numbers and words inserted.
    std::string
    filled(const std::string &text,
           const int         *integers,
           const double      *numbers,
           const char        *words,
           const std::size_t  length)
    {
      std::string result;
      for (std::size_t i = 0; i < text.size(); ++i)
        {
          const char kind = text[i] == '%' && i + 1 < text.size()
                              ? std::toupper((unsigned char)(text[i + 1]))
                              : ' ';
          if (kind == 'I')
            result += std::to_string(*integers++);
          else if (kind == 'R')
            result += text_of(*numbers++);
          else if (kind == 'S')
            {
              result += Utilities::trim(std::string(words, length));
              words += length;
            }
          else
            {
              result += text[i];
              continue;
            }
          ++i;
        }
      return result;
    }
  } // namespace



  void
  sinv_(const double *stress,
        double       *sinv1,
        double       *sinv2,
        const int    *ndi,
        const int    *nshr)
  {
    const auto   s = tensor_of(stress, 1, *ndi, *nshr);
    const double q = std::sqrt(1.5) * deviator(s).norm();
    *sinv1         = trace(s) / 3.;
    *sinv2         = q;
  }



  void
  sprinc_(const double *s,
          double       *ps,
          const int    *lstr,
          const int    *ndi,
          const int    *nshr)
  {
    double directions[9];
    sprind_(s, ps, directions, lstr, ndi, nshr);
  }



  void
  sprind_(const double *s,
          double       *ps,
          double       *an,
          const int    *lstr,
          const int    *ndi,
          const int    *nshr)
  {
    const auto parts = eigenvectors(tensor_of(s, *lstr, *ndi, *nshr),
                                    SymmetricTensorEigenvectorMethod::jacobi);
    for (unsigned int k = 0; k < 3; ++k)
      {
        ps[k] = parts[k].first;
        for (unsigned int i = 0; i < 3; ++i)
          an[k + 3 * i] = parts[k].second[i];
      }
  }



  void
  rotsig_(const double *s,
          const double *r,
          double       *sprime,
          const int    *lstr,
          const int    *ndi,
          const int    *nshr)
  {
    const auto   S = tensor_of(s, *lstr, *ndi, *nshr);
    Tensor<2, 3> R;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        R[i][j] = r[i + 3 * j];
    const Tensor<2, 3> result = R * S * transpose(R);
    for (int k = 0; k < *ndi + *nshr; ++k)
      {
        const int c = component(k, *ndi);
        sprime[k]   = (c > 2 && *lstr == 2 ? 2. : 1.) *
                    result[entry_rows[c]][entry_columns[c]];
      }
  }



  void
  xit_()
  {
    Require(false, UmatCall::message("has called XIT"));
  }



  void
  stdb_abqerr_(const int        *lop,
               const char       *text,
               const int        *intv,
               const double     *realv,
               const char       *charv,
               const std::size_t text_length,
               const std::size_t charv_length)
  {
    const std::string format = Utilities::trim(std::string(text, text_length));
    const std::string message =
      "says: " + filled(format, intv, realv, charv, charv_length);
    Require(*lop > -2, UmatCall::message(message));
    static std::set<std::string> said;
    if (said.insert(format).second)
      std::cerr << (*lop < 0 ? "Warning: " : "Note: ") << UmatCall::caller()
                << ' ' << message << std::endl;
  }
} // namespace greville
