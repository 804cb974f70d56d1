// Laws of the soft solver's contacts in lanes: how they are prepared, and what one round does.
#pragma once

#include <cstring>

#include "impulses.hpp"

namespace {
namespace soft_contacts_laws {

template <int Width, class Features = complete, class Solver = physics::soft_step>
void solve_softly(problem& p, int substeps) {
    struct drift {
        problem& p;

        void integrate_velocities(S) {}
        void integrate_positions(S h) {
            for (auto& b : p.bodies)
                b.displacement = {b.displacement.linear + b.velocity.linear * h,
                                  b.displacement.angular + b.velocity.angular * h};
        }
    };
    physics::arena scratch;
    physics::soft_step_settings<S> settings;
    settings.substeps = substeps;
    // Two bodies more: nobody, and a spare one.
    p.bodies.resize(p.bodies.size() + 2);
    const physics::solver_api::solver_bodies<S, D> bodies{p.bodies.data(), static_cast<std::uint32_t>(p.bodies.size())};
    using solver_in = typename Solver::template in<cell::space, Features, Width>;
    with_contacts<Features>(p, [&](auto& contacts) {
        solver_in::solve(bodies, {contacts, scratch}, settings, S(1.0 / 64), scratch, drift{p});
    });
    p.bodies.resize(p.bodies.size() - 2);
}

/// Gives contacts up to as many points as there may be, some of them with surfaces that run or resist rolling.
inline void enrich(cell::dice& dice, problem& p) {
    for (contact& c : p.contacts) {
        c.restitution = dice.real(0, 1);
        if (dice.below(3) == 0) c.rolling_resistance = dice.real(0, 0.1);
        if (dice.below(3) == 0) draw(dice, c.surface_velocity);
        const physics::tangents<S, D> frame(c.normal);
        const auto first = c.points[0];
        c.count = number_of(1 + dice.below(physics::manifold<S, D>::capacity));
        for (int k = 0; k < c.count; ++k) {
            auto& point = c.points[k];
            physics::tangential<S, D> offset{};
            if (k > 0) draw(dice, offset);
            const vec aside = frame.combine(offset) * S(0.25);
            point.position = first.position + aside;
            point.separation = dice.real(-0.02, 0.02);
            c.persisted_mask = static_cast<std::uint8_t>(c.persisted_mask | dice.below(2) << k);
            point.normal_impulse = dice.real(0, 1);
            point.substep_impulse = c.persisted(k) ? dice.real(0, 2) : S(0);
            draw(dice, point.friction_impulse);
        }
    }
}

/// Both sides of a contact at a place: how they answer to impulses there.
struct sides_at {
    side_of a, b;

