// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "engine/coupling/laws/abraham.hpp"
#include "engine/coupling/laws/added_mass.hpp"
#include "engine/coupling/laws/beetstra.hpp"
#include "engine/coupling/laws/brown_lawler.hpp"
#include "engine/coupling/laws/dallavalle.hpp"
#include "engine/coupling/laws/di_felice.hpp"
#include "engine/coupling/laws/gidaspow.hpp"
#include "engine/coupling/laws/history.hpp"
#include "engine/coupling/laws/koch_hill.hpp"
#include "engine/coupling/laws/lubrication.hpp"
#include "engine/coupling/laws/schiller_naumann.hpp"
#include "engine/coupling/laws/shear_lift.hpp"
#include "engine/coupling/laws/spin.hpp"
#include "engine/coupling/laws/stokes.hpp"
#include "engine/coupling/laws/wall.hpp"

namespace grouser {

/// The laws a case can name. A new law is one file and one word in its list here, and one word in
/// base/fluid_case.cpp; tests that walk the lists cover it.
using DragLaw = std::variant<SchillerNaumannDrag, StokesDrag, DallaValleDrag, BrownLawlerDrag,
                             AbrahamDrag, DiFeliceDrag, DiFeliceBrownLawlerDrag, GidaspowDrag,
                             WenYuDrag, KochHillDrag, BeetstraDrag>;
using AddedMassLaw = std::variant<SphereAddedMass, ZuberAddedMass>;
using HistoryLaw = std::variant<BassetHistory, MeiAdrianHistory>;
using ShearLiftLaw = std::variant<SaffmanMeiLift, SaffmanLift>;
using SpinLiftLaw = std::variant<RubinowKellerLift, OesterleLift>;
using SpinDragLaw = std::variant<KirchhoffSpinDrag, DennisSpinDrag>;
using LubricationLaw = std::variant<BrennerLubrication, LeadingLubrication>;
using WallLaw = std::variant<NoWall, FaxenWall, HabermanSayreWall, DiFeliceWall>;

/// The law of a list called `name`; the first when the name is unknown, which the case reader has
/// already refused. Local.
template <class List>
List law_named(const std::string& name) {
  List chosen;
  const auto look = [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
    ((name == std::variant_alternative_t<kIndex, List>::kName
          ? void(chosen.template emplace<kIndex>())
          : void()),
     ...);
  };
  look(std::make_index_sequence<std::variant_size_v<List>>());
  return chosen;
}

}  // namespace grouser
