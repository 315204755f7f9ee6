// Where overstretched cloth tears.
//
// The edge that is stretched most, of those beyond their limit, begins a crack at one of its ends, across it. From there the crack runs on
// to both sides, along the edges that lead straight ahead, as long as it finds points with an edge beyond its limit, or the cloth's rim. A
// crack relieves the cloth beside it about as far as it is long (Griffith 1921): points so near begin no other crack in the same look. Else
// cloth that is stretched evenly would fall to pieces. The next edge of those that are left goes on.
//
//           *-----*-----*
//          / \ far / \ /         <-- the edge that is stretched, upwards
//         u---p=====v            p has become two: the crack is open from u to v, where it ends
//          \ / \   / \ /
//           *-----*-----*
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/cook/parts.h"
#include "engine/effects/tear/tear.h"

namespace weft::cooking {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostSplits = 1024;   // of a look: the time it takes is bounded

class Tearing {
 public:
  Tearing(const Posed& cloth, std::span<const float> limits) : cloth_(cloth), fans_(cloth.mesh) {
    const std::size_t points = cloth.mesh.points.size();
    is_spared_.resize(points);
    strongest_.resize(points);
    pulls_.resize(points, Eigen::Matrix3d::Zero());
    neighbours_.resize(points);
    for (const WingedEdge& edge : cloth.mesh.edges) {
      neighbours_[edge.a].push_back(edge.b);
      neighbours_[edge.b].push_back(edge.a);
      const double rest = rest_of(edge.b, edge.a).norm(), now = (cloth.places[edge.b] - cloth.places[edge.a]).norm();
      const double limit = 0.5 * (double(limits[edge.a]) + limits[edge.b]);
      const double load = (now / rest - 1) / std::max(limit, 1e-6);
      if (!(load > 1)) continue;
      overstretched_.push_back({load, edge.a, edge.b});
      const Vector3d way = along(edge.a, edge.b);
      for (const std::uint32_t p : {edge.a, edge.b}) {
        strongest_[p] = std::max(strongest_[p], load);
        pulls_[p] += load * way * way.transpose();
      }
    }
    std::ranges::stable_sort(overstretched_, std::greater(), &Overstretched::load);
  }

  std::vector<Split> run() {
    for (const auto& [load, a, b] : overstretched_) {
      if (splits_.size() >= kMostSplits) break;
      if (is_spared_[a] || is_spared_[b]) continue;
      const bool a_first = strongest_[a] >= strongest_[b];
      if (!begin(a_first ? a : b)) begin(a_first ? b : a);
    }
    return std::move(splits_);
  }

 private:
  struct Overstretched {
    double load;   // strain over its limit
    std::uint32_t a, b;
  };

  Vector3d rest_of(std::uint32_t to, std::uint32_t from) const { return vector(cloth_.mesh.points[to]) - vector(cloth_.mesh.points[from]); }
  Vector3d along(std::uint32_t from, std::uint32_t to) const { return rest_of(to, from).normalized(); }
  bool may_split(std::uint32_t p) const { return !is_spared_[p] && !cloth_.is_held(p); }

  // Splits off those triangles of a fan that lie from one place of its rim up to another.
  void split(std::uint32_t point, const Fan& fan, std::size_t from, std::size_t to) {
    Split made{point, {fan.corners.begin() + static_cast<std::ptrdiff_t>(from), fan.corners.begin() + static_cast<std::ptrdiff_t>(to)}};
    std::ranges::sort(made.corners);
    splits_.push_back(std::move(made));
    crack_.push_back(point);
    is_spared_[point] = true;
  }

  // The place on the rim, of those where a triangle ends and the next begins, to which a crack runs best: it points ahead and lies across
  // the pull. None: fan.rim.size().
  std::size_t best(std::uint32_t point, const Fan& fan, const Vector3d& ahead, const Vector3d& pull, std::size_t but) const {
    std::size_t found = fan.rim.size();
    double most = -2;
    for (std::size_t k = fan.is_closed() ? 0 : 1; k < fan.corners.size(); ++k) {
      if (k == but) continue;
      const Vector3d way = along(point, fan.rim[k]);
      const double score = way.dot(ahead) - std::abs(way.dot(pull));
      if (score > most) most = score, found = k;
    }
    return found;
  }