    /// In 3D on each body's own surface, where all points together are apart.
    sides_at(const problem& p, const contact& c, vec offset)
        : a(p.bodies, c.bodies.body_a, c.anchors(0).a + offset - half_gap(c), -1),
          b(p.bodies, c.bodies.body_b, c.anchors(0).b + offset + half_gap(c), 1) {}
    static vec half_gap(const contact& c) {
        S sum = S(0);
        for (int k = 0; k < c.count; ++k) sum += c.points[k].separation;
        return sum > S(0) && !cell::is_2d ? c.normal * (sum * S(0.5 / c.count)) : vec{};
    }
    /// The velocity that an impulse gives to B's side, seen from A's, at another place; and the angular one.
    reals velocity(reals impulse, const sides_at& at) const {
        return impulse * (a.inverse_mass + b.inverse_mass) + cross(a.turn(cross(a.anchor, impulse)), at.a.anchor) +
               cross(b.turn(cross(b.anchor, impulse)), at.b.anchor);
    }
    reals spin(reals impulse) const { return a.turn(cross(a.anchor, impulse)) + b.turn(cross(b.anchor, impulse)); }
    reals spin_about(reals axis) const { return a.turn(axis) + b.turn(axis); }
};
/// Of a speed of order 1, or of the answer to an impulse of order 1.
inline void same(double found, double said, double scale = 1) {
    REQUIRE(std::abs(found - said) <= 256 * epsilon * (scale + std::abs(said)));
}

template <class Block>
void check_friction2(const Block& block, int lane, const sides_at& middle, reals t) {
    same(cell::number(block.friction.stop[lane]) * dot(t, middle.velocity(t, middle)), 1, 4);
}
template <class Stop>
void check_cone(const Stop& stop, int lane, const sides_at& at, reals t, reals u) {
    const double xx = dot(t, at.velocity(t, at)), xy = dot(t, at.velocity(u, at)), yy = dot(u, at.velocity(u, at));
    const double sxx = cell::number(stop.xx[lane]), sxy = cell::number(stop.xy[lane]);
    const double syy = cell::number(stop.yy[lane]);
    // How far from singular the answer is.
    const double condition = (xx + yy) * (xx + yy) / (xx * yy - xy * xy);
    same(xx * sxx + xy * sxy, 1, condition);
    same(xx * sxy + xy * syy, 0, condition);
    same(xy * sxy + yy * syy, 1, condition);
    same(cell::number(stop.gradient_step[lane]) * ((xx + yy) / 2 + std::hypot((xx - yy) / 2, xy)), 1, 4);
}

template <class Block>
void check_lane(const Block& block, int lane, const problem& p, const contact& c) {
    vec center{};
    for (int k = 0; k < c.count; ++k) center += c.points[k].position - c.points[0].position;
    center *= S(1) / S(int{c.count});
    const sides_at middle(p, c, center);
    const physics::tangents<S, D> frame(c.normal);
    const reals n = to_reals(c.normal), t = to_reals(frame.t), u = cell::is_2d ? reals{} : cross(n, t);
    for (int k = 0; k < c.count; ++k) {
        const sides_at here(p, c, c.points[k].position - c.points[0].position);
        const reals offset = to_reals(c.points[k].position - c.points[0].position - center);
        const auto& point = block.points[k];
        same(cell::number(point.mass[lane]) * dot(n, here.velocity(n, here)), 1, 8);
        REQUIRE(point.separation[lane] == c.points[k].separation);
        if constexpr (cell::is_2d) {
            same(cell::number(point.moment_arm[lane]), cross(offset, n).z);
        } else {
            same(cell::number(point.x[lane]), dot(offset, t));
            same(cell::number(point.y[lane]), dot(offset, u));
        }
    }
    const reals spin = middle.spin(n);
    const double push = dot(n, middle.velocity(n, middle));
    if constexpr (cell::is_2d) {
        const double all[] = {push, middle.spin_about({0, 0, 1}).z, spin.z};
        for (int i = 0; i < 3; ++i) same(static_cast<double>(block.k_matrix.rows[i][lane]), all[i], 8);
    } else {
        const reals about_t = middle.spin_about(t), about_u = middle.spin_about(u);
        const double all[] = {push, dot(about_t, t), dot(about_u, u), dot(spin, t), dot(spin, u), dot(about_t, u)};
        for (int i = 0; i < 6; ++i) same(static_cast<double>(block.k_matrix.rows[i][lane]), all[i], 8);
    }
    if constexpr (cell::is_2d) {
        check_friction2(block, lane, middle, t);
    } else if constexpr (requires { block.friction.twist_arm; }) {
        check_cone(block.friction.stop, lane, middle, t, u);
        same(cell::number(block.friction.stop_twist[lane]) * dot(n, middle.spin_about(n)), 1, 4);
        double reach = 0;
        for (int k = 0; k < c.count; ++k)
            reach += size(to_reals(c.points[k].position - c.points[0].position - center)) / c.count;
        same(cell::number(block.friction.twist_arm[lane]), cell::number(c.friction) * reach);
    } else {
        for (int k = 0; k < c.count; ++k)
            check_cone(block.friction.each[k].stop, lane, sides_at(p, c, c.points[k].position - c.points[0].position),
                       t, u);
    }
}
template <class Block>
void put_into_lane(Block& block, int lane, const problem& p, typename Block::gathering& gathered,
                   physics::arena& scratch) {
    const contact& c = p.contacts[static_cast<std::uint32_t>(lane)];
    block.put(lane, c, {c.bodies.body_a, c.bodies.body_b}, p.bodies.data(), {.share = S(0.25), .step = S(1)}, gathered,
              scratch);
}
template <class Friction>
void check_prepared(std::uint64_t seed) {
    constexpr int width = 4;
    using block_type = physics::detail::soft_contact<S, D, width, complete, Friction>;
    cell::dice dice(seed);
    for (int run = 0; run < 200; ++run) {
        // Some lanes are idle: their bodies are nobody.
        const int used = 1 + dice.below(width);
        problem p = random_problem(dice, used, 0.6, run % 2 != 0);
        enrich(dice, p);
        p.bodies.push_back({});
        physics::arena scratch;
        block_type block{};
        typename block_type::gathering gathered;
        for (int lane = 0; lane < width; ++lane) {
            if (lane < used) put_into_lane(block, lane, p, gathered, scratch);
            else block.a[lane] = block.b[lane] = 4;
        }
        block.prepare(p.bodies.data(), gathered);
        for (int lane = 0; lane < used; ++lane)
            check_lane(block, lane, p, p.contacts[static_cast<std::uint32_t>(lane)]);
        for (int lane = used; lane < width; ++lane)
            for (int k = 0; k < block.point_count; ++k) REQUIRE(block.points[k].mass[lane] == S(0));
    }
}
CELL_CASE("soft contacts: what is prepared in lanes is what each contact's own formulas say") {
    check_prepared<physics::patch_friction>(408);
    check_prepared<physics::point_friction>(409);
}

/// What is in one of the lanes.
template <class T, int W, int Bytes>
T lane_of(const physics::detail::pack<T, W, Bytes>& x, int lane) {
    return x.lane(lane);
}
template <class P, int N>
physics::vec<S, N> lane_of(const physics::detail::lane_vec<P, N>& v, int lane) {
    if constexpr (N == 2) return {v.x.lane(lane), v.y.lane(lane)};
    else return {v.x.lane(lane), v.y.lane(lane), v.z.lane(lane)};
}
CELL_CASE("soft contacts: each operator of vectors in lanes gives what vec's gives, to the bit") {
    constexpr int width = 4;
    using I = physics::inverse_of<S>;
    using P = physics::detail::kernel_pack<S, width>;
    using Q = physics::detail::kernel_pack<I, width>;
    using lanes = physics::detail::lane_vec<P, D>;
    cell::dice dice(407);
    for (int run = 0; run < 100; ++run) {
        vec v[width], w[width];
        S rows[2][D][width], scale[width];
        I matrix[6][width];
        for (int lane = 0; lane < width; ++lane) {
            v[lane] = dice.vec<vec>(-2, 2);
            w[lane] = dice.vec<vec>(-2, 2);
            scale[lane] = dice.real(-2, 2);
            for (auto& row : matrix) row[lane] = static_cast<I>(dice.number(-2, 2));
            for (int i = 0; i < D; ++i) {
                rows[0][i][lane] = v[lane][i];
                rows[1][i][lane] = w[lane][i];
            }
        }
        const lanes a = lanes::load(rows[0]), b = lanes::load(rows[1]);
        const P s = P::load(scale);
        for (int lane = 0; lane < width; ++lane) {
            REQUIRE(lane_of(a + b, lane) == v[lane] + w[lane]);
            REQUIRE(lane_of(a - b, lane) == v[lane] - w[lane]);
            REQUIRE(lane_of(a * s, lane) == v[lane] * scale[lane]);
            REQUIRE(lane_of(select_greater(s, P::broadcast(S(0)), a, b), lane) ==
                    (scale[lane] > S(0) ? v[lane] : w[lane]));
            REQUIRE(lane_of(dot(a, b), lane) == dot(v[lane], w[lane]));
            REQUIRE(lane_of(cross(a, b), lane) == cross(v[lane], w[lane]));
            const physics::symmetric<I> m{matrix[0][lane], matrix[1][lane], matrix[2][lane],
                                          matrix[3][lane], matrix[4][lane], matrix[5][lane]};
            const physics::detail::lane_vec<P, 3> turned =
                physics::detail::lane_symmetric<Q, 3>::load(matrix) * physics::detail::lane_vec<P, 3>{a.x, b.y, s};
            REQUIRE(lane_of(turned, lane) == times(m, physics::vec<S, 3>{v[lane].x, w[lane].y, scale[lane]}));
        }
    }
}

/// Takes the loads from most contacts, and parts their surfaces, some so little that they meet within the step. Bodies
/// keep still along some axes.
inline void unload(cell::dice& dice, problem& p) {
    for (auto& b : p.bodies)
        for (int i = 0; i < D; ++i)
            if (dice.below(2) == 0) b.velocity.linear[i] = S(0);
    for (contact& c : p.contacts) {
        if (dice.below(4) == 0) continue;
        if (dice.below(2) == 0) c.rolling_resistance = S(0);
        if (dice.below(2) == 0) c.surface_velocity = {};
        const S gap = dice.below(3) == 0 ? S(0.001) : S(0.1);
        c.persisted_mask = 0;
        for (int k = 0; k < c.count; ++k) {
            c.points[k].separation = gap + dice.real(0, 0.02);
            c.points[k].substep_impulse = S(0);
        }
    }
}

/// Of a problem after some substeps: all velocities and impulses.
template <int Width, class Solver>
std::vector<S> answer_in_lanes(problem p) {
    solve_softly<Width, complete, Solver>(p, 3);
    std::vector<S> all;
    const auto add = [&](const auto& part) {
        const std::size_t size = sizeof part / sizeof(S);
        all.resize(all.size() + size);
        std::memcpy(&all[all.size() - size], &part, sizeof part);
    };
    for (const auto& b : p.bodies) add(b.velocity);
    for (const contact& c : p.contacts) {
        add(physics::detail::value_of(c.twist_impulse));
        add(c.rolling_impulse);
        for (int k = 0; k < c.count; ++k) {
            add(c.points[k].normal_impulse);
            add(c.points[k].friction_impulse);
        }
    }
    return all;
}
template <class Solver>
void compare_widths(std::uint64_t seed) {
    cell::dice dice(seed);
    for (int run = 0; run < 180; ++run) {
        problem p = random_problem(dice, 1 + run % 20, 0.6, run % 2 != 0);
        enrich(dice, p);
        if (run % 3 != 0) unload(dice, p);
        const auto one = answer_in_lanes<1, Solver>(p), four = answer_in_lanes<4, Solver>(p);
        const auto eight = answer_in_lanes<8, Solver>(p);
        REQUIRE(std::memcmp(one.data(), four.data(), one.size() * sizeof(S)) == 0);
        REQUIRE(std::memcmp(one.data(), eight.data(), one.size() * sizeof(S)) == 0);
    }
}
template <class T>
void compare_widths() {
    if constexpr (std::is_floating_point_v<T>) {
        compare_widths<physics::soft_step>(402);
        compare_widths<physics::soft_step_with<physics::point_friction>>(403);
    }
}
CELL_CASE("soft contacts: every width of the lanes gives the same bits, whatever the contacts do") {
    compare_widths<S>();
}

CELL_CASE("soft contacts: where all points of a contact go on pushing, a round stops all of them, wherever they are") {
    cell::dice dice(404);
    for (int run = 0; run < 200; ++run) {
        problem p = random_problem(dice, 1, 0, run % 2 != 0);
        p.contacts[0].bodies.body_a = static_cast<std::uint32_t>(dice.below(2));
        p.contacts[0].bodies.body_b = 2;
        contact& c = p.contacts[0];
        c.count = number_of(2 + dice.below(physics::manifold<S, D>::capacity - 1));
        c.persisted_mask = 255;
        for (auto& b : p.bodies) b.velocity = {};
        const auto first = c.points[0];
        double wanted[physics::manifold<S, D>::capacity], sum = 0;
        for (int k = 0; k < c.count; ++k) {
            // Corners of a patch of any shape, under a load that leans.
            const double angle =
                2 * 3.14159265358979323846 * (k + (cell::is_2d ? 0 : dice.number(-0.2, 0.2))) / c.count;
            const reals n = to_reals(c.normal), t = to_reals(physics::tangents<S, D>(c.normal).t);
            const vec aside = from_reals(t * (0.3 * std::cos(angle)) +
                                         (cell::is_2d ? reals{} : cross(n, t) * (0.2 * std::sin(angle))));
            c.points[k].position = first.position + aside;
            c.points[k].separation = S(-0.01);
            c.points[k].substep_impulse = S(1);
            wanted[k] = 1 + 0.3 * std::cos(angle);
            sum += wanted[k];
        }
        const auto points = points_of(p);
        for (std::size_t k = 0; k < points.size(); ++k)
            for (const side_of& side : points[k].sides) {
                const reals impulse = points[k].normal * (-side.sign * wanted[k]);
                auto& velocity = p.bodies[side.body].velocity;
                velocity.linear += from_reals(impulse * side.inverse_mass);
                velocity.angular += to_angular(side.turn(cross(side.anchor, impulse)));
            }
        solve_softly<physics::detail::native_width<S>, frictionless>(p, 1);
        double borne = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            borne += cell::number(c.points[k].normal_impulse);
            REQUIRE(std::abs(dot(slip_of(p.bodies, points[k]), points[k].normal)) <= 4096 * epsilon);
        }
        REQUIRE(std::abs(borne - sum) <= 4096 * epsilon);
    }
}

CELL_CASE("soft contacts: points at all but one place, at different depths, push no harder than one") {
    cell::dice dice(405);
    for (int run = 0; run < 400; ++run) {
        problem p = random_problem(dice, 1, 0, run % 2 != 0);
        contact& c = p.contacts[0];
        c.count = number_of(2 + dice.below(physics::manifold<S, D>::capacity - 1));
        c.persisted_mask = 255;
        for (auto& b : p.bodies) b.velocity = {};
        const auto first = c.points[0];
        const double apart = std::pow(10, dice.number(-12, -1));
        for (int k = 0; k < c.count; ++k) {
            const vec aside = from_reals(random_direction(dice) * apart);
            c.points[k].position = first.position + aside;
            c.points[k].separation = dice.real(-0.02, 0);
            c.points[k].substep_impulse = dice.real(0, 0.01);
        }
        solve_softly<physics::detail::native_width<S>, frictionless>(p, 4);
        for (const point_of& q : points_of(p)) {
            // Faster than pushed apart, and than the loads that they begin with come to, nothing moves.
            REQUIRE(q.impulse <= 2);
            REQUIRE(size(slip_of(p.bodies, q)) <= 2);
        }
    }
}

}  // namespace soft_contacts_laws
}  // namespace
