// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/run/comparison.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>

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
        formulas = {text,
                    "Exact solution/" + name,
                    dim == 2 ? std::vector<std::string>{"X", "Y", "t"}
                             : std::vector<std::string>{"X", "Y", "Z", "t"}};
    }



    /**
     * Errors of @p n numbers per point, which @p value gives.
     */
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
        body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          double arguments[dim + 1];
          for (unsigned int d = 0; d < dim; ++d)
            arguments[d] = p.reference(d);
          arguments[dim]  = t;
          const double V0 = p.volume0();
          Tensor<1, n> exact =
            formulas(ArrayView<const double>(arguments, dim + 1));
          const double u2 = exact.norm_square();
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
      // A formula can fail at a point of one process.
      run_on_all(
        [&]() {
          for (const Body<dim> &body : bodies)
            add(body);
        },
        comm);
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



  std::vector<std::vector<double>>
  read_columns(const std::string &name,
               const std::string &parameter,
               const unsigned int n_columns)
  {
    std::vector<std::vector<double>> result;
    read_csv(name, parameter, [&](const CsvLine &line) {
      if (line.is_header)
        return;
      AssertThrow(line.words.size() == n_columns,
                  ExcMessage(line.where + "<" + line.text + "> has not " +
                             std::to_string(n_columns) + " numbers."));
      result.emplace_back();
      for (unsigned int k = 0; k < n_columns; ++k)
        result.back().push_back(
          line.number(k, "column " + std::to_string(k + 1)));
    });
    return result;
  }



  template <int dim>
  MeasuredData<dim>::MeasuredData(const ReferenceParameters &parameters)
    : parameters(parameters)
  {
    if (!parameters.surface_file.empty())
      surface =
        read_columns(parameters.surface_file, "Reference/Surface file", 2);
    if (!parameters.failure_line_file.empty())
      {
        const std::string name = "Reference/Failure line file";
        failure_line = read_columns(parameters.failure_line_file, name, 2);
        AssertThrow(dim == 2,
                    ExcMessage("The parameter '" + name +
                               "' is for simulations in 2D."));
        bool is_line = failure_line.size() > 1;
        for (unsigned int k = 1; k < failure_line.size(); ++k)
          is_line = is_line && failure_line[k][0] > failure_line[k - 1][0];
        AssertThrow(is_line,
                    ExcMessage("<" + parameters.failure_line_file +
                               "> of the parameter '" + name +
                               "' needs two or more rows with growing x."));
      }
    if (!parameters.series_file.empty())
      {
        series =
          read_columns(parameters.series_file, "Reference/Series file", 2);
        const auto names = Statistics<dim>::names();
        const auto found =
          std::find(names.begin(), names.end(), parameters.series_quantity);
        AssertThrow(found != names.end(),
                    ExcMessage(
                      "The parameter 'Reference/Series quantity' is <" +
                      parameters.series_quantity + ">, none of " +
                      boost::algorithm::join(names, ", ") + "." +
                      did_you_mean(parameters.series_quantity, names)));
        quantity = found - names.begin();
      }
  }



  template <int dim>
  void
  MeasuredData<dim>::add(const Statistics<dim> &statistics)
  {
    if (series.empty())
      return;
    const double time = statistics.time;
    // Of the values between two neighbouring measured times those that are next
    // to these are enough, however many steps a run takes.
    const std::size_t n = times.size();
    if (n > 1)
      {
        const double before = times[n - 2];
        const bool   is_between =
          std::none_of(series.begin(), series.end(), [&](const auto &row) {
            return row[0] > before && row[0] <= time;
          });
        if (is_between)
          {
            times.pop_back();
            values.pop_back();
          }
      }
    times.push_back(time);
    values.push_back(statistics.values()[quantity]);
  }



  template <int dim>
  Distance
  MeasuredData<dim>::series_distance() const
  {
    Distance result;
    double   sum = 0.;
    for (const auto &row : series)
      {
        const auto next = std::lower_bound(times.begin(), times.end(), row[0]);
        if (next == times.end() || row[0] < times.front() || times.size() < 2)
          continue;
        const std::size_t k = std::max<std::size_t>(1, next - times.begin());
        const double      share =
          (row[0] - times[k - 1]) / (times[k] - times[k - 1]);
        const double value =
          values[k - 1] + share * (values[k] - values[k - 1]);
        const double distance = std::abs(value - row[1]);
        result.mean += distance;
        result.largest = std::max(result.largest, distance);
        result.relative += distance / std::abs(row[1]);
        sum += 1.;
        ++result.n;
      }
    if (result.n > 0)
      {
        result.mean /= sum;
        result.relative /= sum;
      }
    return result;
  }



  template <int dim>
  Distance
  MeasuredData<dim>::surface_distance(const BodyList<dim> &bodies,
                                      const double         h,
                                      const double         floor,
                                      const double         front_99,
                                      const MPI_Comm       comm) const
  {
    std::vector<double> heights(surface.size(), floor);
    for (const Body<dim> &body : bodies)
      {
        body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          const double x = p.position(0);
          const double y = p.position(1) + 0.5 * p.extent(body.points.layout());
          for (unsigned int k = 0; k < surface.size(); ++k)
            if (std::abs(x - surface[k][0]) <= 0.5 * h)
              heights[k] = std::max(heights[k], y);
        });
      }
    Utilities::MPI::max(heights, comm, heights);
    Distance result;
    double   sum = 0., measured_front = surface[0][0];
    for (unsigned int k = 0; k < surface.size(); ++k)
      {
        measured_front        = std::max(measured_front, surface[k][0]);
        const double distance = std::abs(heights[k] - surface[k][1]);
        result.mean += distance / surface.size();
        result.largest = std::max(result.largest, distance);
        sum += std::abs(surface[k][1]) / surface.size();
      }
    result.n        = surface.size();
    result.relative = result.mean / sum;
    result.front    = front_99 - measured_front;
    return result;
  }



  template <int dim>
  double
  MeasuredData<dim>::failure_line_distance(const BodyList<dim> &bodies,
                                           const MPI_Comm       comm) const
  {
    double length = 0., area = 0.;
    for (unsigned int k = 1; k < failure_line.size(); ++k)
      length += std::hypot(failure_line[k][0] - failure_line[k - 1][0],
                           failure_line[k][1] - failure_line[k - 1][1]);
    const auto is_wrong = [&](const ConstPointRef<dim> p) {
      const double x     = p.reference(0);
      const auto   right = std::upper_bound(failure_line.begin(),
                                          failure_line.end(),
                                          x,
                                          [](const double x, const auto &row) {
                                            return x < row[0];
                                          });
      if (right == failure_line.begin() || right == failure_line.end())
        return false;
      const auto   left = right - 1;
      const double part = (x - (*left)[0]) / ((*right)[0] - (*left)[0]);
      const double y    = (*left)[1] + part * ((*right)[1] - (*left)[1]);
      const bool   has_failed =
        p.position().distance(p.reference()) > parameters.failure_displacement;
      return (p.reference(1) > y) != has_failed;
    };
    for (const Body<dim> &body : bodies)
      body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
        if (is_wrong(p))
          area += p.volume0() / body.points.layout().thickness(p.reference());
      });
    return Utilities::MPI::sum(area, comm) / length;
  }



  template class ExactSolution<2>;
  template class ExactSolution<3>;
  template class MeasuredData<2>;
  template class MeasuredData<3>;
} // namespace greville
