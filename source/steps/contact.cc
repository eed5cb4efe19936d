// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/wall_friction.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // All contacts, one line each, in the order in which they act.
    template <int dim>
    std::vector<MakeContact<dim>> &
    contacts()
    {
      static std::vector<MakeContact<dim>> list = {WallFriction<dim>::make};
      return list;
    }
  } // namespace



  template <int dim>
  void
  add_contact(const MakeContact<dim> &make)
  {
    contacts<dim>().push_back(make);
  }



  template <int dim>
  std::vector<std::unique_ptr<Contact<dim>>>
  make_contacts(const IntegratorParts<dim> &parts)
  {
    std::vector<std::unique_ptr<Contact<dim>>> result;
    for (const MakeContact<dim> &make : contacts<dim>())
      if (auto contact = make(parts))
        result.push_back(std::move(contact));
    return result;
  }



  GREVILLE_INSTANTIATE(add_contact);
  GREVILLE_INSTANTIATE(make_contacts);
} // namespace greville
