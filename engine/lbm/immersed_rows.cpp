// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/immersed_rows.hpp"

#include <algorithm>
#include <array>

#include "engine/lbm/collision.hpp"
#include "engine/lbm/wide.hpp"

namespace grouser {
namespace {

template <class Real>
constexpr auto kLanesOf = static_cast<std::int64_t>(WideOf<Real>::kLanes);

std::int64_t whole(std::int64_t cells, std::int64_t lanes) {
  return (cells + lanes - 1) / lanes * lanes;
}

// As many fractions as a register of Real has lanes.
template <class Real>
[[gnu::always_inline]] inline Wide<Real> load_fractions(const float* from) {
  if constexpr (sizeof(Real) == sizeof(float)) {
    return load_wide(from);
  } else {
    using Half = float __attribute__((vector_size(kWideBytes / 2), aligned(4), may_alias));
    return __builtin_convertvector(*reinterpret_cast<const Half*>(from), Wide<double>);
  }
}

template <class Real>
[[gnu::always_inline]] inline Wide<Real> count_up(double first) {
  Wide<Real> values{};
  for (std::size_t i = 0; i < WideOf<Real>::kLanes; ++i) values[i] = static_cast<Real>(i);
  return values + static_cast<Real>(first);
}

template <class Real>
double sum_of(const Wide<Real>& values) {
  // Halves onto each other: one lane after the other would wait for every addition.
  std::array<double, WideOf<Real>::kLanes> sums;
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = static_cast<double>(values[i]);
  for (std::size_t half = sums.size() / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) sums[i] += sums[i + half];
  return sums[0];
}

}  // namespace

template <class Real>
SolidRow<Real>::SolidRow(std::size_t cells)
    : covered(cells / WideOf<Real>::kLanes), weight(cells), share(cells), density(cells) {
  velocity.fill(std::vector<Real>(cells));
  momentum.fill(std::vector<Real>(cells));
}

template <class Real>
ImmersedRows<Real>::ImmersedRows(const CellBlocks& blocks, const CellBox& box, double viscosity_lu)
    : blocks_(blocks),
      box_(box),
      time_(static_cast<Real>(relaxation_time(viscosity_lu) - 0.5)),
      row_(static_cast<std::size_t>(whole(box.nx, kLanesOf<Real>))) {}

template <class Real>
void ImmersedRows<Real>::immerse(const std::vector<ImmersedBall>& balls,
                                 const std::vector<ImmersedBody>& bodies) {
  images_.clear();
  found_.clear();
  rows_.clear();
  for (std::size_t i = 0; i < balls.size(); ++i)
    add_images(balls[i], static_cast<std::uint32_t>(i));
  for (std::size_t i = 0; i < images_.size(); ++i) add_pieces(static_cast<std::uint32_t>(i));
  bodies_.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    add_body(bodies[b], static_cast<std::uint32_t>(balls.size() + b));
  sort_pieces();
  loads_.assign(balls.size() + bodies.size(), {});
}

template <class Real>
void ImmersedRows<Real>::add_images(const ImmersedBall& ball, std::uint32_t number) {
  const double reach = ball.radius + 1.0;
  const auto ends = [&](int axis) {
    return static_cast<double>(blocks_.cells()[static_cast<std::size_t>(axis)]);
  };
  const auto shifts = [&](int axis, double at) {
    std::vector<double> found{0.0};
    if (!blocks_.periodic(axis) || (axis == 2 && box_.ghosts_z == 0)) return found;
    if (at - reach < 0.0) found.push_back(ends(axis));
    if (at + reach > ends(axis) - 1.0) found.push_back(-ends(axis));
    return found;
  };
  for (const double z : shifts(2, ball.centre.z))
    for (const double y : shifts(1, ball.centre.y))
      for (const double x : shifts(0, ball.centre.x)) {
        Image image{ball, cover_radius(ball.radius), number};
        image.ball.centre += {x, y, z};
        images_.push_back(image);
      }
}

template <class Real>
void ImmersedRows<Real>::add_pieces(std::uint32_t index) {
  const Image& image = images_[index];
  const Vec3& centre = image.ball.centre;
  const double reach = image.radius + kHalfDiagonal;
  const auto first = [&](double at, int axis) {
    return std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(at - reach)),
                                  blocks_.low(axis));
  };
  const auto last = [&](double at, int axis) {
    return std::min<std::int64_t>(static_cast<std::int64_t>(std::floor(at + reach)),
                                  blocks_.high(axis) - 1);
  };
  for (std::int64_t z = first(centre.z, 2); z <= last(centre.z, 2); ++z)
    for (std::int64_t y = first(centre.y, 1); y <= last(centre.y, 1); ++y) {
      const BallRow row{centre.x, static_cast<double>(y) - centre.y,
                        static_cast<double>(z) - centre.z, image.radius};
      const BallRow::Reach cells = row.reach();
      add_piece(index, y, z, cells.begin, cells.end);
    }
}

