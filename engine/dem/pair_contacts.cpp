// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_contacts.hpp"

#include <algorithm>
#include <limits>

#include "base/check.hpp"
#include "engine/dem/cell_grid.hpp"
#include "engine/dem/history_view.hpp"

namespace grouser {
namespace {

bool touching_within(const Particle& a, const Particle& b, double reach) {
  const double sum = a.radius + b.radius + reach;
  return norm2(a.position - b.position) < sum * sum;
}

}  // namespace

PairContacts::PairContacts(ContactLaw law, RollingLaw rolling)
    : law_(law), rolling_(rolling), history_width_(history_width(law, rolling)) {}

void PairContacts::set_laws(ContactLaw law, RollingLaw rolling) {
  GROUSER_CHECK(law.index() == law_.index() && rolling.index() == rolling_.index());
  law_ = law;
  rolling_ = rolling;
}

void PairContacts::build(const std::vector<Particle>& particles, std::size_t owned, double skin,
                         const ContactRecords& records) {
  GROUSER_CHECK(particles.size() < std::numeric_limits<std::uint32_t>::max());
  owned_ = owned;
  list_pairs(particles, skin);
  take_histories(particles, records);
  order_by_partner(particles);
}

void PairContacts::list_pairs(const std::vector<Particle>& particles, double skin) {
  start_.assign(1, 0);
  partner_.clear();
  if (particles.empty()) return;
  Vec3 low = particles[0].position;
  Vec3 high = low;
  double radius = 0.0;
  for (const Particle& p : particles) {
    low = {std::min(low.x, p.position.x), std::min(low.y, p.position.y),
           std::min(low.z, p.position.z)};
    high = {std::max(high.x, p.position.x), std::max(high.y, p.position.y),
            std::max(high.z, p.position.z)};
    radius = std::max(radius, p.radius);
  }
  const CellGrid grid(low, high, 2.0 * radius + skin, 2 * particles.size() + 64);
  std::vector<std::uint32_t> first(grid.cells() + 1, 0);
  std::vector<std::uint32_t> cell(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    cell[i] = static_cast<std::uint32_t>(grid.index(grid.cell_of(particles[i].position)));
    ++first[cell[i] + 1];
  }
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  std::vector<std::uint32_t> members(particles.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < particles.size(); ++i)
    members[next[cell[i]]++] = static_cast<std::uint32_t>(i);

  for (std::size_t i = 0; i < owned_; ++i) {
    const std::array<int, 3> at = grid.cell_of(particles[i].position);
    const int z_low = std::max(at[2] - 1, 0);
    const int z_high = std::min(at[2] + 1, grid.count(2) - 1);
    for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, grid.count(0) - 1); ++x)
      for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, grid.count(1) - 1); ++y) {
        // Cells along z follow one another, so their members do too.
        const std::uint32_t from = first[grid.index({x, y, z_low})];
        const std::uint32_t to = first[grid.index({x, y, z_high}) + 1];
        for (std::uint32_t m = from; m < to; ++m) {
          const std::uint32_t j = members[m];
          if (j > i && touching_within(particles[i], particles[j], skin)) partner_.push_back(j);
        }
      }
    start_.push_back(static_cast<std::uint32_t>(partner_.size()));
  }
  GROUSER_CHECK(partner_.size() < std::numeric_limits<std::int32_t>::max());
}

void PairContacts::take_histories(const std::vector<Particle>& particles,
                                  const ContactRecords& records) {
  GROUSER_CHECK(records.particles() == owned_ && records.value_width() == history_width_);
  history_.assign(partner_.size() * history_width_, 0.0);
  output_of_.assign(partner_.size(), -1);
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k)
      for (std::size_t r = records.begin(i); r < records.end(i); ++r) {
        if (records.names(r)[0] != particles[partner_[k]].id) continue;
        std::copy_n(records.values(r), history_width_, &history_[k * history_width_]);
        output_of_[k] = 0;  // has touched; the next sweep sets the true place
        break;
      }
}

void PairContacts::order_by_partner(const std::vector<Particle>& particles) {
  by_partner_start_.assign(owned_ + 1, 0);
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      ++by_partner_start_[i + 1];
      if (partner_[k] < owned_) ++by_partner_start_[partner_[k] + 1];
    }
  for (std::size_t i = 0; i < owned_; ++i) by_partner_start_[i + 1] += by_partner_start_[i];
  by_partner_.resize(by_partner_start_[owned_]);
  std::vector<std::int64_t> partner_id(by_partner_.size());
  std::vector<std::uint32_t> next(by_partner_start_.begin(), by_partner_start_.end() - 1);
  const auto put = [&](std::size_t grain, std::uint32_t pair, std::int64_t other) {
    std::uint32_t place = next[grain]++;
    // Insertion sort: a grain has about ten neighbours.
    while (place > by_partner_start_[grain] && partner_id[place - 1] > other) {
      partner_id[place] = partner_id[place - 1];
      by_partner_[place] = by_partner_[place - 1];
      --place;
    }
    partner_id[place] = other;
    by_partner_[place] = pair;
  };
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      put(i, k, particles[partner_[k]].id);
      if (partner_[k] < owned_) put(partner_[k], k, particles[i].id);
    }
  higher_from_.resize(owned_);
  for (std::size_t i = 0; i < owned_; ++i)
    higher_from_[i] = static_cast<std::uint32_t>(
        std::upper_bound(partner_id.begin() + by_partner_start_[i],
                         partner_id.begin() + by_partner_start_[i + 1], particles[i].id) -
        partner_id.begin());
}

