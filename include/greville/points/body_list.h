// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/points/body.h>

#include <boost/iterator/indirect_iterator.hpp>
#include <vector>

namespace greville
{
  /// A read-only list of bodies from one or several vectors, to which it
  /// refers.
  template <int dim>
  class BodyList
  {
  public:
    BodyList() = default;

    /// Convert a vector of bodies implicitly to a list of all its bodies.
    BodyList(const std::vector<Body<dim>> &bodies)
    {
      add(bodies);
    }

    void
    add(const std::vector<Body<dim>> &bodies)
    {
      for (const Body<dim> &body : bodies)
        add(body);
    }

    void
    add(const Body<dim> &body)
    {
      pointers.push_back(&body);
    }

    /// Replace the bodies that have the same names as the @p others.
    void
    put(const std::vector<Body<dim>> &others)
    {
      for (const Body<dim> *&pointer : pointers)
        for (const Body<dim> &other : others)
          if (other.name == pointer->name)
            pointer = &other;
    }

    std::size_t
    size() const
    {
      return pointers.size();
    }

    const Body<dim> &
    operator[](const std::size_t b) const
    {
      return *pointers[b];
    }

    auto
    begin() const
    {
      return boost::make_indirect_iterator(pointers.begin());
    }

    auto
    end() const
    {
      return boost::make_indirect_iterator(pointers.end());
    }

  private:
    std::vector<const Body<dim> *> pointers;
  };
} // namespace greville
