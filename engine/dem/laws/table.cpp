// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/laws/table.hpp"

#include <utility>

namespace grouser {
namespace {

// Calls `make` for each alternative and keeps the one whose name fits.
template <class Variant, class Make, std::size_t... kIndex>
Variant choose(const std::string& name, const Make& make, std::index_sequence<kIndex...>) {
  Variant chosen = make.template operator()<std::variant_alternative_t<0, Variant>>();
  ((name == std::variant_alternative_t<kIndex, Variant>::kName
        ? void(chosen = make.template operator()<std::variant_alternative_t<kIndex, Variant>>())
        : void()),
   ...);
  return chosen;
}

}  // namespace

ContactLaw make_contact_law(const std::string& name, const Solid& a, const Solid& b,
                            const Surface& surface) {
  return choose<ContactLaw>(
      name, [&]<class Law>() { return Law::from_parameters(a, b, surface); },
      std::make_index_sequence<std::variant_size_v<ContactLaw>>());
}

RollingLaw make_rolling_law(const std::string& name, const Surface& surface) {
  return choose<RollingLaw>(
      name, [&]<class Law>() { return Law::from_parameters(surface); },
      std::make_index_sequence<std::variant_size_v<RollingLaw>>());
}

}  // namespace grouser
