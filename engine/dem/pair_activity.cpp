// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "engine/dem/pair_contacts.hpp"

namespace grouser {

// Grains that sleep are lit when they have a slot with one that is awake; a pack is watched when
// forces on a grain of it may be wanted.
void PairContacts::watch(const std::vector<Particle>& particles,
                         const std::vector<std::uint32_t>& struck, bool is_new,
                         Activity& activity) {
  if (needs_slots()) refresh(particles);
  if (!has_new_slots_ && !is_new && !activity.has_changed()) return;
  has_new_slots_ = false;
  activity.light_alone(particles);
  for (const std::uint32_t grain : struck) activity.light(grain);
  threads_.split(blocks_.size(), [&](std::size_t first, std::size_t last, std::size_t) {
    for (std::size_t b = first; b < last; ++b)
      for (std::size_t slot = 0; slot < blocks_[b].slots.size(); ++slot) {
        const std::uint32_t lower = blocks_[b].slots.lower(slot);
        const std::uint32_t higher = blocks_[b].slots.higher(slot);
        if (activity.is_asleep(lower) == activity.is_asleep(higher)) continue;
        activity.light(activity.is_asleep(lower) ? lower : higher);
      }
  });
  lights_.resize(plan_.chunks.size());
  watched_.resize(plan_.chunks.size());
  threads_.split(lights_.size(), [&](std::size_t first, std::size_t last, std::size_t) {
    for (std::size_t c = first; c < last; ++c) watch_chunk(c, activity);
  });
}

void PairContacts::watch_chunk(std::size_t chunk, const Activity& activity) {
  const Block& block = blocks_[chunk / kChunksOfBlock];
  std::vector<WatchedPack>& watched = watched_[chunk];
  watched.clear();
  bool has_sleeper = false;
  bool is_lit = false;
  for (std::size_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, owned_); ++i) {
    has_sleeper |= activity.is_asleep(i);
    is_lit |= activity.is_lit(i);
  }
  for (std::size_t slot = first_slot(chunk); slot < last_slot(chunk); slot += PairSlots::kLanes) {
    WatchedPack pack{static_cast<std::uint32_t>(slot), 0, false};
    bool is_wanted = false;
    for (std::size_t lane = 0; lane < PairSlots::kLanes; ++lane) {
      const std::uint32_t a = block.slots.lower(slot + lane);
      const std::uint32_t b = block.slots.higher(slot + lane);
      const bool sleeps = activity.is_asleep(a) && activity.is_asleep(b);
      has_sleeper |= activity.is_asleep(a) || activity.is_asleep(b);
      pack.is_awake |= !sleeps;
      is_wanted |= activity.is_lit(a) || activity.is_lit(b);
      if (sleeps) pack.frozen = static_cast<std::uint8_t>(pack.frozen | 1u << lane);
    }
    if (is_wanted) watched.push_back(pack);
  }
  is_lit |= !watched.empty();
  lights_[chunk] = !is_lit ? Light::kDark : has_sleeper ? Light::kMixed : Light::kBright;
}

}  // namespace grouser
