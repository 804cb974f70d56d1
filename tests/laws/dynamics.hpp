// Laws of the contact solver and of the integrator: against exact solutions and optimality conditions.
#pragma once

#include <algorithm>

#include "impulses.hpp"
#include "turning.hpp"

namespace {
namespace dynamics_laws {

/// Velocities of bodies in double.
struct motion_of {
    reals linear, angular;
};

/// What contacts without friction do, exactly: the linear complementarity problem w = A x + q, x >= 0, w >= 0,
/// x w = 0 over the normal impulses, solved by trying every set of active points.
class exact_normals {
public:
    explicit exact_normals(const problem& with) : problem_(with) {
        for (const point_of& p : points_of(with)) {
            points_.push_back(p);
            q_.push_back(dot(p.normal, slip_of(with.bodies, p)) - p.target);
        }
        const std::size_t n = points_.size();
        a_.assign(n, std::vector<double>(n));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < n; ++k) a_[i][k] = answer(points_[i], points_[k]);
    }

    /// The bodies' velocities after the impulses; they are unique, even where the impulses are not.
    std::vector<motion_of> velocities() const {
        const std::vector<double> x = solve();
        std::vector<motion_of> result;
        for (const auto& b : problem_.bodies)
            result.push_back({to_reals(b.velocity.linear), to_reals(b.velocity.angular)});
        for (std::size_t k = 0; k < x.size(); ++k)
            for (const side_of& s : points_[k].sides) {
                const reals p = points_[k].normal * (x[k] * s.sign);
                result[s.body].linear = result[s.body].linear + p * s.inverse_mass;
                result[s.body].angular = result[s.body].angular + s.turn(cross(s.anchor, p));
            }
        return result;
    }

private:
    /// How fast point i parts by a unit impulse at point k.
    static double answer(const point_of& i, const point_of& k) {
        double sum = 0;
        for (const side_of& s : i.sides)
            for (const side_of& t : k.sides) {
                if (s.body != t.body) continue;
                const reals p = k.normal * t.sign;
                sum += s.sign * dot(i.normal, p * t.inverse_mass + cross(t.turn(cross(t.anchor, p)), s.anchor));
            }
        return sum;
    }

    std::vector<double> solve() const {
        const std::size_t n = q_.size();
        for (unsigned active = 0; active < 1u << n; ++active) {
            std::vector<std::size_t> rows;
            for (std::size_t i = 0; i < n; ++i)
                if (active >> i & 1) rows.push_back(i);
            std::vector<std::vector<double>> m;
            for (const std::size_t i : rows) {
                m.emplace_back();
                for (const std::size_t k : rows) m.back().push_back(a_[i][k]);
                m.back().push_back(-q_[i]);
            }
            if (!eliminate(m)) continue;
            std::vector<double> x(n);
            bool fits = true;
            for (std::size_t i = 0; i < rows.size(); ++i) {
                x[rows[i]] = m[i].back();
                fits = fits && m[i].back() >= 0;
            }
            for (std::size_t i = 0; i < n && fits; ++i) {
                double w = q_[i];
                for (std::size_t k = 0; k < n; ++k) w += a_[i][k] * x[k];
                fits = w >= -1e-9;
            }
            if (fits) return x;
        }
        REQUIRE_MESSAGE(false, "the oracle found no solution");
        return {};
    }
    /// Gauss-Jordan with pivoting; false if the matrix is singular.
    static bool eliminate(std::vector<std::vector<double>>& m) {
        for (std::size_t c = 0; c < m.size(); ++c) {
            std::size_t pivot = c;
            for (std::size_t i = c; i < m.size(); ++i)
                if (std::abs(m[i][c]) > std::abs(m[pivot][c])) pivot = i;
            if (std::abs(m[pivot][c]) < 1e-9) return false;
            std::swap(m[c], m[pivot]);
            for (std::size_t i = 0; i < m.size(); ++i) {
                if (i == c) continue;
                const double f = m[i][c] / m[c][c];
                for (std::size_t k = c; k <= m.size(); ++k) m[i][k] -= f * m[c][k];
            }
            for (std::size_t k = m.size() + 1; k-- > c;) m[c][k] /= m[c][c];
        }
        return true;
    }

