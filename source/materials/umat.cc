// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/named_formulas.h>
#include <greville/base/shared_library.h>
#include <greville/materials/hencky.h>
#include <greville/materials/left_cauchy_green.h>
#include <greville/materials/material_lanes.h>
#include <greville/materials/parameter_checks.h>
#include <greville/materials/state_names.h>
#include <greville/materials/umat.h>
#include <greville/materials/umat_arguments.h>

#include <algorithm>
#include <cctype>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int cmname_length = 80, most_state_variables = 10000;

    // Positions in the history before STATEV, in the layout of History::more.
    constexpr unsigned int strain = 0, sse = 6, spd = 7, scd = 8, work = 9,
                           dissipated = 10, modulus = 11, n_fixed = 12;
    static_assert(n_fixed == History<double>::n_first, "");

    const auto fixed_names = Utilities::split_string_list(
      "stran_xx, stran_yy, stran_zz, stran_xy, stran_xz, stran_yz, "
      "energy_elastic, energy_plastic, energy_creep, energy_work, "
      "energy_dissipated, modulus");



    constexpr unsigned int
    entry_of(const unsigned int i, const unsigned int j)
    {
      return i == j ? i : 2 + i + j;
    }



    /// Compute R A R^T for the entries 11, 22, 33, 12, 13, 23 of A.
    void
    rotate(const Tensor<2, 3> &R, double *A)
    {
      double RA[3][3], result[6];
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          RA[i][j] = R[i][0] * A[entry_of(0, j)] + R[i][1] * A[entry_of(1, j)] +
                     R[i][2] * A[entry_of(2, j)];
      for (unsigned int k = 0; k < 6; ++k)
        result[k] = RA[entry_rows[k]][0] * R[entry_columns[k]][0] +
                    RA[entry_rows[k]][1] * R[entry_columns[k]][1] +
                    RA[entry_rows[k]][2] * R[entry_columns[k]][2];
      std::copy_n(result, 6, A);
    }



    /// Return sum_i a_i b_i of symmetric tensors.
    double
    product(const double *a, const double *b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] +
             2. * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
    }

  } // namespace



  struct Umat::Increment
  {
    Tensor<2, 3> rotation;
    double       strain[6]; // ln V
  };



  void *
  Umat::find_function(const std::string &library, const std::string &parameter)
  {
    return function_of_library(library, {"umat_", "umat"}, parameter);
  }



  void
  Umat::declare(ParameterHandler &prm)
  {
    Material::declare(prm);
    add_parameter(prm, "Library", law.library)(
      "Shared library with an Abaqus UMAT, relative to the folder of the "
      "parameter file. scripts/build_umat makes one from Fortran, C or C++.");
    add_parameter(prm, "Properties", properties)(
      "PROPS of the UMAT. Unit: as the UMAT expects; lengths in m, stresses in "
      "Pa.");
    add_parameter(prm, "State variables", state_variables)(
      "STATEV: names for the output, each with an optional unit in brackets, "
      "such as 'void_ratio, suction [Pa]'; or their number, which gives the "
      "names statev_1, statev_2, ...");
    add_formula(prm, "Initial state", initial_state)(
      "Initial STATEV: formulas of x, y and z (0 in plane strain), separated "
      "by semicolons; a single formula is for all of them. Empty: 0.");
    add_choice<bool>(prm,
                     "Tangent",
                     has_tangents_by_differences,
                     {{false, "ddsdde"}, {true, "differences"}})(
      "Tangent of implicit steps: ddsdde, converted to finite strain, or "
      "differences between calls (18 per tangent, in plane strain 8), for a "
      "UMAT with a poor DDSDDE. greville --check measures the error of "
      "DDSDDE.");
    add_parameter(prm, "Element length", element_length, positive())(
      "CELENT, for laws whose softening depends on a length. Unit: m.");
    add_parameter(prm, "Bulk modulus", bulk, Patterns::Double(0.))(
      "Elastic bulk modulus, for the first step and for waves; give it "
      "together with the shear modulus. 0: both from DDSDDE at zero stress. "
      "Unit: Pa.");
    add_parameter(prm, "Shear modulus", shear, Patterns::Double(0.))(
      "Elastic shear modulus. Unit: Pa.");
    add_parameter(prm, "Time limit", law.time_limit, Patterns::Double(0.))(
      "The program ends, with a message, if a call takes longer. 0: no limit. "
      "Unit: s.");
  }



  void
  Umat::reinit(const std::string &section)
  {
    law.section = section;
    Require(!law.library.empty(),
            "The parameter '" + section + "/Library' is empty: the law '" +
              name + "' needs a shared library with a UMAT.");
    function                = find_function(law.library, section + "/Library");
    std::string padded_name = section.substr(section.find(' ') + 1);
    for (char &c : padded_name)
      c = std::toupper((unsigned char)(c));
    padded_name.resize(cmname_length, ' ');

    names.clear();
    units.clear();
    const auto given = Utilities::split_string_list(state_variables, ',');
    const auto check_number = [&](const double n) {
      Require(n <= most_state_variables,
              "The parameter '" + section + "/State variables' has " +
                text_of(n) + " variables per point; at most " +
                std::to_string(most_state_variables) + " are allowed.");
    };
    check_number(double(given.size()));
    if (given.size() == 1 && !given[0].empty() &&
        given[0].find_first_not_of("0123456789") == std::string::npos)
      {
        check_number(std::stod(given[0].substr(0, 300)));
        for (int k = 1; k <= Utilities::string_to_int(given[0]); ++k)
          {
            names.push_back("statev_" + std::to_string(k));
            units.push_back("");
          }
      }
    else
      for (const std::string &text : given)
        {
          const std::size_t open  = text.find('[');
          const bool        has   = open != std::string::npos;
          const std::string state = Utilities::trim(text.substr(0, open));
          Require(
            is_state_name(state) && (!has || text.back() == ']'),
            "The parameter '" + section + "/State variables' has <" + text +
              ">; it has to be a name of letters, digits and _ with an "
              "optional unit in brackets, or the number of all variables.");
          Require(!is_taken_by_points(state) && !contains(fixed_names, state),
                  "The parameter '" + section +
                    "/State variables' has the name <" + state +
                    ">, but all points have a variable of this name.");
          names.push_back(state);
          units.push_back(
            has ? Utilities::trim(text.substr(open + 1, text.size() - open - 2))
                : "");
        }
    check_different(names, section + "/State variables", "name");
    memory.reinit(properties, padded_name, element_length, names.size());
    ForeignCall::catch_faults(law.time_limit);

    initial_formulas.clear();
    const std::string parameter = section + "/Initial state";
    const bool        is_same =
      formula_text(initial_state).find(';') == std::string::npos;
    if (!initial_state.empty())
      for (const std::string &formula :
           split_formulas(initial_state, parameter, is_same ? 1 : names.size()))
        initial_formulas.emplace_back(formula,
                                      parameter,
                                      coordinate_names<3>());

    Require(
      (bulk > 0.) == (shear > 0.),
      "'" + section +
        "' has one of 'Bulk modulus' and 'Shear modulus': give both or none.");
    if (bulk > 0.)
      return;
    MaterialPoint point;
    begin(point, SymmetricTensor<2, 3>());
    const Matrix C = stiffness(point);
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          bulk += C[i][j] / 9.;
        shear += C[3 + i][3 + i] / 3.;
      }
    const bool is_stiff =
      std::isfinite(bulk + shear) && bulk > 0. && shear >= 0.;
    Require(is_stiff,
            "The UMAT of '" + section +
              "/Library' has no stiffness without stress (DDSDDE gives K = " +
              text_of(bulk) + " Pa, G = " + text_of(shear) +
              " Pa): it needs 'Bulk modulus' and 'Shear modulus'.");
  }



  std::vector<std::string>
  Umat::state_names() const
  {
    std::vector<std::string> result = fixed_names;
    result.insert(result.end(), names.begin(), names.end());
    return result;
  }



  std::string
  Umat::state_unit(const std::string &state) const
  {
    const auto k = std::find(names.begin(), names.end(), state) - names.begin();
    return k < std::ptrdiff_t(names.size()) ? units[k] : "";
  }



  void
  Umat::begin(MaterialPoint &point, const SymmetricTensor<2, 3> &stress) const
  {
    point.F      = unit_symmetric_tensor<3>();
    point.J      = 1.;
    point.stress = stress;
    point.state  = History<double>{};
    point.state.resize(n_fixed + names.size());
    const ArrayView<const double> x(&point.position[0], 3);
    for (unsigned int k = 0; k < names.size() && !initial_formulas.empty(); ++k)
      point.state.more[k] =
        initial_formulas[initial_formulas.size() == 1 ? 0 : k](x);
  }



  void
  Umat::initialize(MaterialPoint               &point,
                   const SymmetricTensor<2, 3> &stress) const
  {
    begin(point, stress);
    const Matrix C = stiffness(point);
    for (unsigned int i = 0; i < 3; ++i)
      point.state[modulus] = std::max(point.state[modulus], C[i][i]);
    point.wave_modulus = std::max(bulk + 4. / 3. * shear, point.state[modulus]);
  }



  void
  Umat::decompose(const MaterialPoint *points,
                  const unsigned int   count,
                  Increment           *increments)
  {
    std::array<Lanes, 9> f;
    for (unsigned int i = 0; i < 9; ++i)
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        f[i][lane] = lane < count ? points[lane].increment[i / 3][i % 3]
                     : i % 4 == 0 ? 1.
                                  : 0.;
    const SpectralDecomposition<Lanes> spectrum(left_cauchy_green_less_one(f));
    const std::array<Lanes, 6>         strains =
      spectrum.assemble(logarithmic_strains(spectrum.values));
    std::array<Lanes, 3> inverse;
    for (unsigned int a = 0; a < 3; ++a)
      inverse[a] = 1. / sqrt(1. + spectrum.values[a]);
    const std::array<Lanes, 6> V = spectrum.assemble(inverse);
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        {
          const Lanes R = V[entry_of(i, 0)] * f[j] +
                          V[entry_of(i, 1)] * f[3 + j] +
                          V[entry_of(i, 2)] * f[6 + j];
          for (unsigned int lane = 0; lane < count; ++lane)
            increments[lane].rotation[i][j] = R[lane];
        }
    for (unsigned int k = 0; k < 6; ++k)
      for (unsigned int lane = 0; lane < count; ++lane)
        increments[lane].strain[k] = strains[k][lane];
  }



  void
  Umat::invoke(const MaterialPoint *point, double *first) const
  {
    using Function    = void (*)(GREVILLE_UMAT_ARGUMENTS);
    double *constants = memory[UmatMemory::constants];
    double *results   = memory[UmatMemory::results];
    std::fill_n(results, 2, 0.);
    results[2] = std::numeric_limits<float>::max(); // PNEWDT
    std::copy_n(first + sse, 3, results + 3);
    const UmatCall under_way(law, point, memory);
    try
      {
        reinterpret_cast<Function>(function)(memory[UmatMemory::stress],
                                             memory[UmatMemory::statev],
                                             memory[UmatMemory::ddsdde],
                                             results + 3,
                                             results + 4,
                                             results + 5,
                                             results,
                                             memory[UmatMemory::ddsddt],
                                             memory[UmatMemory::drplde],
                                             results + 1,
                                             memory[UmatMemory::stran],
                                             memory[UmatMemory::dstran],
                                             memory[UmatMemory::time],
                                             memory[UmatMemory::dtime],
                                             constants + 1,
                                             constants + 2,
                                             memory[UmatMemory::predef],
                                             memory[UmatMemory::dpred],
                                             memory.name(),
                                             memory.integer(0),
                                             memory.integer(1),
                                             memory.integer(2),
                                             memory.integer(3),
                                             memory[UmatMemory::props],
                                             memory.integer(4),
                                             memory[UmatMemory::coords],
                                             memory[UmatMemory::drot],
                                             results + 2,
                                             constants,
                                             memory[UmatMemory::dfgrd0],
                                             memory[UmatMemory::dfgrd1],
                                             memory.integer(5),
                                             memory.integer(6),
                                             memory.integer(7),
                                             memory.integer(8),
                                             memory.integer(10),
                                             memory.integer(9),
                                             cmname_length);
      }
    catch (const ExceptionBase &)
      {
        throw;
      }
    catch (const std::exception &error)
      {
        throw UmatFault(
          UmatCall::message(std::string("has thrown <") + error.what() + ">"));
      }
    catch (...)
      {
        throw UmatFault(UmatCall::message("has thrown an exception"));
      }
    AssertThrow(memory.is_intact(),
                UmatFault(UmatCall::message(memory.damage())));
    const double pnewdt = results[2];
    Require(!std::isnan(pnewdt), UmatCall::message("returns nan in PNEWDT"));
    Require(
      pnewdt >= 1.,
      UmatCall::message(
        "asks for a step of " + text_of(pnewdt) +
        " times this length (PNEWDT), which is " +
        text_of(*memory[UmatMemory::dtime]) +
        " s; for explicit steps, set a smaller 'Time/Step' or 'Time/Safety'"));
    if (!memory.is_finite())
      {
        const std::string bad = memory.not_finite();
        Require(bad.empty(), UmatCall::message("returns " + bad));
      }
    std::copy_n(results + 3, 3, first + sse);
  }



  void
  Umat::call(MaterialPoint   &point,
             const Increment &increment,
             Matrix          &C,
             const bool       has_increment) const
  {
    const unsigned int ntens = point.dim == 2 ? 4 : 6;
    memory.prepare(ntens);
    double *const stress = memory[UmatMemory::stress];
    double *const stran  = memory[UmatMemory::stran];
    double *const dstran = memory[UmatMemory::dstran];
    double *const ddsdde = memory[UmatMemory::ddsdde];
    double *const statev = memory[UmatMemory::statev];

    History<double> &state = point.state;
    double           before[6];
    for (unsigned int k = 0; k < 6; ++k)
      before[k] = point.stress.access_raw_entry(k);
    rotate(increment.rotation, before);
    rotate(increment.rotation, &state.first[strain]);
    for (unsigned int k = 0; k < ntens; ++k)
      {
        const double factor = k < 3 ? 1. : 2.;
        stress[k]           = before[k];
        stran[k]            = factor * state.first[strain + k];
        dstran[k]           = factor * increment.strain[k];
      }
    for (unsigned int k = 0; k < 6; ++k)
      state.first[strain + k] += increment.strain[k];
    std::fill_n(ddsdde, ntens * ntens, 0.);
    std::copy(state.more.begin(), state.more.end(), statev);
    // F_n = f^-1 F_(n+1); Fortran has columns first.
    const Tensor<2, 3> F0 = invert(point.increment) * point.F;
    const double       J0 = point.J / determinant(point.increment);
    for (unsigned int i = 0; i < 3; ++i)
      {
        memory[UmatMemory::coords][i] = point.position[i];
        for (unsigned int j = 0; j < 3; ++j)
          {
            const unsigned int k          = i + 3 * j;
            memory[UmatMemory::drot][k]   = increment.rotation[i][j];
            memory[UmatMemory::dfgrd0][k] = F0[i][j];
            memory[UmatMemory::dfgrd1][k] = point.F[i][j];
          }
      }
    const double begin = point.time - point.dt;
    std::fill_n(memory[UmatMemory::time], 2, begin);
    *memory[UmatMemory::dtime] = point.dt;
    memory.set_kinc(begin > 0. ? 2 : 1);
    const double heat = state.first[spd] + state.first[scd];
    invoke(has_increment ? &point : nullptr, state.first.data());

    std::copy_n(statev, state.more.size(), state.more.begin());
    for (unsigned int i = 0; i < ntens; ++i)
      {
        point.stress.access_raw_entry(i) = stress[i];
        before[i]                        = J0 * before[i] + point.J * stress[i];
        for (unsigned int j = 0; j < ntens; ++j)
          C[i][j] = ddsdde[i + ntens * j];
      }
    state.first[work] += 0.5 * product(before, increment.strain);
    state.first[dissipated] +=
      point.J * (state.first[spd] + state.first[scd] - heat);
    for (unsigned int i = 0; i < 3; ++i)
      state.first[modulus] = std::max(state.first[modulus], C[i][i]);
    point.wave_modulus = std::max(bulk + 4. / 3. * shear, state.first[modulus]);
  }



  Umat::Matrix
  Umat::stiffness(MaterialPoint point) const
  {
    // The length of a step without an increment is arbitrary.
    point.dt = point.time = 1.;
    point.increment       = unit_symmetric_tensor<3>();
    Increment none{};
    none.rotation = point.increment;
    Matrix C{};
    call(point, none, C, false);
    return C;
  }



  void
  Umat::update(const ArrayView<MaterialPoint> &points) const
  {
    Increment increments[n_lanes];
    Matrix    C{};
    for (std::size_t first = 0; first < points.size(); first += n_lanes)
      {
        MaterialPoint     *group = points.begin() + first;
        const unsigned int count =
          std::min<std::size_t>(n_lanes, points.size() - first);
        decompose(group, count, increments);
        for (unsigned int lane = 0; lane < count; ++lane)
          if (group[lane].J > 0.)
            call(group[lane], increments[lane], C);
          else
            group[lane].stress = std::numeric_limits<double>::quiet_NaN() *
                                 unit_symmetric_tensor<3>();
      }
  }



  void
  Umat::tangents(const ArrayView<const MaterialPoint> &points,
                 const ArrayView<MaterialTangent>     &result,
                 const unsigned int                    dim) const
  {
    if (has_tangents_by_differences)
      return Material::tangents(points, result, dim);
    AssertThrow(points.size() == result.size(),
                ExcDimensionMismatch(points.size(), result.size()));
    Increment     increment;
    MaterialPoint point;
    Matrix        C{};
    for (std::size_t p = 0; p < points.size(); ++p)
      {
        MaterialTangent &D = result[p];
        D                  = 0.;
        point              = points[p];
        decompose(&point, 1, &increment);
        if (!(point.J > 0.))
          {
            D[0][0][0][0] = std::numeric_limits<double>::quiet_NaN();
            continue;
          }
        call(point, increment, C);
        const SymmetricTensor<2, 3> &sigma = point.stress;
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            {
              for (unsigned int i = 0; i < 3; ++i)
                for (unsigned int j = 0; j < 3; ++j)
                  {
                    const unsigned int row = entry_of(i, j);
                    if (point.dim == 3 || row < 4)
                      D[i][j][k][l] = C[row][entry_of(k, l)];
                    if (k == l)
                      D[i][j][k][l] -= sigma[i][j];
                  }
              // The spin w = (l - l^T) / 2.
              for (unsigned int j = 0; j < 3; ++j)
                {
                  D[k][j][k][l] += 0.5 * sigma[l][j];
                  D[l][j][k][l] -= 0.5 * sigma[k][j];
                  D[j][l][k][l] -= 0.5 * sigma[j][k];
                  D[j][k][k][l] += 0.5 * sigma[j][l];
                }
            }
      }
  }



  double
  Umat::strain_energy(const MaterialPoint &point) const
  {
    const auto &state = point.state.first;
    return state[sse] != 0. ? point.J * state[sse]
                            : state[work] - state[dissipated];
  }



  double
  Umat::dissipation(const MaterialPoint &point) const
  {
    return point.state.first[dissipated];
  }
} // namespace greville
