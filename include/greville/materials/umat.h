// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/expression.h>
#include <greville/materials/lanes.h>
#include <greville/materials/material.h>
#include <greville/materials/umat_call.h>

namespace greville
{
  /**
   * A user-defined law in a shared library with an Abaqus UMAT (Abaqus User
   * Subroutines Reference, "UMAT"): the function umat_ (Fortran) or umat (C),
   * called by its binary interface.
   *
   * From the increment f = V R (its polar decomposition) and the stress
   * sigma_n, the law gets
   *   DROT = R, DSTRAN = ln V, STRESS = R sigma_n R^T,
   *   STRAN_(n+1) = R STRAN_n R^T + ln V,
   * so that the result is objective to round-off (Abaqus uses the integration
   * of Hughes and Winget, 1980, in place of R and V, which agrees up to the
   * cube of the increment); DFGRD1 = F_(n+1), DFGRD0 = F_n, TIME and DTIME,
   * COORDS, PROPS, STATEV. Order 11, 22, 33, 12, 13, 23 with engineering
   * shears; in plane strain NTENS = 4 (NDI = 3, NSHR = 1). TEMP, DTEMP, PREDEF
   * and DPRED are zero, NOEL, NPT, KSTEP and KINC one.
   *
   * DDSDDE is the derivative of the Jaumann rate of the Kirchhoff stress by the
   * rate of deformation d, over J. The derivative of the Cauchy stress by l = d
   * + w is therefore
   *   d sigma = DDSDDE : d - tr(d) sigma + w sigma - sigma w.
   * "Tangent" = differences uses finite differences of calls instead.
   *
   * F is 1 in the initial state, as in Abaqus, also under an initial stress; so
   * the density refers to the initial state. wave_modulus is the maximum of K +
   * 4 G / 3 of moduli() and of all D_11, D_22 and D_33 so far at the point,
   * since laws unload with a larger stiffness than their plastic tangent.
   *
   * The stored energy is J SSE if the law writes it, otherwise the stress work
   * (trapezoidal rule) less the dissipation. The dissipation is the sum of J
   * times the changes of SPD + SCD.
   *
   * Parameters: "Library", "Properties", "State variables", "Initial state",
   * "Tangent", "Element length" (CELENT, m), "Bulk modulus" and "Shear modulus"
   * (Pa), which are taken from DDSDDE in the stress-free state if they are
   * zero, and "Time limit" (s) of a call. State: STRAN, SSE, SPD, SCD, the
   * work, the dissipation and the largest modulus, then STATEV.
   *
   * update() throws dealii::ExcMessage if PNEWDT < 1 or if results are not
   * finite, and UmatFault if the UMAT throws or writes to memory that is not
   * its own. The process ends if the UMAT ends it, see UmatCall. reinit()
   * throws ExcMessage for a library without a UMAT, invalid names or formulas,
   * and a law without a stiffness.
   */
  class Umat : public Material
  {
  public:
    static constexpr const char *name = "umat";

    /// Return the UMAT of a library. Throws like function_of_library().
    static void *
    find_function(const std::string &library, const std::string &parameter);

    void
    declare(dealii::ParameterHandler &prm) override;

    void
    reinit(const std::string &section) override;

    std::vector<std::string>
    state_names() const override;

    std::string
    state_unit(const std::string &name) const override;

    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override;

    void
    update(const dealii::ArrayView<MaterialPoint> &points) const override;

    void
    tangents(const dealii::ArrayView<const MaterialPoint> &points,
             const dealii::ArrayView<MaterialTangent>     &result,
             const unsigned int                            dim) const override;

    double
    strain_energy(const MaterialPoint &point) const override;

    double
    dissipation(const MaterialPoint &point) const override;

    Moduli
    moduli() const override
    {
      return {bulk, shear};
    }

  private:
    /// Matrices by rows and columns, in the order of stress entries.
    using Matrix = std::array<std::array<double, 6>, 6>;

    struct Increment;

    /// Compute rotations and strains of @p count increments.
    static void
    decompose(const MaterialPoint *points,
              const unsigned int   count,
              Increment           *increments);

    /// Call the function with the arguments in the memory and check what it has
    /// written. @p first, the beginning of the history, receives SSE, SPD and
    /// SCD. The @p point is for messages; it is null without an increment.
    void
    invoke(const MaterialPoint *point, double *first) const;

    /// Call the UMAT once: compute stress, state and wave_modulus of @p point
    /// at the end of the step, and DDSDDE[i][j] = d sigma_i / d eps_j.
    void
    call(MaterialPoint   &point,
         const Increment &increment,
         Matrix          &C,
         const bool       has_increment = true) const;

    /// Set the state of a point at rest, without wave_modulus.
    void
    begin(MaterialPoint                       &point,
          const dealii::SymmetricTensor<2, 3> &stress) const;

    /// Return DDSDDE in the state of @p point, without an increment.
    Matrix
    stiffness(MaterialPoint point) const;

    std::vector<double>      properties;
    std::string              state_variables = "0";
    std::string              initial_state;
    bool                     has_tangents_by_differences = false;
    double                   element_length              = 1.;
    double                   bulk = 0., shear = 0.;
    void                    *function = nullptr;
    std::vector<std::string> names, units; // of STATEV
    std::vector<Expression>  initial_formulas;
    UmatCall::Law            law{"", "", 10.};
    // The arguments of the current call.
    mutable UmatMemory memory;
  };
} // namespace greville