// In whole registers within the row.
template <class Real>
void ImmersedRows<Real>::add_piece(std::uint32_t image, std::int64_t y, std::int64_t z,
                                   std::int64_t begin, std::int64_t end) {
  constexpr std::int64_t kLanes = kLanesOf<Real>;
  if (end <= begin || end <= 0) return;
  begin = std::max<std::int64_t>(begin, 0) / kLanes * kLanes;
  end = whole(std::min(end, box_.nx), kLanes);
  if (end <= begin) return;
  rows_.push_back(static_cast<std::uint32_t>(row_number(y - blocks_.low(1), z - blocks_.low(2))));
  found_.push_back(
      {image, static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end - begin)});
}

template <class Real>
void ImmersedRows<Real>::add_body(const ImmersedBody& body, std::uint32_t number) {
  Image image;
  image.ball = {body.centre, 0.0, body.velocity, body.spin};
  image.number = number;
  image.body = static_cast<std::int32_t>(bodies_.size());
  images_.push_back(image);
  const BodyCover& cover = bodies_.emplace_back(
      body.corners, body.facets,
      BodyCover::Rows{blocks_.low(1), blocks_.high(1), blocks_.low(2), blocks_.high(2)});
  const BodyCover::Rows& rows = cover.rows();
  for (std::int64_t z = rows.z_begin; z < rows.z_end; ++z)
    for (std::int64_t y = rows.y_begin; y < rows.y_end; ++y) {
      const auto [begin, end] = cover.reach(y, z);
      add_piece(static_cast<std::uint32_t>(images_.size() - 1), y, z, begin, end);
    }
}

template <class Real>
void ImmersedRows<Real>::cover(const Piece& piece, std::int64_t length, float* fractions) const {
  const Image& image = images_[piece.image];
  const std::int64_t y = y_ + blocks_.low(1);
  const std::int64_t z = z_ + blocks_.low(2);
  if (image.body >= 0) {
    bodies_[static_cast<std::size_t>(image.body)].cover(y, z, piece.begin, length, fractions);
    return;
  }
  const Vec3& centre = image.ball.centre;
  const BallRow ball{centre.x, static_cast<double>(y) - centre.y, static_cast<double>(z) - centre.z,
                     image.radius};
  ball.cover(piece.begin, length, fractions);
}

// By counting: rows are few and pieces come by rising image, which is kept within a row.
template <class Real>
void ImmersedRows<Real>::sort_pieces() {
  starts_.assign(static_cast<std::size_t>(box_.ny * box_.nz) + 1, 0);
  for (const std::uint32_t row : rows_) ++starts_[row + 1];
  for (std::size_t row = 1; row < starts_.size(); ++row) starts_[row] += starts_[row - 1];
  pieces_.resize(found_.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < found_.size(); ++i) pieces_[next[rows_[i]]++] = found_[i];
}

