// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <greville/base/errors.h>

#include <algorithm>

/*
 * dealii::eigenvectors(). Distributions compile deal.II with g++, and clang has
 * another name for its symbol: with clang, the function below calls the same
 * functions of deal.II.
 */
#ifdef __clang__
namespace greville
{
  namespace internal
  {
    template <int dim>
    std::array<std::pair<double, dealii::Tensor<1, dim>>, dim>
    sorted_eigenvectors(const dealii::SymmetricTensor<2, dim>         &tensor,
                        const dealii::SymmetricTensorEigenvectorMethod method)
    {
      using Method      = dealii::SymmetricTensorEigenvectorMethod;
      namespace methods = dealii::internal::SymmetricTensorImplementation;
      Require(
        method != Method::hybrid,
        "The hybrid method of eigenvectors() is not available with clang.");
      auto result = method == Method::jacobi
                      ? methods::jacobi(tensor)
                      : methods::ql_implicit_shifts(tensor);
      std::sort(result.begin(),
                result.end(),
                methods::SortEigenValuesVectors<dim, double>());
      return result;
    }
  } // namespace internal
} // namespace greville

namespace dealii
{
  template <>
  inline std::array<std::pair<double, Tensor<1, 2>>, 2>
  eigenvectors(const SymmetricTensor<2, 2>           &tensor,
               const SymmetricTensorEigenvectorMethod method)
  {
    return greville::internal::sorted_eigenvectors(tensor, method);
  }

  template <>
  inline std::array<std::pair<double, Tensor<1, 3>>, 3>
  eigenvectors(const SymmetricTensor<2, 3>           &tensor,
               const SymmetricTensorEigenvectorMethod method)
  {
    return greville::internal::sorted_eigenvectors(tensor, method);
  }
} // namespace dealii
#endif