template <class Law, class Rolling>
double PairContacts::sweep(const Law& law, const Rolling& rolling,
                           const std::vector<Particle>& particles, double time_step) {
  using View = HistoryView<Law, Rolling>;
  constexpr std::size_t kWidth = View::kWidth;
  double largest = 0.0;
  outputs_.clear();
  for (std::size_t i = 0; i < owned_; ++i) {
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      const bool first_is_lower = particles[i].id < particles[partner_[k]].id;
      const Particle& a = first_is_lower ? particles[i] : particles[partner_[k]];
      const Particle& b = first_is_lower ? particles[partner_[k]] : particles[i];
      const Vec3 apart = a.position - b.position;
      const double distance2 = norm2(apart);
      const double reach = a.radius + b.radius;
      if (distance2 >= reach * reach) {
        if (output_of_[k] >= 0) {
          std::fill_n(&history_[k * kWidth], kWidth, 0.0);
          output_of_[k] = -1;
        }
        continue;
      }
      const double distance = std::sqrt(distance2);
      ContactPoint at;
      at.overlap = reach - distance;
      at.radius = a.radius * b.radius / reach;
      at.mass = a.mass * b.mass / (a.mass + b.mass);
      at.normal = (1.0 / distance) * apart;
      const Vec3 velocity = a.velocity - b.velocity;
      at.normal_velocity = dot(velocity, at.normal);
      const double half = 0.5 * at.overlap;
      const Vec3 rim = (a.radius - half) * a.spin + (b.radius - half) * b.spin;
      at.slip_velocity = velocity - at.normal_velocity * at.normal - cross(rim, at.normal);
      const Vec3 spin = a.spin - b.spin;
      at.rolling_rate = spin - dot(spin, at.normal) * at.normal;

      typename Law::History contact_history;
      typename Rolling::History rolling_history;
      View::load(&history_[k * kWidth], contact_history, rolling_history);
      const ContactForce force = law.evaluate(at, contact_history, time_step);
      PairForce out;
      out.moment = rolling.evaluate(at, force, rolling_history, time_step);
      View::store(&history_[k * kWidth], contact_history, rolling_history);
      out.force = force.normal * at.normal + force.tangential;
      out.twist = cross(force.tangential, at.normal);
      out.half_overlap = half;
      output_of_[k] = static_cast<std::int32_t>(outputs_.size());
      outputs_.push_back(out);
      largest = std::max(largest, at.overlap / std::min(a.radius, b.radius));
    }
  }
  return largest;
}

double PairContacts::add_forces(const std::vector<Particle>& particles, double time_step,
                                std::vector<Vec3>& force, std::vector<Vec3>& moment) {
  const double largest =
      std::visit([&](const auto& law,
                     const auto& rolling) { return sweep(law, rolling, particles, time_step); },
                 law_, rolling_);
  for (std::size_t i = 0; i < owned_; ++i) {
    Vec3 sum;
    Vec3 turn;
    const double radius = particles[i].radius;
    std::uint32_t at = by_partner_start_[i];
    for (; at < higher_from_[i]; ++at) {
      const std::int32_t out = output_of_[by_partner_[at]];
      if (out < 0) continue;
      const PairForce& pair = outputs_[static_cast<std::size_t>(out)];
      sum -= pair.force;
      turn += (radius - pair.half_overlap) * pair.twist - pair.moment;
    }
    for (; at < by_partner_start_[i + 1]; ++at) {
      const std::int32_t out = output_of_[by_partner_[at]];
      if (out < 0) continue;
      const PairForce& pair = outputs_[static_cast<std::size_t>(out)];
      sum += pair.force;
      turn += (radius - pair.half_overlap) * pair.twist + pair.moment;
    }
    force[i] += sum;
    moment[i] += turn;
  }
  return largest;
}

ContactRecords PairContacts::records(const std::vector<Particle>& particles) const {
  ContactRecords out = empty_records();
  for (std::size_t i = 0; i < owned_; ++i) {
    for (std::uint32_t at = by_partner_start_[i]; at < by_partner_start_[i + 1]; ++at) {
      const std::uint32_t k = by_partner_[at];
      if (output_of_[k] < 0) continue;
      // The pair is listed under its first grain; the partner is whichever of the two is not i.
      const bool is_first = k >= start_[i] && k < start_[i + 1];
      const auto first = static_cast<std::size_t>(
          std::upper_bound(start_.begin(), start_.end(), k) - start_.begin() - 1);
      const std::int64_t other = is_first ? particles[partner_[k]].id : particles[first].id;
      out.add(&other, history_.data() + k * history_width_);
    }
    out.close_particle();
  }
  return out;
}

std::vector<StateField> PairContacts::history_fields() const {
  std::vector<StateField> fields = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, law_);
  const std::vector<StateField> more = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, rolling_);
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

std::int64_t PairContacts::count(const std::vector<Particle>& particles) const {
  std::int64_t total = 0;
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      const std::uint32_t j = partner_[k];
      if (output_of_[k] >= 0 && (j < owned_ || particles[i].id < particles[j].id)) ++total;
    }
  return total;
}

}  // namespace grouser