template <class Real>
auto ImmersedRows<Real>::motion_of(const Piece& piece) const -> Motion {
  const ImmersedBall& ball = images_[piece.image].ball;
  const double y = static_cast<double>(y_ + blocks_.low(1)) - ball.centre.y;
  const double z = static_cast<double>(z_ + blocks_.low(2)) - ball.centre.z;
  const Vec3 at_centre = ball.velocity + cross(ball.spin, Vec3{0.0, y, z});
  return {{static_cast<Real>(at_centre.x), static_cast<Real>(at_centre.y),
           static_cast<Real>(at_centre.z)},
          static_cast<Real>(ball.spin.z),
          static_cast<Real>(-ball.spin.y)};
}

template <class Real>
bool ImmersedRows<Real>::begin_row(std::int64_t y, std::int64_t z, const SolidMap& map) {
  const auto row = static_cast<std::size_t>(row_number(y, z));
  const std::uint32_t first = starts_[row];
  const std::uint32_t last = starts_[row + 1];
  if (first == last) return false;
  y_ = y;
  z_ = z;
  std::fill(row_.covered.begin(), row_.covered.end(), std::uint8_t{0});
  std::fill(row_.share.begin(), row_.share.end(), Real(0));
  for (auto& component : row_.velocity) std::fill(component.begin(), component.end(), Real(0));
  std::size_t room = 0;
  for (std::uint32_t p = first; p < last; ++p)
    room += static_cast<std::size_t>(whole(pieces_[p].length, kLanesOf<float>));
  if (fractions_.size() < room) fractions_.resize(room);
  float* fractions = fractions_.data();
  for (std::uint32_t p = first; p < last; ++p) {
    const Piece& piece = pieces_[p];
    const std::int64_t length = whole(piece.length, kLanesOf<float>);
    cover(piece, length, fractions);
    clear_beyond_fluid(piece, map, fractions);
    fill(piece, fractions);
    fractions += length;
  }
  for (std::uint32_t p = first; p < last; ++p)
    weigh(static_cast<std::size_t>(pieces_[p].begin) / WideOf<Real>::kLanes,
          static_cast<std::size_t>(pieces_[p].begin + pieces_[p].length) / WideOf<Real>::kLanes);
  return true;
}

template <class Real>
void ImmersedRows<Real>::clear_beyond_fluid(const Piece& piece, const SolidMap& map,
                                            float* fractions) const {
  for (std::int64_t x = box_.nx; x < piece.begin + piece.length; ++x)
    fractions[x - piece.begin] = 0.0f;
  const std::int64_t end = std::min<std::int64_t>(piece.begin + piece.length, box_.nx);
  for (std::int64_t x = piece.begin; map.has_obstacles() && x < end; ++x)
    if (!map.is_fluid(x, y_, z_)) fractions[x - piece.begin] = 0.0f;
}

// Sums of fractions into `share`, of fractions times velocities into `velocity`.
template <class Real>
void ImmersedRows<Real>::fill(const Piece& piece, const float* fractions) {
  constexpr auto kLanes = static_cast<std::int32_t>(kLanesOf<Real>);
  const Motion motion = motion_of(piece);
  const double from = static_cast<double>(piece.begin) - images_[piece.image].ball.centre.x;
  for (std::int32_t k = 0; k < piece.length; k += kLanes) {
    const Wide<Real> e = load_fractions<Real>(fractions + k);
    const Wide<Real> x = count_up<Real>(from + k);
    const auto add = [&](std::vector<Real>& to, const Wide<Real>& term) {
      Real* const place = to.data() + piece.begin + k;
      store_wide(place, load_wide(place) + term);
    };
    add(row_.share, e);
    add(row_.velocity[0], e * motion.velocity.x);
    add(row_.velocity[1], e * (motion.velocity.y + motion.slope_y * x));
    add(row_.velocity[2], e * (motion.velocity.z + motion.slope_z * x));
  }
}