    const problem& problem_;
    std::vector<point_of> points_;
    std::vector<std::vector<double>> a_;
    std::vector<double> q_;
};

const double close_by = cell::is_fixed ? 4096 * epsilon : 512 * epsilon;

CELL_CASE("solver: without friction it finds the exact solution of the complementarity problem") {
    cell::dice dice(200);
    for (int run = 0; run < 60; ++run) {
        problem p = random_problem(dice, 5, 0);
        const std::vector<motion_of> exact = exact_normals(p).velocities();
        solve<frictionless>(p, 3000);
        for (std::size_t i = 0; i < exact.size(); ++i) {
            REQUIRE(size(to_reals(p.bodies[i].velocity.linear) - exact[i].linear) <= close_by);
            REQUIRE(size(to_reals(p.bodies[i].velocity.angular) - exact[i].angular) <= close_by);
        }
    }
}

CELL_CASE("solver: what it converges to obeys Signorini's and Coulomb's laws") {
    cell::dice dice(201);
    int stuck = 0, slid = 0, apart = 0;
    for (int run = 0; run < 150; ++run) {
        // With far more friction, Gauss-Seidel may go round in circles: the problem itself need not have a solution.
        problem p = random_problem(dice, 6, run % 3 == 0 ? 0.3 : 0.5);
        solve<complete>(p, 3000);
        for (const point_of& at : points_of(p)) {
            const reals slip = slip_of(p.bodies, at);
            const double opens = dot(at.normal, slip) - at.target;
            REQUIRE(at.impulse >= 0);
            REQUIRE(opens >= -close_by);
            if (at.impulse > close_by) REQUIRE(opens <= close_by);
            const reals along = slip - at.normal * dot(at.normal, slip);
            const double pull = size(at.friction), most = at.coefficient * at.impulse;
            REQUIRE(pull <= most + close_by);
            apart += most <= close_by;
            if (most <= close_by) continue;
            if (pull < most - close_by) {
                ++stuck;
                REQUIRE(size(along) <= close_by);
            } else if (size(along) > 100 * close_by) {
                // Friction opposes the slip: the cone is round.
                ++slid;
                REQUIRE(dot(at.friction, along) <= -pull * size(along) * (1 - 1e-3));
            }
        }
    }
    CHECK(stuck > 10);
    CHECK(slid > 10);
    CHECK(apart > 10);
}

CELL_CASE("solver: impulses between bodies keep linear and angular momentum, after any number of rounds") {
    cell::dice dice(202);
    for (int run = 0; run < 60; ++run) {
        problem p = random_problem(dice, 6, 0.6, false);
        for (contact& c : p.contacts) c.rolling_resistance = run % 2 ? dice.real(0, 0.1) : S(0);
        const momenta before = momenta_of(p);
        solve<complete>(p, 1 + run % 8);
        const momenta after = momenta_of(p);
        REQUIRE(size(after.linear - before.linear) <= 256 * epsilon);
        REQUIRE(size(after.angular - before.angular) <= 1024 * epsilon);
    }
}

CELL_CASE("solver: what it converged to is its answer to the next step's warm start, in one round") {
    cell::dice dice(203);
    for (int run = 0; run < 40; ++run) {
        const problem start = random_problem(dice, 5, 0.6);
        problem p = start;
        solve<complete>(p, 3000);
        problem again = start;
        for (std::uint32_t i = 0; i < again.contacts.size(); ++i) {
            again.contacts[i] = p.contacts[i];
            again.contacts[i].persisted_mask = 255;
        }
        solve<complete>(again, 1);
        for (std::size_t i = 0; i < p.bodies.size(); ++i)
            REQUIRE(size(to_reals(again.bodies[i].velocity.linear) - to_reals(p.bodies[i].velocity.linear)) <=
                    4 * close_by);
    }
}

/// The speed along the normal with which a ball of 2 kg leaves a wall, one point between their centres.
double speed_after(double separation, double speed, double restitution) {
    problem p;
    p.bodies.resize(2);
    p.bodies[1].inverse_mass = physics::inverse_of<S>(0.5);
    p.bodies[1].velocity.linear.y = S(speed);
    contact c{};
    c.bodies.body_b = 1;
    c.normal.y = S(1);
    c.count = 1;
    c.points[0].separation = S(separation);
    c.restitution = S(restitution);
    p.contacts.push_back(c);
    solve<complete>(p, 1);
    return cell::number(p.bodies[1].velocity.linear.y);
}

CELL_CASE("solver: gaps may close, overlaps give no speed, bounces give back their share") {
    const double exact = 64 * epsilon;
    // One step closes what is left of a gap, no more.
    CHECK(std::abs(speed_after(0.0625, -10, 0) - -4) <= exact);
    CHECK(std::abs(speed_after(0.0625, -2, 0) - -2) <= exact);
    CHECK(std::abs(speed_after(0.0625, 3, 0) - 3) <= exact);
    // Overlapping surfaces must not approach, however deep they are.
    for (const double overlap : {1.0 / 256, 0.03125, 2.0}) {
        CHECK(std::abs(speed_after(-overlap, -2, 0)) <= exact);
        CHECK(std::abs(speed_after(-overlap, 1, 0) - 1) <= exact);
    }
    // A bounce gives back its share of the approach, but not of a slow one.
    CHECK(std::abs(speed_after(0, -8, 0.5) - 4) <= exact);
    CHECK(std::abs(speed_after(0, -8, 1) - 8) <= exact);
    CHECK(std::abs(speed_after(0, -0.25, 1)) <= exact);
    CHECK(std::abs(speed_after(0.0625, -8, 0.5) - 4) <= exact);
    // What would not touch within the step does not bounce.
    CHECK(std::abs(speed_after(0.25, -8, 0.5) - -8) <= exact);
}

CELL_CASE("contact: impulses go to the same features of the same pair, as a search of all pairs finds them") {
    cell::dice dice(204);
    for (int run = 0; run < 200; ++run) {
        physics::buffer<contact> before, now;
        const auto fill = [&](physics::buffer<contact>& list) {
            for (std::uint32_t a = 0; a < 4; ++a)
                for (std::uint32_t b = a + 1; b < 5; ++b) {
                    if (dice.below(2)) continue;
                    contact c{};
                    // The narrowphase may have turned the pair round.
                    const bool turned_round = dice.below(2);
                    c.shape_a = turned_round ? b : a;
                    c.shape_b = turned_round ? a : b;
                    c.normal = from_reals(random_direction(dice));
                    c.count = number_of(1 + dice.below(physics::manifold<S, D>::capacity));
                    for (int k = 0; k < c.count; ++k)
                        c.points[k].feature = static_cast<std::uint32_t>(4 * dice.below(2) + k);
                    list.push_back(c);
                }
        };
        fill(before);
        fill(now);
        for (contact& c : before)
            for (int k = 0; k < c.count; ++k) {
                c.points[k].normal_impulse = dice.real(0, 4);
                draw(dice, c.points[k].friction_impulse);
            }
        physics::solver_api::inherit_impulses(before, now.begin(), now.end());
        for (const contact& c : now)
            for (int k = 0; k < c.count; ++k) {
                const physics::solver_api::contact_point<S, D>* match = nullptr;
                reals friction;
                for (const contact& old : before)
                    for (int j = 0; j < old.count; ++j)
                        if (old.key() == c.key() && old.points[j].feature == c.points[k].feature) {
                            match = &old.points[j];
                            friction = friction_of(old, old.points[j]);
                        }
                REQUIRE(c.persisted(k) == (match != nullptr));
                REQUIRE(c.points[k].normal_impulse == (match ? match->normal_impulse : S(0)));
                // In world axes, less what the new normal takes.
                const reals n = to_reals(c.normal), kept = friction - n * dot(n, friction);
                REQUIRE(size(friction_of(c, c.points[k]) - kept) <= 32 * epsilon);
            }
    }
}

CELL_CASE("integrator: velocities advance by what drives a body and by implicit damping") {
    cell::dice dice(205);
    using integrator = physics::semi_implicit_euler::in<cell::space>;
    for (int i = 0; i < 500; ++i) {
        physics::twist<S, D> v = random_problem(dice, 1, 0).bodies.back().velocity;
        physics::solver_api::moving_body<S, D> b;
        b.acceleration = dice.vec<vec>(-20, 20);
        b.angular_acceleration = to_angular(random_axis(dice));
        b.linear_damping = dice.real(0, 20);
        b.angular_damping = dice.real(0, 20);
        const double h = 1.0 / 32;
        const reals linear = to_reals(v.linear), angular = to_reals(v.angular);
        integrator::integrate_velocity(v, b, S(h));
        const double slower = 1 + cell::number(b.linear_damping) * h, turning = 1 + cell::number(b.angular_damping) * h;
        REQUIRE(near(v.linear, (linear + to_reals(b.acceleration) * h) * (1 / slower), 64));
        REQUIRE(near(to_reals(v.angular), (angular + to_reals(b.angular_acceleration) * h) * (1 / turning), 64));
    }
}

}  // namespace dynamics_laws
}  // namespace
