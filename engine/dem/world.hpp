// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/core/decomposition.hpp"
#include "engine/core/halo.hpp"
#include "engine/core/state_io.hpp"
#include "engine/dem/activity.hpp"
#include "engine/dem/body.hpp"
#include "engine/dem/body_contacts.hpp"
#include "engine/dem/grain_forces.hpp"
#include "engine/dem/pair_contacts.hpp"

namespace grouser {

/// What a world of grains is made with.
struct WorldSettings {
  Vec3 low;  ///< corners of the region that grains may be in [m]
  Vec3 high;
  double gravity = 9.81;        ///< along -z [m s-2]
  double time_step = 0.0;       ///< [s]
  double largest_radius = 0.0;  ///< [m]
  double skin = 0.0;            ///< margin of the neighbour list [m]; costs time, not accuracy
  /// Where grains end above at first [m]: for the first cuts between ranks; 0 = high.z
  double top = 0.0;
  /// Space is cut anew when the slowest rank takes this many times the mean; infinite = never by
  /// itself
  double uneven = 1.05;
  int threads = 1;  ///< of this rank; change no bit
  std::string law = "hertz_mindlin";
  std::string rolling = "none";
  Solid grain;
  Surface grain_grain;
  ActivityRule activity;  ///< by default nobody sleeps
};

/// What went wrong in a step, agreed by all ranks; the worst wins.
enum class Fault { kNone = 0, kLostParticle = 1, kNotANumber = 2 };

/// Grains and rigid bodies moving under contact forces and gravity.
///
/// Leapfrog: velocities live half a step behind positions; damping forces use them as they are
/// (first order in the time step, the rest second order). The trajectory is the same bit for bit
/// on any number of ranks and threads, for any skin and across save_state / load_state at any step.
class World : public Stateful {
 public:
  /// @throws ConfigError when there are more ranks than most_ranks(). Local.
  World(const Communicator& ranks, const WorldSettings& settings);

  /// Adds a grain on this rank; it moves to its owner at the next step. Ids must be 0 ... N-1 over
  /// all ranks. Local.
  void add_particle(const Particle& particle);

  /// Whether a grain at this place would be this rank's. Local.
  bool owns(const Vec3& position) const;

  /// Makes room for `count` grains on this rank, so that adding them does not move memory. Local.
  void reserve(std::size_t count);

  /// Adds a body; the same on every rank, before the first step. @return its number. Local.
  std::size_t add_body(const std::string& name, Mesh mesh, const Solid& solid,
                       const Surface& surface, bool turns);
  std::size_t bodies() const { return bodies_.size(); }
  Body& body(std::size_t number) { return bodies_[number]; }
  const Body& body(std::size_t number) const { return bodies_[number]; }

  /// Lets `forces` act on grains from the next step on; it must outlive the world's steps. nullptr:
  /// contacts and gravity alone. The same on every rank. Local.
  void set_grain_forces(GrainForces* forces) { forces_ = forces; }

  /// Changes the surface of grains against each other; contact histories stay. Local.
  void set_grain_surface(const Surface& surface);

  struct StepResult {
    Fault fault = Fault::kNone;
    double max_overlap = 0.0;  ///< over the (smaller) radius [1]
    double request = 0.0;      ///< largest of the ranks' requests
    double fastest = 0.0;      ///< speed of a grain [m s-1]
  };
  /// Forces at the present positions, then grains move on by one time step; bodies stay for the
  /// caller to move. `request` lets ranks agree on something in the same message. Collective.
  StepResult step(double request = 0.0);

  /// Cuts space anew between ranks so that each gets as much of `weights`, one for each owned
  /// grain; grains move to their new owners at the next step. No bit of the trajectory changes.
  /// Done by itself, by the time that grains take, when ranks are uneven. Collective.
  void cut_by(const std::vector<double>& weights);
  /// How often it was done by itself. Local.
  int cuts() const { return cuts_; }

  /// Force and moment of all grains on a body in the last step. Local.
  const BodyLoad& load(std::size_t body) const { return loads_[body]; }

  /// Adds what else acts on a body in the step just done, a fluid's load. The same on every rank.
  /// Local.
  void add_load(std::size_t body, const BodyLoad& load) { loads_[body].add(load); }

  /// What all grains and contacts hold after a step. The elastic part is that of the forces of the
  /// step, the height is taken half a step back where the velocities are.
  struct Survey {
    double kinetic = 0.0;       ///< [J]
    double potential = 0.0;     ///< in gravity, above z = 0 [J]
    double elastic = 0.0;       ///< of pairs and body contacts, rolling included [J]
    double mean_overlap = 0.0;  ///< of touching pairs, over the smaller radius [1]
    double total() const { return kinetic + potential + elastic; }
  };
  /// Collective.
  Survey survey() const;

  /// The grain that a fault is about.
  struct Culprit {
    std::int64_t id = -1;  ///< lowest of those it is true of; -1 = none
    Vec3 position;         ///< [m]
    Vec3 velocity;         ///< [m s-1]
    Vec3 origin;           ///< position at the start of the run [m]
  };
  /// Collective.
  Culprit culprit(Fault fault) const;