// From sums to weight, share and mean velocity, for registers that are not done yet.
template <class Real>
void ImmersedRows<Real>::weigh(std::size_t begin, std::size_t end) {
  constexpr std::size_t kLanes = WideOf<Real>::kLanes;
  const Wide<Real> none{};
  const Wide<Real> one = none + Real(1);
  for (std::size_t r = begin; r < end; ++r) {
    if (row_.covered[r] != 0) continue;
    row_.covered[r] = 1;
    const std::size_t at = r * kLanes;
    const Wide<Real> sum = load_wide(row_.share.data() + at);
    const Wide<Real> inverse = sum > none ? one / (sum > none ? sum : one) : none;
    const Wide<Real> e = sum < one ? sum : one;
    const Wide<Real> weight = e * time_ / (one - e + time_);
    store_wide(row_.weight.data() + at, weight);
    store_wide(row_.share.data() + at, weight * inverse);
    for (auto& component : row_.velocity)
      store_wide(component.data() + at, load_wide(component.data() + at) * inverse);
  }
}

template <class Real>
void ImmersedRows<Real>::end_row() {
  const auto row = static_cast<std::size_t>(row_number(y_, z_));
  const float* fractions = fractions_.data();
  for (std::uint32_t p = starts_[row]; p < starts_[row + 1]; ++p) {
    take(pieces_[p], fractions);
    fractions += whole(pieces_[p].length, kLanesOf<float>);
  }
}

// Momentum of the cells goes from the fluid's velocity to the solid's by its share of B.
template <class Real>
void ImmersedRows<Real>::take(const Piece& piece, const float* fractions) {
  constexpr auto kLanes = static_cast<std::int32_t>(kLanesOf<Real>);
  const Motion motion = motion_of(piece);
  const ImmersedBall& ball = images_[piece.image].ball;
  const double from = static_cast<double>(piece.begin) - ball.centre.x;
  Vec3T<Wide<Real>> force{};
  Wide<Real> force_y_x{};
  Wide<Real> force_z_x{};
  for (std::int32_t k = 0; k < piece.length; k += kLanes) {
    const auto at = static_cast<std::size_t>(piece.begin + k);
    const Wide<Real> x = count_up<Real>(from + k);
    const Wide<Real> part = load_fractions<Real>(fractions + k) * load_wide(row_.share.data() + at);
    const Wide<Real> density = load_wide(row_.density.data() + at);
    const auto lost = [&](int axis, const Wide<Real>& velocity) {
      return part * (load_wide(row_.momentum[static_cast<std::size_t>(axis)].data() + at) -
                     density * velocity);
    };
    const Wide<Real> y_force = lost(1, motion.velocity.y + motion.slope_y * x);
    const Wide<Real> z_force = lost(2, motion.velocity.z + motion.slope_z * x);
    force.x += lost(0, Wide<Real>{} + motion.velocity.x);
    force.y += y_force;
    force.z += z_force;
    force_y_x += x * y_force;
    force_z_x += x * z_force;
  }
  if (images_[piece.image].body >= 0)
    for (std::int32_t k = 0; k < piece.length; ++k)
      loads_[images_[piece.image].number].volume.add(static_cast<double>(fractions[k]));
  const Vec3 f{sum_of<Real>(force.x), sum_of<Real>(force.y), sum_of<Real>(force.z)};
  const double y = static_cast<double>(y_ + blocks_.low(1)) - ball.centre.y;
  const double z = static_cast<double>(z_ + blocks_.low(2)) - ball.centre.z;
  loads_[images_[piece.image].number].add(
      f, {y * f.z - z * f.y, z * f.x - sum_of<Real>(force_z_x), sum_of<Real>(force_y_x) - y * f.x});
}

template <class Real>
std::size_t ImmersedRows<Real>::bytes() const {
  return (pieces_.capacity() + found_.capacity()) * sizeof(Piece) +
         (starts_.capacity() + rows_.capacity()) * sizeof(std::uint32_t) +
         images_.capacity() * sizeof(Image) + loads_.capacity() * sizeof(ImmersedLoad) +
         fractions_.capacity() * sizeof(float) + 9 * row_.weight.capacity() * sizeof(Real);
}

template struct SolidRow<double>;
template struct SolidRow<float>;
template class ImmersedRows<double>;
template class ImmersedRows<float>;

}  // namespace grouser