  // In which direction a point is pulled apart, in the mesh at rest: the main axis of its edges beyond their limit.
  Vector3d pull_at(std::uint32_t point) const {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(pulls_[point]).eigenvectors().col(2);
  }

  bool begin(std::uint32_t point) {
    if (!may_split(point)) return false;
    crack_.clear();
    if (!open(point, pull_at(point))) return false;
    relieve();
    return true;
  }

  bool open(std::uint32_t point, const Vector3d& pull) {
    const std::vector<Fan> fans = fans_.of(point);
    const Fan& fan = fans.front();
    if (fans.size() > 1) {   // it hangs together by this point alone
      split(point, fan, 0, fan.corners.size());
      return true;
    }
    // Across the pull, in the cloth: from the normal of the triangles around.
    Vector3d normal = Vector3d::Zero();
    for (std::size_t k = 0; k < fan.corners.size(); ++k)
      normal += rest_of(fan.rim[k], point).cross(rest_of(fan.rim[(k + 1) % fan.rim.size()], point));
    const Vector3d across = normal.cross(pull).normalized();
    if (!across.allFinite() || across.isZero()) return false;
    const std::size_t u = best(point, fan, across, pull, fan.rim.size());
    if (u == fan.rim.size()) return false;   // of one triangle
    if (!fan.is_closed()) {
      const std::size_t v = best(point, fan, -across, pull, fan.rim.size());
      const auto straight = [&](std::size_t k) { return std::abs(along(point, fan.rim[k]).dot(across)); };
      const std::size_t at = straight(v) > straight(u) ? v : u;
      split(point, fan, at, fan.corners.size());
      run_on(point, fan.rim[at]);
      return true;
    }
    const std::size_t v = best(point, fan, -across, pull, u);
    if (v == fan.rim.size()) return false;
    split(point, fan, std::min(u, v), std::max(u, v));
    const std::uint32_t ends[] = {fan.rim[u], fan.rim[v]};
    for (const std::uint32_t end : ends) run_on(point, end);
    return true;
  }

  // The crack is open from `from` to `point`.
  void run_on(std::uint32_t from, std::uint32_t point) {
    while (splits_.size() < kMostSplits && may_split(point) && strongest_[point] > 0) {
      const std::vector<Fan> fans = fans_.of(point);
      if (fans.size() > 1) return;
      const Fan& fan = fans.front();
      const auto at = static_cast<std::size_t>(std::ranges::find(fan.rim, from) - fan.rim.begin());
      if (at >= fan.corners.size() || (!fan.is_closed() && at == 0)) return;   // not between two triangles
      if (!fan.is_closed()) return split(point, fan, at, fan.corners.size());   // it has reached the rim
      const std::size_t next = best(point, fan, along(from, point), pull_at(point), at);
      if (next == fan.rim.size()) return;
      const std::uint32_t ahead = fan.rim[next];
      split(point, fan, std::min(at, next), std::max(at, next));
      from = std::exchange(point, ahead);
    }
  }

  // As many edges around as the crack has points.
  void relieve() {
    std::vector<std::uint32_t> rim = crack_, next;
    for (std::size_t far = std::max<std::size_t>(crack_.size(), 2); far > 0; --far, rim.swap(next)) {
      next.clear();
      for (const std::uint32_t p : rim)
        for (const std::uint32_t other : neighbours_[p])
          if (!is_spared_[other]) is_spared_[other] = true, next.push_back(other);
    }
  }

  const Posed& cloth_;
  Fans fans_;
  std::vector<Overstretched> overstretched_;
  std::vector<double> strongest_;                  // of each point: the most load of its edges beyond their limit
  std::vector<Eigen::Matrix3d> pulls_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<bool> is_spared_;
  std::vector<std::uint32_t> crack_;
  std::vector<Split> splits_;
};

}  // namespace

std::vector<Split> cracks(const Posed& cloth, std::span<const float> limits) { return Tearing(cloth, limits).run(); }

}  // namespace weft::cooking