  /// The deepest contact of the last step.
  struct Deepest {
    double overlap = 0.0;      ///< over the smaller radius [1]
    std::int64_t first = -1;   ///< lower id, or the grain on a body
    std::int64_t second = -1;  ///< higher id, or -1 - number of the body
    Vec3 position;             ///< of the first [m]
  };
  /// Collective.
  Deepest deepest() const;

  /// Sum of translational and rotational kinetic energy of all grains [J]. Collective.
  double kinetic_energy() const;
  std::int64_t contacts() const;        ///< touching contacts, pairs and bodies. Collective.
  std::int64_t particle_count() const;  ///< Collective.
  std::int64_t sleepers() const;        ///< grains that sleep. Collective.
  /// Kinetic energy that grains had when they fell asleep, since the start of the run [J]. Local.
  double taken_by_sleep() const { return activity_.taken(); }

  /// Grains of this rank.
  std::size_t owned() const { return owned_; }
  const std::vector<Particle>& particles() const { return particles_; }
  /// Position at the start of the run, for displacements [m].
  const std::vector<Vec3>& origins() const { return origins_; }
  /// Makes the present positions the origins. Local.
  void reset_origins();

  const Communicator& ranks() const { return ranks_; }
  const WorldSettings& settings() const { return settings_; }

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override;
  void load_rows(const StateTable& rows) override;
  void end_load() override;

 private:
  // A grain that comes from another rank; its histories stay in the message.
  struct Arrival {
    Particle particle;
    Vec3 origin;
    std::size_t message = 0;
    std::size_t histories = 0;  // where they begin
  };
  // A position to single precision: enough to tell how far a grain has moved since.
  struct Place {
    float x;
    float y;
    float z;
    Vec3 position() const { return {x, y, z}; }
  };
  // What a thread finds out while it moves grains; a cache line of its own.
  struct alignas(64) Motion {
    double fastest2 = 0.0;  // largest squared speed
    double slow2 = 0.0;     // of those that are not fast
    bool is_lost = false;   // a grain has left the region, or is nowhere
    double sum = 0.0;       // of |vx| + |vy| + |vz|
    Activity::Change change;
    void add(const Motion& other);
  };

  void rebuild();
  void cut_if_uneven();
  double unevenness_of_counts() const;
  bool looks_uneven(double most, double sum);
  std::vector<double> costs() const;
  std::vector<Bytes> exchange_leaving(std::vector<bool>& leaves) const;
  std::vector<Bytes> deliver(std::map<int, Bytes> out) const;
  std::vector<Arrival> arrivals_in(const std::vector<Bytes>& messages) const;
  void keep_histories(std::uint32_t grain, std::int64_t id, ByteReader reader);
  std::vector<std::uint32_t> numbers_by_cell(const std::vector<bool>& leaves,
                                             const std::vector<Arrival>& arrivals) const;
  void put_in_order(std::vector<std::uint32_t> number);
  void move(const PairContacts::Ready& ready, Motion& motion);
  std::size_t move_packs(const PairContacts::Ready& ready, Motion& motion);
  double displacement() const;
  void watch(bool are_new);
  std::optional<std::uint32_t> loaded_grain(std::int64_t id) const;
  void load_particles(StateTable rows);
  void load_pairs(const StateTable& rows);
  void load_touches(StateTable rows);
  void load_bodies(const StateTable& rows);

  Communicator ranks_;
  WorldSettings settings_;
  Threads threads_;
  Decomposition boxes_;
  std::vector<int> neighbours_;
  Halo halo_;
  std::vector<Particle> particles_;  // owned, then ghosts
  std::vector<Vec3> origins_;
  std::size_t owned_ = 0;
  Activity activity_;
  std::size_t struck_ = 0;  // grains that a moving body may touch
  PairContacts pairs_;
  GrainForces* forces_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<BodyContacts> body_contacts_;
  std::vector<BodyLoad> loads_;
  std::int64_t count_ = 0;       // of grains on all ranks
  std::vector<Place> built_at_;  // where grains were when the list was made
  bool may_be_far_ = true;       // from their owners, which need not be neighbours
  bool is_new_ = true;           // nobody has looked yet how many grains each rank gets
  bool is_uneven_ = false;       // by the time of the steps since the last look
  int patience_ = 0;             // steps of a list's life after which it is not waited for
  double busy_ = 0.0;            // processor time in contacts and motion since the last look [s]
  int busy_steps_ = 0;
  int cuts_ = 0;
  double rounding_ = 0.0;     // bound of what a Place leaves out [m]
  std::string load_failure_;  // what is wrong with rows that came to this rank
  bool must_rebuild_ = true;
  double moved_ = 0.0;       // bound of grain displacement since then [m]
  double near_moved_ = 0.0;  // bound of grain against body displacement since find_near [m]
};

}  // namespace grouser
