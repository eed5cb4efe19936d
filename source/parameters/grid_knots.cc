// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <greville/parameters/section_parameters.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <regex>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// The largest number of cells in a direction.
    constexpr double largest_number = 1e6;

    const std::string too_many =
      "The parameters 'Grid/Knots' make more than a million cells in a "
      "direction.";

    const std::string form =
      "'0, 0.1, 0.3, 1' (edges of cells) or 'fine(0.2, 0.6, 0.01) ratio 1.4'";

    std::string
    name_of(const unsigned int d)
    {
      return "Grid/Knots " + std::string(1, "xyz"[d]);
    }



    /// A range of equal cells.
    struct FineRange
    {
      double       begin, end;
      unsigned int n_cells;

      double
      h() const
      {
        return (end - begin) / n_cells;
      }
    };



    /// The range between two fine ones, or a fine one and an end of the grid.
    /// The wanted size of cells,
    /// @f[ h(x) = \min(h_0 + (r - 1) (x - x_0), h_1 + (r - 1) (x_1 - x), H),
    /// @f] lets a cell be r times as large as the one before it. Edges divide
    /// the integral of 1 / h into equal parts.
    class GradedRange
    {
    public:
      GradedRange(const double begin,
                  const double end,
                  const double h_begin,
                  const double h_end,
                  const double ratio,
                  const double largest)
        : begin(begin)
        , end(end)
        , h_begin(std::min(h_begin, largest))
        , h_end(std::min(h_end, largest))
        , ratio(ratio)
        , largest(largest)
      {
        const double n = std::ceil(needed_cells(ratio) - 1e-6);
        Require(n <= largest_number, too_many);
        set_cells(std::max(1., n));
      }

      double
      smallest_wanted() const
      {
        return std::min(h_begin, h_end);
      }

      /// Return the number of cells that can be added without a cell smaller
      /// than wanted.
      unsigned int
      n_spare() const
      {
        const double n = std::floor((end - begin) / smallest_wanted() + 1e-6);
        return std::max(n - n_cells, 0.);
      }

      /// Use more cells than needed, with a smaller ratio.
      void
      set_cells(const unsigned int n)
      {
        n_cells    = n;
        double low = 1. + 1e-8, high = ratio;
        for (unsigned int k = 0; k < 50; ++k)
          {
            const double middle                     = 0.5 * (low + high);
            (needed_cells(middle) > n ? low : high) = middle;
          }
        needed_cells(high);
      }

      /// Append the edges behind the first one.
      void
      append_edges(std::vector<double> &edges) const
      {
        for (unsigned int k = 1; k < n_cells; ++k)
          edges.push_back(begin + distance(integral() * k / n_cells));
        edges.push_back(end);
      }

      double       begin, end;
      unsigned int n_cells = 0;

    private:
      struct Piece
      {
        double length, h, slope, integral;
      };

      /// Set the pieces in which h is linear, and return the number of cells
      /// that are required for a ratio of the sizes of neighbours.
      double
      needed_cells(const double ratio)
      {
        const double slope = ratio - 1.;
        // Places where both lines meet, and where each meets the largest size.
        const double top =
          std::clamp(0.5 * (begin + end + (h_end - h_begin) / slope),
                     begin,
                     end);
        const double left  = std::min(top, begin + (largest - h_begin) / slope),
                     right = std::max(top, end - (largest - h_end) / slope);
        pieces.clear();
        add(left - begin, h_begin, slope);
        add(right - left, h_begin + slope * (left - begin), 0.);
        add(end - right, h_end + slope * (end - right), -slope);
        return integral() * slope / std::log1p(slope);
      }

      void
      add(const double length, const double h, const double slope)
      {
        if (length > 0.)
          pieces.push_back({length,
                            h,
                            slope,
                            slope == 0.
                              ? length / h
                              : std::log1p(slope * length / h) / slope});
      }

      double
      integral() const
      {
        double sum = 0.;
        for (const Piece &piece : pieces)
          sum += piece.integral;
        return sum;
      }

      /// Return the distance from the start at which the integral of 1 / h
      /// reaches @p value.
      double
      distance(double value) const
      {
        double result = 0.;
        for (const Piece &piece : pieces)
          {
            const double part = std::min(value, piece.integral);
            result +=
              part == piece.integral ? piece.length
              : piece.slope == 0.
                ? part * piece.h
                : piece.h * std::expm1(piece.slope * part) / piece.slope;
            value -= part;
          }
        return result;
      }

      double             h_begin, h_end, ratio, largest;
      std::vector<Piece> pieces;
    };



    /// The text fine(BEGIN, END, SIZE) ... ratio R largest H.
    struct Grading
    {
      std::vector<FineRange> fine;
      double ratio = 0., largest = std::numeric_limits<double>::max();
    };



    Grading
    read_grading(const std::string &text,
                 const double       lower,
                 const double       upper,
                 const std::string &problem)
    {
      static const std::regex range(
        R"(^[\s,;]*fine\s*\(([^,()]+),([^,()]+),([^,()]+)\))"),
        word(R"(^[\s,;]*(ratio|largest)\s+([^\s,;]+))");
      const auto number = [&](const std::string &digits) {
        try
          {
            const double result = Utilities::string_to_double(digits);
            Require(std::isfinite(result), "");
            return result;
          }
        catch (const std::exception &)
          {
            throw ExcMessage(problem + "'" + digits +
                             "' is not a number: write " + form + ".");
          }
      };
      Grading     result;
      auto       &fine = result.fine;
      std::string rest = text;
      for (std::smatch match; !Utilities::trim(rest).empty();
           rest = match.suffix())
        if (std::regex_search(rest, match, range))
          {
            const double begin = number(match[1]), end = number(match[2]),
                         h = number(match[3]);
            Require(begin >= lower && begin < end && end <= upper && h > 0. &&
                      h <= end - begin && end - begin <= largest_number * h &&
                      (fine.empty() || fine.back().end <= begin),
                    problem + "a range fine(BEGIN, END, SIZE) has to lie in "
                              "the grid, behind the range before it, and hold "
                              "a cell of its size, and at most a million.");
            fine.push_back(
              {begin,
               end,
               static_cast<unsigned int>(std::ceil((end - begin) / h - 1e-6))});
          }
        else if (std::regex_search(rest, match, word))
          (match[1] == "ratio" ? result.ratio : result.largest) =
            number(match[2]);
        else
          throw ExcMessage(problem + "'" + Utilities::trim(rest) +
                           "' is not understood: write " + form + ".");
      double coarsest = 0.;
      for (const FineRange &own : fine)
        coarsest = std::max(coarsest, own.h());
      Require(!fine.empty() && result.ratio > 1. && result.largest >= coarsest,
              problem + "write " + form +
                ", with a ratio of neighbours above 1, and 'largest SIZE' for "
                "a limit that is not below these sizes.");
      return result;
    }



    /// Add cells to one of the ranges, so that their number is a multiple of 8,
    /// 4 or 2: cells are halved from coarse ones, of which each process keeps
    /// all.
    void
    round_cells(std::vector<GradedRange> &graded, const unsigned int n_cells)
    {
      const auto widest = std::max_element(graded.begin(),
                                           graded.end(),
                                           [](const auto &a, const auto &b) {
                                             return a.n_spare() < b.n_spare();
                                           });
      for (unsigned int multiple = n_cells > 16 ? 8 : 2;
           multiple > 1 && widest != graded.end();
           multiple /= 2)
        {
          const unsigned int added = (multiple - n_cells % multiple) % multiple;
          if (added > widest->n_spare())
            continue;
          if (added > 0)
            widest->set_cells(widest->n_cells + added);
          return;
        }
    }



    /// Return the ranges beside fine ones.
    std::vector<GradedRange>
    graded_ranges(const Grading     &grading,
                  const double       lower,
                  const double       upper,
                  const std::string &problem)
    {
      const auto              &fine = grading.fine;
      constexpr double         none = std::numeric_limits<double>::max();
      std::vector<GradedRange> graded;
      unsigned int             n_cells = 0;
      for (std::size_t k = 0; k <= fine.size(); ++k)
        {
          const double begin = k == 0 ? lower : fine[k - 1].end,
                       end   = k == fine.size() ? upper : fine[k].begin;
          if (end - begin > 1e-9 * (upper - lower))
            {
              graded.emplace_back(begin,
                                  end,
                                  k == 0 ? none : fine[k - 1].h(),
                                  k == fine.size() ? none : fine[k].h(),
                                  grading.ratio,
                                  std::min(grading.largest, upper - lower));
              Require(end - begin >=
                        graded.back().smallest_wanted() / grading.ratio,
                      problem + "beside a range of cells of " +
                        text_of(graded.back().smallest_wanted()) +
                        " m there are " + text_of(end - begin) +
                        " m left: end the range there.");
            }
          if (k < fine.size())
            n_cells += fine[k].n_cells;
        }
      for (const GradedRange &other : graded)
        n_cells += other.n_cells;
      Require(n_cells <= largest_number, too_many);
      round_cells(graded, n_cells);
      return graded;
    }



    std::vector<double>
    graded_edges(const std::string &text,
                 const double       lower,
                 const double       upper,
                 const std::string &problem)
    {
      const Grading grading = read_grading(text, lower, upper, problem);
      const std::vector<GradedRange> graded =
        graded_ranges(grading, lower, upper, problem);
      std::vector<double> edges{lower};
      auto                next     = graded.begin();
      const auto          grade_to = [&](const double x) {
        if (next != graded.end() && next->begin < x)
          (next++)->append_edges(edges);
      };
      for (const FineRange &own : grading.fine)
        {
          grade_to(own.begin);
          edges.back() = own.begin;
          for (unsigned int k = 1; k < own.n_cells; ++k)
            edges.push_back(own.begin + own.h() * k);
          edges.push_back(own.end);
        }
      grade_to(upper);
      edges.front() = lower;
      edges.back()  = upper;
      return edges;
    }
  } // namespace



  std::vector<double>
  GridParameters::edges(const unsigned int d) const
  {
    if (knots[d].empty())
      return {};
    const std::string problem =
      "The parameter '" + name_of(d) + "' is <" + knots[d] + ">: ";
    if (knots[d].find("fine") != std::string::npos)
      return graded_edges(knots[d], lower[d], upper[d], problem);
    std::vector<double> result;
    try
      {
        result =
          Utilities::string_to_double(Utilities::split_string_list(knots[d]));
      }
    catch (const std::exception &)
      {
        throw ExcMessage(problem + "write " + form + ".");
      }
    const double tolerance = 1e-9 * (upper[d] - lower[d]);
    Require(result.size() > 1 &&
              std::abs(result.front() - lower[d]) <= tolerance &&
              std::abs(result.back() - upper[d]) <= tolerance &&
              std::adjacent_find(result.begin(),
                                 result.end(),
                                 [tolerance](const double a, const double b) {
                                   return !(b - a > tolerance);
                                 }) == result.end(),
            problem + "edges of cells have to increase from " +
              text_of(lower[d]) + " to " + text_of(upper[d]) +
              ", the corners of the grid.");
    result.front() = lower[d];
    result.back()  = upper[d];
    return result;
  }



  void
  GridParameters::set_edges(const unsigned int         d,
                            const std::vector<double> &edges)
  {
    cells[d] = edges.size() - 1;
    knots[d].clear();
    for (const double edge : edges)
      {
        // The shortest text of the same number.
        char       text[32];
        const auto end = std::to_chars(text, text + sizeof(text), edge).ptr;
        knots[d] += (knots[d].empty() ? "" : ", ") + std::string(text, end);
      }
  }



  void
  GridParameters::check(const unsigned int dim) const
  {
    const auto needs = [&](const std::size_t size, const std::string &name) {
      Require(size == dim,
              "The parameter '" + name + "' takes " + std::to_string(dim) +
                " numbers in " + std::to_string(dim) +
                "D (see 'Simulation/Dimension'), not " + std::to_string(size) +
                ".");
    };
    needs(lower.size(), "Grid/Lower corner");
    needs(upper.size(), "Grid/Upper corner");
    needs(cells.size(), "Grid/Cells");
    for (unsigned int d = 0; d < dim; ++d)
      Require(lower[d] < upper[d],
              "'Grid/Upper corner' has to be larger than 'Grid/Lower corner' "
              "in all directions, but " +
                text_of(upper[d]) + " is not above " + text_of(lower[d]) + ".");
    for (unsigned int d = 0; d < dim; ++d)
      Require(cells[d] > 0 || !knots[d].empty(),
              "The parameter 'Grid/Cells' has 0 cells in " +
                std::string(1, "xyz"[d]) + ": only '" + name_of(d) +
                "' gives their number.");
    Require(dim == 3 || knots[2].empty(),
            "The parameter '" + name_of(2) + "' is <" + knots[2] +
              ">, and 'Simulation/Dimension' is 2: there is no direction z.");
  }



  void
  GridParameters::complete(const unsigned int dim, ParameterHandler &prm)
  {
    if (is_uniform())
      return;
    check(dim);
    for (unsigned int d = 0; d < cells.size(); ++d)
      {
        if (knots[d].empty())
          continue;
        const std::vector<double> given   = edges(d);
        const unsigned int        n_given = given.size() - 1;
        const unsigned int        n_parts = std::max(1u, cells[d] / n_given);
        Require(cells[d] == 0 ||
                  (cells[d] == n_parts * n_given && cells[d] <= largest_number),
                "The parameter 'Grid/Cells' has " + std::to_string(cells[d]) +
                  " cells in " + std::string(1, "xyz"[d]) + ", where '" +
                  name_of(d) + "' makes " + std::to_string(n_given) +
                  ": 0 takes these, and a multiple, at most a million, divides "
                  "each one.");
        std::vector<double> all;
        for (unsigned int k = 0; k < n_given; ++k)
          for (unsigned int part = 0; part < n_parts; ++part)
            all.push_back(given[k] +
                          (given[k + 1] - given[k]) * part / n_parts);
        all.push_back(given.back());
        set_edges(d, all);
      }
    set_parameter(prm, {"Grid"}, "Cells", Patterns::Tools::to_string(cells));
    for (unsigned int d = 0; d < dim; ++d)
      set_parameter(prm,
                    {"Grid"},
                    "Knots " + std::string(1, "xyz"[d]),
                    std::string(knots[d]));
  }
} // namespace greville
