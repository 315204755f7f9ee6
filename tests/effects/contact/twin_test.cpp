// The contacts' twin against what it stands for: gradients, momentum, friction, and that nothing crosses.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "shaders/contact/contact.ref.h"
#include "tests/support/tufts.h"
#include "tests/support/twins.h"

namespace weft::reference {
namespace {

constexpr double kRecover = 4e-4;   // m a substep

double distance(const Pair& pair, const Points& x) { return closest(places(pair, x), pair.edges ? 2 : 1).distance; }

Points along(const Points& x, const Points& p, const std::vector<double>& fractions) {
  Points end;
  for (std::size_t i = 0; i < x.size(); ++i) end.push_back(x[i] + fractions[i] * (p[i] - x[i]));
  return end;
}

TEST(ContactTwin, the_distance_of_a_pair_changes_as_its_gradient_says) {
  Random random(1);
  const Tufts t = tufts(random, 20, 4, 0);
  for (const Pair& pair : t.pairs) {
    const Contact contact = prepare_contact(pair, t.x, t.x, kRecover, t.inverse_masses);
    if (distance(pair, t.x) < 1e-3) continue;   // where it bends sharply, differences say nothing
    for (int j = 0; j < 4; ++j) {
      const std::uint32_t i = pair.particle[static_cast<std::size_t>(j)];
      const auto value = [&](const Vector& at) {
        Points moved = t.x;
        moved[i] = at;
        return distance(pair, moved);
      };
      // The distance's second derivative is about one over itself, its third 1e6; a step of 1e-5 makes 1e-4 of that.
      EXPECT_LT((difference(value, t.x[i]) - contact_gradient(contact, j)).norm(), 1e-4);
    }
  }
}

TEST(ContactTwin, a_lone_contact_is_met_at_once) {
  Random random(2);
  Tufts t = tufts(random, 200, 1, 0.02);
  std::fill(t.inverse_masses.begin(), t.inverse_masses.end(), 10.0);
  const auto contacts = prepare(t, 1);
  const Points p = solve_contacts(t.pairs, contacts, t.x, t.p, t.inverse_masses, std::vector<double>(t.x.size(), 0.0));
  int pushed = 0;
  for (std::size_t k = 0; k < t.pairs.size(); ++k) {
    const double before = contact_value(contacts[k], places(t.pairs[k], t.p));
    const double after = contact_value(contacts[k], places(t.pairs[k], p));
    pushed += before < 0;
    EXPECT_NEAR(after, std::max(before, 0.0), 1e-12);
  }
  EXPECT_GT(pushed, 20);
}

TEST(ContactTwin, contacts_keep_momentum) {
  Random random(3);
  const Tufts t = tufts(random, 30, 12, 0.02, 1000000);
  const Points p = solve_contacts(t.pairs, prepare(t, kRecover), t.x, t.p, t.inverse_masses, std::vector<double>(t.x.size(), 0.5));
  Vector sum = Vector::Zero();
  double size = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    sum += (p[i] - t.p[i]) / t.inverse_masses[i];
    size += (p[i] - t.p[i]).norm() / t.inverse_masses[i];
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(sum.norm(), 1e-12 * size);
}

TEST(ContactTwin, friction_stays_in_its_cone_and_stops_at_most) {
  Random random(4);
  const Tufts t = tufts(random, 200, 1, 0.03);
  const auto contacts = prepare(t, kRecover);
  int slid = 0, stuck = 0;
  for (std::size_t k = 0; k < t.pairs.size(); ++k) {
    Eigen::Vector4d masses;
    for (int j = 0; j < 4; ++j) masses[j] = t.inverse_masses[t.pairs[k].particle[static_cast<std::size_t>(j)]];
    const double mu = between(random, 0, 3);
    const Quad x = places(t.pairs[k], t.x), p = places(t.pairs[k], t.p);
    const ContactImpulse impulse = contact_impulse(contacts[k], x, p, masses, masses, mu);
    if (impulse.lambda == 0) continue;
    EXPECT_LE(impulse.tangential.norm(), mu * impulse.lambda * (1 + 1e-12));
    EXPECT_NEAR(impulse.tangential.dot(contacts[k].normal), 0, 1e-12 * impulse.lambda);
    double give = 0;   // of the pair to an impulse
    for (int j = 0; j < 4; ++j) give += masses[j] * contacts[k].weights[j] * contacts[k].weights[j];
    const Vector motion = offset(contacts[k].weights, p) - offset(contacts[k].weights, x);
    const Vector before = motion - contacts[k].normal * contacts[k].normal.dot(motion), after = before + give * impulse.tangential;
    EXPECT_GE(after.dot(before), -1e-12 * before.squaredNorm());
    EXPECT_NEAR(after.cross(before).norm(), 0, 1e-12 * before.squaredNorm());
    (after.norm() < 1e-9 ? stuck : slid)++;
  }
  EXPECT_GT(slid, 10);
  EXPECT_GT(stuck, 10);
}

TEST(ContactTwin, no_particle_is_pushed_further_than_the_penetration) {
  // An edge that is held at one end is pressed upon there: its other end hardly moves the place.
  const Points x{{0, 0, 0.001}, {0, 1, 0.001}, {0.001, -1, 0}, {0.001, 1, 0}};
  Points p = x;
  p[2].z() += 0.002;
  p[3].z() += 0.002;
  const Pair pair{{0, 1, 2, 3}, 0.002, true};
  const std::vector<double> masses{0, 1, 0, 0}, friction(4, 0.0);
  const Contact contact = prepare_contact(pair, x, p, 0.002, std::vector<double>(4, 1.0));
  const double penetration = -contact_value(contact, places(pair, p));
  ASSERT_GT(penetration, 0.001);
  const Points pushed = solve_contacts({&pair, 1}, {&contact, 1}, x, p, masses, friction);
  EXPECT_LE((pushed[1] - p[1]).norm(), penetration * (1 + 1e-12));
}

TEST(ContactLimit, nothing_crosses_however_violent_the_motion) {
  for (const double violence : {0.003, 0.01, 0.1, 1.0}) {
    Random random(5);
    const Tufts t = tufts(random, 60, 12, violence, 1000000);
    const Limit limit = limit_motion(t.pairs, prepare(t, kRecover), t.x, t.p, t.inverse_masses);
    EXPECT_GT(meetings(t.pairs, t.x, t.p), violence > 0.005 ? 20u : 0u) << violence;
    EXPECT_EQ(meetings(t.pairs, t.x, along(t.x, t.p, limit.fractions)), 0u) << violence;
  }
}

TEST(ContactLimit, pairs_that_go_along_are_not_held_back) {
  Random random(6);
  Tufts t = tufts(random, 60, 12, 1e-5, 1000000);
  for (std::size_t i = 0; i < t.x.size(); ++i) t.p[i] += Vector(3, -5, 4);   // m
  // Those that are as close as pairs may come must not come closer.
  std::erase_if(t.pairs, [&](const Pair& pair) { return distance(pair, t.x) < kLimitMargin * pair.separation + 1e-4; });
  const Limit limit = limit_motion(t.pairs, prepare(t, kRecover), t.x, t.p, t.inverse_masses);
  EXPECT_EQ(*std::min_element(limit.fractions.begin(), limit.fractions.end()), 1);
}

// A pile of triangles, one over the other, that all go down together but for the lowest.
struct Pile {
  Points x, p;
  std::vector<double> inverse_masses;
  std::vector<Pair> pairs;   // each corner with the layer below, and that one's with it
};
Pile pile(std::size_t layers, double gap, double fall) {
  Pile pile;
  for (std::size_t k = 0; k < layers; ++k)
    for (int corner = 0; corner < 3; ++corner) {
      const double turn = corner * 2 * M_PI / 3 + 0.1 * static_cast<double>(k);
      pile.x.push_back({0.02 * std::cos(turn), gap * static_cast<double>(k), 0.02 * std::sin(turn)});
      pile.p.push_back(pile.x.back() - Vector(0, k == 0 ? 0 : fall, 0));
      pile.inverse_masses.push_back(1);
    }
  for (std::uint32_t i = 0; i + 3 < pile.x.size(); i += 3)
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      pile.pairs.push_back({{i + 3 + corner, i, i + 1, i + 2}, gap, false});
      pile.pairs.push_back({{i + corner, i + 3, i + 4, i + 5}, gap, false});
      for (std::uint32_t other = 0; other < 3; ++other)
        pile.pairs.push_back({{i + 3 + corner, i + 3 + (corner + 1) % 3, i + other, i + (other + 1) % 3}, gap, true});
    }
  return pile;
}

TEST(ContactLimit, layers_that_fall_together_stop_over_one_that_is_stopped) {
  for (const std::size_t layers : {3u, 10u, 20u, 40u, 80u}) {
    const Pile p = pile(layers, 0.001, 0.05);
    std::vector<Contact> contacts;
    for (const Pair& pair : p.pairs) contacts.push_back(prepare_contact(pair, p.x, p.p, kRecover, p.inverse_masses));
    const Limit limit = limit_motion(p.pairs, contacts, p.x, p.p, p.inverse_masses);
    const Points end = along(p.x, p.p, limit.fractions);
    EXPECT_EQ(meetings(p.pairs, p.x, end), 0u) << layers;
    for (std::size_t i = 3; i < end.size(); ++i) EXPECT_GE(end[i].y() - end[i - 3].y(), 0.00009) << layers << " layers, particle " << i;
    // Every round stops a layer. Where there are more layers, those above keep to their half of the gap.
    EXPECT_EQ(limit.falls_back, layers > WEFT_LIMIT_ROUNDS) << layers;
    EXPECT_EQ(limit.rounds, std::min<int>(static_cast<int>(layers), WEFT_LIMIT_ROUNDS)) << layers;
  }
}

TEST(ContactLimit, what_cannot_stop_takes_its_slack_from_the_other_side) {
  const Points x{{0, 0.01, 0}, {-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}};
  const Pair pair{{0, 1, 2, 3}, 0.005, false};
  for (const double rise : {0.002, 0.008}) {
    Points p = x;
    p[0].y() -= 0.05;
    for (std::size_t j = 1; j < 4; ++j) p[j].y() += rise;
    const std::vector<double> masses{1, 0, 0, 0};
    const Contact contact = prepare_contact(pair, x, p, kRecover, masses);
    const Limit limit = limit_motion({&pair, 1}, {&contact, 1}, x, p, masses);
    const Points end = along(x, p, limit.fractions);
    EXPECT_EQ(limit.fractions[1], 1);
    EXPECT_FALSE(limit.falls_back);
    EXPECT_NEAR(end[0].y(), rise + 0.0005, 1e-4) << rise;   // a tenth of the separation
    EXPECT_FALSE(sides_meet(places(pair, x), places(pair, end), false));
  }
}

TEST(ContactLimit, an_anchor_waits_for_what_is_in_its_way_but_not_further_from_its_target_than_is_stated) {
  const Points x{{0, 0.001, 0}, {-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}};
  const Pair pair{{0, 1, 2, 3}, 0.005, false};
  for (const double lag : {0.0, 0.04, 0.05, 0.07}) {   // m
    const double down = 0.01 + lag;
    Points p = x;
    p[0].y() -= down;
    const std::vector<double> masses{0, 1, 1, 1}, lags{lag, 0, 0, 0};
    const Contact contact = prepare_contact(pair, x, p, kRecover, masses);
    const Limit limit = limit_motion({&pair, 1}, {&contact, 1}, x, p, masses, lags);
    const double end = along(x, p, limit.fractions)[0].y(), tracking_error = end - p[0].y();
    // A tenth of the separation is left of the gap.
    EXPECT_NEAR(tracking_error, std::min(down - 0.0005, 0.01 + kKinematicLagLimit * 0.005), 1e-12) << lag;
    EXPECT_EQ(limit.fractions[1], 1);
  }
}

// It is pushed at one corner and turns: along the normal at the start its other corners are in the way, where it ends they are not.
TEST(ContactLimit, a_triangle_that_turns_out_of_the_way_holds_nothing_up_unless_it_ends_too_near) {
  const Points x{{0, 0.005, 0.09}, {-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}};
  const Pair pair{{0, 1, 2, 3}, 0.005, false};
  for (const double distance : {0.001, 0.002, 0.0026, 0.004, 0.02}) {   // m, at the end
    Points p = x;
    p[3].y() -= 0.04;
    p[0].y() = -0.038 + distance * std::hypot(1, 0.2);   // the triangle falls by 0.2 in 1
    const std::vector<double> masses{1, 1, 1, 1};
    const Contact contact = prepare_contact(pair, x, p, kRecover, masses);
    EXPECT_LT((contact.normal - Vector(0, 1, 0)).norm(), 1e-12);
    const Limit limit = limit_motion({&pair, 1}, {&contact, 1}, x, p, masses);
    const bool is_held = *std::min_element(limit.fractions.begin(), limit.fractions.end()) < 1;
    EXPECT_EQ(is_held, distance < kParted * pair.separation) << distance;
    EXPECT_FALSE(sides_meet(places(pair, x), places(pair, along(x, p, limit.fractions)), false)) << distance;
  }
}

TEST(ContactLimit, sides_that_meet_stay_where_they_are) {
  const Points x{{0, 0, 0}, {-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}};
  Points p = x;
  for (Vector& place : p) place.y() -= 0.1;
  const Pair pair{{0, 1, 2, 3}, 0.005, false};
  const std::vector<double> masses{1, 1, 0, 1};
  const Contact contact = prepare_contact(pair, x, p, kRecover, masses);
  EXPECT_FALSE(contact.directed);
  const Limit limit = limit_motion({&pair, 1}, {&contact, 1}, x, p, masses);
  EXPECT_EQ(limit.fractions, (std::vector<double>{0, 0, 1, 0}));
}

}  // namespace
}  // namespace weft::reference
